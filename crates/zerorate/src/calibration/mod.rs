//! A calibration of one unit: what was found, how well it is known, where it holds, and where it comes from.
//!
//! Its file form is specified in `docs/formats/calibration.md`; [`Calibration::parse`] and [`Calibration::to_toml`]
//! read and write it.

mod check;
mod file;

pub use file::{FileError, FileWarning};

use crate::noise::{FLICKER_CUTOFF_HZ, FLOOR_PER_B};
use crate::{Correction, Outcome, Uncertainty, Validity};
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Version of the file form that this software writes, and the newest that it reads.
pub const SCHEMA: u32 = 1;
/// The only part that this software calibrates.
pub const PART: &str = "ADIS16130";

/// One unit's calibration. Only the correction must be there; a measured calibration has everything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Version of the file form.
    pub schema: u32,
    /// Always [`PART`].
    pub part: String,
    /// Serial number of the unit.
    pub serial: Option<String>,
    /// When the measurement ended, RFC 3339; none for a simulated part.
    pub created: Option<String>,
    /// How it was measured: `an1042` is F-51.
    pub method: Option<String>,
    /// The software that measured it.
    pub software: Option<String>,
    /// Where the samples came from.
    pub device: Option<String>,
    /// Registers and reading scheme of the part while it was measured.
    pub config: Option<String>,
    /// SHA-256 of the samples it was computed from (`docs/formats/capture.md`).
    pub capture_sha256: Option<String>,
    /// What the user noted of the supply.
    pub supply_note: Option<String>,
    /// Texts of the measurement's warnings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// PBC, BTC and T3 (F-50).
    pub correction: Correction,
    /// The means it rests on.
    pub measured: Option<Measured>,
    /// Standard uncertainties and covariances.
    pub uncertainty: Option<Uncertainties>,
    /// The noise behind them.
    pub noise: Option<NoiseRecord>,
    /// Where the correction holds.
    pub validity: Option<Validity>,
    /// The run itself.
    pub run: Option<Run>,
}

/// Steps 4 and 6 of F-51.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the names of F-51, with their units")]
pub struct Measured {
    pub b1_dps: f64,
    pub t1_c: f64,
    pub b2_dps: f64,
    pub t2_c: f64,
}

/// [`Uncertainty`] with the coverage of its intervals: value ± `coverage_factor` × u covers the truth with the
/// probability `coverage`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "as the fields of `Uncertainty`")]
pub struct Uncertainties {
    pub coverage: f64,
    pub coverage_factor: f64,
    pub u_pbc_dps: f64,
    pub u_btc_dps_per_c: f64,
    pub u_t3_c: f64,
    pub cov_pbc_btc_dps2_per_c: f64,
    pub cov_pbc_t3_dps_c: f64,
    pub cov_btc_t3_dps: f64,
    pub u_curvature_dps_per_c: f64,
    pub u_b1_dps: f64,
    pub u_t1_c: f64,
    pub u_b2_dps: f64,
    pub u_t2_c: f64,
    #[serde(default)]
    pub drift_dps: Option<f64>,
}

/// The noise model, and which of it was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "as the fields of `NoiseModel`; a source is `measured` or `typical (M-04)`")]
pub struct NoiseRecord {
    pub white_dps_per_rt_hz: f64,
    pub white_source: String,
    pub flicker_floor_dps: f64,
    pub flicker_cutoff_hz: f64,
    pub flicker_source: String,
    pub rate_random_walk_dps_per_rt_s: f64,
    pub rate_random_walk_source: String,
}

/// How the measurement went.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "as the fields of `Outcome` and `Plan`")]
pub struct Run {
    pub duration_s: f64,
    pub rate_hz: f64,
    pub rdy_hz: f64,
    pub samples: u64,
    pub lost_samples: u64,
    pub average_s: f64,
    pub warmup_s: f64,
    pub settle_s: f64,
    pub offset_s: f64,
    pub max_lost: f64,
    pub max_u_btc_dps_per_c: f64,
    /// Component of the Earth's rotation that was subtracted (F-16); none: it is inside PBC.
    pub earth_dps: Option<f64>,
    pub assume_linear: bool,
}

/// What the core cannot know of a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "as the fields of `Calibration`")]
pub struct Origin {
    pub serial: Option<String>,
    pub created: Option<String>,
    pub software: String,
    pub device: String,
    pub config: String,
    pub capture_sha256: String,
    pub supply_note: Option<String>,
}

impl Calibration {
    /// The calibration that a measurement amounts to.
    #[must_use]
    pub fn new(outcome: &Outcome, origin: Origin) -> Self {
        Self {
            schema: SCHEMA,
            part: PART.to_string(),
            serial: origin.serial.as_deref().map(one_line),
            created: origin.created.as_deref().map(one_line),
            method: Some("an1042".to_string()),
            software: Some(one_line(&origin.software)),
            device: Some(one_line(&origin.device)),
            config: Some(one_line(&origin.config)),
            capture_sha256: Some(origin.capture_sha256),
            supply_note: origin.supply_note.as_deref().map(one_line),
            warnings: outcome.warnings.iter().map(|warning| one_line(&warning.to_string())).collect(),
            correction: outcome.correction,
            measured: Some(Measured {
                b1_dps: outcome.b1_dps,
                t1_c: outcome.t1_c,
                b2_dps: outcome.b2_dps,
                t2_c: outcome.t2_c,
            }),
            uncertainty: Some(outcome.uncertainty.into()),
            noise: Some(noise_record(outcome)),
            validity: Some(Validity { temp_min_c: outcome.temp_min_c, temp_max_c: outcome.temp_max_c }),
            run: Some(run(outcome)),
        }
    }

    /// Short name of what it corrects, the same for the same unit and numbers: 12 hexadecimal digits. Corrected data
    /// carry it.
    #[must_use]
    pub fn id(&self) -> String {
        let Correction { pbc_dps, btc_dps_per_c, t3_c } = self.correction;
        let serial = self.serial.as_deref().unwrap_or_default();
        let created = self.created.as_deref().unwrap_or_default();
        let content = alloc::format!("{PART}|{serial}|{created}|{pbc_dps:?}|{btc_dps_per_c:?}|{t3_c:?}");
        check::sha256_hex(&content)[..12].to_string()
    }
}

impl Calibration {
    /// Standard uncertainty of PBC + (T − T3) · BTC at the temperature T, °C, in °/s: of what is added to the rate,
    /// not of the rate itself. None where the calibration states no uncertainties.
    ///
    /// u² = u_pbc² + d² u_btc² + 2 d cov_pbc_btc with d = T − T3, the first-order propagation of JCGM 100:2008,
    /// equation 13, for two quantities. T3 is no third one: PBC is what it is *at the T3 that the file states*, so
    /// that an error of that reading, ε, is an error −BTC · ε of PBC and in u_pbc once already (and in cov_pbc_btc, as
    /// far as it has to do with BTC's).
    #[must_use]
    pub fn u_correction_dps(&self, temp_c: f64) -> Option<f64> {
        let u = self.uncertainty.as_ref()?;
        let d = temp_c - self.correction.t3_c;
        let alone = u.u_pbc_dps * u.u_pbc_dps + (d * u.u_btc_dps_per_c) * (d * u.u_btc_dps_per_c);
        // rounding, or a file by hand whose covariances are impossible, may leave less than nothing
        Some(libm::sqrt((alone + 2.0 * d * u.cov_pbc_btc_dps2_per_c).max(0.0)))
    }
}

impl From<Uncertainty> for Uncertainties {
    fn from(u: Uncertainty) -> Self {
        Self {
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            u_pbc_dps: u.u_pbc_dps,
            u_btc_dps_per_c: u.u_btc_dps_per_c,
            u_t3_c: u.u_t3_c,
            cov_pbc_btc_dps2_per_c: u.cov_pbc_btc,
            cov_pbc_t3_dps_c: u.cov_pbc_t3,
            cov_btc_t3_dps: 0.0,
            u_curvature_dps_per_c: u.u_curvature_dps_per_c,
            u_b1_dps: u.u_b1_dps,
            u_t1_c: u.u_t1_c,
            u_b2_dps: u.u_b2_dps,
            u_t2_c: u.u_t2_c,
            drift_dps: Some(u.drift_dps),
        }
    }
}

/// A text of the file form: control characters are written as Rust writes them, `\n` for a line break.
fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for character in text.chars() {
        match character.is_control() {
            true => line.extend(character.escape_default()),
            false => line.push(character),
        }
    }
    line
}

fn noise_record(outcome: &Outcome) -> NoiseRecord {
    let model = &outcome.noise.model;
    let source = |measured| if measured { "measured" } else { "typical (M-04)" }.to_string();
    NoiseRecord {
        white_dps_per_rt_hz: model.white_dps_per_rt_hz,
        white_source: source(true),
        flicker_floor_dps: FLOOR_PER_B * model.bias_instability_dps,
        flicker_cutoff_hz: FLICKER_CUTOFF_HZ,
        flicker_source: source(outcome.noise.flicker_measured),
        rate_random_walk_dps_per_rt_s: model.rate_random_walk_dps_per_rt_s,
        rate_random_walk_source: source(false),
    }
}

fn run(outcome: &Outcome) -> Run {
    let plan = &outcome.plan;
    Run {
        duration_s: outcome.duration_s,
        rate_hz: outcome.rate_hz,
        rdy_hz: outcome.rdy_hz,
        samples: outcome.samples,
        lost_samples: outcome.lost_samples,
        average_s: plan.average_s,
        warmup_s: plan.warmup_s,
        settle_s: plan.settle_s,
        offset_s: plan.offset_s,
        max_lost: plan.max_lost,
        max_u_btc_dps_per_c: plan.max_u_btc_dps_per_c,
        earth_dps: plan.earth_dps,
        assume_linear: plan.assume_linear,
    }
}
