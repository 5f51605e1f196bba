//! Tests every reader with damaged input: none may panic, and none may allocate more than the input justifies.
//!
//! Each target takes whole small files, as this program or others write them, and edits them at random. The edits are
//! the same on every machine, and the target sets their number. To run other or more edits:
//!
//! ```sh
//! ZERORATE_FUZZ_SEED=7 ZERORATE_FUZZ_ITERATIONS=100000 cargo test -p zerorate-record --lib fuzz::
//! ```
//!
//! A failure prints the seed and the number that replay it. The program has its own targets, for devices and words,
//! with the same harness.

mod captures;
mod edit;
mod harness;

use harness::edited;
