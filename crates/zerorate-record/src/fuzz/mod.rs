//! Fuzz tests: the reader of captures gets damaged input in every format, and must not panic.
//!
//! Each target edits small, valid captures at random, as often as it sets. The edits are the same on every machine. To
//! run other edits or more:
//!
//! ```sh
//! ZERORATE_FUZZ_SEED=7 ZERORATE_FUZZ_ITERATIONS=100000 cargo test -p zerorate-record --lib fuzz::
//! ```
//!
//! A failure prints the seed and the iteration that replay it. The command-line program has fuzz targets with the
//! same harness, for the bytes of a bridge, for calibrations and for arguments.

mod captures;
mod edit;
mod harness;

use harness::edited;
