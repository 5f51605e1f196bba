//! A column of a table with names and types: an Arrow stream or file, Parquet, a capture or not.

use super::choice::{Choice, Columns};
use super::clock::Times;
use super::judged::{self, Judging};
use super::series::{SeriesBuilder, join, missing_in};
use super::unit::TimeUnit;
use super::{Clock, ColumnOptions, Found, Gap, Result, wrong};
use crate::capture::columns::Rows;
use crate::capture::succession::Mark;
use crate::capture::table::BatchSource;
use crate::capture::{CaptureError, CaptureInfo, Checked, Layout, info};
use crate::cells::{floats, integers};
use crate::limits::Room;
use arrow_array::types::{Int32Type, Int64Type};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::{DataType, Schema, TimeUnit as ArrowUnit};
use std::path::Path;

/// Reads a column of a table. Of a capture all columns are read, because its checks are over all of them.
pub fn read(path: &Path, mut source: Box<dyn BatchSource>, room: Room, args: &ColumnOptions) -> Result<Found> {
    let schema = source.stated().schema.clone();
    let mut reading = Reading::start(path, &schema, room, args)?;
    if info::is_capture(schema.metadata()) {
        let mut capture = Checked::new(path, source)?;
        while let Some((batch, rows)) = capture.next_rows()? {
            reading.take(&batch, Some(&rows))?;
        }
        return reading.finish(Some(capture.warnings().join("; ")).filter(|said| !said.is_empty()));
    }
    while let Some(batch) = source.next_batch()? {
        reading.take(&batch, None)?;
    }
    reading.finish(source.stated().warning.clone())
}

/// A column being read, with its time.
pub struct Reading<'a> {
    path: &'a Path,
    /// The columns to be read: the numbers; the time, or time and losses of a capture.
    pub columns: Vec<usize>,
    name: String,
    time_name: String,
    values: SeriesBuilder,
    times: Option<Times>,
    capture: Option<Capture>,
    judging: Option<Judging>,
}

impl<'a> Reading<'a> {
    /// Chooses the columns.
    pub fn start(path: &'a Path, schema: &Schema, room: Room, args: &ColumnOptions) -> Result<Self> {
        let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
        let position = |wanted: &str| names.iter().position(|name| *name == wanted);
        let metadata = schema.metadata();
        let info = info::is_capture(metadata).then(|| CaptureInfo::from_metadata(path, metadata)).transpose()?;
        let default = info.as_ref().and_then(|info| only_rate(&info.layout, position));
        let numeric = schema.fields().iter().map(|field| field.data_type().is_numeric()).collect();
        let Choice { value, time } = Columns { path, names: names.clone(), numeric }.choose(args, default)?;
        let name = names[value].to_owned();
        let info = info.filter(|_| time.is_none());
        let capture = info.as_ref().map(|info| Capture::of(&info.layout, &name));
        let judging = info.as_ref().and_then(|info| Judging::of_column(&name, info));
        let columns = [value].into_iter().chain(time).collect();
        let mut values = SeriesBuilder::new(room);
        values.reserve(0, schema.field(value).data_type().is_integer());
        let mut times = time.map(|_| Times::new());
        if let (Some(times), Some(time)) = (&mut times, time) {
            times.unit = unit_of(schema.field(time).data_type());
        }
        let time_name = time.map_or_else(String::new, |index| names[index].to_owned());
        Ok(Self { path, columns, name, time_name, values, times, capture, judging })
    }

    /// Makes room for so many rows.
    pub fn reserve(&mut self, rows: usize, data_type: &DataType) {
        self.values.reserve(rows, data_type.is_integer());
    }

    fn take(&mut self, batch: &RecordBatch, rows: Option<&Rows>) -> Result<(), CaptureError> {
        let columns: Vec<ArrayRef> = self.columns.iter().map(|index| batch.column(*index).clone()).collect();
        self.append(&columns, rows)
    }

    /// Adds a piece of the columns; of a capture, with its rows.
    pub fn append(&mut self, columns: &[ArrayRef], rows: Option<&Rows>) -> Result<(), CaptureError> {
        let first = self.values.rows();
        self.check_room(columns.first().map_or(0, |column| column.len() as u64))?;
        if let (Some(times), Some(column)) = (&mut self.times, columns.get(1)) {
            append_times(times, column).map_err(|(row, what)| {
                wrong(self.path, format_args!("column {}, row {}", self.time_name, first + row as u64), what)
            })?;
        }
        if let (Some(capture), Some(rows)) = (&mut self.capture, rows) {
            capture.count(rows);
        }
        let values = match (&mut self.judging, rows) {
            (Some(judging), Some(rows)) => {
                judging.take(&columns[0], rows).map_err(|error| judged::failed(self.path, &error))?
            }
            _ => columns[0].clone(),
        };
        self.append_values(&values, first)
    }

    fn append_values(&mut self, values: &ArrayRef, first: u64) -> Result<(), CaptureError> {
        append_values(&mut self.values, values).map_err(|(row, what)| {
            wrong(self.path, format_args!("column {}, row {}", self.name, first + row as u64), what)
        })
    }

    /// Whether there is room for `more` rows.
    pub fn check_room(&self, more: u64) -> Result<(), CaptureError> {
        self.values.check_room(more).map_err(|why| CaptureError::no_room(self.path, why))
    }

    /// All rows were read.
    pub fn finish(mut self, warning: Option<String>) -> Result<Found> {
        let mut found = None;
        if let Some(mut judging) = self.judging.take() {
            let last = judging.finish().map_err(|error| judged::failed(self.path, &error))?;
            let first = self.values.rows();
            last.map_or(Ok(()), |last| self.append_values(&last, first))?;
            found = judging.found(self.path)?;
        }
        let warning = [warning, found].into_iter().flatten().reduce(|all, more| format!("{all}; {more}"));
        let Self { name, time_name, values, times, capture, .. } = self;
        let scale = capture.as_ref().and_then(|capture| capture.scale);
        let clock = match (times, capture) {
            (Some(times), _) => Clock::Column(time_name, times),
            (None, Some(capture)) => capture.clock(),
            (None, None) => Clock::Silent,
        };
        Ok(Found { name, values, clock, scale, warning })
    }
}

/// A row in a piece, and what is wrong there.
type Wrong = (usize, String);

/// Integers go in as such, as far as they are small enough to be codes.
fn append_values(values: &mut SeriesBuilder, column: &ArrayRef) -> Result<(), Wrong> {
    if column.data_type().is_integer() {
        if let Ok(codes) = integers::<Int32Type>(column) {
            match codes.null_count() {
                0 => values.extend_codes(codes.values()),
                _ => codes.iter().for_each(|code| push(values, code.map(i64::from))),
            }
            return Ok(());
        }
        if let Ok(integers) = integers::<Int64Type>(column) {
            integers.iter().for_each(|integer| push(values, integer));
            return Ok(());
        }
    }
    let numbers = floats(column).map_err(|error| (0, error.to_string()))?;
    let infinite = |row| (row, "it is infinite, which cannot be averaged".to_owned());
    if numbers.null_count() == 0 {
        return values.extend_numbers(numbers.values()).map_err(infinite);
    }
    match numbers.iter().position(|number| !values.push_number(number.unwrap_or(f64::NAN))) {
        Some(row) => Err(infinite(row)),
        None => Ok(()),
    }
}

fn push(values: &mut SeriesBuilder, integer: Option<i64>) {
    match integer {
        Some(integer) => values.push_integer(integer),
        None => values.push_missing(),
    }
}

/// The unit of a type that states one.
fn unit_of(data_type: &DataType) -> Option<TimeUnit> {
    let (DataType::Timestamp(unit, _) | DataType::Duration(unit)) = data_type else {
        return None;
    };
    Some(match unit {
        ArrowUnit::Second => TimeUnit::S,
        ArrowUnit::Millisecond => TimeUnit::Ms,
        ArrowUnit::Microsecond => TimeUnit::Us,
        ArrowUnit::Nanosecond => TimeUnit::Ns,
    })
}

fn append_times(times: &mut Times, column: &ArrayRef) -> Result<(), Wrong> {
    let missing = || "no time; every row must have one".to_owned();
    let at = |row: usize| move |what: String| (row, what);
    if column.data_type().is_integer() || times.unit.is_some() {
        let found = integers::<Int64Type>(column).map_err(|error| (0, error.to_string()))?;
        for (row, time) in found.iter().enumerate() {
            time.ok_or_else(missing).and_then(|time| times.push_integer(time)).map_err(at(row))?;
        }
    } else if column.data_type().is_numeric() {
        let found = floats(column).map_err(|error| (0, error.to_string()))?;
        for (row, time) in found.iter().enumerate() {
            time.ok_or_else(missing).and_then(|time| times.push_number(time)).map_err(at(row))?;
        }
    } else {
        return Err((0, format!("it holds {} and no time; choose another with --time-column", column.data_type())));
    }
    Ok(())
}

/// The column with the rate of a capture of one axis, corrected if it is.
fn only_rate(layout: &Layout, position: impl Fn(&str) -> Option<usize>) -> Option<usize> {
    let [axis] = layout.axes() else { return None };
    position(&axis.corrected_column()).or_else(|| position(&axis.code_column()))
}

/// What a capture tells beyond its numbers: it has counted what was lost.
struct Capture {
    /// °/s or °C in a step of the code, where the column holds codes.
    scale: Option<f64>,
    span_ns: Option<(u64, u64)>,
    rows: u64,
    gaps: Vec<Gap>,
}

impl Capture {
    fn of(layout: &Layout, name: &str) -> Self {
        let of_axis = layout.axes().iter().find(|axis| axis.code_column() == name);
        let of_axis = of_axis.map(|axis| 1.0 / axis.scale_dps().lsb_per_unit);
        let of_temp = (name == "temp_code").then(|| 1.0 / layout.temp().lsb_per_unit);
        Self { scale: of_axis.or(of_temp), span_ns: None, rows: 0, gaps: Vec::new() }
    }

    /// Takes the times and losses of rows that were checked.
    fn count(&mut self, rows: &Rows) {
        for Mark { t_ns, lost, .. } in rows.marks() {
            self.span_ns = Some((self.span_ns.map_or(t_ns, |(start, _)| start), t_ns));
            // what the first row lost was before the record
            if lost > 0 && self.rows > 0 {
                join(&mut self.gaps, Gap { at: self.rows as usize, missing: u64::from(lost) });
            }
            self.rows += 1;
        }
    }

    fn clock(self) -> Clock {
        let intervals = self.rows.saturating_sub(1).saturating_add(missing_in(&self.gaps));
        let rate = |(first, last): (u64, u64)| intervals as f64 * 1e9 / (last - first) as f64;
        Clock::Counted { rate_hz: self.span_ns.filter(|(first, last)| first < last).map(rate), gaps: self.gaps }
    }
}
