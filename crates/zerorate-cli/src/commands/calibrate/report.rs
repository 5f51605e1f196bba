//! The result of a calibration, for scripts (JSON) and for people (text).

use super::deliver::Rescued;
use adis16130_twin::Truth;
use serde::Serialize;
use std::path::Path;
use zerorate::calibration::{CalibratedAxis, Run};
use zerorate::thermal::{BiasCurve, Step, TERMS};
use zerorate::{Calibration, Names, Outcome, Say, Uncertainty, Warning};
use zerorate_view::duration::Seconds;

/// The JSON object of `calibrate --json`; the names are a contract.
#[derive(Serialize)]
pub struct Report {
    /// Of a part with one axis; else it stands in `axes`.
    #[serde(flatten)]
    only: Option<Numbers>,
    coverage: f64,
    coverage_factor: f64,
    rdy_hz: f64,
    rate_hz: f64,
    samples: u64,
    lost_samples: u64,
    duration_s: f64,
    temp_min_c: f64,
    temp_max_c: f64,
    method: Option<String>,
    device: Option<String>,
    calibration_id: String,
    capture_sha256: Option<String>,
    /// Those that concern all axes.
    warnings: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    axes: Vec<AxisReport>,
    /// The calibration itself, where a file that was asked for could not be written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rescued: Option<Rescued>,
}

/// One of several axes.
#[derive(Serialize)]
struct AxisReport {
    name: String,
    #[serde(flatten)]
    numbers: Numbers,
    /// Those that concern it alone.
    warnings: Vec<String>,
}

/// What was found of an axis.
#[derive(Serialize)]
struct Numbers {
    /// Steps 4 and 6 of AN-1042; null by another method.
    b1_dps: Option<f64>,
    t1_c: Option<f64>,
    b2_dps: Option<f64>,
    t2_c: Option<f64>,
    btc_dps_per_c: f64,
    pbc_dps: f64,
    t3_c: f64,
    /// Of a curve.
    #[serde(flatten)]
    higher: Option<Higher>,
    u_pbc_dps: f64,
    u_btc_dps_per_c: f64,
    u_t3_c: f64,
    impossible_readings: u64,
    /// The correction at the end of the recording, evenly over the temperatures seen.
    curve: Vec<CurvePoint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<TruthReport>,
}

/// What a curve has beside PBC and BTC.
#[derive(Serialize)]
struct Higher {
    order: usize,
    order_weights: [f64; TERMS],
    btc2_dps_per_c2: f64,
    btc3_dps_per_c3: f64,
    lag_s: f64,
    play_c: f64,
    bias_instability_dps: f64,
    rate_random_walk_dps_per_rt_s: f64,
    steps: Vec<StepReport>,
}

/// A step of the level that was taken out.
#[derive(Serialize)]
struct StepReport {
    at_s: f64,
    size_dps: f64,
    u_dps: f64,
}

/// What is added to a rate at a temperature.
#[derive(Serialize)]
pub struct CurvePoint {
    pub temp_c: f64,
    pub correction_dps: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub u_dps: Option<f64>,
}

/// What the twin knows: the values that a perfect measurement would find at the reported T3.
#[derive(Serialize)]
struct TruthReport {
    pbc_dps: f64,
    btc_dps_per_c: f64,
    curve: Vec<CurvePoint>,
}

/// Points of a curve.
pub const POINTS: u8 = 9;

impl CurvePoint {
    /// Where they stand: evenly from a temperature to another.
    pub fn temps_c(low_c: f64, high_c: f64) -> impl Iterator<Item = f64> {
        (0..POINTS).map(move |k| low_c + (high_c - low_c) * f64::from(k) / f64::from(POINTS - 1))
    }
}

impl Numbers {
    fn new(outcome: &Outcome, axis: &CalibratedAxis, truth: Option<&Truth>) -> Self {
        let t3_c = outcome.correction.t3_c;
        let (low_c, high_c) = (outcome.temp_min_c, outcome.temp_max_c);
        let temps = || CurvePoint::temps_c(low_c, high_c);
        let point = |temp_c| CurvePoint {
            temp_c,
            correction_dps: outcome.correction.at(temp_c),
            u_dps: axis.u_correction_dps(temp_c),
        };
        let true_point =
            |truth: &Truth, temp_c| CurvePoint { temp_c, correction_dps: truth.pbc_dps(temp_c), u_dps: None };
        Self {
            b1_dps: outcome.means.map(|means| means.b1_dps),
            t1_c: outcome.means.map(|means| means.t1_c),
            b2_dps: outcome.means.map(|means| means.b2_dps),
            t2_c: outcome.means.map(|means| means.t2_c),
            higher: outcome.curve.as_ref().map(Higher::new),
            curve: temps().map(point).collect(),
            btc_dps_per_c: outcome.correction.btc_dps_per_c,
            pbc_dps: outcome.correction.pbc_dps,
            t3_c,
            u_pbc_dps: outcome.uncertainty.u_pbc_dps,
            u_btc_dps_per_c: outcome.uncertainty.u_btc_dps_per_c,
            u_t3_c: outcome.uncertainty.u_t3_c,
            impossible_readings: outcome.impossible_readings,
            truth: truth.map(|truth| TruthReport {
                pbc_dps: truth.pbc_dps(t3_c),
                btc_dps_per_c: truth.btc_dps_per_c(t3_c),
                curve: temps().map(|temp_c| true_point(truth, temp_c)).collect(),
            }),
        }
    }
}

impl Higher {
    fn new(curve: &BiasCurve) -> Self {
        let step = |step: Step| StepReport { at_s: step.at_s, size_dps: step.size_dps, u_dps: step.u_dps };
        Self {
            order: curve.order,
            order_weights: curve.order_weights.map(|weight| (1e4 * weight).round() / 1e4),
            btc2_dps_per_c2: curve.correction.btc2_dps_per_c2,
            btc3_dps_per_c3: curve.correction.btc3_dps_per_c3,
            lag_s: curve.following.lag_s,
            play_c: curve.following.play_c,
            bias_instability_dps: curve.noise.bias_instability_dps,
            rate_random_walk_dps_per_rt_s: curve.noise.rate_random_walk_dps_per_rt_s,
            steps: curve.steps.into_iter().flatten().map(step).collect(),
        }
    }
}

impl Report {
    /// Of all axes of the calibration, in its order. `truths` are the twins' states at the end of step 8; none where
    /// the part is no twin.
    pub fn new(outcomes: &[Outcome], calibration: &Calibration, truths: &[Truth], names: Names) -> Self {
        let common: Vec<&Warning> = Outcome::shared_warnings(outcomes).collect();
        let text = |one: &Warning| format!("{}: {}", one.code(), one.with(names));
        let mut axes: Vec<AxisReport> = Vec::new();
        for (index, (outcome, axis)) in outcomes.iter().zip(&calibration.axes).enumerate() {
            let own = outcome.warnings.iter().filter(|warning| !common.contains(warning));
            axes.push(AxisReport {
                name: axis.name.clone(),
                numbers: Numbers::new(outcome, axis, truths.get(index)),
                warnings: own.map(text).collect(),
            });
        }
        let only = if axes.len() == 1 { axes.pop().map(|axis| axis.numbers) } else { None };
        let (run, span) = (calibration.run, calibration.validity);
        let of_run = |number: fn(&Run) -> f64| run.as_ref().map_or(f64::NAN, number);
        Self {
            only,
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            rdy_hz: of_run(|run| run.rdy_hz),
            rate_hz: of_run(|run| run.rate_hz),
            samples: run.map_or(0, |run| run.samples),
            lost_samples: run.map_or(0, |run| run.lost_samples),
            duration_s: of_run(|run| run.duration_s),
            temp_min_c: span.map_or(f64::NAN, |span| span.temp_min_c),
            temp_max_c: span.map_or(f64::NAN, |span| span.temp_max_c),
            method: calibration.method.clone(),
            device: calibration.device.clone(),
            calibration_id: calibration.id(),
            capture_sha256: calibration.capture_sha256.clone(),
            warnings: common.into_iter().map(text).collect(),
            axes,
            rescued: None,
        }
    }

    /// All warnings, those of one axis with its name.
    pub fn warnings(&self) -> Vec<String> {
        let own = |axis: &AxisReport| {
            axis.warnings.iter().map(|text| format!("axis {}: {text}", axis.name)).collect::<Vec<_>>()
        };
        self.warnings.iter().cloned().chain(self.axes.iter().flat_map(own)).collect()
    }

    /// The same for people; `file` is where the calibration went.
    pub fn text(&self, file: Option<&Path>, serial: Option<&str>) -> String {
        let mut text = self.head();
        for axis in &self.axes {
            text += &format!("axis {}\n{}\n", axis.name, axis.numbers.text(self.coverage_factor));
        }
        text += &self.only.as_ref().map_or_else(String::new, |only| only.text(self.coverage_factor) + "\n");
        text += &self.meaning();
        for axis in &self.axes {
            let truth = axis.numbers.against_truth();
            text += &truth.map_or_else(String::new, |truth| format!("axis {}: {truth}", axis.name));
        }
        text += &self.only.as_ref().and_then(Numbers::against_truth).unwrap_or_default();
        text + "\n" + &self.what_next(file, serial)
    }

    fn head(&self) -> String {
        let device = self.device.as_deref().unwrap_or_default();
        format!(
            "Calibration {} of {device}\n{} samples in {}, {:.1} a second, {} lost\n\n",
            self.calibration_id,
            self.samples,
            Seconds(self.duration_s.round()),
            self.rate_hz,
            self.lost_samples
        )
    }

    fn meaning(&self) -> String {
        let numbers = self.only.iter().chain(self.axes.iter().map(|axis| &axis.numbers));
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
            self.temp_min_c,
            self.temp_max_c,
            self.coverage * 100.0
        )
    }

    fn what_next(&self, file: Option<&Path>, serial: Option<&str>) -> String {
        let plain = |serial: &&str| serial.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c));
        let serial =
            serial.map_or_else(String::new, |sn| format!(" --serial {}", Some(sn).filter(plain).unwrap_or("SN")));
        match file.map(Path::display) {
            Some(file) => {
                format!(
                    "Written to {file}. Next: zerorate stream --cal {file}{serial}, zerorate export {file} --format \
                     c\n"
                )
            }
            None => "Nothing was written: give -o unit.toml to keep the calibration.\n".to_owned(),
        }
    }
}

impl Numbers {
    fn text(&self, factor: f64) -> String {
        let Self { btc_dps_per_c, pbc_dps, t3_c, .. } = self;
        let line = format!(
            "  PBC  {pbc_dps:+.5} ± {:.5} °/s     at T3 = {t3_c:.3} °C\n  \
               BTC  {btc_dps_per_c:+.5} ± {:.5} °/s/°C\n",
            self.u_pbc_dps * factor,
            self.u_btc_dps_per_c * factor,
        );
        line + &self
            .means()
            .or_else(|| self.higher.as_ref().map(|higher| higher.text(self, factor)))
            .unwrap_or_default()
    }

    /// Steps 4 and 6.
    fn means(&self) -> Option<String> {
        let (b1_dps, t1_c, b2_dps, t2_c) = (self.b1_dps?, self.t1_c?, self.b2_dps?, self.t2_c?);
        Some(format!("  B1   {b1_dps:+.5} °/s at T1 = {t1_c:.3} °C\n  B2   {b2_dps:+.5} °/s at T2 = {t2_c:.3} °C\n"))
    }

    fn against_truth(&self) -> Option<String> {
        let truth = self.truth.as_ref()?;
        if self.higher.is_some() {
            let off =
                self.curve.iter().zip(&truth.curve).map(|(one, other)| one.correction_dps - other.correction_dps);
            let rms_dph = 3600.0 * (off.map(|off| off * off).sum::<f64>() / f64::from(POINTS)).sqrt();
            return Some(format!(
                "the twin's truth: the curve is {rms_dph:.1} °/h off, rms over the temperatures seen\n"
            ));
        }
        Some(format!(
            "the twin's truth: PBC {:+.5} °/s (measured {:+.5} off), BTC {:+.5} °/s/°C (measured {:+.5} off)\n",
            truth.pbc_dps,
            self.pbc_dps - truth.pbc_dps,
            truth.btc_dps_per_c,
            self.btc_dps_per_c - truth.btc_dps_per_c
        ))
    }
}

impl Higher {
    fn text(&self, numbers: &Numbers, factor: f64) -> String {
        let squares: f64 = numbers.curve.iter().filter_map(|point| point.u_dps).map(|u_dps| u_dps * u_dps).sum();
        let u_dph = 3600.0 * (squares / f64::from(POINTS)).sqrt();
        let kind = ["a constant", "a line", "a curve of order 2", "a curve of order 3"][self.order.min(TERMS - 1)];
        let terms = match self.order {
            2 => format!("  BTC2 {:+.3e} °/s/°C²\n", self.btc2_dps_per_c2),
            3 => {
                format!("  BTC2 {:+.3e} °/s/°C²\n  BTC3 {:+.3e} °/s/°C³\n", self.btc2_dps_per_c2, self.btc3_dps_per_c3)
            }
            _ => String::new(),
        };
        format!(
            "{terms}  {kind} (probability {:.0} %), known to ±{:.1} °/h, rms over the temperatures seen\n",
            100.0 * self.order_weights[self.order.min(TERMS - 1)],
            factor * u_dph
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zerorate::calibration::Origin;
    use zerorate::{Axis, Correction, Measured, Noise, Part, Plan};

    fn outcome(pbc_dps: f64, own: Warning) -> Outcome {
        Outcome {
            curve: None,
            means: Some(Measured { b1_dps: 0.1, t1_c: 25.0, b2_dps: 0.3, t2_c: 31.0 }),
            correction: Correction::line(pbc_dps, -0.04, 32.0),
            uncertainty: Uncertainty {
                u_b1_dps: 0.004,
                u_b2_dps: 0.004,
                u_t1_c: 0.0002,
                u_t2_c: 0.0002,
                u_pbc_dps: 0.0026,
                u_btc_dps_per_c: 0.0048,
                u_curvature_dps_per_c: 0.0047,
                u_t3_c: 0.0007,
                cov_pbc_btc: 1e-8,
                cov_pbc_t3: 2e-8,
                drift_dps: 0.0004,
            },
            noise: Noise { model: Axis::ADIS16130.typical_noise(), flicker_measured: false, walk_measured: false },
            rdy_hz: 100.0,
            rate_hz: 100.0,
            samples: 317_100,
            lost_samples: 3,
            impossible_readings: 1,
            duration_s: 3171.0,
            temp_min_c: 24.9,
            temp_max_c: 32.1,
            plan: Plan::default(),
            warnings: vec![Warning::EarthIncluded, own],
        }
    }

    fn report(axes: &str, outcomes: &[Outcome]) -> Report {
        let text = format!(
            "schema = 1\nname = \"P\"\naxis = [{axes}]\n\
             rate = {{ lsb_per_dps = 20, zero_code = 0, width_bits = 16 }}\n\
             temperature = {{ lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12 }}\n"
        );
        let calibration = Calibration::new(&Part::parse(&text).unwrap(), outcomes, Origin::default());
        Report::new(outcomes, &calibration, &[], zerorate::Setting::name)
    }

    /// Several axes stand in a list, each with its warnings; one stands at the top, as it ever did.
    #[test]
    fn axes_are_listed_where_there_are_several() {
        let two = [outcome(-0.5, Warning::Restless), outcome(0.25, Warning::RestUnjudged)];
        let several = report("{ name = \"x\" }, { name = \"y\" }", &two);
        let json = serde_json::to_value(&several).unwrap();
        assert_eq!((&json["pbc_dps"], &json["axes"][1]["pbc_dps"]), (&serde_json::Value::Null, &0.25.into()));
        assert_eq!((&json["axes"][0]["name"], &json["axes"][0]["impossible_readings"]), (&"x".into(), &1.into()));
        assert_eq!((json["warnings"].as_array().unwrap().len(), &json["samples"]), (1, &317_100.into()));
        let codes: Vec<String> = several.warnings().iter().map(|text| text[..14].to_owned()).collect();
        assert_eq!(codes, ["earth-included", "axis x: restle", "axis y: rest-u"]);
        let text = several.text(None, None);
        assert!(text.contains("axis x\n  PBC  -0.50000") && text.contains("axis y\n  PBC  +0.25000"), "{text}");

        let json = serde_json::to_value(report("{ name = \"x\" }", &two[..1])).unwrap();
        assert_eq!((&json["pbc_dps"], &json["axes"]), (&(-0.5).into(), &serde_json::Value::Null));
        assert_eq!(json["warnings"].as_array().unwrap().len(), 2);
    }
}
