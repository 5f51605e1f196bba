//! The C interface: see `include/zerorate.h`, which is generated from this crate, and `README.md`.
//!
//! Only the functions that take C pointers (`boundary.rs`, `bus.rs`, `table.rs`) and the exports use `unsafe`. Nothing
//! allocates and nothing panics. `cargo xtask c` checks the library for both.

#![cfg_attr(not(test), no_std)]

mod boundary;
mod bus;
mod correction;
mod corrector;
mod gyro;
mod procedure;
mod remedy;
#[cfg(not(test))]
mod runtime;
mod self_test;
mod status;
mod table;
#[cfg(test)]
mod tests;
mod tracker;
