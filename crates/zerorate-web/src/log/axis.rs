//! Converts the results of a log's column to messages for the page.

use super::message::{LogAxis, LogColumn, LogPicture, LogTerm};
use zerorate_imu::{AxisReport, Kind, Record};
use zerorate_logs::{Column, Quantity};
use zerorate_view::noise::{Group, TermRow, term_rows};
use zerorate_view::plot::number;

/// Describes a column before its analysis.
pub fn column(column: &Column) -> LogColumn {
    let (quantity, missing) = (column.quantity, column.missing());
    let unit = quantity.map(|of| of.unit().to_owned());
    LogColumn { name: column.name.clone(), kind: quantity.and_then(Kind::of), unit, missing }
}

pub fn message(record: &Record) -> LogAxis {
    let axis = AxisReport::new(record, None);
    let terms = term_rows(&axis.report).into_iter().map(term).collect();
    LogAxis { axis, terms }
}

fn term(row: TermRow) -> LogTerm {
    let value = |(interval, unit): (zerorate_view::Interval, String)| match row.is_identified {
        true => format!("{interval} {unit}"),
        false => format!("< {} {unit}", number(interval.hi)),
    };
    let (name, identified, remark) = (row.name, row.is_identified, row.remark);
    LogTerm { name, values: row.values.into_iter().map(value).collect(), identified, remark }
}

/// The plots of all columns for each quantity: deviations, and spectra and records if all its columns have them.
pub fn pictures(axes: &[Record]) -> Vec<LogPicture> {
    Group::all(axes).iter().flat_map(of_group).collect()
}

fn of_group(group: &Group<'_>) -> Vec<LogPicture> {
    let (heading, name) = match group.records.first().and_then(|record| record.quantity) {
        Some(Quantity::AngularRate) => ("Gyroscope", "gyroscope"),
        Some(Quantity::Acceleration) => ("Accelerometer", "accelerometer"),
        Some(Quantity::Temperature) => ("Temperature", "temperature"),
        None => ("Columns", "columns"),
    };
    let picture = |picture: zerorate_view::noise::Picture| LogPicture {
        name: format!("{name}-{}.svg", picture.what),
        title: format!("{heading}: {}", picture.title()),
        svg: picture.svg,
    };
    group.pictures().into_iter().map(picture).collect()
}
