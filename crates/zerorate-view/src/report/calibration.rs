//! The HTML page of a calibration.

use super::Fact;
use super::course::{self, Course};
use crate::duration::Seconds;
use crate::plot::{self, CorrectionCurve, CorrectionPoint};
use crate::printable;
use anyhow::Result;
use askama::Template;
use zerorate::calibration::{CalibratedAxis, Contribution, CurveRecord, Run, SIMULATED, Uncertainties};
use zerorate::{Calibration, Correction};

/// The largest number of rows of the look-up table.
const ROWS: f64 = 16.0;
/// Extent of the plot beyond the measured temperatures, or of plot and table around T3 if none are stated, °C.
const BEYOND_C: f64 = 5.0;
/// Number of steps between the points of the plotted curve.
const POINTS: u32 = 80;

#[derive(Template)]
#[template(path = "calibration.html")]
struct Page<'a> {
    title: String,
    software: &'a str,
    /// What the comparison of several calibrations shows.
    comparison: String,
    units: Vec<Unit<'a>>,
}

struct Unit<'a> {
    simulated: bool,
    title: String,
    below: String,
    file: &'a str,
    method: &'a str,
    /// Warnings about several axes. Warnings about one axis are shown below its result.
    warnings: &'a [String],
    span: String,
    /// The temperatures of the look-up table, in words.
    table_span: String,
    /// Level of the headings below an axis.
    level: u8,
    axes: Vec<AxisPart<'a>>,
    sections: Vec<Section>,
}

struct AxisPart<'a> {
    /// The name of the axis; `None` for a single axis.
    name: Option<&'a str>,
    warnings: Vec<&'a String>,
    coverage: String,
    quantities: Vec<Quantity>,
    /// The correction at the temperature of the comparison, with its interval.
    compared: (String, String),
    budget: Vec<BudgetRow>,
    pbc: String,
    btc: String,
    t3: String,
    /// The higher terms of a curve, in symbols and in numbers; empty for a linear correction.
    symbols: &'static str,
    terms: String,
    picture: String,
    has_band: bool,
    /// The sentence about the dots of the picture; empty if it has none.
    dots: &'static str,
    /// The plot of the measurement over time, if there is one.
    over_time: Option<String>,
    /// The rows of the look-up table: temperature, correction, and half of its interval if stated.
    table: Vec<Vec<String>>,
    sections: Vec<Section>,
}

struct Quantity {
    name: &'static str,
    value: String,
    unit: &'static str,
    uncertainty: String,
    interval: String,
}

struct BudgetRow {
    of: &'static str,
    source: &'static str,
    u: String,
    share: String,
}

struct Section {
    name: &'static str,
    facts: Vec<Fact>,
}

/// Makes one HTML page of several calibrations, each with its file name. `course` belongs to the first calibration.
///
/// # Errors
/// Returns an error if the template cannot be filled. That is not expected, since the compiler checks the template.
pub fn calibration_page(calibrations: &[(Calibration, String)], course: Option<&Course>) -> Result<String> {
    let at_c = common_c(calibrations);
    let mut units: Vec<Unit<'_>> = calibrations.iter().map(|(one, file)| unit(one, file, at_c)).collect();
    if let (Some(course), Some((calibration, _)), Some(unit)) = (course, calibrations.first(), units.first_mut()) {
        for (part, axis) in unit.axes.iter_mut().zip(&calibration.axes) {
            part.over_time = course::picture(course, calibration, axis);
        }
    }
    let title = match units.as_slice() {
        [only] => only.title.clone(),
        several => format!("{} calibrations", several.len()),
    };
    let comparison = format!("correction at {at_c:.2}\u{a0}°C, °/s");
    Ok(printable::page(&Page { title, software: zerorate::SOFTWARE, comparison, units }.render()?))
}

/// The temperature at which calibrations are compared, °C: the mean of all T3, limited to the range that all stated
/// ranges share, if they share one.
fn common_c(calibrations: &[(Calibration, String)]) -> f64 {
    let t3_c = || calibrations.iter().flat_map(|(one, _)| &one.axes).map(|axis| axis.correction.t3_c);
    let mean_c = t3_c().sum::<f64>() / t3_c().count().max(1) as f64;
    let spans = || calibrations.iter().filter_map(|(one, _)| one.validity);
    let low_c = spans().map(|span| span.temp_min_c).fold(f64::NEG_INFINITY, f64::max);
    let high_c = spans().map(|span| span.temp_max_c).fold(f64::INFINITY, f64::min);
    if low_c <= high_c { mean_c.clamp(low_c, high_c) } else { mean_c }
}

fn unit<'a>(calibration: &'a Calibration, file: &'a str, at_c: f64) -> Unit<'a> {
    let serial = calibration.serial.as_deref().map_or(String::new(), |serial| format!(", serial {serial}"));
    let created = match calibration.created.as_deref() {
        _ if calibration.is_simulated() => SIMULATED.to_owned(),
        Some(created) => format!("measured {created}"),
        None => "no date".to_owned(),
    };
    let several = calibration.axes.len() > 1;
    Unit {
        simulated: calibration.is_simulated(),
        title: format!(
            "{}Calibration of {}{serial}",
            if calibration.is_simulated() { "SIMULATED: " } else { "" },
            calibration.part
        ),
        below: format!("{file}: calibration {}, {created}", calibration.id()),
        file,
        method: calibration.method.as_deref().unwrap_or("by hand"),
        warnings: if several { &calibration.warnings } else { &[] },
        span: span(calibration),
        table_span: table_span(calibration),
        level: if several { 3 } else { 2 },
        axes: calibration.axes.iter().map(|axis| axis_part(calibration, axis, at_c)).collect(),
        sections: sections(calibration),
    }
}

fn axis_part<'a>(calibration: &'a Calibration, axis: &'a CalibratedAxis, at_c: f64) -> AxisPart<'a> {
    let correction = &axis.correction;
    let several = calibration.axes.len() > 1;
    let of_all = calibration.warnings.iter().filter(|_| !several);
    let own =
        [Section { name: "Means", facts: means(calibration, axis) }, Section { name: "Noise", facts: noise(axis) }];
    AxisPart {
        name: several.then_some(axis.name.as_str()),
        warnings: of_all.chain(&axis.warnings).collect(),
        coverage: coverage(axis),
        quantities: quantities(axis),
        compared: compared(calibration, axis, at_c),
        budget: axis.budget().iter().filter(|part| part.u > 0.0).map(budget_row).collect(),
        pbc: signed_term(correction.pbc_dps),
        btc: format!("{:+.6}", correction.btc_dps_per_c),
        t3: format!("{:.4}", correction.t3_c),
        symbols: match order(correction) {
            1 => "",
            2 => " + (TEMP − T3)² · BTC2",
            _ => " + (TEMP − T3)² · BTC2 + (TEMP − T3)³ · BTC3",
        },
        terms: terms(correction),
        picture: calibration_picture(calibration, axis),
        has_band: stated(axis).is_some(),
        dots: match means_of(calibration, axis).as_slice() {
            [] => "",
            _ if earth_dps(calibration) == 0.0 => " Dots are minus the means of steps 4, 6 and 8.",
            _ => " Dots are the Earth's rotation minus the means of steps 4, 6 and 8.",
        },
        over_time: None,
        table: look_up(axis, table_c(calibration, axis)),
        sections: own.into_iter().filter(|section| several && !section.facts.is_empty()).collect(),
    }
}

/// The correction at a temperature, and its interval; in place of the interval a remark if there is none.
fn compared(calibration: &Calibration, axis: &CalibratedAxis, at_c: f64) -> (String, String) {
    let value = axis.correction.apply(0.0, at_c);
    let half = stated(axis).zip(axis.u_correction_dps(at_c)).map(|(stated, u)| stated.factor * u);
    let interval = match (half, calibration.validity) {
        (_, Some(span)) if !(span.temp_min_c..=span.temp_max_c).contains(&at_c) => "not measured there".to_owned(),
        (Some(half), _) => format!("{:+.5} … {:+.5}", value - half, value + half),
        (None, _) => "not stated".to_owned(),
    };
    (format!("{value:+.5}"), interval)
}

/// The temperature span of the look-up table, °C: the measured one, or one around T3 if none is stated.
fn table_c(calibration: &Calibration, axis: &CalibratedAxis) -> (f64, f64) {
    let t3_c = axis.correction.t3_c;
    calibration.validity.map_or((t3_c - BEYOND_C, t3_c + BEYOND_C), |span| (span.temp_min_c, span.temp_max_c))
}

fn table_span(calibration: &Calibration) -> String {
    match calibration.validity {
        Some(_) => "over the temperatures that were measured".to_owned(),
        None => format!("from {BEYOND_C} °C below T3 to {BEYOND_C} °C above"),
    }
}

/// The rows of the look-up table: the ends of the span, and multiples of a round step between them.
fn look_up(axis: &CalibratedAxis, (low_c, high_c): (f64, f64)) -> Vec<Vec<String>> {
    let (step_c, _) = plot::round_step((high_c - low_c) / (ROWS - 1.0));
    let factor = stated(axis).map(|stated| stated.factor);
    let row = |temp_c: f64| {
        let half = factor.zip(axis.u_correction_dps(temp_c)).map(|(factor, u)| format!("{:.6}", factor * u));
        let correction = format!("{:+.6}", axis.correction.apply(0.0, temp_c));
        [format!("{temp_c:.2}"), correction].into_iter().chain(half).collect()
    };
    let multiples = (low_c / step_c).ceil() as i64..=(high_c / step_c).floor() as i64;
    let is_apart = |temp_c: &f64| temp_c - low_c > step_c / 2.0 && high_c - temp_c > step_c / 2.0;
    let between = multiples.map(|k| k as f64 * step_c).filter(is_apart);
    std::iter::once(low_c).chain(between).chain([high_c]).map(row).collect()
}

fn budget_row(part: &Contribution) -> BudgetRow {
    let unit = if part.of == "PBC" { "°/s" } else { "°/s/°C" };
    BudgetRow {
        of: part.of,
        source: part.source,
        u: format!("{:.2e} {unit}", part.u),
        share: format!("{:.0} %", 100.0 * part.share),
    }
}

fn coverage(axis: &CalibratedAxis) -> String {
    let coverage = stated(axis).map_or(zerorate::Uncertainty::COVERAGE, |stated| stated.coverage);
    format!("{} % interval", (coverage * 1000.0).round() / 10.0)
}

fn order(correction: &Correction) -> u8 {
    match correction {
        line if line.is_line() => 1,
        curve if curve.btc3_dps_per_c3 == 0.0 => 2,
        _ => 3,
    }
}

fn terms(correction: &Correction) -> String {
    let Correction { t3_c, btc2_dps_per_c2: second, btc3_dps_per_c3: third, .. } = *correction;
    let square = format!(" + (TEMP − {t3_c:.4} °C)² · ({second:+.4e} °/s/°C²)");
    match order(correction) {
        1 => String::new(),
        2 => square,
        _ => format!("{square} + (TEMP − {t3_c:.4} °C)³ · ({third:+.4e} °/s/°C³)"),
    }
}

/// The uncertainty of a correction, as the calibration file states it.
struct StatedUncertainty {
    coverage: f64,
    factor: f64,
    /// Standard uncertainties of PBC, BTC, BTC2 and BTC3. A linear correction has only the first two.
    terms: [Option<f64>; 4],
    /// Standard uncertainty of T3, °C. `None` for a curve, whose T3 is exact by definition.
    t3_c: Option<f64>,
}

fn stated(axis: &CalibratedAxis) -> Option<StatedUncertainty> {
    let of_curve = |curve: &CurveRecord| StatedUncertainty {
        coverage: curve.coverage,
        factor: curve.coverage_factor,
        terms: std::array::from_fn(|k| Some(curve.covariance[k][k].max(0.0).sqrt())),
        t3_c: None,
    };
    let of_line = |u: Uncertainties| StatedUncertainty {
        coverage: u.coverage,
        factor: u.coverage_factor,
        terms: [Some(u.u_pbc_dps), Some(u.u_btc_dps_per_c), None, None],
        t3_c: Some(u.u_t3_c),
    };
    axis.curve.as_ref().map(of_curve).or_else(|| axis.uncertainty.map(of_line))
}

fn quantities(axis: &CalibratedAxis) -> Vec<Quantity> {
    let (correction, stated) = (&axis.correction, stated(axis));
    let quantity = |name, value: f64, unit, u: Option<f64>, unknown: &str, written: &dyn Fn(f64) -> String| {
        let signed =
            |value: f64| format!("{}{}", if value.is_sign_negative() { "-" } else { "+" }, written(value.abs()));
        let half = stated.as_ref().zip(u).map(|(stated, u)| stated.factor * u);
        let interval = |half: f64| format!("{} … {}", signed(value - half), signed(value + half));
        Quantity {
            name,
            value: signed(value),
            unit,
            uncertainty: u.map_or_else(|| unknown.to_owned(), written),
            interval: half.map_or_else(|| unknown.to_owned(), interval),
        }
    };
    let [pbc, btc, btc2, btc3] = stated.as_ref().map_or([None; 4], |stated| stated.terms);
    let (t3_c, exact) = stated.as_ref().map_or((None, "not stated"), |stated| (stated.t3_c, "by definition"));
    let fixed = |places: usize| move |value: f64| format!("{value:.places$}");
    let power = |value: f64| format!("{value:.4e}");
    let mut all = vec![
        quantity("PBC, precision bias correction", correction.pbc_dps, "°/s", pbc, "not stated", &fixed(5)),
        quantity("BTC, bias temperature correction", correction.btc_dps_per_c, "°/s/°C", btc, "not stated", &fixed(6)),
        quantity("T3, reference temperature", correction.t3_c, "°C", t3_c, exact, &fixed(4)),
    ];
    let unknown = if stated.is_some() { "in the band below" } else { "not stated" };
    let (second, third) = (correction.btc2_dps_per_c2, correction.btc3_dps_per_c3);
    all.push(quantity("BTC2, quadratic term", second, "°/s/°C²", btc2, unknown, &power));
    all.push(quantity("BTC3, cubic term", third, "°/s/°C³", btc3, unknown, &power));
    all.truncate(2 + usize::from(order(correction)));
    all
}

/// Formats a term of a sum: `+ 0.25000` or `− 0.25000`.
fn signed_term(value: f64) -> String {
    format!("{} {:.5}", if value < 0.0 { '−' } else { '+' }, value.abs())
}

fn span(calibration: &Calibration) -> String {
    match calibration.validity {
        Some(span) => format!(
            "Measured between {:.1} and {:.1} °C. Outside, the correction is an extrapolation; calibrate over a wider \
             span instead.",
            span.temp_min_c, span.temp_max_c
        ),
        None => "The calibration does not state the temperatures at which it was measured.".to_owned(),
    }
}

/// Plots the correction of an axis over temperature as SVG (°/s over °C), with its interval and the measured
/// temperatures. The axis must be one of the calibration.
pub fn calibration_picture(calibration: &Calibration, axis: &CalibratedAxis) -> String {
    let correction = &axis.correction;
    let valid_c = calibration.validity.map(|span| (span.temp_min_c, span.temp_max_c));
    let (coldest, hottest) = valid_c.unwrap_or((correction.t3_c, correction.t3_c));
    let (from, to) = (coldest.min(correction.t3_c) - BEYOND_C, hottest.max(correction.t3_c) + BEYOND_C);
    let factor = stated(axis).map_or(0.0, |stated| stated.factor);
    let point = |k: u32| {
        let temp_c = from + (to - from) * f64::from(k) / f64::from(POINTS);
        CorrectionPoint {
            temp_c,
            correction_dps: correction.apply(0.0, temp_c),
            half_dps: factor * axis.u_correction_dps(temp_c).unwrap_or(0.0),
        }
    };
    let points = (0..=POINTS).map(point).collect();
    plot::correction(&CorrectionCurve { points, means: means_of(calibration, axis), t3_c: correction.t3_c, valid_c })
}

/// The means of steps 4, 6 and 8 that a linear correction was computed from, negated and without the Earth's
/// rotation, with their intervals.
fn means_of(calibration: &Calibration, axis: &CalibratedAxis) -> Vec<CorrectionPoint> {
    let Some((means, u)) = axis.measured.zip(axis.uncertainty) else { return Vec::new() };
    let earth_dps = earth_dps(calibration);
    let mean = |temp_c, correction_dps, u_dps| CorrectionPoint {
        temp_c,
        correction_dps,
        half_dps: u.coverage_factor * u_dps,
    };
    vec![
        mean(means.t1_c, earth_dps - means.b1_dps, u.u_b1_dps),
        mean(means.t2_c, earth_dps - means.b2_dps, u.u_b2_dps),
        mean(axis.correction.t3_c, axis.correction.pbc_dps, u.u_pbc_dps),
    ]
}

/// The Earth's rotation that was subtracted, °/s; 0 if none was.
fn earth_dps(calibration: &Calibration) -> f64 {
    calibration.run.as_ref().and_then(|run| run.earth_dps).unwrap_or(0.0)
}

fn sections(calibration: &Calibration) -> Vec<Section> {
    let mut sections = vec![Section { name: "Measurement", facts: measurement(calibration) }];
    if let [only] = calibration.axes.as_slice() {
        sections.push(Section { name: "Noise", facts: noise(only) });
    }
    sections.push(Section { name: "Origin", facts: origin(calibration) });
    sections.retain(|section| !section.facts.is_empty());
    sections
}

fn measurement(calibration: &Calibration) -> Vec<Fact> {
    let mut facts = Vec::new();
    if let Some(method) = &calibration.method {
        let note = if method == "an1042" { " (procedure of AN-1042)" } else { "" };
        facts.push(Fact::new("method", format!("{method}{note}")));
    }
    if let [only] = calibration.axes.as_slice() {
        facts.extend(means(calibration, only));
    }
    if let Some(span) = calibration.validity {
        facts.push(Fact::new("temperatures", format!("{:.2} … {:.2} °C", span.temp_min_c, span.temp_max_c)));
    }
    let is_line = calibration.axes.iter().all(|axis| axis.curve.is_none());
    facts.extend(calibration.run.iter().flat_map(|stated| run(stated, is_line)));
    facts
}

/// The means of steps 4, 6 and 8 (F-51) as measured, for the page's table.
fn means(calibration: &Calibration, axis: &CalibratedAxis) -> Vec<Fact> {
    let Some(means) = axis.measured else { return Vec::new() };
    let with = |value: f64, u: Option<f64>| u.map_or(format!("{value:+.5}"), |u| format!("{value:+.5} (u = {u:.5})"));
    let u = axis.uncertainty;
    let mean = |name, dps, u_dps, temp: f64, t: &str| {
        Fact::new(name, format!("{} °/s at {t} = {temp:.4} °C", with(dps, u_dps)))
    };
    let b3_dps = earth_dps(calibration) - axis.correction.pbc_dps;
    vec![
        mean("B1, mean before warming", means.b1_dps, u.map(|u| u.u_b1_dps), means.t1_c, "T1"),
        mean("B2, mean after warming", means.b2_dps, u.map(|u| u.u_b2_dps), means.t2_c, "T2"),
        mean("B3, mean after settling", b3_dps, u.map(|u| u.u_pbc_dps), axis.correction.t3_c, "T3"),
    ]
}

/// Facts about the run. The windows of AN-1042 and the treatment of curvature are shown for a linear correction only.
fn run(run: &Run, is_line: bool) -> Vec<Fact> {
    let share = 100.0 * run.lost_samples as f64 / (run.samples + run.lost_samples).max(1) as f64;
    let earth = match run.earth_dps {
        Some(dps) => format!("{dps:+.5} °/s subtracted from PBC, and inside B1, B2 and B3"),
        None => "not subtracted: its component along the axis is inside PBC".to_owned(),
    };
    let plan = format!(
        "averages of {}, warm-up {}, settling {}, offset average {}",
        Seconds(run.average_s),
        Seconds(run.warmup_s),
        Seconds(run.settle_s),
        Seconds(run.offset_s)
    );
    let curvature = if run.assume_linear { "assumed to be none" } else { "inside the uncertainty of BTC" };
    let of_line = [Fact::new("plan", plan), Fact::new("curvature", curvature)];
    let facts = [
        Fact::new("duration", Seconds(run.duration_s.round()).to_string()),
        Fact::new("samples", format!("{} at {:.2} Hz (data ready {:.2} Hz)", run.samples, run.rate_hz, run.rdy_hz)),
        Fact::new("lost samples", format!("{} ({share:.4} %; limit {} %)", run.lost_samples, run.max_lost * 100.0)),
        Fact::new("Earth's rotation", earth),
    ];
    facts.into_iter().chain(of_line.into_iter().filter(|_| is_line)).collect()
}

fn noise(axis: &CalibratedAxis) -> Vec<Fact> {
    let Some(noise) = &axis.noise else { return Vec::new() };
    let fact =
        |name, value: f64, unit, source: &str| Fact::new(name, format!("{} {unit}, {source}", plot::number(value)));
    vec![
        fact("white noise density", noise.white_dps_per_rt_hz, "°/s/√Hz", &noise.white_source),
        fact("floor of the flicker", noise.flicker_floor_dps, "°/s", &noise.flicker_source),
        fact("rate random walk", noise.rate_random_walk_dps_per_rt_s, "°/s/√s", &noise.rate_random_walk_source),
    ]
}

pub(super) fn origin(calibration: &Calibration) -> Vec<Fact> {
    let known = [
        ("serial number", &calibration.serial),
        ("measured", &calibration.created),
        ("device", &calibration.device),
        ("configuration", &calibration.config),
        ("supply", &calibration.notes.supply),
        ("surroundings", &calibration.notes.ambient),
        ("operator", &calibration.notes.operator),
        ("computer", &calibration.notes.host),
        ("software", &calibration.software),
        ("SHA-256 of the samples", &calibration.capture_sha256),
    ];
    let fact = |(name, value): (&str, &Option<String>)| value.as_ref().map(|value| Fact::new(name, value.as_str()));
    known.into_iter().filter_map(fact).chain([Fact::new("calibration id", calibration.id())]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BY_HAND: &str =
        "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n";

    /// A curve as `calibrate --method warmup` and `chamber` write it.
    #[test]
    fn a_curve_is_shown_with_its_uncertainty() {
        let (mut calibration, _) = Calibration::parse(BY_HAND).unwrap();
        let mut covariance = [[0.0; 4]; 4];
        (covariance[0][0], covariance[1][1], covariance[2][2], covariance[3][3]) = (1e-6, 4e-8, 9e-10, 1e-12);
        let axis = &mut calibration.axes[0];
        (axis.correction.btc2_dps_per_c2, axis.correction.btc3_dps_per_c3) = (0.0005, 0.0);
        axis.curve = Some(CurveRecord {
            coverage: 0.95,
            coverage_factor: 2.0,
            order: 2,
            order_weights: [0.0, 0.0, 1.0, 0.0],
            covariance,
            lag_s: 0.0,
            play_c: 0.0,
            steps: Vec::new(),
            sources: None,
        });
        let other = Calibration::parse(BY_HAND).unwrap().0;
        let both = [(calibration.clone(), "unit.toml".to_owned()), (other, "other.toml".to_owned())];
        let html = calibration_page(&both[..1], None).unwrap();
        for expected in [
            "-0.25200 … -0.24800</td><td class=\"number\">0.00100",
            "-0.040400 … -0.039600</td><td class=\"number\">0.000200",
            "+4.4000e-4 … +5.6000e-4</td><td class=\"number\">3.0000e-5",
            "The band is its 95 % interval",
            "by definition",
        ] {
            assert!(html.contains(expected), "{expected} in {html}");
        }
        assert!(!html.contains("not stated") && !html.contains("BTC3"), "{html}");
        let compared = calibration_page(&both, None).unwrap();
        for expected in [
            "<title>2 calibrations",
            "unit.toml</th>",
            "other.toml: calibration",
            "correction at 31.50\u{a0}°C",
            "PBC at T3",
        ] {
            assert!(compared.contains(expected), "{expected} in {compared}");
        }
        let plain = CalibratedAxis { curve: None, ..calibration.axes[0].clone() };
        let pictures = [&calibration.axes[0], &plain].map(|axis| calibration_picture(&calibration, axis));
        assert_ne!(pictures[0], pictures[1], "the band is drawn");
    }

    #[test]
    fn a_calibration_by_hand_says_what_is_not_known() {
        let (mut calibration, _) = Calibration::parse(BY_HAND).unwrap();
        calibration.warnings.extend(["the base moved", "earth-included: Earth"].map(str::to_owned));
        let html = calibration_page(&[(calibration, "<unit>.toml".to_owned())], None).unwrap();
        let place = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text} in {html}"));
        assert!(
            place("T3, reference") < place("the base moved") && place("the base moved") < place("How to apply it")
        );
        for expected in [
            "Calibration of ADIS16130",
            "RATE − 0.25000 °/s + (TEMP − 31.5000 °C) · (-0.040000 °/s/°C)",
            "not stated",
            "does not state the temperatures",
            "<svg",
            "Warning: the base moved",
            "<p class=\"below\">not in the uncertainty (earth-included): Earth",
        ] {
            assert!(html.contains(expected), "{expected} in {html}");
        }
        // T3 − 5 °C is 26.5 °C, where −0.25 − 0.04 · (26.5 − 31.5) = −0.05 is added
        for row in ["26.50</td><td class=\"number\">-0.05", "31.00</td><td class=\"number\">-0.23"] {
            assert!(html.contains(row), "{row} in {html}");
        }
        assert!(!html.contains("<unit>"), "the name is escaped");
    }
}
