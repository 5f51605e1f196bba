//! The HTML page of a temperature calibration.

use super::{AxisCurve, FACTOR, Points, pictures, warnings_of_axes};
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
    /// The means of each axis over blocks of its logs, which the plots show as dots.
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
    let curves: Vec<&AxisCurve> = axes.iter().map(|(axis, _)| *axis).collect();
    Sensor {
        name: curves.first().map_or_else(String::new, |axis| axis.sensor.clone()),
        warnings: warnings_of_axes(curves.iter().copied()),
        tables: vec![results(&curves), cubics(&curves)],
        pictures: vec![
            pictures::over_temperature(axes),
            pictures::left_over_temperature(axes),
            pictures::left_over_time(axes),
        ],
    }
}

/// The text of a cell without a value.
const NONE: &str = "–";

/// Formats a value of an axis; `None` if the axis lacks it.
type Cell<'a> = &'a dyn Fn(&AxisCurve) -> Option<String>;

/// The table of results. A column without a value of any axis is left out.
fn results(axes: &[&AxisCurve]) -> Table {
    let Some(first) = axes.first() else { return Table::default() };
    let (unit, reference_c) = (first.unit, first.reference_c);
    let stated = |value: f64, u: f64| minus(&PlusMinus { value, half: FACTOR * u }.to_string());
    let half = |half: f64| format!("±{}", number(half));
    // an accelerometer's bias cannot be told from gravity
    let bias = |axis: &AxisCurve| (axis.kind == Kind::Gyroscope).then(|| stated(axis.bias, axis.u_bias));
    let columns: [(String, Cell<'_>); 9] = [
        ("axis".to_owned(), &|axis| Some(axis.name.clone())),
        (format!("bias, {unit}"), &bias),
        (format!("slope, {unit}/°C"), &|axis| Some(stated(axis.slope_per_c, axis.u_slope_per_c))),
        (format!("span before, {unit}"), &|axis| Some(number(axis.before))),
        (format!("span after, {unit}"), &|axis| Some(number(axis.after))),
        ("lag, s".to_owned(), &|axis| Some(minus(&format!("{:.0}", axis.lag_s)))),
        (format!("hysteresis, {unit}"), &|axis| axis.hysteresis.map(half)),
        (format!("bias if it was on before, {unit}"), &|axis| axis.u_if_on_before.map(|u| half(FACTOR * u))),
        (format!("from start to start, {unit}"), &|axis| axis.spread_of_starts.map(|u| half(FACTOR * u))),
    ];
    let shown: Vec<_> = columns.iter().filter(|(_, of)| axes.iter().any(|axis| of(axis).is_some())).collect();
    let row = |axis: &&AxisCurve| shown.iter().map(|(_, of)| of(axis).unwrap_or_else(|| NONE.to_owned())).collect();
    Table {
        title: format!("{} at {reference_c:.0} °C", if bias(first).is_some() { "Bias" } else { "Slope" }),
        head: shown.iter().map(|(head, _)| head.clone()).collect(),
        rows: axes.iter().map(row).collect(),
        note: "± is half of a 95 % interval. The span after is that of what remains where the curve comes from the \
               other parts of the record."
            .to_owned(),
    }
}

fn cubics(axes: &[&AxisCurve]) -> Table {
    let (unit, about_c) = axes.first().map_or(("", 0.0), |axis| (axis.unit, axis.cubic.about_c));
    let head = ["axis", "X0, @", "X1, @/°C", "X2, @/°C²", "X3, @/°C³", "leaves up to, @"];
    let row = |axis: &&AxisCurve| {
        let terms = axis.cubic.terms.iter().map(|term| minus(&format!("{term:.4e}")));
        std::iter::once(axis.name.clone()).chain(terms).chain([number(axis.cubic.left)]).collect()
    };
    Table {
        title: "Polynomial of order 3".to_owned(),
        head: head.map(|text| text.replace('@', unit)).to_vec(),
        rows: axes.iter().map(row).collect(),
        note: format!("bias = X0 + X1 d + X2 d² + X3 d³ with d = T − {about_c:.0} °C"),
    }
}
