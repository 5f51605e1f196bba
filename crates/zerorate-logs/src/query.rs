//! The columns that a reader is asked for.

use crate::choice::ColumnSelection;
use crate::options::ColumnOptions;

/// The wanted columns, and the known facts about them.
pub struct ColumnQuery<'a> {
    pub wanted: ColumnSelection<'a>,
    pub args: &'a ColumnOptions,
    /// True if the temperature of a capture is to be read in the same pass. It comes last.
    pub with_temperature: bool,
}

impl<'a> ColumnQuery<'a> {
    /// Asks for these columns without a temperature beside them.
    pub fn of(wanted: ColumnSelection<'a>, args: &'a ColumnOptions) -> Self {
        Self { wanted, args, with_temperature: false }
    }
}
