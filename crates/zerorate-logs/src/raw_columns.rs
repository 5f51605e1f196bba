//! Columns as their reader finds them in a file, before units and times are applied.

use crate::clock::Times;
use crate::sample::{Cell, ROWS, Sampled};
use crate::series::SeriesBuilder;
use crate::stated_rate::StatedRate;
use crate::warning::LogWarning;
use std::borrow::Cow;
use zerorate_allan::Gap;
use zerorate_input::{Quantity, Unit};

/// The columns that a reader found, and what the file states about their times.
pub struct RawColumns {
    pub columns: Vec<RawColumn>,
    pub clock: Clock,
    pub warnings: Vec<LogWarning>,
    /// The first rows of all columns of the file; empty if the reader saw only `columns`. For a bag with a given rate,
    /// only the first stamps.
    pub sample: Vec<Sampled>,
    pub stated_rate: Option<StatedRate>,
}

impl RawColumns {
    /// The columns, and the name and times of the time column, from a reader that saw no other columns.
    pub fn new(
        columns: impl IntoIterator<Item = RawColumn>,
        time: Option<(String, Times)>,
        warnings: impl IntoIterator<Item = LogWarning>,
    ) -> Self {
        let clock = time.map_or(Clock::Silent, |(name, times)| Clock::Column(name, times));
        let (columns, warnings) = (columns.into_iter().collect(), warnings.into_iter().collect());
        Self { columns, clock, warnings, sample: Vec::new(), stated_rate: None }
    }
}

pub struct RawColumn {
    pub name: String,
    pub values: SeriesBuilder,
    /// The quantity, and the size of a step of 1 in the unit of results, if the format of the file defines them.
    pub stated: Option<(Quantity, f64)>,
    /// The size of a step of 1 in the unit of the log, if a line above the data states it; otherwise 1.
    pub step: f64,
    /// True if the file states the scale of the codes, as a capture does.
    pub is_scaled: bool,
    pub warnings: Vec<LogWarning>,
    /// True if this is an unrequested temperature beside requested columns.
    pub is_beside: bool,
    /// True if the end of the name means a sensor and is no unit.
    pub is_lettered: bool,
}

impl RawColumn {
    pub fn new(name: String, values: SeriesBuilder) -> Self {
        let (stated, warnings) = (None, Vec::new());
        Self { name, values, stated, step: 1.0, is_scaled: false, warnings, is_beside: false, is_lettered: false }
    }

    /// The column with the unit and the size of its steps, which the log states.
    pub fn in_steps(self, unit: Unit, step: f64) -> Self {
        Self { stated: Some((unit.quantity(), unit.in_results() * step)), step, ..self }
    }
}

/// What a file states about the times of its rows.
pub enum Clock {
    /// The file states nothing.
    Silent,
    /// The name of a column, and the times in it.
    Column(String, Times),
    /// Rate and gaps, as the writer of the file counted them.
    Counted { rate_hz: Option<f64>, gaps: Vec<Gap> },
}

/// The first rows of all columns of a log, if its reader saw them all, or else of the columns that were read.
pub fn first_rows<'a>(seen: &'a [Sampled], columns: &[RawColumn]) -> Cow<'a, [Sampled]> {
    let cells = |column: &RawColumn| column.values.first_rows(ROWS).into_iter().map(Cell::number).collect();
    let read = |column: &RawColumn| Sampled { cells: cells(column), ..Sampled::new(&column.name) };
    if seen.is_empty() { Cow::Owned(columns.iter().map(read).collect()) } else { Cow::Borrowed(seen) }
}
