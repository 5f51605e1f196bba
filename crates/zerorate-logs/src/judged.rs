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

/// Judges the readings of an axis, once for all columns that hold them.
pub struct Judging {
    axis: usize,
    layout: Layout,
    health: Health,
    tally: Tally,
    start_ns: Option<u64>,
}

/// Whether each reading of a stretch is to be believed.
#[derive(Default)]
pub struct Believed {
    rates: Vec<bool>,
    temps: Vec<bool>,
}

impl Judging {
    /// Judges the readings of an axis by its number; none if the part has no such axis.
    fn new(axis: usize, info: &CaptureInfo) -> Option<Self> {
        let health = Health::new(&info.part().axes.get(axis)?.axis);
        Some(Self { axis, layout: info.layout.clone(), health, tally: Tally::default(), start_ns: None })
    }

    /// Takes rows in, and says what is judged by now: of all rows so far but for the last two.
    pub fn take(&mut self, rows: &Rows) -> Believed {
        let mut believed = Believed::with_capacity(rows.len());
        self.tally.samples += rows.len() as u64;
        self.start_ns = self.start_ns.or(rows.marks().next().map(|mark| mark.t_ns));
        let judged = rows.readings(&self.layout, self.axis).filter_map(|reading| self.health.push(&reading));
        judged.for_each(|judged| believed.push(&judged));
        believed
    }

    /// The rest, at the end of the capture.
    pub fn finish(&mut self) -> Believed {
        let mut believed = Believed::default();
        while let Some(judged) = self.health.finish() {
            believed.push(&judged);
        }
        believed
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
}

impl Believed {
    fn with_capacity(rows: usize) -> Self {
        let some = || Vec::with_capacity(rows + 2);
        Self { rates: some(), temps: some() }
    }

    fn push(&mut self, judged: &Judged) {
        self.rates.push(judged.flags.rate_is_good());
        self.temps.push(judged.flags.temp_is_good());
    }
}

/// The readings that make a column.
#[derive(Clone, Copy, Debug)]
enum Channel {
    Rate,
    Temp,
}

/// A column of readings, of which those that are not to be believed become gaps.
pub struct Readings {
    /// Its place among the judges.
    pub judge: usize,
    channel: Channel,
    /// Values of the rows that are not judged yet.
    tail: Option<ArrayRef>,
}

impl Readings {
    /// The readings of the column of this name; none if it holds no readings. The judge of their axis joins `judges`,
    /// unless it is there. A temperature is judged with the first axis.
    pub fn of_column(name: &str, info: &CaptureInfo, judges: &mut Vec<Judging>) -> Option<Self> {
        let of_axis = info.layout.axes().iter().position(|axis| {
            [axis.code_column(), axis.rate_column(), axis.corrected_column()].contains(&name.to_owned())
        });
        let (channel, axis) = match (of_axis, name) {
            (Some(axis), _) => (Channel::Rate, axis),
            (None, "temp_code" | "temp_c") => (Channel::Temp, 0),
            (None, _) => return None,
        };
        let judge = match judges.iter().position(|judge| judge.axis == axis) {
            Some(place) => place,
            None => {
                judges.push(Judging::new(axis, info)?);
                judges.len() - 1
            }
        };
        Some(Self { judge, channel, tail: None })
    }

    /// Takes the values of more rows in. Gives those that are judged by now, in their order, without those that are
    /// not to be believed.
    pub fn take(&mut self, values: &ArrayRef, believed: &Believed) -> Result<ArrayRef, ArrowError> {
        let believed = self.of_channel(believed);
        let values = match self.tail.take() {
            Some(tail) => concat(&[&tail, values])?,
            None => values.clone(),
        };
        self.tail = Some(values.slice(believed.len(), values.len() - believed.len()));
        masked(&values.slice(0, believed.len()), believed)
    }

    /// The values that are left.
    pub fn finish(&mut self, believed: &Believed) -> Result<Option<ArrayRef>, ArrowError> {
        self.tail.take().map(|values| masked(&values, self.of_channel(believed))).transpose()
    }

    fn of_channel<'a>(&self, believed: &'a Believed) -> &'a [bool] {
        match self.channel {
            Channel::Rate => &believed.rates,
            Channel::Temp => &believed.temps,
        }
    }
}

/// An error of judging, in the file at `path`.
pub fn failed(path: &Path, error: &ArrowError) -> CaptureError {
    wrong(path, format_args!("raw columns"), error.to_string())
}

fn masked(values: &ArrayRef, believed: &[bool]) -> Result<ArrayRef, ArrowError> {
    if believed.iter().all(|believed| *believed) {
        return Ok(values.clone());
    }
    nullif(values, &BooleanArray::from_iter(believed.iter().map(|believed| Some(!believed))))
}
