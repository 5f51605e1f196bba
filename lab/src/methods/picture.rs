//! The plots of docs/reference/methods.md: residual and coverage over the measured temperatures.

use super::campaign::{METHODS, RAW};
use super::comparison::Summary;
use super::unit::{Kind, TEMPS};
use zerorate::Uncertainty;
use zerorate_view::plot::{Lines, Panel, lines};

const SHARE: &str = "place in the temperatures seen, % from the lowest to the highest";

/// Plots the residual bias over temperature: a panel for each kind of unit, a line for each method but `raw`.
pub fn residuals(methods: &[Vec<Summary>]) -> String {
    let correcting: Vec<usize> = (0..METHODS.len()).filter(|index| METHODS[*index].name != RAW).collect();
    lines(&Lines {
        title: "What is left of the bias, rms over units".to_owned(),
        names: names(&correcting),
        x_name: SHARE.to_owned(),
        y_name: "residual, °/h".to_owned(),
        is_log: true,
        rule: None,
        panels: panels(methods, &correcting, |summary| over(summary.at_temps_dph)),
    })
}

/// Plots the share of units inside their 95 % intervals over temperature, for the methods that state intervals.
pub fn coverage(methods: &[Vec<Summary>]) -> String {
    let states = |index: &usize| methods.iter().any(|of_kind| of_kind[*index].coverage.is_some());
    let stating: Vec<usize> = (0..METHODS.len()).filter(states).collect();
    lines(&Lines {
        title: "Units inside their 95 % intervals".to_owned(),
        names: names(&stating),
        x_name: SHARE.to_owned(),
        y_name: "inside, %".to_owned(),
        is_log: false,
        rule: Some(100.0 * Uncertainty::COVERAGE),
        panels: panels(methods, &stating, inside),
    })
}

fn names(indices: &[usize]) -> Vec<String> {
    indices.iter().map(|index| METHODS[*index].name.to_owned()).collect()
}

fn inside(summary: &Summary) -> Vec<(f64, f64)> {
    summary.coverage.map_or(Vec::new(), |coverage| over(coverage.at_temps))
}

/// A panel for each kind of unit, with lines of the methods that have these indices.
fn panels(methods: &[Vec<Summary>], indices: &[usize], line: fn(&Summary) -> Vec<(f64, f64)>) -> Vec<Panel> {
    let panel = |(kind, of_kind): (Kind, &Vec<Summary>)| Panel {
        label: format!("{} units", kind.name()),
        lines: indices.iter().map(|index| line(&of_kind[*index])).collect(),
    };
    Kind::ALL.into_iter().zip(methods).map(panel).collect()
}

fn over(values: [f64; TEMPS]) -> Vec<(f64, f64)> {
    (0..TEMPS).map(|k| (100.0 * k as f64 / (TEMPS - 1) as f64, values[k])).collect()
}
