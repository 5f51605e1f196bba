//! The bias over temperature of all axes in logs of one unit.

mod ardupilot;
mod log;
mod reading;

use crate::code_scales::CodeOptions;
use crate::{CodedRefusal, InvalidOptions};
use anyhow::Result;
pub use log::UnitLog;
use zerorate::Calibration;
use zerorate::temperature::curve::{CurveRefusal, LogCurve};
use zerorate_imu::ImuOptions;
use zerorate_logs::Names;
use zerorate_view::tempcal::{AxisCurve, Points, UnitNames, calibration, refusal_text};

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
    /// The largest standard uncertainty of a gyroscope's bias over the temperatures of the logs, °/s; none: any.
    pub max_u_dps: Option<f64>,
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
    /// The names of the options, for messages.
    names: Names,
}

/// Finds the bias over temperature of all axes of the sensors in logs of one unit.
///
/// # Errors
/// Returns an error if a log cannot be read, has no temperature or lacks axes, and a refusal if it gives no curve.
pub fn tempcal(logs: &[UnitLog], options: &TempcalOptions) -> Result<Tempcal> {
    if let Some(wanted) = options.max_u_dps.filter(|wanted| !(wanted.is_finite() && *wanted > 0.0)) {
        return Err(InvalidOptions(format!("the largest uncertainty is {wanted} °/s; give a number above 0")).into());
    }
    let (sensors, notes) = reading::sensors(logs, options)?;
    let names = options.axes.log.names;
    let mut all = Tempcal { axes: Vec::new(), curves: Vec::new(), points: Vec::new(), notes, names };
    for sensor in sensors {
        let name = sensor.name.clone();
        let refused =
            |why: CurveRefusal| CodedRefusal::new(why.code(), format!("{name}: {}", refusal_text(&why, names)));
        for (axis, curve, points) in sensor.fitted(options.reference_c).map_err(refused)? {
            options.max_u_dps.map_or(Ok(()), |wanted| axis.known_to(wanted)).map_err(refused)?;
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
    pub fn calibration(&self, part: &str, serial: Option<String>, logs: &[UnitLog]) -> Result<Calibration> {
        let logs = logs.iter().map(|log| log.path().display().to_string()).collect::<Vec<_>>().join(", ");
        let unit = UnitNames { part: part.to_owned(), serial, logs };
        Ok(calibration(&self.axes, &self.curves, unit, self.names).map_err(|why| InvalidOptions(why.0))?)
    }
}
