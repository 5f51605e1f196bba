//! Integer corrections that work on an axis's raw codes.

use anyhow::{Context, Result};
use zerorate::calibration::CalibratedAxis;
use zerorate::{Calibration, CurveForm, IntegerCorrection, IntegerCurve, IntegerForm, Scale};

/// The scales of an axis, and its integer correction for codes of these scales.
pub(super) struct Codes {
    pub(super) rate: Scale,
    pub(super) temp: Scale,
    pub(super) integer: Integer,
}

/// An integer correction and the number format in which firmware computes it.
pub(super) enum Integer {
    /// The linear correction of F-50.
    Line(IntegerCorrection, IntegerForm),
    /// A correction with a quadratic or a cubic term as well.
    Curve(IntegerCurve, CurveForm),
}

impl Integer {
    pub(super) fn t3_code(&self) -> i32 {
        match self {
            Self::Line(line, _) => line.t3_code,
            Self::Curve(curve, _) => curve.t3_code,
        }
    }
}

impl Codes {
    /// `None` if the calibration does not state the scales.
    pub(super) fn of(calibration: &Calibration, axis: &CalibratedAxis) -> Result<Option<Self>> {
        let (Some(rate), Some(temp)) = (axis.rate, calibration.temp) else { return Ok(None) };
        let integer = Self::integer(axis, &rate, &temp);
        let integer = match calibration.axes.as_slice() {
            [_] => integer?,
            _ => integer.with_context(|| format!("axis {}", axis.name))?,
        };
        Ok(Some(Self { rate, temp, integer }))
    }

    fn integer(axis: &CalibratedAxis, rate: &Scale, temp: &Scale) -> Result<Integer> {
        let correction = &axis.correction;
        Ok(match correction.is_line() {
            true => Integer::Line(correction.to_integer(rate, temp)?, IntegerForm::new(rate, temp)),
            false => Integer::Curve(correction.to_integer_curve(rate, temp)?, CurveForm::new(rate, temp)),
        })
    }
}
