//! The code that the boards share: a bridge (`docs/formats/bridge.md`) without its pins.
//!
//! [`sampling`] reads the part. It runs in an interrupt, above [`port`], which carries bytes over USB when there is
//! time. They share a [`Link`] and nothing else.

#![no_std]

pub mod bus;
pub mod lamp;
mod link;
pub mod port;
pub mod sampling;
pub mod state;
#[cfg(test)]
mod tests;

pub use link::Link;
