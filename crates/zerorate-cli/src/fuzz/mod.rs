//! Fuzz tests of calibrations, of messages of a bridge, and of words of the command line: damaged input causes no
//! panic. `zerorate-record` has the harness.

mod calibrations;
#[path = "../../../zerorate-record/src/fuzz/edit.rs"]
mod edit;
#[path = "../../../zerorate-record/src/fuzz/harness.rs"]
mod harness;
mod wires;
mod words;

use harness::edited;
