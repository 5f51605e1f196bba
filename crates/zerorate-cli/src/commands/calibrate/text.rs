//! Formats the result of a calibration for people.

use std::path::Path;
use zerorate::temperature::TERMS;
use zerorate_jobs::CodedWarning;
use zerorate_jobs::calibrate::{AxisNumbers, CalibrationReport, CurvePoint, CurveTerms, POINTS};
use zerorate_logs::quoted;
use zerorate_view::duration::Seconds;
use zerorate_view::plot::number;
use zerorate_view::{PlusMinus, remark};

/// `file` is the path of the calibration, if it was saved. `assumes_line` is true if the plan assumes a line.
pub fn text(report: &CalibrationReport, file: Option<&Path>, serial: Option<&str>, assumes_line: bool) -> String {
    let found = |numbers: &AxisNumbers| found(numbers, report.coverage_factor, assumes_line);
    let mut text = head(report);
    for axis in &report.axes {
        text += &format!("axis {}\n{}", axis.name, found(&axis.numbers));
        text += &format!("{}\n", remarks(&axis.remarks));
    }
    text += &report.only.as_ref().map_or_else(String::new, |only| found(only) + "\n");
    text += &(meaning(report) + &remarks(&report.remarks));
    for axis in &report.axes {
        let truth = against_truth(&axis.numbers);
        text += &truth.map_or_else(String::new, |truth| format!("axis {}: {truth}", axis.name));
    }
    text += &report.only.as_ref().and_then(against_truth).unwrap_or_default();
    text + "\n" + &what_next(file, serial, report.device.as_deref())
}

/// The warnings about the measurement, then the warnings about single axes, which start with the name of the axis.
pub fn warnings(report: &CalibrationReport) -> Vec<String> {
    let own = report.axes.iter().flat_map(|axis| axis.warnings.iter().map(|one| format!("axis {}: {one}", axis.name)));
    report.warnings.iter().map(ToString::to_string).chain(own).collect()
}

/// Formats the standing remarks, one line each. Every measurement by the same plan has the same remarks.
pub fn remarks(remarks: &[CodedWarning]) -> String {
    remarks.iter().filter_map(|one| remark(one.code(), &one.text())).map(|line| line + "\n").collect()
}

fn head(report: &CalibrationReport) -> String {
    let device = report.device.as_deref().unwrap_or_default();
    format!(
        "{}Calibration {} of {device}\n{} samples in {}, {:.1} a second, {} lost\n\n",
        if report.simulated { "SIMULATED: " } else { "" },
        report.calibration_id,
        report.samples,
        Seconds(report.duration_s.round()),
        report.rate_hz,
        report.lost_samples
    )
}

fn meaning(report: &CalibrationReport) -> String {
    let numbers = report.only.iter().chain(report.axes.iter().map(|axis| &axis.numbers));
    let order = numbers.filter_map(|numbers| numbers.higher.as_ref()).map(|higher| higher.order).max();
    let more = match order {
        Some(2) => " + d² · BTC2",
        Some(3) => " + d² · BTC2 + d³ · BTC3",
        _ => "",
    };
    let d = if more.is_empty() { "(TEMP − T3)" } else { "d" };
    let where_d = if more.is_empty() { "" } else { ", d = TEMP − T3" };
    format!(
        "corrected rate = RATE + PBC + {d} · BTC{more}{where_d}, measured between {:.1} and {:.1} °C\n\
         ± is the {:.0} % interval\n",
        report.temp_min_c,
        report.temp_max_c,
        report.coverage * 100.0
    )
}

/// The next commands. `$PART` stands for the address of a real part, as in the documentation.
fn what_next(file: Option<&Path>, serial: Option<&str>, device: Option<&str>) -> String {
    let serial = serial.map_or_else(String::new, |serial| format!(" --serial {}", quoted(serial)));
    let device = match device.unwrap_or("twin:") {
        "twin:" => String::new(),
        twin if twin.starts_with("twin:") => format!(" --device {}", quoted(twin)),
        _ => " --device \"$PART\"".to_owned(),
    };
    match file.map(|file| file.display().to_string()) {
        Some(name) => {
            let file = quoted(&name);
            format!(
                "Written to {name}. Next: zerorate stream{device} --cal {file}{serial}, zerorate export {file} \
                 --format c\n"
            )
        }
        None => "Nothing was saved: give -o unit.toml to keep the calibration.\n".to_owned(),
    }
}

fn found(numbers: &AxisNumbers, factor: f64, assumes_line: bool) -> String {
    let AxisNumbers { btc_dps_per_c, pbc_dps, t3_c, .. } = numbers;
    let pbc = PlusMinus { value: *pbc_dps, half: numbers.u_pbc_dps * factor };
    let btc = PlusMinus { value: *btc_dps_per_c, half: numbers.u_btc_dps_per_c * factor };
    let line = format!("  PBC  {pbc} °/s at T3 = {t3_c:.2} °C\n  BTC  {btc} °/s/°C\n");
    line + &means(numbers)
        .map(|means| means + &ends(numbers, factor))
        .or_else(|| numbers.higher.as_ref().map(|higher| curve(higher, numbers, factor, assumes_line)))
        .unwrap_or_default()
}

/// Formats the averages of steps 4 and 6 of AN-1042; `None` for the other methods.
fn means(numbers: &AxisNumbers) -> Option<String> {
    let (b1_dps, t1_c, b2_dps, t2_c) = (numbers.b1_dps?, numbers.t1_c?, numbers.b2_dps?, numbers.t2_c?);
    Some(format!("  B1   {b1_dps:+.4} °/s at T1 = {t1_c:.2} °C\n  B2   {b2_dps:+.4} °/s at T2 = {t2_c:.2} °C\n"))
}

/// The expanded uncertainty of the correction at the lowest and the highest measured temperature; empty if unknown.
fn ends(numbers: &AxisNumbers, factor: f64) -> String {
    let end = |point: Option<&CurvePoint>| {
        let CurvePoint { temp_c, u_dps, .. } = point?;
        Some(format!("±{} °/s at {temp_c:.1} °C", number(factor * (*u_dps)?)))
    };
    match (end(numbers.curve.first()), end(numbers.curve.last())) {
        (Some(low), Some(high)) => format!("  known to {low}, {high}\n"),
        _ => String::new(),
    }
}

fn against_truth(numbers: &AxisNumbers) -> Option<String> {
    let truth = numbers.truth.as_ref()?;
    if numbers.higher.is_some() {
        let off = numbers.curve.iter().zip(&truth.curve).map(|(one, other)| one.correction_dps - other.correction_dps);
        let rms_dps = number((off.map(|off| off * off).sum::<f64>() / f64::from(POINTS)).sqrt());
        return Some(format!("the twin's truth: the curve is {rms_dps} °/s off, rms over the temperatures seen\n"));
    }
    Some(format!(
        "the twin's truth: PBC {:+.4} °/s (measured {:+.4} off), BTC {:+.4} °/s/°C (measured {:+.4} off)\n",
        truth.pbc_dps,
        numbers.pbc_dps - truth.pbc_dps,
        truth.btc_dps_per_c,
        numbers.btc_dps_per_c - truth.btc_dps_per_c
    ))
}

fn curve(higher: &CurveTerms, numbers: &AxisNumbers, factor: f64, assumes_line: bool) -> String {
    let squares: f64 = numbers.curve.iter().filter_map(|point| point.u_dps).map(|u_dps| u_dps * u_dps).sum();
    let u_dps = (squares / f64::from(POINTS)).sqrt();
    let kind = ["a constant", "a line", "a curve of order 2", "a curve of order 3"][higher.order.min(TERMS - 1)];
    let terms = match higher.order {
        2 => format!("  BTC2 {:+.3e} °/s/°C²\n", higher.btc2_dps_per_c2),
        3 => {
            format!("  BTC2 {:+.3e} °/s/°C²\n  BTC3 {:+.3e} °/s/°C³\n", higher.btc2_dps_per_c2, higher.btc3_dps_per_c3)
        }
        _ => String::new(),
    };
    let why = match assumes_line && higher.order == 1 {
        true => "assumed".to_owned(),
        false => format!("probability {:.0} %", 100.0 * higher.order_weights[higher.order.min(TERMS - 1)]),
    };
    format!("{terms}  {kind} ({why}), known to ±{} °/s, rms over the temperatures seen\n", number(factor * u_dps))
}

#[cfg(test)]
#[path = "../../../../zerorate/tests/core/outcome/mod.rs"]
mod measured;

#[cfg(test)]
mod tests {
    use super::*;
    use zerorate::calibration::Origin;
    use zerorate::{Calibration, Correction, Outcome, Part, Warning};

    fn outcome(pbc_dps: f64, own: Warning) -> Outcome {
        Outcome {
            correction: Correction::line(pbc_dps, -0.04, 32.0),
            samples: 317_100,
            impossible_readings: 1,
            warnings: vec![Warning::EarthIncluded, own],
            ..measured::outcome()
        }
    }

    fn report(axes: &str, outcomes: &[Outcome]) -> CalibrationReport {
        let text = format!(
            "schema = 1\nname = \"P\"\naxis = [{axes}]\n\
             rate = {{ lsb_per_dps = 20, zero_code = 0, width_bits = 16 }}\n\
             temperature = {{ lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12 }}\n"
        );
        let calibration = Calibration::new(&Part::parse(&text).unwrap(), outcomes, Origin::default());
        CalibrationReport::new(outcomes, &calibration, &[], zerorate::Setting::name)
    }

    /// The JSON lists several axes, each with its warnings. The numbers of a single axis are at the top level.
    #[test]
    fn axes_are_listed_where_there_are_several() {
        let two = [outcome(-0.5, Warning::Restless), outcome(0.25, Warning::RestUnjudged)];
        let several = report("{ name = \"x\" }, { name = \"y\" }", &two);
        let json = serde_json::to_value(&several).unwrap();
        assert_eq!((&json["pbc_dps"], &json["axes"][1]["pbc_dps"]), (&serde_json::Value::Null, &0.25.into()));
        assert_eq!((&json["axes"][0]["name"], &json["axes"][0]["impossible_readings"]), (&"x".into(), &1.into()));
        assert_eq!((json["remarks"].as_array().unwrap().len(), &json["samples"]), (1, &317_100.into()));
        let codes: Vec<String> = warnings(&several).iter().map(|text| text[..14].to_owned()).collect();
        assert_eq!(codes, ["axis x: restle", "axis y: rest-u"]);
        let text = text(&several, None, None, false);
        assert!(text.contains("axis x\n  PBC  -0.5000") && text.contains("axis y\n  PBC  +0.2500"), "{text}");

        let json = serde_json::to_value(report("{ name = \"x\" }", &two[..1])).unwrap();
        assert_eq!((&json["pbc_dps"], &json["axes"]), (&(-0.5).into(), &serde_json::Value::Null));
        assert_eq!((json["warnings"].as_array().unwrap().len(), json["remarks"].as_array().unwrap().len()), (1, 1));
    }

    #[test]
    fn an_assumed_line_has_no_probability() {
        let numbers = report("{ name = \"x\" }", &[outcome(-0.5, Warning::Restless)]).only.unwrap();
        let higher = |order| CurveTerms {
            order,
            order_weights: [0.25, 0.75, 0.0, 0.0],
            btc2_dps_per_c2: 0.0,
            btc3_dps_per_c3: 0.0,
            lag_s: 0.0,
            play_c: 0.0,
            bias_instability_dps: 0.0,
            rate_random_walk_dps_per_rt_s: 0.0,
            steps: Vec::new(),
            sway_probability: 0.0,
        };
        for (order, assumes_line, kind) in [
            (1, true, "a line (assumed), known to"),
            (1, false, "a line (probability 75 %), known to"),
            (0, true, "a constant (probability 25 %), known to"),
        ] {
            let text = curve(&higher(order), &numbers, 1.96, assumes_line);
            assert!(text.contains(kind), "{text}");
        }
    }
}
