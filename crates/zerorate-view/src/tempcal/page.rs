//! The HTML page of a temperature calibration.

use super::{AxisCurve, FACTOR, Points, pictures};
use crate::interval::PlusMinus;
use crate::plot::{minus, number};
use crate::printable;
use crate::report::Table;
use anyhow::Result;
use askama::Template;
use zerorate_imu::Kind;

/// The content of the page.
pub struct TempcalPage<'a> {
    /// The heading.
    pub title: String,
    /// The command line that made the page.
    pub command: String,
    /// Warnings about the logs.
    pub warnings: &'a [String],
    /// The curve of each axis.
    pub axes: &'a [AxisCurve],
    /// The means of each axis.
    pub points: &'a [Points],
}

#[derive(Template)]
#[template(path = "tempcal.html")]
struct Page<'a> {
    title: String,
    software: &'a str,
    command: String,
    warnings: &'a [String],
    sensors: Vec<Sensor>,
}

struct Sensor {
    name: String,
    warnings: Vec<String>,
    tables: Vec<Table>,
    pictures: Vec<String>,
}

/// Makes the page as HTML.
///
/// # Errors
/// Returns an error if the template cannot be filled.
pub fn tempcal_page(page: TempcalPage<'_>) -> Result<String> {
    let TempcalPage { title, command, warnings, axes, points } = page;
    let all: Vec<(&AxisCurve, &Points)> = axes.iter().zip(points).collect();
    let sensors = all.chunk_by(|one, other| one.0.sensor == other.0.sensor).map(sensor).collect();
    let page = Page { title, software: zerorate::SOFTWARE, command, warnings, sensors };
    Ok(printable::page(&page.render()?))
}

fn sensor(axes: &[(&AxisCurve, &Points)]) -> Sensor {
    let warnings = axes.iter().flat_map(|(axis, _)| axis.warnings.iter().map(|line| format!("{}: {line}", axis.name)));
    Sensor {
        name: axes.first().map_or_else(String::new, |(axis, _)| axis.sensor.clone()),
        warnings: warnings.collect(),
        tables: vec![results(axes), cubics(axes)],
        pictures: vec![
            pictures::over_temperature(axes),
            pictures::left_over_temperature(axes),
            pictures::left_over_time(axes),
        ],
    }
}

fn results(axes: &[(&AxisCurve, &Points)]) -> Table {
    // an accelerometer's bias cannot be told from gravity
    let has_bias = axes.iter().any(|(axis, _)| axis.kind == Kind::Gyroscope);
    let head = ["axis", "unit", "bias", "slope per °C", "span before", "span after", "lag, s", "hysteresis"];
    let shown = |index: &usize| *index != BIAS || has_bias;
    let row = |(axis, _): &(&AxisCurve, &Points)| {
        let stated = |value: f64, u: f64| minus(&PlusMinus { value, half: FACTOR * u }.to_string());
        let cells = [
            axis.name.clone(),
            axis.unit.to_owned(),
            stated(axis.bias, axis.u_bias),
            stated(axis.slope_per_c, axis.u_slope_per_c),
            number(axis.before),
            number(axis.after),
            format!("{:.0}", axis.lag_s),
            axis.hysteresis.map_or_else(|| "not seen".to_owned(), |half| format!("±{}", number(half))),
        ];
        only(cells, shown)
    };
    let (reference_c, of) =
        (axes.first().map_or(0.0, |(axis, _)| axis.reference_c), if has_bias { "Bias" } else { "Slope" });
    Table {
        title: format!("{of} at {reference_c:.0} °C"),
        head: only(head.map(str::to_owned), shown),
        rows: axes.iter().map(row).collect(),
        note: "± is half of a 95 % interval. The span after is that of what remains where the curve comes from the \
               other parts of the record."
            .to_owned(),
    }
}

/// The index of the bias column.
const BIAS: usize = 2;

fn only(cells: [String; 8], shown: impl Fn(&usize) -> bool) -> Vec<String> {
    cells.into_iter().enumerate().filter(|(index, _)| shown(index)).map(|(_, cell)| cell).collect()
}

fn cubics(axes: &[(&AxisCurve, &Points)]) -> Table {
    let head = ["axis", "unit", "X0", "X1", "X2", "X3", "leaves up to"];
    let row = |(axis, _): &(&AxisCurve, &Points)| {
        let terms = axis.cubic.terms.iter().map(|term| minus(&format!("{term:.4e}")));
        let ends = [axis.name.clone(), axis.unit.to_owned()];
        ends.into_iter().chain(terms).chain([number(axis.cubic.left)]).collect()
    };
    let about_c = axes.first().map_or(0.0, |(axis, _)| axis.cubic.about_c);
    Table {
        title: "Polynomial of order 3".to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: axes.iter().map(row).collect(),
        note: format!("bias = X0 + X1 d + X2 d² + X3 d³ with d = T − {about_c:.0} °C"),
    }
}
