//! Means that no sensor has at rest. They tell of a wrong unit, of a wrong scale, or of columns that are mixed.

use crate::{Column, LogWarning, Quantity, Series};
use std::path::Path;

/// Gravity, m/s². It differs by 0.3 % over the Earth.
const GRAVITY_M_S2: f64 = 9.8;
/// The share by which the accelerometers may be off it: scales by 3 %, and an axis of the MPU-6050 by 0.8 m/s².
const WITHIN: f64 = 0.2;
/// Below this, gravity has been subtracted, m/s².
const SUBTRACTED_M_S2: f64 = 0.3;
/// No gyroscope has such a bias, °/s: the data sheet of the MPU-6050 allows 20, and most allow less.
const NO_BIAS_DPS: f64 = 50.0;

/// The warnings about the axes of an IMU in the log at `path`.
pub(super) fn doubts(path: &Path, axes: &[Column]) -> Vec<LogWarning> {
    let of = |quantity| axes.iter().filter(move |axis| axis.quantity == Some(quantity));
    let warning = |what| LogWarning::Implausible { path: path.display().to_string(), what };
    let turns = of(Quantity::AngularRate).filter_map(|axis| {
        let mean_dps = mean(axis).filter(|mean_dps| mean_dps.abs() > NO_BIAS_DPS)?;
        Some(format!("{} is {mean_dps:.0} °/s in the mean", axis.name))
    });
    let accelerations: Vec<f64> = of(Quantity::Acceleration).filter_map(mean).collect();
    let fall = match accelerations[..] {
        [x, y, z] => {
            let m_s2 = (x * x + y * y + z * z).sqrt();
            let is_off = m_s2 > SUBTRACTED_M_S2 && (m_s2 / GRAVITY_M_S2 - 1.0).abs() > WITHIN;
            is_off.then(|| format!("gravity is {m_s2:.3} m/s²"))
        }
        _ => None,
    };
    turns.take(1).chain(fall).map(warning).collect()
}

/// The mean in °/s or m/s²; none where codes may have their zero in the middle of the scale.
fn mean(axis: &Column) -> Option<f64> {
    let Series::Numbers(_) = &axis.series else { return None };
    Some(axis.scale * axis.facts().mean()).filter(|mean| mean.is_finite())
}
