//! Noise analyses in words and plots, shared by all front ends.

mod pictures;
mod words;

pub use pictures::{Group, Picture, axes_svg, svg};
pub use words::{
    GaussMarkov, TermRow, gauss_markov, holds_below, interval, is_without_misfit, misfit, predicts, removed, stated,
    term_rows,
};

use zerorate_imu::Record;

/// True if there are several records, all of one log: the axes of one sensor.
#[must_use]
pub fn are_axes(records: &[Record]) -> bool {
    records.len() > 1 && records.windows(2).all(|pair| pair[0].file == pair[1].file)
}

/// The name that distinguishes a record from the others: its column, or file and column for several logs.
#[must_use]
pub fn name(is_of_one_log: bool, record: &Record) -> String {
    if is_of_one_log { record.column.clone() } else { record.label() }
}
