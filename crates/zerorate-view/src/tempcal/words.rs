//! The curves as a text table for a terminal.

use super::{AxisCurve, FACTOR};
use crate::interval::PlusMinus;
use crate::plot::number;
use std::fmt::Write;
use zerorate::temperature::curve::CurveRefusal;
use zerorate_imu::Kind;
use zerorate_logs::{Names, Setting};

/// The text of a refusal, with the settings that can help.
#[must_use]
pub fn refusal_text(why: &CurveRefusal, names: Names) -> String {
    match why {
        CurveRefusal::Moves { .. } => {
            format!("{why} with {} and {}", names.of(Setting::Skip), names.of(Setting::Until))
        }
        why => why.to_string(),
    }
}

/// The table: the sensors, with two lines for each axis. Bias and slope are given ± half of their 95 % intervals.
#[must_use]
pub fn table(axes: &[AxisCurve]) -> String {
    let mut text =
        "value ± half of its 95 % interval; span of the bias before and after the correction\n\n".to_owned();
    let mut last = "";
    for axis in axes {
        if axis.sensor != last {
            let (low_c, high_c) = axis.span_c();
            let head = if last.is_empty() { "" } else { "\n" };
            last = &axis.sensor;
            // writing to a string cannot fail
            let _ = writeln!(text, "{head}{last}, {low_c:.1} to {high_c:.1} °C");
        }
        row(&mut text, axis);
    }
    text
}

/// The warnings of all axes. Each text occurs once, with the names of the axes that have it.
#[must_use]
pub fn warnings_of_axes<'a>(axes: impl IntoIterator<Item = &'a AxisCurve>) -> Vec<String> {
    let axes: Vec<&AxisCurve> = axes.into_iter().collect();
    let mut lines: Vec<(&str, Vec<&str>)> = Vec::new();
    for (axis, line) in axes.iter().flat_map(|axis| axis.warnings.iter().map(move |line| (*axis, line))) {
        match lines.iter_mut().find(|(known, _)| known == line) {
            Some((_, names)) => names.push(&axis.name),
            None => lines.push((line, vec![&axis.name])),
        }
    }
    let worded = |(line, names): (&str, Vec<&str>)| {
        let (code, text) = line.split_once(": ").unwrap_or((line, ""));
        let of = if names.len() == axes.len() { "all axes".to_owned() } else { names.join(", ") };
        format!("{code}: {of}: {text}")
    };
    lines.into_iter().map(worded).collect()
}

fn row(text: &mut String, axis: &AxisCurve) {
    let AxisCurve { name, unit, reference_c, bias, u_bias, slope_per_c, u_slope_per_c, .. } = axis;
    let half = |u: f64| number(FACTOR * u);
    let stated = |value: f64, u: f64| PlusMinus { value, half: FACTOR * u };
    let slope = format!("{} {unit}/°C at {reference_c:.0} °C", stated(*slope_per_c, *u_slope_per_c));
    // an accelerometer's bias cannot be told from gravity
    let bias = match axis.kind {
        Kind::Gyroscope => format!("bias {} {unit}, ", stated(*bias, *u_bias)),
        Kind::Accelerometer => String::new(),
    };
    let (before, after) = (number(axis.before), number(axis.after));
    let lag = match axis.lag_s {
        lag_s if lag_s.abs() < LEAST_LAG_S => "no lag".to_owned(),
        lag_s if lag_s < 0.0 => format!("the thermometer lags {:.0} s", -lag_s),
        lag_s => format!("lag {lag_s:.0} s"),
    };
    let on = axis
        .u_if_on_before
        .map_or_else(String::new, |u| format!("; bias ±{} {unit} if it was on before the log", half(u)));
    let hysteresis = axis.hysteresis.map_or_else(String::new, |half| format!(", hysteresis ±{} {unit}", number(half)));
    let starts =
        axis.spread_of_starts.map_or_else(String::new, |u| format!(", ±{} {unit} from start to start", half(u)));
    let _ = writeln!(text, "  {name}: {bias}slope {slope}");
    let _ = writeln!(text, "    span {before} {unit} before, {after} {unit} after; {lag}{on}{hysteresis}{starts}");
}

/// A lag shorter than this, s, is shown as no lag.
const LEAST_LAG_S: f64 = 0.5;
