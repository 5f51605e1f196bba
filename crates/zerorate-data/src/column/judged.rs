//! The readings of a capture that are not to be believed are no numbers, but gaps.

use super::wrong;
use super::{LogError, Result as LogResult};
use crate::believed;
use crate::capture::CaptureError;
use crate::cells::integers;
use adis16130::{ChannelStatus, RateCode, Sample, TempCode, Width};
use arrow_array::types::{UInt8Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrayRef, BooleanArray};
use arrow_schema::ArrowError;
use arrow_select::concat::concat;
use arrow_select::nullif::nullif;
use std::path::Path;
use zerorate::health::{Health, Judged};
use zerorate::{Axis, Reading, Tally};

/// The raw columns that judging takes, after those of the numbers.
pub const NEEDED: [&str; 5] = ["t_ns", "lost", "rate_code", "status", "temp_code"];

/// Which readings a column is made of.
#[derive(Clone, Copy, Debug)]
enum Channel {
    Rate,
    Temp,
}

/// Judges the rows of a capture while one of its columns is read.
pub struct Judging {
    channel: Channel,
    width: Width,
    health: Health,
    tally: Tally,
    start_ns: Option<u64>,
    /// Values of the rows that are not judged yet.
    tail: Option<ArrayRef>,
}

impl Judging {
    /// For the column of this name; none if it holds no readings.
    pub fn of_column(name: &str, width: Width, axis: &Axis) -> Option<Self> {
        let channel = match name {
            "rate_code" | "rate_dps" | "rate_corrected_dps" => Channel::Rate,
            "temp_code" | "temp_c" => Channel::Temp,
            _ => return None,
        };
        let (health, tally) = (Health::new(axis), Tally::default());
        Some(Self { channel, width, health, tally, start_ns: None, tail: None })
    }

    /// Takes a piece in: the values, and the columns that are [`NEEDED`]. Gives the values that are judged by now, in
    /// their order, without those that are not to be believed.
    pub fn take(&mut self, value: &ArrayRef, needed: &[ArrayRef]) -> Result<ArrayRef, ArrowError> {
        let [t_ns, lost, rate, status, temp] = needed else {
            return Err(ArrowError::SchemaError("a raw column is missing".to_owned()));
        };
        let (t_ns, lost) = (integers::<UInt64Type>(t_ns)?, integers::<UInt32Type>(lost)?);
        let (rate, status, temp) =
            (integers::<UInt32Type>(rate)?, integers::<UInt8Type>(status)?, integers::<UInt32Type>(temp)?);
        let mut believed = Vec::with_capacity(value.len() + 2);
        for row in 0..value.len() {
            let sample = Sample {
                t_ns: t_ns.value(row),
                seq: row as u32,
                rate: RateCode::new(rate.value(row), self.width),
                status: status.is_valid(row).then(|| ChannelStatus::new(status.value(row))),
                temp: temp.is_valid(row).then(|| TempCode::new(temp.value(row), self.width)),
                lost: lost.value(row),
            };
            self.start_ns.get_or_insert(sample.t_ns);
            self.tally.samples += 1;
            believed.extend(self.health.push(&Reading::from(&sample)).map(|judged| self.believes(&judged)));
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

    /// What there is to say of the rows, once all are judged. A part that had stopped is no measurement.
    pub fn found(&self, path: &Path) -> LogResult<Option<String>> {
        let start_ns = self.start_ns.unwrap_or_default();
        if let Some(frozen) = self.health.frozen_at_end() {
            let why = believed::frozen_text(&frozen, start_ns);
            return Err(LogError::Refused(format!("{}: {why}; or cut the recording before that", path.display())));
        }
        let found = believed::warnings(&self.health, &self.tally, start_ns);
        let text = format!("{}: {}", path.display(), found.join("; "));
        Ok((!found.is_empty()).then_some(text))
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
