//! The bias over temperature of all axes in logs of one unit.

mod ardupilot;
mod corrected;
mod log;
mod reading;

use crate::code_scales::CodeOptions;
use crate::{CodedRefusal, InvalidOptions};
use anyhow::Result;
pub use corrected::CorrectedLog;
pub use log::UnitLog;
use zerorate::Calibration;
use zerorate::temperature::curve::{CurveRefusal, LogCurve};
use zerorate_imu::ImuOptions;
use zerorate_logs::Names;
use zerorate_view::tempcal::{AxisCurve, Points, UnitNames, calibration, refusal_text};

/// The settings of the temperature calibration.
pub struct TempcalOptions {
    /// The columns of the axes, and facts that the logs do not state.
    pub axes: ImuOptions,
    /// The scales of integer codes, for axes whose unit is not given.
    pub codes: CodeOptions,
    /// The temperature column; `None` finds it by its unit or name.
    pub temperature: Option<String>,
    /// The reference temperature of the bias, °C; `None` for 25 °C, or mid-span if the logs do not reach 25 °C.
    pub reference_c: Option<f64>,
    /// Limit of a gyroscope's standard uncertainty of bias at any temperature in the logs, °/s; `None` for no limit.
    pub max_u_dps: Option<f64>,
}

/// The curves of all axes.
pub struct Tempcal {
    /// The curve of each axis, sensor by sensor.
    pub axes: Vec<AxisCurve>,
    /// The curves of `axes`, in the form that calibrations are made from.
    pub curves: Vec<LogCurve>,
    /// Means of each axis over parts of the logs, less steps and level, and what the curve leaves of them, for plots.
    pub points: Vec<Points>,
    /// Warnings about the logs as a whole, with their codes.
    pub notes: Vec<String>,
    names: Names,
}

/// Fits the bias over temperature of all axes of the sensors in logs of one unit.
///
/// # Errors
/// Returns an error if a log cannot be read, has no temperature or lacks axes, or a refusal if no fit is possible or a
/// curve is too uncertain.
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
    /// Returns an error if there are no gyroscopes, or more than a calibration can hold.
    pub fn calibration(&self, part: &str, serial: Option<String>, logs: &[UnitLog]) -> Result<Calibration> {
        let logs = logs.iter().map(|log| log.path().display().to_string()).collect::<Vec<_>>().join(", ");
        let unit = UnitNames { part: part.to_owned(), serial, logs };
        Ok(calibration(&self.axes, &self.curves, unit, self.names).map_err(|why| InvalidOptions(why.0))?)
    }
}
