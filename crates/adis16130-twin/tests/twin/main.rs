//! The twin against `docs/facts.md`: every number here is written down from the facts again, not taken from the twin.

mod bus;
mod determinism;
mod faults;
mod keys;
mod link;
mod noise;
mod pins;
mod registers;
mod slow;
mod timing;
