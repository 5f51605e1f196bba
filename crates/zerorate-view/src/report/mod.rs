//! Reports: self-contained HTML pages for the screen and for paper.

mod allan;
mod calibration;
mod chamber;
mod course;

pub use allan::{AllanPage, Table, allan_page};
pub use calibration::{calibration_page, calibration_picture};
pub use chamber::{ChamberPage, chamber_page, over_temperature, over_time, wide_loop};
pub use course::{Course, Moment};

/// A named fact: a row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// The text of the first cell.
    pub name: String,
    /// The text of the second cell: the value, with its unit.
    pub value: String,
}

impl Fact {
    /// Makes a fact from its name and its value.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}
