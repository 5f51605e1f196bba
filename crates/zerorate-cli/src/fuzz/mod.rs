//! Damaged input into every decoder of the program: none may panic. The harness is that of `zerorate-data`.

mod calibrations;
#[path = "../../../zerorate-data/src/fuzz/edit.rs"]
mod edit;
#[path = "../../../zerorate-data/src/fuzz/harness.rs"]
mod harness;
mod wires;
mod words;

use harness::edited;
