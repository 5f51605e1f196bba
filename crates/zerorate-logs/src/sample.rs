//! The first rows of all columns of a table. A column that was not requested may show, for example, that the rows are
//! of several sensors.

use crate::clock::Times;
use crate::only::ANY;
use crate::time_names::ticks;
use arrow_array::cast::AsArray;
use arrow_array::types::Int64Type;
use arrow_array::{Array, ArrayRef};
use arrow_schema::{DataType, Field, TimeUnit as ArrowUnit};
use zerorate_input::cells::{floats, integers};
use zerorate_input::{TimeUnit, Unit};

/// Largest number of rows that are kept.
pub const ROWS: usize = 2048;

#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A finite number.
    Number(f64),
    Word(String),
    /// An empty cell, or a number that is not finite.
    Missing,
}

/// The first cells of a column.
#[derive(Clone, Debug)]
pub struct Sampled {
    /// The name of the column, or its number.
    pub name: String,
    pub cells: Vec<Cell>,
    /// The unit of time that the type of the column states.
    pub time_unit: Option<TimeUnit>,
}

impl Cell {
    pub fn number(number: f64) -> Self {
        if number.is_finite() { Self::Number(number) } else { Self::Missing }
    }

    pub fn as_number(&self) -> Option<f64> {
        if let Self::Number(number) = self { Some(*number) } else { None }
    }

    pub fn as_word(&self) -> Option<&str> {
        if let Self::Word(word) = self { Some(word) } else { None }
    }

    /// True if the cell has the value that a user wrote: the same word, or the same number, or [`ANY`].
    pub fn is(&self, value: &str) -> bool {
        match self {
            _ if value == ANY => true,
            Self::Number(number) => value.parse() == Ok(*number),
            Self::Word(word) => word == value,
            Self::Missing => value.is_empty(),
        }
    }
}

impl Sampled {
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), cells: Vec::new(), time_unit: None }
    }

    pub fn of_field(field: &Field) -> Self {
        Self { time_unit: time_unit(field.data_type()), ..Self::new(field.name()) }
    }

    /// The first of these times as a column, counted from the first row.
    #[cfg(any(feature = "mcap", feature = "ros", feature = "sqlite"))]
    pub fn of_times(name: &str, times: &Times) -> Self {
        let cells = times.since_first().iter().take(ROWS).map(|time| Cell::number(*time)).collect();
        Self { cells, time_unit: times.unit, ..Self::new(name) }
    }

    pub fn take(&mut self, column: &ArrayRef) {
        let rows = column.len().min(ROWS.saturating_sub(self.cells.len()));
        self.cells.extend(cells(&column.slice(0, rows)));
    }

    /// The unit of time that the type or the name of the column states.
    pub fn stated_time(&self) -> Option<TimeUnit> {
        let is_other = Unit::of_column(&self.name).is_some() || ticks(&self.name).is_some();
        let by_name = || TimeUnit::of_column(&self.name).filter(|_| !is_other);
        self.time_unit.or_else(by_name)
    }

    /// The cells as times; `None` if one is not a number.
    pub fn times(&self) -> Option<Times> {
        let mut times = Times::new();
        for cell in &self.cells {
            times.push_number(cell.as_number()?).ok()?;
        }
        Some(times)
    }
}

pub fn cells(column: &ArrayRef) -> Vec<Cell> {
    let words = |row: usize| match column.data_type() {
        DataType::Utf8 => Some(column.as_string::<i32>().value(row).to_owned()),
        DataType::LargeUtf8 => Some(column.as_string::<i64>().value(row).to_owned()),
        DataType::Utf8View => Some(column.as_string_view().value(row).to_owned()),
        DataType::Boolean => Some(column.as_boolean().value(row).to_string()),
        _ => None,
    };
    if let Some(dictionary) = column.as_any_dictionary_opt() {
        let (values, keys) = (cells(dictionary.values()), dictionary.normalized_keys());
        let of = |row| if column.is_valid(row) { values.get(keys[row]).cloned() } else { None };
        return (0..column.len()).map(|row| of(row).unwrap_or(Cell::Missing)).collect();
    }
    let counted = || integers::<Int64Type>(column).map(|counts| counts.unary(|count| count as f64));
    if let Ok(numbers) = floats(column).or_else(|_| counted()) {
        return numbers.iter().map(|number| Cell::number(number.unwrap_or(f64::NAN))).collect();
    }
    let word = |row| if column.is_valid(row) { words(row).map(Cell::Word) } else { None };
    (0..column.len()).map(|row| word(row).unwrap_or(Cell::Missing)).collect()
}

pub fn time_unit(data_type: &DataType) -> Option<TimeUnit> {
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
