//! Readings of a capture that cannot be trusted become gaps.

use super::wrong;
use super::{LogError, Result as LogResult};
use crate::warning::LogWarning;
use arrow_array::{Array, ArrayRef, BooleanArray};
use arrow_schema::ArrowError;
use arrow_select::concat::concat;
use arrow_select::nullif::nullif;
use std::path::Path;
use zerorate::Tally;
use zerorate::health::{Health, Judged};
use zerorate_record::columns::Rows;
use zerorate_record::{CaptureError, CaptureInfo, Layout, believed};

/// The readings that make a column.
#[derive(Clone, Copy, Debug)]
enum Channel {
    Rate,
    Temp,
}

/// Judges the rows of a capture while one of its columns is read.
pub struct Judging {
    channel: Channel,
    axis: usize,
    layout: Layout,
    health: Health,
    tally: Tally,
    start_ns: Option<u64>,
    /// Values of the rows that are not judged yet.
    tail: Option<ArrayRef>,
}

impl Judging {
    /// The readings of the column of this name; none if it holds no readings. A temperature is judged with the first
    /// axis.
    pub fn of_column(name: &str, info: &CaptureInfo) -> Option<Self> {
        let layout = info.layout.clone();
        let of_axis = layout.axes().iter().position(|axis| {
            [axis.code_column(), axis.rate_column(), axis.corrected_column()].contains(&name.to_owned())
        });
        let (channel, axis) = match (of_axis, name) {
            (Some(axis), _) => (Channel::Rate, axis),
            (None, "temp_code" | "temp_c") => (Channel::Temp, 0),
            (None, _) => return None,
        };
        let (health, tally) = (Health::new(&info.part().axes.get(axis)?.axis), Tally::default());
        Some(Self { channel, axis, layout, health, tally, start_ns: None, tail: None })
    }

    /// Takes a piece in: the values, and the rows that they stand in. Gives the values that are judged by now, in
    /// their order, without those that are not to be believed.
    pub fn take(&mut self, value: &ArrayRef, rows: &Rows) -> Result<ArrayRef, ArrowError> {
        let mut believed = Vec::with_capacity(value.len() + 2);
        for row in rows.iter() {
            self.start_ns.get_or_insert(row.t_ns);
            self.tally.samples += 1;
            let reading = self.layout.reading(&row, self.axis);
            let judged = reading.and_then(|reading| self.health.push(&reading));
            believed.extend(judged.map(|judged| self.believes(&judged)));
        }
        let values = match self.tail.take() {
            Some(tail) => concat(&[&tail, value])?,
            None => value.clone(),
        };
        self.tail = Some(values.slice(believed.len(), values.len() - believed.len()));
        masked(&values.slice(0, believed.len()), believed)
    }

    /// The values that are left.
    pub fn finish(&mut self) -> Result<Option<ArrayRef>, ArrowError> {
        let mut believed = Vec::new();
        while let Some(judged) = self.health.finish() {
            believed.push(self.believes(&judged));
        }
        self.tail.take().map(|values| masked(&values, believed)).transpose()
    }

    /// The warnings about the rows, once all are judged. A part that had stopped is refused.
    pub fn found(&self, path: &Path) -> LogResult<Vec<LogWarning>> {
        let start_ns = self.start_ns.unwrap_or_default();
        if let Some(frozen) = self.health.frozen_at_end() {
            let why = believed::frozen_text(&frozen, start_ns);
            return Err(LogError::Refused(
                "frozen",
                format!("{}: {why}; or cut the recording before that", path.display()),
            ));
        }
        let found = believed::warnings(&self.health, &self.tally, start_ns).into_iter();
        Ok(found.map(|warning| LogWarning::Readings { path: path.display().to_string(), warning }).collect())
    }

    fn believes(&self, judged: &Judged) -> bool {
        match self.channel {
            Channel::Rate => judged.flags.rate_is_good(),
            Channel::Temp => judged.flags.temp_is_good(),
        }
    }
}

/// An error of judging, in the file at `path`.
pub fn failed(path: &Path, error: &ArrowError) -> CaptureError {
    wrong(path, format_args!("raw columns"), error.to_string())
}

fn masked(values: &ArrayRef, believed: Vec<bool>) -> Result<ArrayRef, ArrowError> {
    if believed.iter().all(|believed| *believed) {
        return Ok(values.clone());
    }
    nullif(values, &BooleanArray::from_iter(believed.into_iter().map(|believed| Some(!believed))))
}
