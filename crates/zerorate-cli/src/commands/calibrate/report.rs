//! The result of a calibration, for scripts (JSON) and for people (text).

use super::deliver::Rescued;
use adis16130_twin::Truth;
use serde::Serialize;
use std::path::Path;
use zerorate::calibration::Run;
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
    b1_dps: f64,
    t1_c: f64,
    b2_dps: f64,
    t2_c: f64,
    btc_dps_per_c: f64,
    pbc_dps: f64,
    t3_c: f64,
    u_pbc_dps: f64,
    u_btc_dps_per_c: f64,
    u_t3_c: f64,
    impossible_readings: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<TruthReport>,
}

/// What the twin knows: the values that a perfect measurement would find at the reported T3.
#[derive(Serialize)]
struct TruthReport {
    pbc_dps: f64,
    btc_dps_per_c: f64,
}

impl Numbers {
    fn new(outcome: &Outcome, truth: Option<&Truth>) -> Self {
        let t3_c = outcome.correction.t3_c;
        Self {
            b1_dps: outcome.b1_dps,
            t1_c: outcome.t1_c,
            b2_dps: outcome.b2_dps,
            t2_c: outcome.t2_c,
            btc_dps_per_c: outcome.correction.btc_dps_per_c,
            pbc_dps: outcome.correction.pbc_dps,
            t3_c,
            u_pbc_dps: outcome.uncertainty.u_pbc_dps,
            u_btc_dps_per_c: outcome.uncertainty.u_btc_dps_per_c,
            u_t3_c: outcome.uncertainty.u_t3_c,
            impossible_readings: outcome.impossible_readings,
            truth: truth
                .map(|truth| TruthReport { pbc_dps: truth.pbc_dps(t3_c), btc_dps_per_c: truth.btc_dps_per_c(t3_c) }),
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
                numbers: Numbers::new(outcome, truths.get(index)),
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
        format!(
            "corrected rate = RATE + PBC + (TEMP − T3) · BTC, measured between {:.1} and {:.1} °C\n\
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
        let Self { b1_dps, t1_c, b2_dps, t2_c, btc_dps_per_c, pbc_dps, t3_c, .. } = self;
        format!(
            "  PBC  {pbc_dps:+.5} ± {:.5} °/s     at T3 = {t3_c:.3} °C\n  \
               BTC  {btc_dps_per_c:+.5} ± {:.5} °/s/°C\n  \
               B1   {b1_dps:+.5} °/s at T1 = {t1_c:.3} °C\n  \
               B2   {b2_dps:+.5} °/s at T2 = {t2_c:.3} °C\n",
            self.u_pbc_dps * factor,
            self.u_btc_dps_per_c * factor,
        )
    }

    fn against_truth(&self) -> Option<String> {
        let truth = self.truth.as_ref()?;
        Some(format!(
            "the twin's truth: PBC {:+.5} °/s (measured {:+.5} off), BTC {:+.5} °/s/°C (measured {:+.5} off)\n",
            truth.pbc_dps,
            self.pbc_dps - truth.pbc_dps,
            truth.btc_dps_per_c,
            self.btc_dps_per_c - truth.btc_dps_per_c
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zerorate::calibration::Origin;
    use zerorate::{Axis, Correction, Noise, Part, Plan};

    fn outcome(pbc_dps: f64, own: Warning) -> Outcome {
        Outcome {
            b1_dps: 0.1,
            t1_c: 25.0,
            b2_dps: 0.3,
            t2_c: 31.0,
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
            noise: Noise { model: Axis::ADIS16130.typical_noise(), flicker_measured: false },
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
