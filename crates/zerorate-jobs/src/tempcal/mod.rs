//! The bias over temperature of all axes in logs of one unit.

mod ardupilot;
mod reading;

use crate::{CodedRefusal, InvalidOptions};
use crate::code_scales::CodeOptions;
use anyhow::Result;
use reading::Sensor;
use std::path::PathBuf;
use std::thread;
use zerorate::calibration::LogUnit;
use zerorate::temperature::ThermalError;
use zerorate::temperature::curve::{AxisRecord, CurveRefusal, CurveWarning, LagLikelihood, LogCurve, check};
use zerorate_imu::{ImuOptions, Kind};
use zerorate::{Calibration, MAX_AXES, SOFTWARE};
use zerorate_view::tempcal::{AxisCurve, Measured, Points};

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
        for (axis, curve, points) in sensor.fitted(options.reference_c)? {
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
            let text = format!("a calibration holds {MAX_AXES} axes, and the log has {count}; choose one IMU by --topic");
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

impl Sensor {
    /// The curves of the axes. They share what they tell about the lag.
    fn fitted(self, reference_c: Option<f64>) -> Result<Vec<(AxisCurve, LogCurve, Points)>> {
        let name = &self.name;
        let refused = |why: CurveRefusal| anyhow::Error::from(CodedRefusal::new(why.code(), format!("{name}: {why}")));
        let of_error = |error: ThermalError| refused(error.into());
        check(self.axes.iter().map(|axis| &axis.logs[..])).map_err(refused)?;
        let records = on_threads(&self.axes, |axis| AxisRecord::new(axis.logs.clone()));
        let records = records.into_iter().collect::<Result<Vec<AxisRecord>, ThermalError>>().map_err(of_error)?;
        let indices: Vec<usize> = (0..records.len()).collect();
        let curves = on_threads(&indices, |index| {
            let others = records.iter().enumerate().filter(|(other, _)| other != index);
            records[*index].curve(&others.map(|(_, other)| other.lag()).collect::<Vec<&LagLikelihood>>())
        });
        let mut all = Vec::new();
        for ((axis, record), curve) in self.axes.iter().zip(&records).zip(curves) {
            let curve = curve.map_err(of_error)?;
            let (imu, device_id) = (self.imu(), self.device_id);
            let measured = Measured { sensor: name, name: &axis.name, kind: self.kind, reference_c, imu, device_id };
            let mut found = AxisCurve::new(&measured, &curve);
            found.warnings = curve.warnings(record.logs(), found.unit).iter().map(CurveWarning::coded).collect();
            let points = Points::new(&curve, record.logs(), &found);
            all.push((found, curve, points));
        }
        Ok(all)
    }
}

/// The result of a function for each item, on as many threads as there are items.
fn on_threads<T: Sync, R: Send>(items: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let of = &of;
    thread::scope(|scope| {
        let running: Vec<_> = items.iter().map(|item| scope.spawn(move || of(item))).collect();
        let join = |thread: thread::ScopedJoinHandle<'_, R>| match thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        running.into_iter().map(join).collect()
    })
}
