//! A column of a table with names and types: Parquet or an Arrow stream, a capture or not.

use super::{Column, Series, Timing, ambiguous, position};
use crate::capture::columns::{CORRECTED, Rows};
use crate::capture::table::BatchSource;
use crate::capture::{CaptureError, CaptureReader, info};
use adis16130::{RATE_LSB_PER_DPS, TEMP_LSB_PER_C, Width};
use anyhow::Result;
use arrow::array::{Array, ArrayRef, AsArray};
use arrow::compute::{CastOptions, cast_with_options};
use arrow::datatypes::{DataType, Float64Type, Int32Type, Schema};
use std::path::Path;

/// Reads a column of a table.
pub fn read(path: &Path, source: Box<dyn BatchSource>, wanted: Option<&str>) -> Result<Column> {
    let schema = source.schema();
    let is_capture = info::is_capture(schema.metadata());
    let index = choose(path, &schema, is_capture, wanted)?;
    let name = schema.field(index).name().clone();
    let codes = is_code(&name, is_capture) || fits_i32(schema.field(index).data_type());
    let mut reading = Reading {
        path,
        index,
        name: &name,
        series: if codes { Series::Codes(vec![]) } else { Series::Numbers(vec![]) },
    };
    let (scale, timing, warning) =
        if is_capture { reading.capture(CaptureReader::from_source(path, source)?)? } else { reading.table(source)? };
    let series = reading.series;
    Ok(Column { name, series, scale, timing, warning })
}

/// The column that was named, or else the rate of a capture, or else the only column that holds numbers.
fn choose(path: &Path, schema: &Schema, is_capture: bool, wanted: Option<&str>) -> Result<usize> {
    let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
    let numeric = |index: &usize| schema.field(*index).data_type().is_numeric();
    let index = match wanted {
        Some(wanted) => position(path, &names, wanted)?,
        None if is_capture => position(path, &names, CORRECTED).or_else(|_| position(path, &names, "rate_code"))?,
        None => match (0..names.len()).filter(numeric).collect::<Vec<_>>()[..] {
            [only] => only,
            _ => return Err(ambiguous(path, "has several columns", &names)),
        },
    };
    if numeric(&index) {
        Ok(index)
    } else {
        Err(ambiguous(path, &format!("holds no numbers in `{}`", names[index]), &names))
    }
}

fn is_code(name: &str, is_capture: bool) -> bool {
    is_capture && matches!(name, "rate_code" | "temp_code")
}

fn fits_i32(data_type: &DataType) -> bool {
    matches!(data_type, DataType::Int8 | DataType::Int16 | DataType::Int32 | DataType::UInt8 | DataType::UInt16)
}

/// Physical unit per code of a capture's column (F-40, F-41, F-43).
fn capture_scale(name: &str, width: Width) -> f64 {
    let lsb_per_unit = match name {
        "rate_code" => RATE_LSB_PER_DPS,
        "temp_code" => TEMP_LSB_PER_C,
        _ => return 1.0,
    };
    f64::from(1u32 << (24 - width.bits())) / f64::from(lsb_per_unit)
}

/// A column being read.
struct Reading<'a> {
    path: &'a Path,
    index: usize,
    name: &'a str,
    series: Series,
}

type Facts = (f64, Option<Timing>, Option<String>);

impl Reading<'_> {
    fn table(&mut self, mut source: Box<dyn BatchSource>) -> Result<Facts, CaptureError> {
        for batch in source.by_ref() {
            self.append(batch?.column(self.index))?;
        }
        Ok((1.0, None, source.warning().map(str::to_owned)))
    }

    fn capture(&mut self, mut reader: CaptureReader) -> Result<Facts, CaptureError> {
        let mut clock = Clock::default();
        while let Some(rows) = reader.next_rows()? {
            clock.advance(&rows);
            self.append(rows.batch().column(self.index))?;
        }
        let scale = capture_scale(self.name, reader.info().width);
        Ok((scale, Some(clock.timing()), reader.warning().map(str::to_owned)))
    }

    fn append(&mut self, column: &ArrayRef) -> Result<(), CaptureError> {
        let first_row = self.series.len();
        let wrong = |at: usize, what: &str| {
            CaptureError::damaged(self.path, format!("column {}, row {}", self.name, first_row + at), what)
        };
        if let Some(empty) = (0..column.len()).find(|row| column.is_null(*row)) {
            return Err(wrong(empty, "no value; all rows of a column must have one"));
        }
        let cast = |to| {
            cast_with_options(column, &to, &CastOptions { safe: false, ..CastOptions::default() })
                .map_err(|error| wrong(0, &error.to_string()))
        };
        match &mut self.series {
            Series::Codes(codes) => {
                codes.extend_from_slice(cast(DataType::Int32)?.as_primitive::<Int32Type>().values())
            }
            Series::Numbers(numbers) => {
                let found = cast(DataType::Float64)?;
                let found = found.as_primitive::<Float64Type>().values();
                if let Some(at) = found.iter().position(|number| !number.is_finite()) {
                    return Err(wrong(at, &format!("{} cannot be averaged", found[at])));
                }
                numbers.extend_from_slice(found);
            }
        }
        Ok(())
    }
}

/// Adds up rows, losses and time.
#[derive(Default)]
struct Clock {
    rows: u64,
    lost: u64,
    span_ns: Option<(u64, u64)>,
}

impl Clock {
    fn advance(&mut self, rows: &Rows) {
        // what the first row lost was before the record
        let skipped = usize::from(self.rows == 0);
        self.lost += rows.samples().skip(skipped).map(|sample| u64::from(sample.lost)).sum::<u64>();
        self.rows += rows.len() as u64;
        if let Some((first, last)) = rows.span_ns() {
            self.span_ns = Some((self.span_ns.map_or(first, |(first, _)| first), last));
        }
    }

    fn timing(&self) -> Timing {
        let intervals = self.rows.saturating_sub(1) + self.lost;
        let rate = |(first, last): (u64, u64)| intervals as f64 * 1e9 / (last - first) as f64;
        Timing { rate_hz: self.span_ns.filter(|(first, last)| first < last).map(rate), lost: self.lost }
    }
}
