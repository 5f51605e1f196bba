//! Exports a calibration for firmware, as tables and integer coefficients.

pub(crate) mod autopilot;
mod codes;
mod firmware;
mod form;
mod json;
mod layout;
mod prefix;
mod warning;

use crate::remark::remarks_apart;
use anyhow::Result;
pub use form::{ExportForm, FormRow};
use layout::Layout;
pub use prefix::Prefix;
pub use warning::ExportWarning;
use zerorate::{Calibration, TableRow};

/// The settings of an export. `None` means the default.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Step of the table, °C.
    pub step_c: Option<f64>,
    /// Distance from T3 to either end of the table, °C.
    pub span_c: Option<f64>,
    /// The prefix of all names in C and Rust.
    pub prefix: Option<Prefix>,
    /// The number of the gyroscope in the flight controller.
    pub sensor: Option<u32>,
    /// The device_id of the gyroscope in PX4. An export to PX4 fails without it.
    pub device_id: Option<i32>,
}

/// The error for invalid settings of an export. The text states the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidOptions(pub String);

impl std::fmt::Display for InvalidOptions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InvalidOptions {}

/// A calibration with its tables, ready to be written in any format.
#[derive(Debug)]
pub struct Export {
    calibration: Calibration,
    layout: Layout,
    /// The table of each axis of the calibration.
    tables: Vec<Vec<TableRow>>,
    options: Options,
}

impl Export {
    /// Chooses the step and the span that the options leave open, and computes the tables.
    ///
    /// # Errors
    /// Returns [`InvalidOptions`] if no table can have this step and span.
    pub fn new(calibration: Calibration, options: Options) -> Result<Self> {
        let layout = Layout::new(&calibration, options.step_c, options.span_c);
        let tables = calibration.axes.iter().map(|axis| layout.rows(&axis.correction)).collect::<Result<_>>()?;
        Ok(Self { calibration, layout, tables, options })
    }

    /// Warnings about the range and the tables.
    #[must_use]
    pub fn warnings(&self) -> Vec<ExportWarning> {
        self.layout.warnings(&self.calibration)
    }

    /// Checks that the calibration has the axes that the format needs: x, y and z for a flight controller.
    ///
    /// # Errors
    /// Returns an error that names the axes of the calibration.
    pub fn check_axes(&self, form: ExportForm) -> Result<()> {
        if form.is_autopilot() { autopilot::three(self).map(drop) } else { Ok(()) }
    }

    /// The text of the exported file.
    ///
    /// # Errors
    /// Returns [`InvalidOptions`] or another error if the settings or the calibration do not fit the format.
    pub fn text(&self, form: ExportForm) -> Result<String> {
        let Options { prefix, sensor, device_id, .. } = &self.options;
        match form {
            ExportForm::C => firmware::c(self, prefix.as_ref()),
            ExportForm::Rust => firmware::rust(self, prefix.as_ref()),
            ExportForm::Csv => Ok(csv(self)),
            ExportForm::Json => json::text(self),
            ExportForm::Px4 => autopilot::px4(self, *sensor, *device_id),
            ExportForm::Ardupilot => autopilot::ardupilot(self, *sensor),
        }
    }

    /// Describes the largest error of a CSV table between its rows, one text for each axis with a curve. Axes with a
    /// linear correction have no text, because their tables can be interpolated exactly.
    #[must_use]
    pub fn lost_by_rows(&self) -> Vec<String> {
        let Layout { step_c, span_c, .. } = self.layout;
        let curves = self.calibration.axes.iter().filter(|axis| !axis.correction.is_line());
        let lost = curves.map(|axis| {
            let (name, curve) = (&axis.name, &axis.correction);
            format!(
                "axis {name}: straight lines between rows are off the curve by up to {:.1e} °/s, the nearest row \
                 by up to {:.1e} °/s",
                curve.bend_dps(step_c, span_c),
                curve.steepest_dps_per_c(span_c) * step_c / 2.0
            )
        });
        lost.collect()
    }
}

/// The table as CSV: one column for the only axis of an ADIS16130, otherwise a named column for each axis.
fn csv(export: &Export) -> String {
    let Export { calibration, tables, .. } = export;
    let names = calibration.axes.iter().map(|axis| format!(",{}_correction_dps", axis.name));
    let header = if calibration.is_plain() { ",correction_dps".to_owned() } else { names.collect() };
    let mut text = format!("delta_c{header}\n");
    for (index, row) in tables.first().into_iter().flatten().enumerate() {
        text += &tidy(row.delta_c).to_string();
        for corrections in tables {
            text += &format!(",{}", tidy(corrections[index].correction_dps));
        }
        text.push('\n');
    }
    text
}

/// The warnings of a calibration and its axes, without the standing remarks.
fn warnings(calibration: &Calibration) -> Vec<String> {
    let of_axes = calibration.axes.iter().flat_map(|axis| &axis.warnings);
    let all: Vec<&String> = calibration.warnings.iter().chain(of_axes).collect();
    remarks_apart(&all).1
}

/// Rounds to twelve significant digits and removes a negative zero, so that 3 · 0.02 is written as 0.06.
fn tidy(value: f64) -> f64 {
    // a formatted number always parses
    let rounded = format!("{value:.11e}").parse().unwrap_or(value);
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_lose_the_errors_of_rounding() {
        assert_eq!(
            [0.1 + 0.2, -0.0, 6.0 * 0.02 * -0.04, 3.0 * 0.02].map(|x| tidy(x).to_string()),
            ["0.3", "0", "-0.0048", "0.06"]
        );
    }
}
