//! The HTML page of a measurement in a chamber.

use super::calibration::origin;
use super::{Fact, calibration_picture};
use crate::plot::{ResidualPoint, residuals};
use crate::printable;
use anyhow::Result;
use askama::Template;
use zerorate::chamber::{Branches, ChamberOutcome, Record, Residual};
use zerorate::{Calibration, Uncertainty};

/// The content of the page.
pub struct ChamberPage<'a> {
    /// The heading of the page.
    pub title: &'a str,
    /// The resulting calibration.
    pub calibration: &'a Calibration,
    /// The means of rate and temperature over each second, and over each soak.
    pub record: &'a Record,
    /// The outcome of each axis of the calibration.
    pub outcomes: &'a [ChamberOutcome],
    /// Warnings about the measurement.
    pub warnings: &'a [String],
    /// The facts of each axis.
    pub facts: Vec<Vec<Fact>>,
}

#[derive(Template)]
#[template(path = "chamber.html")]
struct Page<'a> {
    simulated: bool,
    title: &'a str,
    below: String,
    software: &'a str,
    warnings: &'a [String],
    axes: Vec<AxisPart>,
    origin: Vec<Fact>,
}

struct AxisPart {
    name: Option<String>,
    facts: Vec<Fact>,
    correction: String,
    over_time: String,
    over_temperature: String,
    points: Vec<Vec<String>>,
}

/// Makes the page as HTML.
///
/// # Errors
/// Returns an error if the template cannot be filled.
pub fn chamber_page(page: ChamberPage<'_>) -> Result<String> {
    let ChamberPage { title, calibration, record, outcomes, warnings, facts } = page;
    let axes =
        calibration.axes.iter().zip(outcomes).zip(facts).enumerate().map(|(index, ((axis, outcome), facts))| {
            AxisPart {
                name: (outcomes.len() > 1).then(|| axis.name.clone()),
                facts,
                correction: calibration_picture(calibration, axis),
                over_time: over_time(outcome),
                over_temperature: over_temperature(outcome),
                points: points(record, outcome, index),
            }
        });
    let below = format!("calibration {}, {} soak points", calibration.id(), record.soaks.len());
    let simulated = calibration.is_simulated();
    let (software, origin) = (zerorate::SOFTWARE, origin(calibration));
    let page = Page { simulated, title, below, software, warnings, axes: axes.collect(), origin };
    Ok(printable::page(&page.render()?))
}

/// Plots the corrected rate over the time of the measurement, as SVG.
pub fn over_time(outcome: &ChamberOutcome) -> String {
    picture("What the correction leaves over time", "time, min", outcome, |residual| residual.at_s / 60.0)
}

/// Plots the corrected rate over the temperature, which shows the hysteresis loop, as SVG.
pub fn over_temperature(outcome: &ChamberOutcome) -> String {
    picture("What the correction leaves over temperature", "temperature, °C", outcome, |residual| residual.temp_c)
}

fn picture(title: &str, x_name: &str, outcome: &ChamberOutcome, x: fn(&Residual) -> f64) -> String {
    let point = |residual: &Residual| {
        let &Residual { residual_dps, warming, .. } = residual;
        ResidualPoint { x: x(residual), residual_dps, warming }
    };
    residuals(title, x_name, &outcome.residuals.iter().map(point).collect::<Vec<_>>())
}

fn points(record: &Record, outcome: &ChamberOutcome, axis: usize) -> Vec<Vec<String>> {
    let row = |(soak, residual_dps): (&zerorate::chamber::Soak, &f64)| {
        vec![
            (soak.step + 1).to_string(),
            format!("{:.1}", soak.set_c),
            format!("{:.3}", soak.temp_c),
            soak.rates_dps.get(axis).map_or(String::new(), |rate_dps| format!("{rate_dps:+.5}")),
            format!("{residual_dps:+.5}"),
            format!("{:+.4}", soak.drift_c_per_min),
            if soak.settled { "yes" } else { "no" }.to_owned(),
        ]
    };
    record.soaks.iter().zip(&outcome.soak_residuals_dps).map(row).collect()
}

/// The text of the warning `hysteresis`, if the difference between warming and cooling is significant. No curve over
/// temperature can correct hysteresis.
#[must_use]
pub fn wide_loop(outcome: &ChamberOutcome, axis: &str) -> Option<String> {
    let Branches { half_width_dps, u_dps, .. } = outcome.branches?;
    let half_u_dps = Uncertainty::FACTOR * u_dps;
    (half_width_dps.abs() > 3.0 * u_dps).then(|| {
        format!(
            "{axis}: cooling and warming lie ±{half_width_dps:.5} ± {half_u_dps:.5} °/s about their mean; allow for it"
        )
    })
}
