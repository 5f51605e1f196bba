//! Fuzz tests: every reader gets damaged input. None may panic, and none may allocate more than the input justifies.
//!
//! Each target edits whole small files, as this program or others write them, at random. The edits are the same on
//! every machine, and the target sets their number. To run other edits or more:
//!
//! ```sh
//! ZERORATE_FUZZ_SEED=7 ZERORATE_FUZZ_ITERATIONS=100000 cargo test -p zerorate-record --lib fuzz::
//! ```
//!
//! A failure prints the seed and the iteration that replay it. The command-line program has its own fuzz targets,
//! for devices and words, with the same harness.

mod captures;
mod edit;
mod harness;

use harness::edited;
