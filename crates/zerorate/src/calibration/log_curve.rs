//! Builds a calibration from curves of the bias over temperature that were fitted to logs.

use super::{CalibratedAxis, Calibration, CurveRecord, MEASURED, NoiseRecord, Notes, one_line};
use crate::correction::{Correction, Validity};
use crate::part::UNKNOWN_MARGIN_C;
use crate::temperature::curve::LogCurve;
use crate::uncertainty::Uncertainty;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

pub(super) const METHOD: &str = "tempcal";

/// Facts about a unit that its curves do not hold.
#[derive(Clone, Debug)]
pub struct LogUnit {
    /// Name of the kind of part: letters, digits, `-`, `_` and `.`.
    pub part: String,
    /// Serial number.
    pub serial: Option<String>,
    /// The software that fitted the curves.
    pub software: String,
    /// The logs that the curves come from, as text.
    pub device: String,
    /// T3 of the corrections, °C.
    pub t3_c: f64,
}

impl Calibration {
    /// Builds a calibration from the bias curves, °/s, of the gyroscopes of a unit. Each curve comes with the name of
    /// its axis and its warnings. The corrections have terms up to the third order. Their uncertainty includes the
    /// part of the curve that these terms miss.
    #[must_use]
    pub fn of_log_curves(unit: LogUnit, axes: &[(String, &LogCurve, Vec<String>)]) -> Self {
        let spans = || axes.iter().map(|(_, curve, _)| curve.span_c());
        let validity = spans().reduce(|one, other| (one.0.max(other.0), one.1.min(other.1)));
        Self {
            part: unit.part,
            serial: unit.serial.as_deref().map(one_line),
            created: None,
            method: Some(METHOD.to_string()),
            software: Some(one_line(&unit.software)),
            device: Some(one_line(&unit.device)),
            config: None,
            capture_sha256: None,
            notes: Notes::default(),
            warnings: Vec::new(),
            temp: None,
            axes: axes.iter().map(|(name, curve, warnings)| axis(name, curve, warnings, unit.t3_c)).collect(),
            validity: validity.map(|(temp_min_c, temp_max_c)| Validity {
                temp_min_c,
                temp_max_c,
                margin_c: UNKNOWN_MARGIN_C,
            }),
            run: None,
        }
    }
}

fn axis(name: &str, curve: &LogCurve, warnings: &[String], t3_c: f64) -> CalibratedAxis {
    let cubic = curve.cubic(t3_c);
    CalibratedAxis {
        name: name.to_string(),
        warnings: warnings.iter().map(|line| one_line(line)).collect(),
        rate: None,
        correction: Correction::against(cubic.terms, t3_c),
        measured: None,
        uncertainty: None,
        curve: Some(CurveRecord {
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            order: cubic.terms.len() - 1,
            order_weights: [0.0, 0.0, 0.0, 1.0],
            covariance: cubic.covariance,
            lag_s: curve.lag_s().max(0.0),
            play_c: curve.following.play_c,
            steps: curve.steps.iter().map(|step| [step.at_s, step.size]).collect(),
            sources: None,
        }),
        noise: Some(NoiseRecord::new(&curve.noise, MEASURED.into(), MEASURED.into())),
    }
}
