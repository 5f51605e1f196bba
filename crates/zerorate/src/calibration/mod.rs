//! A calibration of one unit: the corrections of its axes, their uncertainties, the temperatures where they hold, and
//! their origin.
//!
//! `docs/formats/calibration.md` specifies the file format. [`Calibration::parse`] reads a file, and
//! [`Calibration::to_toml`] writes one.

mod budget;
mod chamber;
mod date;
mod file;
mod form;
mod limits;
mod log_curve;

pub use budget::Contribution;
pub use chamber::ChamberRun;
pub use date::is_rfc3339;
pub use file::{FileError, FileWarning};
pub use log_curve::LogUnit;

use crate::check_lines::sha256_hex;
use crate::correction::{Correction, Corrector, CorrectorConfig, Validity};
use crate::noise::{FLICKER_CUTOFF_HZ, NoiseModel};
use crate::notice::Warning;
use crate::part::{NamedAxis, Part, Scale};
use crate::plan::Wording as _;
use crate::procedure::{Measured, Noise, Outcome};
use crate::temperature::{self, BiasCurve, Sources, TERMS};
use crate::uncertainty::Uncertainty;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use serde::{Deserialize, Serialize};
use zerorate_allan::{FLOOR_PER_B, SettingName};

/// The newest version of the file format that this software reads. A file is written in the oldest version that can
/// express it ([`Calibration::schema`]).
pub const SCHEMA: u32 = 4;

/// Value of [`Calibration::created`] in place of a date, if the part was the software twin.
pub const SIMULATED: &str = "SIMULATED";

/// The calibration of one unit. Only its part and its corrections are mandatory.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Name of the kind of part.
    pub part: String,
    /// Serial number of the unit.
    pub serial: Option<String>,
    /// Time at which the samples were recorded, RFC 3339, or [`SIMULATED`] for the software twin.
    pub created: Option<String>,
    /// Method of the measurement: `an1042` (F-51), `warmup` and `cycle` (which use every block of a recording),
    /// `chamber` or `tempcal`.
    pub method: Option<String>,
    /// The software that made the measurement.
    pub software: Option<String>,
    /// The device that the samples came from.
    pub device: Option<String>,
    /// Registers and reading scheme of the part while it was measured.
    pub config: Option<String>,
    /// SHA-256 of the samples from which the calibration was computed (`docs/formats/capture.md`).
    pub capture_sha256: Option<String>,
    /// Circumstances of the measurement.
    pub notes: Notes,
    /// Texts of the measurement's warnings that concern all axes.
    pub warnings: Vec<String>,
    /// Scale of the temperature codes, which all axes share.
    pub temp: Option<Scale>,
    /// The axes, from one to [`MAX_AXES`](crate::MAX_AXES).
    pub axes: Vec<CalibratedAxis>,
    /// The temperatures at which the corrections hold.
    pub validity: Option<Validity>,
    /// Durations, sample counts, data rates and limits of the measurement.
    pub run: Option<Run>,
}

/// The calibration of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedAxis {
    /// Name of the axis in the part and its captures.
    pub name: String,
    /// Texts of the warnings that concern this axis alone.
    pub warnings: Vec<String>,
    /// Scale of the rate codes.
    pub rate: Option<Scale>,
    /// PBC, BTC and T3 (F-50), and the higher-order terms of a curve.
    pub correction: Correction,
    /// The measured means from which the method of AN-1042 computes the calibration.
    pub measured: Option<Measured>,
    /// Standard uncertainties and covariances of a calibration by AN-1042.
    pub uncertainty: Option<Uncertainties>,
    /// Uncertainties of a curve, and the model that it was computed with.
    pub curve: Option<CurveRecord>,
    /// The noise that the uncertainties are computed from.
    pub noise: Option<NoiseRecord>,
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

/// The uncertainty of a curve, and the model that it was computed with. Value ± `coverage_factor` × u covers the
/// truth with the probability `coverage`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "as the fields of `BiasCurve`")]
pub struct CurveRecord {
    pub coverage: f64,
    pub coverage_factor: f64,
    pub order: usize,
    /// Posterior probability of each of the orders 0 to 3.
    pub order_weights: [f64; TERMS],
    /// Covariance of PBC, BTC, and the terms of second and third order. Entry (i, j) is in (°/s)²/°C^(i + j).
    pub covariance: [[f64; TERMS]; TERMS],
    /// Lag of the bias behind the temperature sensor, s.
    pub lag_s: f64,
    /// Half width of the play between bias and temperature (a hysteresis, as of a gear with backlash), °C.
    pub play_c: f64,
    /// Bias steps that were removed from the data: time from the start of the measurement or log, s, and size, °/s.
    pub steps: Vec<[f64; 2]>,
    /// Sources of the uncertainties of PBC and BTC. `None` in older files and in calibrations from logs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sources: Option<SourcesRecord>,
}

/// Contributions of the choice of model and of base motion to the uncertainties of PBC and BTC. The rest is noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "as the fields of `Sources`, of PBC and BTC")]
pub struct SourcesRecord {
    pub u_models_pbc_dps: f64,
    pub u_models_btc_dps_per_c: f64,
    pub u_sway_pbc_dps: f64,
    pub u_sway_btc_dps_per_c: f64,
    pub sway_probability: f64,
}

/// The noise model, and which of its terms were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "as the fields of `NoiseModel`; a source is `measured`, `typical (…)` or `unknown`")]
pub struct NoiseRecord {
    pub white_dps_per_rt_hz: f64,
    pub white_source: String,
    pub flicker_floor_dps: f64,
    pub flicker_cutoff_hz: f64,
    pub flicker_source: String,
    pub rate_random_walk_dps_per_rt_s: f64,
    pub rate_random_walk_source: String,
}

/// Durations, sample counts, data rates and limits of a measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// Component of the Earth's rotation that was subtracted, °/s (F-16). `None` if it is part of PBC.
    pub earth_dps: Option<f64>,
    pub assume_linear: bool,
}

/// Whether a device of this name is the software twin.
#[must_use]
pub fn is_twin(device: &str) -> bool {
    device == "twin" || device.starts_with("twin:")
}

/// Facts about a measurement that only the caller knows.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "as the fields of `Calibration`")]
pub struct Origin {
    pub serial: Option<String>,
    pub created: Option<String>,
    pub software: String,
    pub device: String,
    pub config: String,
    pub capture_sha256: String,
    pub notes: Notes,
}

/// Circumstances of a measurement, for information only. No number depends on them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notes {
    /// The supply, as the user describes it.
    pub supply: Option<String>,
    /// The surroundings, as the user describes them.
    pub ambient: Option<String>,
    /// The person who measured.
    pub operator: Option<String>,
    /// Name of the computer. `None` if unknown, and for a simulated part, whose files depend on the seed alone.
    pub host: Option<String>,
}

impl Notes {
    /// Returns these notes, with the notes of `other` in place of missing ones.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            supply: self.supply.or(other.supply),
            ambient: self.ambient.or(other.ambient),
            operator: self.operator.or(other.operator),
            host: self.host.or(other.host),
        }
    }

    fn one_line(self) -> Self {
        let one_line = |note: Option<String>| note.as_deref().map(one_line);
        Self {
            supply: one_line(self.supply),
            ambient: one_line(self.ambient),
            operator: one_line(self.operator),
            host: one_line(self.host),
        }
    }
}

impl Calibration {
    /// Builds the calibration of a part from one outcome for each axis, in the order of the axes.
    #[must_use]
    pub fn new(part: &Part, outcomes: &[Outcome], origin: Origin) -> Self {
        let common: Vec<&Warning> = Outcome::shared_warnings(outcomes).collect();
        Self {
            part: part.name.to_string(),
            serial: origin.serial.as_deref().map(one_line),
            created: origin.created.as_deref().map(one_line),
            method: outcomes.first().map(|outcome| outcome.plan.method.name().to_string()),
            software: Some(one_line(&origin.software)),
            device: Some(one_line(&origin.device)),
            config: Some(one_line(&origin.config)),
            capture_sha256: Some(origin.capture_sha256),
            notes: origin.notes.one_line(),
            warnings: common.iter().map(|warning| said(warning)).collect(),
            temp: part.axes.first().map(|first| first.axis.temp),
            axes: part.axes.iter().zip(outcomes).map(|(axis, outcome)| calibrated(axis, outcome, &common)).collect(),
            validity: validity(part, outcomes),
            run: outcomes.first().map(run),
        }
    }

    /// Whether the part was the software twin, so that nothing real was measured.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        self.created.as_deref() == Some(SIMULATED) || self.device.as_deref().is_some_and(is_twin)
    }

    /// Returns the axis with this name.
    #[must_use]
    pub fn axis(&self, name: &str) -> Option<&CalibratedAxis> {
        self.axes.iter().find(|axis| axis.name == name)
    }

    /// Builds a corrector for the axes of a part with these names, in the given order.
    ///
    /// # Errors
    /// Returns [`OtherPart`] if the calibration belongs to another part, or lacks one of the axes.
    pub fn corrector<'a>(
        &self,
        part: &str,
        axes: impl IntoIterator<Item = &'a str>,
    ) -> Result<Corrector<Vec<Correction>>, OtherPart> {
        let known = self.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", ");
        if self.part != part {
            return Err(OtherPart::Part { calibrated: self.part.clone(), axes: known, part: part.into() });
        }
        let correction = |name| self.axis(name).map(|axis| axis.correction).ok_or(name);
        let corrections: Result<Vec<Correction>, &str> = axes.into_iter().map(correction).collect();
        match corrections {
            Ok(corrections) => Ok(Corrector::new(CorrectorConfig { corrections, validity: self.validity })),
            Err(name) => Err(OtherPart::Axis { axis: name.into(), axes: known }),
        }
    }

    /// Whether the calibration was made from logs in °/s, so that it corrects logs and not the codes of a part.
    #[must_use]
    pub fn is_of_logs(&self) -> bool {
        self.method.as_deref() == Some(log_curve::METHOD)
    }

    /// Identifies the calibration by 12 hexadecimal digits, which corrected data carry. The digits depend on part and
    /// serial number, the date if not [`SIMULATED`], the axis names if not [`Self::is_plain`], and the coefficients.
    #[must_use]
    pub fn id(&self) -> String {
        let part = &self.part;
        let serial = self.serial.as_deref().unwrap_or_default();
        let created = self.created.as_deref().filter(|created| *created != SIMULATED).unwrap_or_default();
        let mut content = alloc::format!("{part}|{serial}|{created}");
        for CalibratedAxis { name, correction, .. } in &self.axes {
            let Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = correction;
            if !self.is_plain() {
                content.extend(["|", name]);
            }
            content += &alloc::format!("|{pbc_dps:?}|{btc_dps_per_c:?}|{t3_c:?}");
            if !correction.is_line() {
                content += &alloc::format!("|{btc2_dps_per_c2:?}|{btc3_dps_per_c3:?}");
            }
        }
        sha256_hex(&content)[..12].to_string()
    }
}

/// The error for a calibration that does not belong to the data to be corrected.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the fields are the names that the text shows")]
pub enum OtherPart {
    /// The calibration belongs to another kind of part.
    Part { calibrated: String, axes: String, part: String },
    /// The calibration has no axis of the name `axis`.
    Axis { axis: String, axes: String },
}

impl fmt::Display for OtherPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Part { calibrated, axes, part } => write!(
                f,
                "the calibration is of part {calibrated} (axes {axes}), not of {part}: its numbers mean nothing there"
            ),
            Self::Axis { axis, axes } => write!(
                f,
                "the calibration has no axis {axis:?}: it is of {axes}; calibrate that axis, or leave it out"
            ),
        }
    }
}

impl core::error::Error for OtherPart {}

impl CalibratedAxis {
    /// Standard uncertainty, °/s, of the correction that is added at the temperature `temp_c`, and not of the rate
    /// itself. `None` if the calibration states no uncertainties.
    ///
    /// For a curve it follows from the covariance of all terms. Otherwise u² = u_pbc² + d² u_btc² + 2 d cov_pbc_btc
    /// with d = T − T3, by JCGM 100:2008, equation 13. T3 is not a third quantity, because PBC holds *at the T3 that
    /// the file states*. An error ε of the reading of T3 is an error −BTC · ε of PBC. So u_pbc contains this error
    /// already, and cov_pbc_btc contains its correlation with the error of BTC.
    #[must_use]
    pub fn u_correction_dps(&self, temp_c: f64) -> Option<f64> {
        if let Some(curve) = &self.curve {
            return Some(temperature::u_dps(&curve.covariance, temp_c - self.correction.t3_c));
        }
        let u = self.uncertainty.as_ref()?;
        let d = temp_c - self.correction.t3_c;
        let alone = u.u_pbc_dps * u.u_pbc_dps + (d * u.u_btc_dps_per_c) * (d * u.u_btc_dps_per_c);
        // rounding, or impossible covariances in a file written by hand, may make this negative
        Some(libm::sqrt((alone + 2.0 * d * u.cov_pbc_btc_dps2_per_c).max(0.0)))
    }
}

/// Source of a term of the noise model that the measurement itself showed.
const MEASURED: &str = "measured";

impl NoiseRecord {
    fn new(model: &NoiseModel, flicker_source: String, rate_random_walk_source: String) -> Self {
        Self {
            white_dps_per_rt_hz: model.white_dps_per_rt_hz,
            white_source: MEASURED.to_string(),
            flicker_floor_dps: FLOOR_PER_B * model.bias_instability_dps,
            flicker_cutoff_hz: FLICKER_CUTOFF_HZ,
            flicker_source,
            rate_random_walk_dps_per_rt_s: model.rate_random_walk_dps_per_rt_s,
            rate_random_walk_source,
        }
    }
}

/// Rounds a probability to the four decimals that the file keeps.
fn rounded(probability: f64) -> f64 {
    libm::round(1e4 * probability) / 1e4
}

impl From<&BiasCurve> for CurveRecord {
    fn from(curve: &BiasCurve) -> Self {
        Self {
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            order: curve.order,
            order_weights: curve.order_weights.map(rounded),
            covariance: curve.covariance,
            lag_s: curve.following.lag_s,
            play_c: curve.following.play_c,
            steps: curve.steps.iter().flatten().map(|step| [step.at_s, step.size_dps]).collect(),
            sources: Some(curve.sources.into()),
        }
    }
}

impl From<Sources> for SourcesRecord {
    fn from(Sources { u_models, u_base_motion, base_motion_probability }: Sources) -> Self {
        Self {
            u_models_pbc_dps: u_models[0],
            u_models_btc_dps_per_c: u_models[1],
            u_sway_pbc_dps: u_base_motion[0],
            u_sway_btc_dps_per_c: u_base_motion[1],
            sway_probability: rounded(base_motion_probability),
        }
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

/// Writes a text on one line: control characters become escapes as in Rust, such as `\n` for a line break.
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

/// Code and text of a warning for the file, without names of settings, because the reader may use another front end.
fn said(warning: &Warning) -> String {
    one_line(&format!("{}: {}", warning.code(), warning.with(|_| SettingName::text(""))))
}

fn calibrated(axis: &NamedAxis, outcome: &Outcome, common: &[&Warning]) -> CalibratedAxis {
    let own = outcome.warnings.iter().filter(|warning| !common.contains(warning));
    CalibratedAxis {
        name: axis.name.to_string(),
        warnings: own.map(said).collect(),
        rate: Some(axis.axis.rate),
        correction: outcome.correction,
        measured: outcome.means,
        uncertainty: Some(outcome.uncertainty).filter(|_| outcome.curve.is_none()).map(Uncertainties::from),
        curve: outcome.curve.as_ref().map(CurveRecord::from),
        noise: Some(noise_record(axis, &outcome.noise)),
    }
}

/// The span of temperatures that the measurements of all axes share.
fn validity(part: &Part, outcomes: &[Outcome]) -> Option<Validity> {
    let temp_min_c = outcomes.iter().map(|outcome| outcome.temp_min_c).reduce(f64::max)?;
    let temp_max_c = outcomes.iter().map(|outcome| outcome.temp_max_c).reduce(f64::min)?;
    let margin_c = part.axes.first()?.axis.temp_margin_c();
    Some(Validity { temp_min_c, temp_max_c, margin_c })
}

fn noise_record(axis: &NamedAxis, noise: &Noise) -> NoiseRecord {
    let typical = |source: &Option<_>| match (axis.axis.noise, source) {
        (None, _) => "unknown".to_string(),
        (Some(_), None) => "typical".to_string(),
        (Some(_), Some(source)) => alloc::format!("typical ({source})"),
    };
    let source = |measured, known| if measured { MEASURED.to_string() } else { typical(known) };
    let flicker_source = source(noise.flicker_measured, &axis.sources.flicker);
    NoiseRecord::new(&noise.model, flicker_source, source(noise.walk_measured, &axis.sources.rate_random_walk))
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
