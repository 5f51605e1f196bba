//! What the codes of an axis need for their correction.

use anyhow::{Context, Result};
use zerorate::calibration::CalibratedAxis;
use zerorate::{Calibration, IntegerCorrection, IntegerForm, Scale};

/// The scales of an axis, and its correction on them.
pub struct Codes {
    pub rate: Scale,
    pub temp: Scale,
    pub form: IntegerForm,
    pub integer: IntegerCorrection,
}

impl Codes {
    /// None where the calibration does not state the scales.
    pub fn of(calibration: &Calibration, axis: &CalibratedAxis) -> Result<Option<Self>> {
        let (Some(rate), Some(temp)) = (axis.rate, calibration.temp) else { return Ok(None) };
        let integer = axis.correction.to_integer(&rate, &temp);
        let integer = match calibration.axes.as_slice() {
            [_] => integer?,
            _ => integer.with_context(|| format!("axis {}", axis.name))?,
        };
        Ok(Some(Self { rate, temp, form: IntegerForm::new(&rate, &temp), integer }))
    }
}
