//! Compares the twin with `docs/facts.md`. Every number in these tests comes from the facts, not from the twin.

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
