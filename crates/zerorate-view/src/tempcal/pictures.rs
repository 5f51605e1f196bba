//! Plots of the bias over temperature.

use super::{AxisCurve, FACTOR, MeanPoint, Points};
use crate::plot::{Dot, Scatter, ScatterPanel, scatter};

/// Plots the means, the curve and its band over temperature, one panel per axis of a unit.
#[must_use]
pub fn over_temperature(axes: &[(&AxisCurve, &Points)]) -> String {
    let said = ["Bias over temperature", "the line is the curve, with its 95 % band", "temperature, °C"];
    let curve = |axis: &AxisCurve| {
        axis.curve.iter().map(|point| point.values()).map(|(c, bias, u)| (c, bias, FACTOR * u)).collect()
    };
    picture(said, axes, |point| (point.temp_c, point.value), curve)
}

/// Plots the residuals over temperature.
#[must_use]
pub(super) fn left_over_temperature(axes: &[(&AxisCurve, &Points)]) -> String {
    let said = ["What the curve leaves over temperature", "", "temperature, °C"];
    picture(said, axes, |point| (point.temp_c, point.left), |_| Vec::new())
}

/// Plots the residuals over time.
#[must_use]
pub(super) fn left_over_time(axes: &[(&AxisCurve, &Points)]) -> String {
    let said = ["What the curve leaves over time", "", "time, min"];
    picture(said, axes, |point| (point.at_s / 60.0, point.left), |_| Vec::new())
}

/// Draws a panel for each axis: a dot at each of its means, and its curve.
fn picture(
    [title, subtitle, x_name]: [&str; 3],
    axes: &[(&AxisCurve, &Points)],
    at: fn(&MeanPoint) -> (f64, f64),
    curve: fn(&AxisCurve) -> Vec<(f64, f64, f64)>,
) -> String {
    let dot = |point: &MeanPoint| Dot { at: at(point), is_warming: point.is_warming };
    let panel = |(axis, points): &(&AxisCurve, &Points)| ScatterPanel {
        label: format!("{}, {}", axis.name, axis.unit),
        dots: points.all.iter().map(dot).collect(),
        curve: curve(axis),
    };
    let [title, subtitle, x_name] = [title, subtitle, x_name].map(str::to_owned);
    scatter(&Scatter { title, subtitle, x_name, panels: axes.iter().map(panel).collect() })
}
