//! The request for columns that a reader receives.

use crate::choice::ColumnSelection;
use crate::options::ColumnOptions;

pub struct ColumnQuery<'a> {
    pub wanted: ColumnSelection<'a>,
    pub args: &'a ColumnOptions,
    /// True if the temperature of a capture is to be read in the same pass. If it was not requested, it comes last.
    pub with_temperature: bool,
}

impl<'a> ColumnQuery<'a> {
    pub fn of(wanted: ColumnSelection<'a>, args: &'a ColumnOptions) -> Self {
        Self { wanted, args, with_temperature: false }
    }
}
