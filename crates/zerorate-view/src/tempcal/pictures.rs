//! Plots of the bias over temperature.

use super::{AxisCurve, FACTOR, Points};
use crate::plot::{Dot, Scatter, ScatterPanel, scatter};

/// Plots the means, the curve and its band over temperature, one panel per axis of a unit.
#[must_use]
pub fn over_temperature(axes: &[(&AxisCurve, &Points)]) -> String {
    let panel = |(axis, points): &(&AxisCurve, &Points)| ScatterPanel {
        label: format!("{}, {}", axis.name, axis.unit),
        dots: dots(points, |point| (point.temp_c, point.value)),
        curve: axis.curve.iter().map(|point| point.values()).map(|(c, bias, u)| (c, bias, FACTOR * u)).collect(),
    };
    picture("Bias over temperature", "the line is the curve, with its 95 % band", "temperature, °C", axes, panel)
}

/// Plots the residuals over temperature.
#[must_use]
pub(super) fn left_over_temperature(axes: &[(&AxisCurve, &Points)]) -> String {
    let panel = |(axis, points): &(&AxisCurve, &Points)| ScatterPanel {
        label: format!("{}, {}", axis.name, axis.unit),
        dots: dots(points, |point| (point.temp_c, point.left)),
        curve: Vec::new(),
    };
    picture("What the curve leaves over temperature", "", "temperature, °C", axes, panel)
}

/// Plots the residuals over time.
#[must_use]
pub(super) fn left_over_time(axes: &[(&AxisCurve, &Points)]) -> String {
    let panel = |(axis, points): &(&AxisCurve, &Points)| ScatterPanel {
        label: format!("{}, {}", axis.name, axis.unit),
        dots: dots(points, |point| (point.at_s / 60.0, point.left)),
        curve: Vec::new(),
    };
    picture("What the curve leaves over time", "", "time, min", axes, panel)
}

fn dots(points: &Points, at: impl Fn(&super::MeanPoint) -> (f64, f64)) -> Vec<Dot> {
    points.all.iter().map(|point| Dot { at: at(point), is_warming: point.is_warming }).collect()
}

fn picture(
    title: &str,
    subtitle: &str,
    x_name: &str,
    axes: &[(&AxisCurve, &Points)],
    panel: impl Fn(&(&AxisCurve, &Points)) -> ScatterPanel,
) -> String {
    let (title, subtitle, x_name) = (title.to_owned(), subtitle.to_owned(), x_name.to_owned());
    scatter(&Scatter { title, subtitle, x_name, panels: axes.iter().map(panel).collect() })
}
