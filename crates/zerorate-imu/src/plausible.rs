//! Detects values that no sensor has at rest. Such values indicate a wrong unit, a wrong scale, or mixed columns.

use crate::{codes, in_turn};
use std::path::Path;
use zerorate_allan::hertz;
use zerorate_logs::{Column, ColumnOptions, LogWarning, Quantity, Series, Setting, Unit};

/// Gravity, m/s². It differs by up to 0.3 % over the Earth.
const GRAVITY_M_S2: f64 = 9.8;
/// Largest relative error of gravity: scales are off by up to 3 %, and an axis of the MPU-6050 has a bias of up to 0.8
/// m/s².
const WITHIN: f64 = 0.2;
/// If the mean acceleration is below this, m/s², gravity seems to have been subtracted, or its unit to be wrong.
const SUBTRACTED_M_S2: f64 = 0.3;
/// No gyroscope has a bias above this, °/s: the data sheet of the MPU-6050 allows 20, and most allow less.
const NO_BIAS_DPS: f64 = 50.0;
/// No gyroscope has white noise above this, °/s/√Hz: the MPU-3050 has 0.01, and the ADXRS620 0.05.
const NO_NOISE_DPS_PER_RT_HZ: f64 = 0.15;
/// No IMU is read more slowly than this, Hz.
const SLOW_HZ: f64 = 0.5;
/// Steps too coarse for a log: whole °/s and, with a margin, whole g in m/s².
const WHOLE_DPS: f64 = 1.0;
const WHOLE_M_S2: f64 = 9.0;

/// Gravity that is computed from increments, or in columns that seem to be in g, may be off by this share.
const WITHIN_OF_INCREMENTS: f64 = 0.05;

/// Evidence that accelerometer columns hold velocity increments: the norm of their means, times the sample rate, is
/// gravity, and the norm itself is not.
pub(super) fn increments(axes: &[Column]) -> Option<String> {
    let m_s = acceleration(axes)?;
    let rate_hz = axes.first()?.rate_hz;
    let is_off = (m_s / GRAVITY_M_S2 - 1.0).abs() > WITHIN;
    let is_gravity = (m_s * rate_hz / GRAVITY_M_S2 - 1.0).abs() < WITHIN_OF_INCREMENTS;
    let m_s2 = m_s * rate_hz;
    (is_off && is_gravity).then(|| format!("{m_s:.4} m/s², times {rate_hz:.0} Hz, are gravity: {m_s2:.2} m/s²"))
}

/// Warns of implausible values in the axes of an IMU.
pub(super) fn doubts(path: &Path, axes: &[Column], log: &ColumnOptions) -> Vec<LogWarning> {
    let of = |quantity| axes.iter().filter(move |axis| axis.quantity == Some(quantity));
    let warning = |what| LogWarning::Implausible { path: path.display().to_string(), what };
    let turn = |axis: &Column, has_sign| {
        let mean_dps = mean(axis, has_sign).filter(|mean_dps| mean_dps.abs() > NO_BIAS_DPS)?;
        Some(format!("{} is {} °/s in the mean", axis.name, shown(mean_dps, 0)))
    };
    let has_sign = of(Quantity::AngularRate).any(has_sign);
    let turns = of(Quantity::AngularRate).filter_map(|axis| turn(axis, has_sign));
    let fall = acceleration(axes).and_then(|m_s2| {
        let is_off = m_s2 > SUBTRACTED_M_S2 && (m_s2 / GRAVITY_M_S2 - 1.0).abs() > WITHIN;
        let of_kind: Vec<&Column> = of(Quantity::Acceleration).collect();
        let remedy = || codes::of_gravity(&of_kind, log).map_or_else(String::new, |remedy| format!(" ({remedy})"));
        is_off.then(|| format!("gravity is {} m/s²{}", shown(m_s2, 3), remedy()))
    });
    let small = small_gravity(axes);
    let gyroscope = codes::of_gyroscope(log.names);
    turns
        .take(1)
        .chain(fall)
        .chain(small)
        .chain(whole(axes, &gyroscope))
        .chain(noisy(axes, log))
        .chain(in_turn::doubt(axes))
        .chain(slow(axes))
        .map(warning)
        .collect()
}

/// Warns of columns in °/s or rad/s with values or a sample rate that no gyroscope has, at rest or not. A scale that
/// the user states is not doubted: a log of raw numbers may be of another sensor.
#[must_use]
pub fn implausible_rates(path: &Path, columns: &[Column], log: &ColumnOptions) -> Vec<LogWarning> {
    let is_rate = |column: &&Column| column.quantity == Some(Quantity::AngularRate);
    let rates: Vec<&Column> = columns.iter().filter(is_rate).collect();
    let scale = format!("if these are codes, {} with the size of one in this unit", log.names.of(Setting::Scale));
    let whole = if log.scale.is_none() { whole(rates.iter().copied(), &scale) } else { None };
    let doubts = whole.into_iter().chain(slow(rates));
    doubts.map(|what| LogWarning::Implausible { path: path.display().to_string(), what }).collect()
}

/// A warning about steps that no sensor has, with the remedy for a gyroscope.
fn whole<'a>(axes: impl IntoIterator<Item = &'a Column>, of_gyroscope: &str) -> Option<String> {
    let axis = axes.into_iter().find(|axis| is_whole(axis))?;
    let unit = axis.quantity.map_or("", Quantity::unit);
    let is_rate = axis.quantity == Some(Quantity::AngularRate);
    let remedy = if is_rate { format!(" ({of_gyroscope})") } else { String::new() };
    let (name, step) = (&axis.name, shown(axis.scale, 3));
    Some(format!("{name} has steps of {step} {unit}, as codes without their scale have{remedy}"))
}

fn slow<'a>(axes: impl IntoIterator<Item = &'a Column>) -> Option<String> {
    let rate_hz = axes.into_iter().map(|axis| axis.rate_hz).find(|rate_hz| *rate_hz < SLOW_HZ)?;
    Some(format!("rows come at {}", hertz(rate_hz)))
}

/// A warning if the steps between samples of all gyroscopes show more noise than a sensor at rest or in slow motion.
fn noisy(axes: &[Column], log: &ColumnOptions) -> Option<String> {
    let gyros = axes.iter().filter(|axis| axis.quantity == Some(Quantity::AngularRate) && !axis.is_blank());
    let first = gyros.clone().next()?;
    let density = |axis: &Column| {
        let numbers = codes::numbers(axis);
        // the square of the one-sided density is twice the variance of a sample divided by the rate, and a step has
        // twice the variance of a sample
        in_turn::PER_MEAN * in_turn::steps(&numbers).0 * axis.scale / axis.rate_hz.sqrt()
    };
    let least = gyros.map(density).min_by(f64::total_cmp)?;
    let is_rad = first.scale == Unit::RadPerS.in_results() && least.to_radians() < NO_NOISE_DPS_PER_RT_HZ;
    let remedy = || codes::unit_to_give(log.names, Setting::GyroUnit, Unit::Dps, first);
    let remedy = if is_rad { format!(" (if the numbers are °/s: {})", remedy()) } else { String::new() };
    (least > NO_NOISE_DPS_PER_RT_HZ)
        .then(|| format!("the noise of all gyroscopes is above {} °/s/√Hz{remedy}", shown(least, 2)))
}

/// A warning about gravity below [`SUBTRACTED_M_S2`]. If gravity is 1 in the unit of the columns, the numbers are
/// probably in g. Otherwise a filter may have subtracted gravity.
fn small_gravity(axes: &[Column]) -> Option<String> {
    let m_s2 = acceleration(axes).filter(|m_s2| *m_s2 < SUBTRACTED_M_S2)?;
    let scale = axes.iter().find(|axis| axis.quantity == Some(Quantity::Acceleration))?.scale;
    Some(match (m_s2 / scale - 1.0).abs() < WITHIN_OF_INCREMENTS {
        true => format!("gravity is 1.0 of the unit of its columns, {m_s2:.4} m/s², as if it were g"),
        false => format!("gravity is {m_s2:.3} m/s², as if it had been subtracted"),
    })
}

pub(super) fn is_gravity(means_m_s2: impl Iterator<Item = f64>) -> bool {
    let m_s2 = means_m_s2.map(|mean| mean * mean).sum::<f64>().sqrt();
    (m_s2 / GRAVITY_M_S2 - 1.0).abs() < WITHIN
}

/// The norm of the means of the three axes of the accelerometer, m/s²: gravity. `None` unless three means are known.
fn acceleration(axes: &[Column]) -> Option<f64> {
    let of_kind: Vec<&Column> = axes.iter().filter(|axis| axis.quantity == Some(Quantity::Acceleration)).collect();
    let has_sign = of_kind.iter().any(|axis| has_sign(axis));
    let means: Vec<f64> = of_kind.iter().filter_map(|axis| mean(axis, has_sign)).collect();
    let [x, y, z] = means[..] else { return None };
    Some((x * x + y * y + z * z).sqrt())
}

/// The mean in °/s or m/s². `None` if it is not finite, and for codes whose zero may be in the middle of the scale.
fn mean(axis: &Column, has_sign: bool) -> Option<f64> {
    let is_plain = Unit::ALL.into_iter().any(|unit| unit.in_results() == axis.scale);
    let is_known = matches!(axis.series, Series::Numbers(_)) || has_sign || is_plain;
    Some(axis.scale * axis.facts().mean()).filter(|mean| is_known && mean.is_finite())
}

/// The value with this many decimals. From 10⁶ on it is in scientific form, because no sensor has such a value.
fn shown(value: f64, decimals: usize) -> String {
    if value.abs() < 1e6 { format!("{value:.decimals$}") } else { format!("{value:.2e}") }
}

fn has_sign(axis: &Column) -> bool {
    matches!(&axis.series, Series::Codes(codes) if codes.iter().any(|code| *code < 0))
}

/// True if all samples are multiples of a step that no sensor has, as codes without their scale are.
fn is_whole(axis: &Column) -> bool {
    let step = match axis.quantity {
        Some(Quantity::AngularRate) => WHOLE_DPS,
        _ => WHOLE_M_S2,
    };
    matches!(axis.series, Series::Codes(_)) && axis.scale >= step && !axis.is_blank()
}
