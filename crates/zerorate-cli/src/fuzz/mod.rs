//! Fuzz tests: damaged input into every decoder of the program. None may panic. `zerorate-record` has the harness.

mod calibrations;
#[path = "../../../zerorate-record/src/fuzz/edit.rs"]
mod edit;
#[path = "../../../zerorate-record/src/fuzz/harness.rs"]
mod harness;
mod wires;
mod words;

use harness::edited;
