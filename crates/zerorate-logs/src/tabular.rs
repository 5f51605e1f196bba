//! Reads columns of a table with names and types: an Arrow stream or file, Parquet, or a table that describes itself.

use super::clock::Times;
use super::sample::{self, Sampled};
use super::series::SeriesBuilder;
use crate::choice::{Choice, Columns};
use crate::error::{LogError, Result};
use crate::only::RowFilter;
use crate::query::ColumnQuery;
use crate::raw_columns::{Clock, RawColumn, RawColumns};
use crate::setting::Setting;
use crate::warning::LogWarning;
use arrow_array::types::{Int32Type, Int64Type};
use arrow_array::{Array, ArrayRef, BooleanArray, RecordBatch};
use arrow_schema::{DataType, FieldRef, Schema};
use arrow_select::filter::filter;
use std::path::Path;
use zerorate_allan::Gap;
use zerorate_input::cells::{floats, integers};
use zerorate_input::limits::MemoryBudget;
use zerorate_input::table::{BatchSource, Described, DescribedTable, Source, describes_itself};
use zerorate_input::{InputError, InputWarning, Quantity};

pub fn read(
    path: &Path,
    mut source: Box<dyn BatchSource>,
    budget: MemoryBudget,
    asked: &ColumnQuery<'_>,
) -> Result<RawColumns> {
    let schema = source.stated().schema.clone();
    if let Some(open) = asked.args.described.filter(|_| describes_itself(&schema)) {
        return match open(path, Source::Table(source))? {
            Some(table) => read_described(path, table, budget, asked),
            None => Err(needs_reader(path)),
        };
    }
    let mut reading = TableColumns::start(path, &schema, budget, asked, None)?;
    while let Some(batch) = source.read_batch()? {
        reading.take(&batch)?;
    }
    reading.finish(source.stated().warning.clone())
}

pub fn read_described(
    path: &Path,
    table: Box<dyn DescribedTable>,
    budget: MemoryBudget,
    asked: &ColumnQuery<'_>,
) -> Result<RawColumns> {
    let mut reading = TableColumns::start(path, &table.schema(), budget, asked, Some(&*table))?;
    let columns = reading.columns.clone();
    let validates = reading.time.is_none();
    let described = table.read(&columns, validates, &mut |columns| reading.append(columns))?;
    reading.finish_described(described)
}

/// The wanted columns of a table while their rows are added.
pub struct TableColumns<'a> {
    path: &'a Path,
    /// Indices of the columns to read, in this order: the numbers, the time, and the columns of `only`.
    pub columns: Vec<usize>,
    values: Vec<RawColumn>,
    time: Option<(String, Times)>,
    /// The filter of rows, and the names of the columns that it tests, the last of `columns`; `None` keeps all rows.
    only: Option<(&'a RowFilter, Vec<String>)>,
    sample: Vec<Sampled>,
}

impl<'a> TableColumns<'a> {
    pub fn start(
        path: &'a Path,
        schema: &Schema,
        room: MemoryBudget,
        asked: &ColumnQuery<'a>,
        described: Option<&dyn DescribedTable>,
    ) -> Result<Self> {
        let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
        if asked.args.described.is_none() && describes_itself(schema) {
            return Err(needs_reader(path));
        }
        let default = described.map_or_else(Vec::new, |table| table.default_columns());
        let numeric = schema.fields().iter().map(|field| field.data_type().is_numeric()).collect();
        // a duration is not a point in time
        let is_time = |field: &FieldRef| matches!(field.data_type(), DataType::Timestamp(..));
        let clocks = schema.fields().iter().map(is_time).collect();
        let all = Columns { path, names: names.clone(), numeric, clocks, settings: asked.args.names };
        let Choice { mut values, time, only } = all.choose(asked.wanted, asked.args, &default)?;
        let temperature = described.and_then(|table| table.temperature());
        let beside = temperature.filter(|at| asked.with_temperature && !values.contains(at));
        let wanted = values.len();
        values.extend(beside);
        if described.is_some() && !only.is_empty() {
            return Err(asked.args.only_of_tables(path));
        }
        // with a time column, a described table is read like any other
        let described = described.filter(|_| time.is_none());
        let column = |index: &usize| -> Result<RawColumn> {
            let mut series = SeriesBuilder::sharing(room, wanted);
            series.reserve(0, schema.field(*index).data_type().is_integer());
            let stated = described.and_then(|table| table.step(*index));
            if stated.is_some_and(|(quantity, _)| quantity != Quantity::Temperature) {
                let unit = asked.args.unit.filter(|_| asked.args.scale.is_none());
                asked.args.leaves_scale(path, names[*index], unit, Setting::Unit)?;
            }
            let (is_scaled, is_beside) = (stated.is_some(), beside == Some(*index));
            Ok(RawColumn { stated, is_scaled, is_beside, ..RawColumn::new(names[*index].to_owned(), series) })
        };
        let time_column = time.map(|time| {
            let mut times = Times::new();
            times.unit = sample::time_unit(schema.field(time).data_type());
            (names[time].to_owned(), times)
        });
        Ok(Self {
            path,
            values: values.iter().map(column).collect::<Result<_>>()?,
            columns: values.iter().copied().chain(time).chain(only.iter().copied()).collect(),
            only: asked.args.only.as_ref().map(|of| (of, only.iter().map(|at| names[*at].to_owned()).collect())),
            sample: Vec::new(),
            time: time_column,
        })
    }

    #[cfg(feature = "parquet")]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    #[cfg(feature = "parquet")]
    pub fn reserve(&mut self, rows: usize, schema: &Schema) {
        for (column, index) in self.values.iter_mut().zip(&self.columns) {
            column.values.reserve(rows, schema.field(*index).data_type().is_integer());
        }
    }

    /// Adds the wanted rows of a batch, which has all columns of the table.
    pub fn take(&mut self, batch: &RecordBatch) -> Result<(), InputError> {
        let columns: Vec<ArrayRef> = self.columns.iter().map(|index| batch.column(*index).clone()).collect();
        self.sample(batch)?;
        self.append(&columns)
    }

    /// Adds the first wanted rows of a batch, in all columns, to the sample.
    pub fn sample(&mut self, batch: &RecordBatch) -> Result<(), InputError> {
        if self.sample.is_empty() {
            self.sample = batch.schema().fields().iter().map(|field| Sampled::of_field(field)).collect();
        }
        let telling = self.only.iter().flat_map(|(_, names)| names).map(|name| batch.column_by_name(name).cloned());
        let Some(told) = telling.collect::<Option<Vec<ArrayRef>>>() else { return Ok(()) };
        let columns = self.wanted_rows(batch.columns().iter().cloned().chain(told).collect())?;
        self.sample.iter_mut().zip(&columns).for_each(|(sampled, column)| sampled.take(column));
        Ok(())
    }

    /// Keeps the rows that meet the conditions. The last of `columns` are the columns of the conditions.
    fn wanted_rows(&self, columns: Vec<ArrayRef>) -> Result<Vec<ArrayRef>, InputError> {
        let Some((only, names)) = &self.only else { return Ok(columns) };
        let mut wanted = vec![true; columns.first().map_or(0, |column| column.len())];
        for (column, condition) in columns[columns.len().saturating_sub(names.len())..].iter().zip(&only.conditions) {
            let cells = sample::cells(column);
            wanted.iter_mut().zip(&cells).for_each(|(wanted, cell)| *wanted &= cell.is(&condition.value));
        }
        let wanted = BooleanArray::from(wanted);
        let rows = |column: &ArrayRef| filter(column, &wanted);
        columns
            .iter()
            .map(rows)
            .collect::<Result<_, _>>()
            .map_err(|error| InputError::damaged(self.path, "raw columns", error.to_string()))
    }

    /// Adds the wanted rows of `columns`, which are the arrays of `self.columns` in their order.
    pub fn append(&mut self, columns: &[ArrayRef]) -> Result<(), InputError> {
        let columns = &self.wanted_rows(columns.to_vec())?[..];
        let Some(first) = self.values.first() else { return Ok(()) };
        let (first, more) = (first.values.rows(), columns.first().map_or(0, |column| column.len() as u64));
        self.values[0].values.check_room(more).map_err(|why| InputError::over_budget(self.path, why))?;
        let path = self.path;
        let wrong = |name: &str, (row, what): Wrong| {
            InputError::damaged(path, format!("column {name}, row {}", first + row as u64), what)
        };
        if let (Some((name, times)), Some(column)) = (&mut self.time, columns.get(self.values.len())) {
            append_times(times, column).map_err(|what| wrong(name, what))?;
        }
        self.values.iter_mut().zip(columns).try_for_each(|(RawColumn { name, values, .. }, added)| {
            append_values(values, added).map_err(|what| wrong(name, what))
        })
    }

    pub fn finish(self, warning: Option<InputWarning>) -> Result<RawColumns> {
        if let (Some((only, _)), Some(0)) = (self.only, self.values.first().map(|column| column.values.rows())) {
            return Err(only.without_rows(self.path));
        }
        let found = RawColumns::new(self.values, self.time, warning.map(LogWarning::File));
        Ok(RawColumns { sample: self.sample, ..found })
    }

    fn finish_described(self, described: Described) -> Result<RawColumns> {
        let Described { rate_hz, lost, warnings, of_columns, refused } = described;
        if let Some((code, why)) = refused {
            return Err(LogError::Refused(code, why));
        }
        let gaps = lost.into_iter().map(|(at, missing)| Gap { at, missing }).collect();
        let counted = Clock::Counted { rate_hz, gaps };
        let clock = self.time.map_or(counted, |(name, times)| Clock::Column(name, times));
        let path = self.path.display().to_string();
        let of_readings = |(code, text)| LogWarning::OfReadings { path: path.clone(), code, text };
        let of_columns = of_columns.into_iter().map(|warnings| warnings.into_iter().map(of_readings).collect());
        let columns =
            self.values.into_iter().zip(of_columns).map(|(column, warnings)| RawColumn { warnings, ..column });
        let warnings = warnings.into_iter().map(|(code, text)| LogWarning::OfTable { code, text }).collect();
        Ok(RawColumns { columns: columns.collect(), clock, warnings, sample: self.sample, stated_rate: None })
    }
}

/// The error if a table describes itself and no reader for it is set: codes must not be read without their scale.
pub fn needs_reader(path: &Path) -> LogError {
    LogError::Ask(format!("{} describes itself; set `described` to its reader", path.display()))
}

/// An error: the index of the row among the rows that are being added, and the reason.
type Wrong = (usize, String);

/// Adds values. Integers stay integers if they are small enough to be codes.
fn append_values(values: &mut SeriesBuilder, column: &ArrayRef) -> Result<(), Wrong> {
    if column.data_type().is_integer() {
        if let Ok(codes) = integers::<Int32Type>(column)
            && codes.null_count() == 0
        {
            values.extend_codes(codes.values().iter().copied());
            return Ok(());
        }
        if let Ok(integers) = integers::<Int64Type>(column) {
            integers.iter().for_each(|integer| match integer {
                Some(integer) => values.push_integer(integer),
                None => values.push_missing(),
            });
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
