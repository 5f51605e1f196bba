//! What the boards share: a bridge (`docs/formats/bridge.md`) without its pins.
//!
//! [`sampling`] reads the part. It runs in an interrupt, above [`port`], which carries bytes over USB when there is
//! time. A [`Link`] is all that they share.

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
