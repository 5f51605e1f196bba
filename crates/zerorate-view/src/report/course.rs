//! The data that a calibration was made from, over time.

use crate::plot::{Series, over_time};
use zerorate::calibration::{CalibratedAxis, Calibration};

/// The means of a measurement over time.
#[derive(Clone, Debug)]
pub struct Course {
    /// The names of the axes.
    pub axes: Vec<String>,
    /// The means, in order of time.
    pub moments: Vec<Moment>,
}

/// Means over a few seconds. A mean without samples is NaN.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Mid-time, s after the first sample.
    pub at_s: f64,
    /// Temperature, °C.
    pub temp_c: f64,
    /// Rate of each axis, °/s.
    pub rates_dps: Vec<f64>,
}

/// Plots rate, temperature and corrected rate of an axis as SVG, with the windows of AN-1042 (F-51). `None` if the
/// course lacks the axis.
pub(super) fn picture(course: &Course, calibration: &Calibration, axis: &CalibratedAxis) -> Option<String> {
    let index = course.axes.iter().position(|name| *name == axis.name)?;
    let series = |name: &str, value: &dyn Fn(f64, f64) -> f64| {
        let point = |moment: &Moment| Some((moment.at_s, value(*moment.rates_dps.get(index)?, moment.temp_c)));
        Series { name: name.to_owned(), points: course.moments.iter().filter_map(point).collect() }
    };
    let all = [
        series("rate, °/s", &|rate_dps, _| rate_dps),
        series("temperature, °C", &|_, temp_c| temp_c),
        series("rate with the correction, °/s", &|rate_dps, temp_c| axis.correction.apply(rate_dps, temp_c)),
    ];
    Some(over_time("The measurement over time", &all, &windows_s(calibration)))
}

/// Start and end of the averages of steps 4, 6 and 8, s. Empty without a run, and for a curve, which uses all samples.
fn windows_s(calibration: &Calibration) -> Vec<(f64, f64)> {
    let Some(run) = calibration.run.as_ref().filter(|_| calibration.axes.iter().all(|axis| axis.curve.is_none()))
    else {
        return Vec::new();
    };
    let second_s = run.average_s + run.warmup_s;
    let offset_s = second_s + run.average_s + run.settle_s;
    vec![(0.0, run.average_s), (second_s, second_s + run.average_s), (offset_s, offset_s + run.offset_s)]
}
