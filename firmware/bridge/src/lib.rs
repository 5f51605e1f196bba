//! The code that the boards share: a bridge (`docs/formats/bridge.md`) without its pins.
//!
//! [`sampling`] reads the part. It runs in an interrupt with a higher priority than [`port`], which carries bytes over
//! USB. The two share a [`Link`] and nothing else.

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
