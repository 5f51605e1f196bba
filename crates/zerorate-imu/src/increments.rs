//! Columns of increments: the change of angle or velocity during a sample, in place of the angular rate or the
//! acceleration.

use crate::Kind;
use crate::increment_names::{by_unit, may_be, named};
use std::path::Path;
use zerorate_logs::{Column, ColumnOptions, LogError, Result, Setting};

/// True if the name of a column states increments, or names an axis and states a unit of increments.
fn states_increments(column: &Column) -> bool {
    let is_axis = || column.quantity.is_none() && Kind::of_column(column).is_some();
    named(&column.name).is_some() || is_axis() && by_unit(&column.name).is_some()
}

/// True if an axis may hold increments, by its name.
fn is_suspect(axis: &Column) -> bool {
    named(&axis.name).is_some() || axis.quantity.is_none() && may_be(&axis.name)
}

/// Asks about columns that are increments by their names or units, unless the user says whether they are. Columns
/// that are not axes, such as `roll [deg]`, may hold angles.
///
/// # Errors
/// Returns a question that names these columns.
pub fn ask(path: &Path, columns: &[&Column], args: &ColumnOptions) -> Result<()> {
    ask_where(states_increments, path, columns, args)
}

/// [`ask`] for columns that are known as axes.
pub(super) fn ask_axes(path: &Path, axes: &[&Column], args: &ColumnOptions) -> Result<()> {
    ask_where(is_suspect, path, axes, args)
}

fn ask_where(is: fn(&Column) -> bool, path: &Path, columns: &[&Column], args: &ColumnOptions) -> Result<()> {
    let names: Vec<&str> = columns.iter().filter(|column| is(column)).map(|column| &*column.name).collect();
    match names.is_empty() || args.increments.is_some() {
        true => Ok(()),
        false => Err(question(path, &format!("{} by name", names.join(", ")), args)),
    }
}

/// The question whether columns hold increments, with the evidence for it.
pub fn question(path: &Path, seen: &str, args: &ColumnOptions) -> LogError {
    let [yes, no] = [Setting::Increments, Setting::NoIncrements].map(|setting| args.names.of(setting));
    let what = "the angle or velocity of each sample, in place of its rate";
    LogError::Ask(format!("{}: these may be increments, {what}: {seen}; give {yes}, or {no}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_may_hold_increments_and_other_columns_angles() {
        let suspect = |name: &str| is_suspect(&Column::new(name, zerorate_logs::Series::Numbers(vec![0.0]), 1.0));
        assert!(["dax", "dtx", "dW_x", "gyro_x [deg]"].into_iter().all(suspect));
        assert!(!["gyro_x", "wx", "ax", "date"].into_iter().any(suspect));
        let states =
            |name: &str| states_increments(&Column::new(name, zerorate_logs::Series::Numbers(vec![0.0]), 1.0));
        assert!(["gyro_x_deg", "wx [rad]", "dtheta_x"].into_iter().all(states));
        assert!(!["roll [deg]", "heading_deg", "day", "gyro_x"].into_iter().any(states));
    }
}
