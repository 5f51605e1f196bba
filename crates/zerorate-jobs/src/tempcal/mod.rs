//! The bias over temperature of all axes in logs of one unit.

mod ardupilot;
mod reading;

use crate::code_scales::CodeOptions;
use crate::{CodedRefusal, InvalidOptions};
use anyhow::Result;
use std::path::PathBuf;
use zerorate::calibration::LogUnit;
use zerorate::temperature::curve::{CurveRefusal, LogCurve};
use zerorate::{Calibration, MAX_AXES, SOFTWARE};
use zerorate_imu::{ImuOptions, Kind};
use zerorate_view::tempcal::{AxisCurve, Points};

/// What is wanted of the logs.
pub struct TempcalOptions {
    /// The columns that are axes, and facts that the logs do not state.
    pub axes: ImuOptions,
    /// The scales of integer codes, for axes whose unit is not given.
    pub codes: CodeOptions,
    /// The column with the temperature; none: the one that its unit or name states.
    pub temperature: Option<String>,
    /// The temperature at which the bias is stated, °C; none: 25 °C, or the middle if the logs do not have it.
    pub reference_c: Option<f64>,
}

/// The curves of all axes.
pub struct Tempcal {
    /// The curve of each axis, sensor by sensor.
    pub axes: Vec<AxisCurve>,
    /// The same curves, from which calibrations are made.
    pub curves: Vec<LogCurve>,
    /// The means of each axis, for pictures.
    pub points: Vec<Points>,
    /// Warnings about the logs as a whole, with their codes.
    pub notes: Vec<String>,
}

/// Finds the bias over temperature of all axes of the sensors in logs of one unit.
///
/// # Errors
/// Returns an error if a log cannot be read, has no temperature or lacks axes, and a refusal if it cannot give a curve.
pub fn tempcal(logs: &[PathBuf], options: &TempcalOptions) -> Result<Tempcal> {
    let (sensors, notes) = reading::sensors(logs, options)?;
    let mut all = Tempcal { axes: Vec::new(), curves: Vec::new(), points: Vec::new(), notes };
    for sensor in sensors {
        let name = sensor.name.clone();
        let refused = |why: CurveRefusal| CodedRefusal::new(why.code(), format!("{name}: {why}"));
        for (axis, curve, points) in sensor.fitted(options.reference_c).map_err(refused)? {
            all.axes.push(axis);
            all.curves.push(curve);
            all.points.push(points);
        }
    }
    Ok(all)
}

impl Tempcal {
    /// The calibration of the gyroscopes.
    ///
    /// # Errors
    /// Returns an error if there are none, or more than a calibration holds.
    pub fn calibration(&self, part: &str, serial: Option<String>, logs: &[PathBuf]) -> Result<Calibration> {
        let of_kind = |(axis, _): &(&AxisCurve, &LogCurve)| axis.kind == Kind::Gyroscope;
        let gyroscopes: Vec<(&AxisCurve, &LogCurve)> = self.axes.iter().zip(&self.curves).filter(of_kind).collect();
        let Some(&(first, _)) = gyroscopes.first() else {
            return Err(InvalidOptions("a calibration holds gyroscopes, and the log has none".to_owned()).into());
        };
        if gyroscopes.len() > MAX_AXES {
            let count = gyroscopes.len();
            let text =
                format!("a calibration holds {MAX_AXES} axes, and the log has {count}; choose one IMU by --topic");
            return Err(InvalidOptions(text).into());
        }
        let unit = LogUnit {
            part: word(part),
            serial,
            software: SOFTWARE.to_owned(),
            device: logs.iter().map(|log| log.display().to_string()).collect::<Vec<_>>().join(", "),
            t3_c: first.reference_c,
        };
        let axis = |(axis, curve): (&AxisCurve, _)| (word(&axis.name), curve, axis.warnings.clone());
        let axes: Vec<(String, &LogCurve, Vec<String>)> = gyroscopes.into_iter().map(axis).collect();
        Ok(Calibration::of_log_curves(unit, &axes))
    }
}

/// A name as calibrations have them.
fn word(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '_' };
    name.chars().map(letter).take(40).collect()
}
