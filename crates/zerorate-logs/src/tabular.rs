//! Columns of a table with names and types: an Arrow stream or file, Parquet, a capture or not.

use super::choice::{Choice, Columns};
use super::clock::Times;
use super::judged::{self, Believed, Judging, Readings};
use super::sample::{self, Sampled};
use super::series::{SeriesBuilder, join, missing_in};
use super::{Clock, ColumnQuery, Found, FoundColumn, Gap, Only, Result, wrong};
use crate::warning::LogWarning;
use arrow_array::types::{Int32Type, Int64Type};
use arrow_array::{Array, ArrayRef, BooleanArray, RecordBatch};
use arrow_schema::Schema;
use arrow_select::filter::filter;
use std::path::Path;
use zerorate_record::cells::{floats, integers};
use zerorate_record::columns::Rows;
use zerorate_record::limits::Room;
use zerorate_record::succession::Mark;
use zerorate_record::table::BatchSource;
use zerorate_record::{CaptureError, CaptureInfo, CaptureWarning, Checked, CodedAxis, Layout, Quantity, is_capture};

/// Reads columns of a table. Of a capture all columns are read, because its checks are over all of them.
pub fn read(path: &Path, mut source: Box<dyn BatchSource>, room: Room, asked: &ColumnQuery<'_>) -> Result<Found> {
    let schema = source.stated().schema.clone();
    let mut reading = TableColumns::start(path, &schema, room, asked)?;
    if is_capture(schema.metadata()) {
        let mut capture = Checked::new(path, source)?;
        let reading = judged_beside(&mut capture, reading)?;
        return reading.finish(capture.warnings());
    }
    while let Some(batch) = source.next_batch()? {
        reading.take(&batch, None)?;
    }
    reading.finish(source.stated().warning.clone())
}

/// Batches that may wait to be judged.
#[cfg(not(target_family = "wasm"))]
const AHEAD: usize = 4;

/// Judges the rows of a capture on a thread of its own while this one checks them, which takes as long.
#[cfg(not(target_family = "wasm"))]
fn judged_beside<'a>(
    capture: &mut Checked,
    mut reading: TableColumns<'a>,
) -> std::result::Result<TableColumns<'a>, CaptureError> {
    std::thread::scope(|scope| {
        let (checked, to_judge) = std::sync::mpsc::sync_channel(AHEAD);
        let judging = scope.spawn(move || {
            for (batch, rows) in to_judge {
                reading.take(&batch, Some(&rows))?;
            }
            Ok(reading)
        });
        while let Some(next) = capture.next_rows()? {
            // where judging has failed, it says why
            if checked.send(next).is_err() {
                break;
            }
        }
        drop(checked);
        judging.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// A browser has one thread.
#[cfg(target_family = "wasm")]
fn judged_beside<'a>(
    capture: &mut Checked,
    mut reading: TableColumns<'a>,
) -> std::result::Result<TableColumns<'a>, CaptureError> {
    while let Some((batch, rows)) = capture.next_rows()? {
        reading.take(&batch, Some(&rows))?;
    }
    Ok(reading)
}

/// Columns being read, with their time.
pub struct TableColumns<'a> {
    path: &'a Path,
    /// The columns to be read: the numbers, and behind them the time.
    pub columns: Vec<usize>,
    values: Vec<TableColumn>,
    judges: Vec<Judging>,
    time: Option<(String, Times)>,
    /// The rows that are read, by the last of `columns`, and its name; none: all.
    only: Option<(&'a Only, String)>,
    capture: Option<Capture>,
    /// The first rows of all columns of a table.
    sample: Vec<Sampled>,
}

/// One of them.
struct TableColumn {
    name: String,
    values: SeriesBuilder,
    stated: Option<(Quantity, f64)>,
    /// If they are readings of a capture.
    readings: Option<Readings>,
    is_beside: bool,
}

impl<'a> TableColumns<'a> {
    /// Chooses the columns.
    pub fn start(path: &'a Path, schema: &Schema, room: Room, asked: &ColumnQuery<'a>) -> Result<Self> {
        let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
        let metadata = schema.metadata();
        let info = is_capture(metadata).then(|| CaptureInfo::from_metadata(path, metadata)).transpose()?;
        let default = info.as_ref().map_or_else(Vec::new, |info| rates(&info.layout, &names));
        let numeric = schema.fields().iter().map(|field| field.data_type().is_numeric()).collect();
        let all = Columns { path, names: names.clone(), numeric, settings: asked.args.names };
        let Choice { mut values, time, only } = all.choose(asked.wanted, asked.args, &default)?;
        let temperature = names.iter().position(|name| *name == "temp_code");
        let beside = temperature.filter(|at| asked.with_temperature && info.is_some() && !values.contains(at));
        let wanted = values.len();
        values.extend(beside);
        if let (Some(_), Some(_)) = (&info, only) {
            return Err(asked.args.only_of_tables(path));
        }
        // with a time column it is a table as any other
        let info = info.filter(|_| time.is_none());
        let mut judges = Vec::new();
        let column = |index: &usize| {
            let name = names[*index].to_owned();
            let mut series = SeriesBuilder::sharing(room, wanted);
            series.reserve(0, schema.field(*index).data_type().is_integer());
            let stated = info.as_ref().and_then(|info| of_code(&info.layout, &name));
            let readings = info.as_ref().and_then(|info| Readings::of_column(&name, info, &mut judges));
            TableColumn { name, values: series, stated, readings, is_beside: beside == Some(*index) }
        };
        let time_column = time.map(|time| {
            let mut times = Times::new();
            times.unit = sample::time_unit(schema.field(time).data_type());
            (names[time].to_owned(), times)
        });
        Ok(Self {
            path,
            values: values.iter().map(column).collect(),
            columns: values.iter().copied().chain(time).chain(only).collect(),
            only: asked.args.only.as_ref().zip(only.map(|at| names[at].to_owned())),
            sample: Vec::new(),
            judges,
            time: time_column,
            capture: info.map(|_| Capture::default()),
        })
    }

    /// The number of columns of numbers.
    #[cfg(feature = "parquet")]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Makes room for so many rows.
    #[cfg(feature = "parquet")]
    pub fn reserve(&mut self, rows: usize, schema: &Schema) {
        for (column, index) in self.values.iter_mut().zip(&self.columns) {
            column.values.reserve(rows, schema.field(*index).data_type().is_integer());
        }
    }

    /// Adds rows of the whole table; of a capture, with what they are.
    pub fn take(&mut self, batch: &RecordBatch, rows: Option<&Rows>) -> Result<(), CaptureError> {
        let columns: Vec<ArrayRef> = self.columns.iter().map(|index| batch.column(*index).clone()).collect();
        if rows.is_none() {
            self.sample(batch)?;
        }
        self.append(&columns, rows)
    }

    /// Keeps the first of these rows, in all columns.
    pub fn sample(&mut self, batch: &RecordBatch) -> Result<(), CaptureError> {
        if self.sample.is_empty() {
            self.sample = batch.schema().fields().iter().map(|field| Sampled::of_field(field)).collect();
        }
        let told = self.only.as_ref().and_then(|(_, name)| batch.column_by_name(name)).cloned();
        if self.only.is_some() && told.is_none() {
            return Ok(());
        }
        let columns = self.wanted_rows(batch.columns().iter().cloned().chain(told).collect())?;
        self.sample.iter_mut().zip(&columns).for_each(|(sampled, column)| sampled.take(column));
        Ok(())
    }

    /// The rows that are wanted. The last column tells them.
    fn wanted_rows(&self, columns: Vec<ArrayRef>) -> Result<Vec<ArrayRef>, CaptureError> {
        let (Some((only, _)), Some(last)) = (&self.only, columns.last()) else { return Ok(columns) };
        let wanted: BooleanArray = sample::cells(last).iter().map(|cell| Some(cell.is(&only.value))).collect();
        let rows = |column: &ArrayRef| filter(column, &wanted);
        columns.iter().map(rows).collect::<Result<_, _>>().map_err(|error| judged::failed(self.path, &error))
    }

    /// Adds a piece of the columns; of a capture, with its rows.
    pub fn append(&mut self, columns: &[ArrayRef], rows: Option<&Rows>) -> Result<(), CaptureError> {
        let columns = &self.wanted_rows(columns.to_vec())?[..];
        let Some(first) = self.values.first() else { return Ok(()) };
        let (first, more) = (first.values.rows(), columns.first().map_or(0, |column| column.len() as u64));
        self.values[0].values.check_room(more).map_err(|why| CaptureError::no_room(self.path, why))?;
        if let (Some((name, times)), Some(column)) = (&mut self.time, columns.get(self.values.len())) {
            append_times(times, column).map_err(|(row, what)| {
                wrong(self.path, format_args!("column {name}, row {}", first + row as u64), what)
            })?;
        }
        if let (Some(capture), Some(rows)) = (&mut self.capture, rows) {
            capture.count(rows);
        }
        let believed: Vec<Believed> = match rows {
            Some(rows) => self.judges.iter_mut().map(|judge| judge.take(rows)).collect(),
            None => Vec::new(),
        };
        self.values
            .iter_mut()
            .zip(columns)
            .try_for_each(|(column, values)| column.append(self.path, values, &believed))
    }

    /// All rows were read.
    pub fn finish(self, warnings: impl IntoIterator<Item = CaptureWarning>) -> Result<Found> {
        let Self { path, values, mut judges, time, capture, only, sample, .. } = self;
        if let (Some((only, _)), Some(0)) = (only, values.first().map(|column| column.values.rows())) {
            return Err(only.without_rows(path));
        }
        let clock = match (time, capture) {
            (Some((name, times)), _) => Clock::Column(name, times),
            (None, Some(capture)) => capture.clock(),
            (None, None) => Clock::Silent,
        };
        let believed: Vec<Believed> = judges.iter_mut().map(Judging::finish).collect();
        let columns =
            values.into_iter().map(|column| column.finish(path, &judges, &believed)).collect::<Result<_>>()?;
        let warnings = warnings.into_iter().map(LogWarning::Capture).collect();
        Ok(Found { columns, clock, warnings, sample })
    }
}

impl TableColumn {
    /// Adds values; of readings, those that every judge found.
    fn append(&mut self, path: &Path, values: &ArrayRef, believed: &[Believed]) -> Result<(), CaptureError> {
        let found = self.readings.as_mut().and_then(|readings| Some((believed.get(readings.judge)?, readings)));
        match found {
            Some((believed, readings)) => {
                let judged = readings.take(values, believed).map_err(|error| judged::failed(path, &error))?;
                self.append_values(path, &judged)
            }
            None => self.append_values(path, values),
        }
    }

    fn append_values(&mut self, path: &Path, values: &ArrayRef) -> Result<(), CaptureError> {
        let first = self.values.rows();
        append_values(&mut self.values, values)
            .map_err(|(row, what)| wrong(path, format_args!("column {}, row {}", self.name, first + row as u64), what))
    }

    fn finish(mut self, path: &Path, judges: &[Judging], believed: &[Believed]) -> Result<FoundColumn> {
        let mut warnings = Vec::new();
        if let Some(mut readings) = self.readings.take() {
            let last = readings.finish(&believed[readings.judge]).map_err(|error| judged::failed(path, &error))?;
            last.map_or(Ok(()), |last| self.append_values(path, &last))?;
            warnings = judges[readings.judge].found(path)?;
        }
        let Self { name, values, stated, is_beside, .. } = self;
        Ok(FoundColumn { stated, warnings, is_beside, ..FoundColumn::new(name, values) })
    }
}

/// A row in a piece, and what is wrong there.
type Wrong = (usize, String);

/// Integers go in as such, as far as they are small enough to be codes.
fn append_values(values: &mut SeriesBuilder, column: &ArrayRef) -> Result<(), Wrong> {
    if column.data_type().is_integer() {
        if let Ok(codes) = integers::<Int32Type>(column) {
            match codes.null_count() {
                0 => values.extend_codes(codes.values().iter().copied()),
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
        return values.extend_numbers(numbers.values().iter().copied()).map_err(infinite);
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

fn append_times(times: &mut Times, column: &ArrayRef) -> Result<(), Wrong> {
    let missing = || "no time; every row must have one".to_owned();
    let at = |row: usize| move |what: String| (row, what);
    if column.data_type().is_integer() || times.unit.is_some() {
        let found = integers::<Int64Type>(column).map_err(|error| (0, error.to_string()))?;
        for (row, time) in found.iter().enumerate() {
            times.push_integer(time.ok_or_else(missing).map_err(at(row))?);
        }
    } else if column.data_type().is_numeric() {
        let found = floats(column).map_err(|error| (0, error.to_string()))?;
        for (row, time) in found.iter().enumerate() {
            time.ok_or_else(missing).and_then(|time| times.push_number(time)).map_err(at(row))?;
        }
    } else {
        return Err((0, format!("it holds {} and no time; choose another column", column.data_type())));
    }
    Ok(())
}

/// The columns with the rates of a capture, corrected if they are.
fn rates(layout: &Layout, names: &[&str]) -> Vec<usize> {
    let position = |wanted: String| names.iter().position(|name| *name == wanted);
    let rate = |axis: &CodedAxis| position(axis.corrected_column()).or_else(|| position(axis.code_column()));
    layout.axes().iter().filter_map(rate).collect()
}

/// °/s or °C in a step of the code, where the column of a capture holds codes.
fn of_code(layout: &Layout, name: &str) -> Option<(Quantity, f64)> {
    let of_axis = layout.axes().iter().find(|axis| axis.code_column() == name);
    let of_axis = of_axis.map(|axis| (Quantity::AngularRate, 1.0 / axis.scale_dps().lsb_per_unit));
    of_axis.or_else(|| (name == "temp_code").then(|| (Quantity::Temperature, 1.0 / layout.temp().lsb_per_unit)))
}

/// The statements of a capture beyond its numbers: it has counted lost samples.
#[derive(Default)]
struct Capture {
    span_ns: Option<(u64, u64)>,
    rows: u64,
    gaps: Vec<Gap>,
}

impl Capture {
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
