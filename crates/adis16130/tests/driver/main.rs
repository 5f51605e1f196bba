//! Tests the driver with a mock of the part, which was written from docs/facts.md and has its own register table.

#[cfg(feature = "async")]
mod asynch;
#[cfg(feature = "bridge")]
mod bridge;
mod codes;
mod converter;
mod diagnosis;
mod errors;
mod features;
mod in_range;
mod kinds;
mod no_reading;
mod part;
mod registers;
mod sample;
mod sampler;
mod self_test;
mod wire;
