//! The files that are made from fitted curves: a calibration and a CSV table.

use super::AxisCurve;
use crate::export::InvalidOptions;
use std::fmt::Write;
use zerorate::calibration::LogUnit;
use zerorate::temperature::curve::LogCurve;
use zerorate::{Calibration, MAX_AXES, SOFTWARE};
use zerorate_imu::Kind;
use zerorate_logs::{Names, Setting};

/// The identity of the sensor, for the calibration file.
pub struct UnitNames {
    /// The type of the sensor.
    pub part: String,
    /// The serial number.
    pub serial: Option<String>,
    /// The paths of the logs, joined by commas.
    pub logs: String,
}

/// Makes a calibration of the gyroscopes. Error texts refer to the settings by `names`.
///
/// # Errors
/// Returns an error if there are no gyroscopes, more than a calibration can hold, or two that get the same name.
pub fn calibration(
    axes: &[AxisCurve],
    curves: &[LogCurve],
    unit: UnitNames,
    names: Names,
) -> Result<Calibration, InvalidOptions> {
    let of_kind = |(axis, _): &(&AxisCurve, &LogCurve)| axis.kind == Kind::Gyroscope;
    let gyroscopes: Vec<(&AxisCurve, &LogCurve)> = axes.iter().zip(curves).filter(of_kind).collect();
    let Some(&(first, _)) = gyroscopes.first() else {
        return Err(InvalidOptions("a calibration holds gyroscopes, and the log has none".to_owned()));
    };
    if gyroscopes.len() > MAX_AXES {
        let (count, option) = (gyroscopes.len(), names.of(Setting::Topic));
        return Err(InvalidOptions(format!(
            "a calibration holds {MAX_AXES} axes, and the log has {count}; choose one IMU with {option}"
        )));
    }
    let unit = LogUnit {
        part: axis_name(&unit.part),
        serial: unit.serial,
        software: SOFTWARE.to_owned(),
        device: unit.logs,
        t3_c: first.reference_c,
    };
    let axis = |(axis, curve): (&AxisCurve, _)| (axis_name(&axis.name), curve, axis.warnings.clone());
    let axes: Vec<(String, &LogCurve, Vec<String>)> = gyroscopes.into_iter().map(axis).collect();
    let is_repeated = |(index, (name, ..)): &(usize, &(String, _, _))| axes[..*index].iter().any(|of| of.0 == *name);
    if let Some((_, (name, ..))) = axes.iter().enumerate().find(is_repeated) {
        return Err(InvalidOptions(format!("two axes would be called {name} in a calibration; rename their columns")));
    }
    Ok(Calibration::of_log_curves(unit, &axes))
}

/// The name of an axis or a part in a calibration file: its last 40 characters. Characters that the file does not
/// allow become `_`.
#[must_use]
pub fn axis_name(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '_' };
    let letters: Vec<char> = name.chars().map(letter).collect();
    letters[letters.len().saturating_sub(40)..].iter().collect()
}

/// The curves as a CSV table, with a row for each axis and temperature.
#[must_use]
pub fn csv(axes: &[AxisCurve]) -> String {
    let mut text = "axis,unit,temp_c,bias,u\n".to_owned();
    for axis in axes {
        for (temp_c, bias, u) in axis.curve.iter().map(|point| point.values()) {
            // writing to a string cannot fail
            let _ = writeln!(text, "{},{},{temp_c},{bias},{u}", axis.name, axis.unit);
        }
    }
    text
}
