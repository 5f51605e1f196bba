//! Damaged input into every reader: none may panic, and none may keep more than the input has room for.
//!
//! Each target takes whole small files, as this program or others write them, and edits them at random: the same edits
//! on every machine, and as many as the target says. Others and more are tried with
//!
//! ```sh
//! ZERORATE_FUZZ_SEED=7 ZERORATE_FUZZ_ITERATIONS=100000 cargo test -p zerorate-record --lib fuzz::
//! ```
//!
//! and a failure prints the seed and the number that replay it. The program has targets of its own, for devices and
//! words, with the same harness.

mod captures;
mod edit;
mod harness;

use harness::edited;
