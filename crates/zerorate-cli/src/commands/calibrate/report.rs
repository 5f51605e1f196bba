//! The result of a calibration, for scripts (JSON) and for people (text).

use super::deliver::Rescued;
use adis16130_twin::Truth;
use serde::Serialize;
use std::path::Path;
use zerorate::{Calibration, Names, Outcome, Say, Uncertainty};
use zerorate_view::duration::Seconds;

/// The JSON object of `calibrate --json`; the names are a contract.
#[derive(Serialize)]
pub struct Report {
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
    coverage: f64,
    coverage_factor: f64,
    rdy_hz: f64,
    rate_hz: f64,
    samples: u64,
    lost_samples: u64,
    impossible_readings: u64,
    duration_s: f64,
    temp_min_c: f64,
    temp_max_c: f64,
    method: Option<String>,
    device: Option<String>,
    calibration_id: String,
    capture_sha256: Option<String>,
    pub warnings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<TruthReport>,
    /// The calibration itself, where a file that was asked for could not be written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rescued: Option<Rescued>,
}

/// What the twin knows: the values that a perfect measurement would find at the reported T3.
#[derive(Serialize)]
struct TruthReport {
    pbc_dps: f64,
    btc_dps_per_c: f64,
}

impl Report {
    /// `truth` is the twin's state at the end of step 8.
    pub fn new(outcome: &Outcome, calibration: &Calibration, truth: Option<&Truth>, names: Names) -> Self {
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
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            rdy_hz: outcome.rdy_hz,
            rate_hz: outcome.rate_hz,
            samples: outcome.samples,
            lost_samples: outcome.lost_samples,
            impossible_readings: outcome.impossible_readings,
            duration_s: outcome.duration_s,
            temp_min_c: outcome.temp_min_c,
            temp_max_c: outcome.temp_max_c,
            method: calibration.method.clone(),
            device: calibration.device.clone(),
            calibration_id: calibration.id(),
            capture_sha256: calibration.capture_sha256.clone(),
            warnings: outcome.warnings.iter().map(|one| format!("{}: {}", one.code(), one.with(names))).collect(),
            rescued: None,
            truth: truth
                .map(|truth| TruthReport { pbc_dps: truth.pbc_dps(t3_c), btc_dps_per_c: truth.btc_dps_per_c(t3_c) }),
        }
    }

    /// The same for people; `file` is where the calibration went.
    pub fn text(&self, file: Option<&Path>, serial: Option<&str>) -> String {
        let mut text = self.head() + &self.numbers();
        if let Some(truth) = &self.truth {
            text += &self.against(truth);
        }
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

    fn numbers(&self) -> String {
        let Self { b1_dps, t1_c, b2_dps, t2_c, btc_dps_per_c, pbc_dps, t3_c, .. } = self;
        let wide = |u: f64| u * self.coverage_factor;
        format!(
            "  PBC  {pbc_dps:+.5} ± {:.5} °/s     at T3 = {t3_c:.3} °C\n  \
               BTC  {btc_dps_per_c:+.5} ± {:.5} °/s/°C\n  \
               B1   {b1_dps:+.5} °/s at T1 = {t1_c:.3} °C\n  \
               B2   {b2_dps:+.5} °/s at T2 = {t2_c:.3} °C\n\n\
             corrected rate = RATE + PBC + (TEMP − T3) · BTC, measured between {:.1} and {:.1} °C\n\
             ± is the {:.0} % interval\n",
            wide(self.u_pbc_dps),
            wide(self.u_btc_dps_per_c),
            self.temp_min_c,
            self.temp_max_c,
            self.coverage * 100.0
        )
    }

    fn against(&self, truth: &TruthReport) -> String {
        format!(
            "the twin's truth: PBC {:+.5} °/s (measured {:+.5} off), BTC {:+.5} °/s/°C (measured {:+.5} off)\n",
            truth.pbc_dps,
            self.pbc_dps - truth.pbc_dps,
            truth.btc_dps_per_c,
            self.btc_dps_per_c - truth.btc_dps_per_c
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
