//! The bias over temperature of all axes in logs of one unit.

mod reading;
mod warning;

use crate::CodedRefusal;
use crate::code_scales::CodeOptions;
use anyhow::Result;
use reading::Sensor;
use std::path::PathBuf;
use std::thread;
pub use warning::{TempcalRefusal, TempcalWarning};
use zerorate::temperature::ThermalError;
use zerorate::temperature::curve::{AxisRecord, LEAST_SPAN_C, LagLikelihood, LogMeans, MOST_MOTION};
use zerorate_imu::ImuOptions;
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
    let mut all = Tempcal { axes: Vec::new(), points: Vec::new(), notes };
    for sensor in sensors {
        sensor.check()?;
        let (axes, points) = sensor.fitted(options.reference_c)?;
        all.axes.extend(axes);
        all.points.extend(points);
    }
    Ok(all)
}

impl Sensor {
    /// Refuses what cannot give a curve.
    fn check(&self) -> Result<()> {
        let refused = |why: TempcalRefusal| CodedRefusal::new(why.code(), format!("{}: {why}", self.name));
        let blocks = || self.axes.iter().flat_map(|axis| &axis.logs).flat_map(LogMeans::blocks);
        let (low_c, high_c) = blocks()
            .fold((f64::MAX, f64::MIN), |(low, high), block| (low.min(block.temp_c), high.max(block.temp_c)));
        if blocks().next().is_some() && high_c - low_c < LEAST_SPAN_C {
            return Err(refused(TempcalRefusal::SmallSpan { low_c, high_c }).into());
        }
        let moving = self.axes.iter().flat_map(|axis| &axis.logs).map(LogMeans::moving_share).fold(0.0, f64::max);
        if moving > MOST_MOTION {
            return Err(refused(TempcalRefusal::Moves { share: moving }).into());
        }
        Ok(())
    }

    /// The curves of the axes. They share what they tell about the lag.
    fn fitted(self, reference_c: Option<f64>) -> Result<(Vec<AxisCurve>, Vec<Points>)> {
        let name = &self.name;
        let refused = |error: ThermalError| {
            let why = TempcalRefusal::of(error);
            anyhow::Error::from(CodedRefusal::new(why.code(), format!("{name}: {why}")))
        };
        let records = on_threads(&self.axes, |axis| AxisRecord::new(axis.logs.clone()));
        let records = records.into_iter().collect::<Result<Vec<AxisRecord>, ThermalError>>().map_err(refused)?;
        let indices: Vec<usize> = (0..records.len()).collect();
        let curves = on_threads(&indices, |index| {
            let others = records.iter().enumerate().filter(|(other, _)| other != index);
            records[*index].curve(&others.map(|(_, other)| other.lag()).collect::<Vec<&LagLikelihood>>())
        });
        let (mut all, mut points) = (Vec::new(), Vec::new());
        for ((axis, record), curve) in self.axes.iter().zip(&records).zip(curves) {
            let curve = curve.map_err(refused)?;
            let measured = Measured { sensor: name, name: &axis.name, kind: self.kind, reference_c };
            let mut found = AxisCurve::new(&measured, &curve);
            found.warnings = warning::of(&curve, record.logs(), &found).iter().map(TempcalWarning::coded).collect();
            points.push(Points::new(&curve, record.logs(), &found));
            all.push(found);
        }
        Ok((all, points))
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
