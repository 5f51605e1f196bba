//! The state of a tracker as a TOML file, with check lines as a calibration has. `docs/tracking.md` specifies it.

use super::{COVARIANCES, Counts, Filter, Prior, RestPrior, STATES, Saved, TrackerConfig};
use crate::calibration::{CalibratedAxis, Calibration, CurveRecord};
use crate::check_lines::{self, Damage};
use crate::noise::NoiseModel;
use crate::part::Axis;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use serde::{Deserialize, Serialize};
use zerorate_allan::FLOOR_PER_B;
use zerorate_allan::entry::{Document, EntryError};

const HEADER: &str =
    "# What zerorate stream --track has learned (docs/tracking.md). To begin anew, delete this file.\n";
const SCHEMA: u32 = 2;

/// The tracked biases of a part, for the next time that it is switched on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackFile {
    schema: u32,
    /// Id of the calibration that the file continues.
    pub calibration: String,
    /// Name of the kind of part.
    pub part: String,
    /// Serial number of the unit.
    pub serial: Option<String>,
    /// Time at which the file was written, RFC 3339. `None` for a simulated part.
    pub saved: Option<String>,
    axis: Vec<AxisForm>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisForm {
    name: String,
    state: [f32; STATES],
    covariance: [f32; COVARIANCES],
    at_c: f32,
    /// Schema 1 has neither `rests` nor `turns`.
    #[serde(default = "one")]
    rests: f32,
    #[serde(default = "one")]
    turns: f32,
    learned_s: u32,
    doubtful_s: u32,
    rolled_back: u32,
}

fn one() -> f32 {
    1.0
}

/// The reason why a text cannot be used as a state. Lines count from 1.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum TrackFileError {
    /// The text is not TOML, or does not have the fields of a state.
    Syntax { line: usize, message: String },
    /// Newer software wrote the file.
    Newer { schema: u32 },
    /// The text has changed since it was written.
    Altered(Damage),
    /// The text has no check lines, so nothing shows whether it is whole.
    Unchecked,
    /// The state continues another calibration.
    OtherCalibration { of: String, given: String },
    /// The state belongs to another unit.
    OtherUnit { of: String, given: String },
    /// The state lacks an axis of the part.
    NoAxis { axis: String },
}

impl fmt::Display for TrackFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax { line, message } => write!(f, "line {line}: {message}"),
            Self::Newer { schema } => write!(f, "a newer zerorate wrote schema {schema}; update this one"),
            Self::Altered(damage) => damage.fmt(f),
            Self::Unchecked => f.write_str(check_lines::UNCHECKED),
            Self::OtherCalibration { of, given } => {
                write!(f, "it continues calibration {of}, and you gave {given}")
            }
            Self::OtherUnit { of, given } => write!(f, "it belongs to {of}, and the part is {given}"),
            Self::NoAxis { axis } => write!(f, "it has no axis {axis:?}"),
        }
    }
}

impl core::error::Error for TrackFileError {}

impl From<EntryError> for TrackFileError {
    fn from(EntryError { line, what: message, .. }: EntryError) -> Self {
        Self::Syntax { line: line.unwrap_or(1), message }
    }
}

impl TrackFile {
    /// Makes the file of the tracked axes of a calibration. Each state comes with the name of its axis.
    pub fn new<'a>(
        calibration: &Calibration,
        saved: Option<String>,
        axes: impl IntoIterator<Item = (&'a str, Saved)>,
    ) -> Self {
        let form = |(name, Saved { filter, rest_prior, counts }): (&str, Saved)| AxisForm {
            name: name.to_string(),
            state: filter.state,
            covariance: filter.covariance,
            at_c: filter.at_c,
            rests: rest_prior.rests,
            turns: rest_prior.rotations,
            learned_s: counts.learned_s,
            doubtful_s: counts.doubtful_s,
            rolled_back: counts.rolled_back,
        };
        Self {
            schema: SCHEMA,
            calibration: calibration.id(),
            part: calibration.part.clone(),
            serial: calibration.serial.clone(),
            saved,
            axis: axes.into_iter().map(form).collect(),
        }
    }

    /// Reads a state, and checks that it is complete.
    ///
    /// # Errors
    /// Returns an error if the text is not a state, is damaged or incomplete, or has a newer schema.
    pub fn parse(text: &str) -> Result<Self, TrackFileError> {
        let checked = check_lines::verify(text).map_err(TrackFileError::Altered)?;
        let fields = check_lines::without_checks(text);
        let file: Self = Document::parse(&fields)?.fields()?;
        match checked {
            _ if file.schema > SCHEMA => Err(TrackFileError::Newer { schema: file.schema }),
            true => Ok(file),
            false => Err(TrackFileError::Unchecked),
        }
    }

    /// Writes the text of the file, with its check lines. Numbers come back bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        check_lines::file(HEADER, self)
    }

    /// Returns the state of an axis, if it belongs to that calibration.
    ///
    /// # Errors
    /// Returns an error if the state belongs to another calibration or unit, or lacks the axis.
    pub fn of(&self, calibration: &Calibration, axis: &str) -> Result<Saved, TrackFileError> {
        let given = calibration.id();
        if self.calibration != given {
            return Err(TrackFileError::OtherCalibration { of: self.calibration.clone(), given });
        }
        let unit = |part: &str, serial: &Option<String>| {
            [part, serial.as_deref().map_or("", |_| " "), serial.as_deref().unwrap_or_default()].concat()
        };
        let (of, given) = (unit(&self.part, &self.serial), unit(&calibration.part, &calibration.serial));
        if of != given {
            return Err(TrackFileError::OtherUnit { of, given });
        }
        let form = self.axis.iter().find(|form| form.name == axis);
        let form = form.ok_or_else(|| TrackFileError::NoAxis { axis: axis.to_string() })?;
        let AxisForm { state, covariance, at_c, rests, turns, learned_s, doubtful_s, rolled_back, .. } = *form;
        let filter = Filter { state, covariance, at_c };
        let (rest_prior, counts) =
            (RestPrior { rests, rotations: turns }, Counts { learned_s, doubtful_s, rolled_back });
        Ok(Saved { filter, rest_prior, counts })
    }
}

/// Assumed uncertainty of PBC for a calibration that states none, such as one written by hand, °/s. It is a choice.
/// With it, the tracker accepts the level of a first rest within ±0.1 °/s once more rests agree with it.
const UNSTATED_U_PBC_DPS: f64 = 0.05;

impl Prior {
    /// The uncertainties that a calibration states, or assumed ones if it states none.
    fn of_calibration(calibrated: &CalibratedAxis, axis: &Axis) -> Self {
        if let Some(CurveRecord { covariance, .. }) = &calibrated.curve {
            return Self {
                u_pbc_dps: libm::sqrt(covariance[0][0]),
                u_btc_dps_per_c: libm::sqrt(covariance[1][1]),
                cov_pbc_btc_dps2_per_c: covariance[0][1],
                u_curvature_dps_per_c2: libm::sqrt(covariance[2][2]),
            };
        }
        let typical_dps_per_c2 = axis.bias.curvature_dps_per_c2.unwrap_or(0.0);
        let u_curvature_dps_per_c2 = if calibrated.correction.is_line() { typical_dps_per_c2 } else { 0.0 };
        let (u_pbc_dps, u_btc_dps_per_c, cov_pbc_btc_dps2_per_c) = match &calibrated.uncertainty {
            Some(stated) => (stated.u_pbc_dps, stated.u_btc_dps_per_c, stated.cov_pbc_btc_dps2_per_c),
            None => (UNSTATED_U_PBC_DPS, axis.bias.tempco_spread_dps_per_c.unwrap_or(0.0), 0.0),
        };
        Self { u_pbc_dps, u_btc_dps_per_c, cov_pbc_btc_dps2_per_c, u_curvature_dps_per_c2 }
    }
}

impl TrackerConfig {
    /// Makes the configuration for an axis of a calibration. It takes the noise and the uncertainties of the
    /// calibration, or of the part if the calibration states none. `None` if there is no white noise above zero,
    /// because the test for rest compares with it.
    #[must_use]
    pub fn of_calibration(calibrated: &CalibratedAxis, axis: &Axis) -> Option<Self> {
        let noise = match &calibrated.noise {
            Some(record) => NoiseModel {
                white_dps_per_rt_hz: record.white_dps_per_rt_hz,
                bias_instability_dps: record.flicker_floor_dps / FLOOR_PER_B,
                rate_random_walk_dps_per_rt_s: record.rate_random_walk_dps_per_rt_s,
            },
            None => axis.noise?.model(),
        };
        let prior = Prior::of_calibration(calibrated, axis);
        let usable = noise.white_dps_per_rt_hz > 0.0;
        usable.then(|| Self { noise, ..Self::of(axis, calibrated.correction, prior) })
    }
}
