//! The TOML tables of a calibration file, and their conversion from and to [`Calibration`].

use super::{CalibratedAxis, Calibration, CurveRecord, NoiseRecord, Notes, Run, Uncertainties};
use crate::correction::{Correction, Validity};
use crate::part::{Part, Scale};
use crate::procedure::Measured;
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize, Serializer};

/// The first schema that allows several axes, and parts other than the ADIS16130.
pub(super) const SEVERAL: u32 = 2;

/// The first schema that allows the higher-order terms of a curve, for one axis or for several.
pub(super) const CURVED: u32 = 3;

/// The first schema that allows notes other than the supply, for one axis or for several.
pub(super) const NOTED: u32 = 4;

/// The keys of a calibration file of any schema, in the order in which they are written.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CalibrationForm {
    pub(super) schema: u32,
    pub(super) part: String,
    serial: Option<String>,
    pub(super) created: Option<String>,
    method: Option<String>,
    software: Option<String>,
    device: Option<String>,
    config: Option<String>,
    capture_sha256: Option<String>,
    supply_note: Option<String>,
    pub(super) ambient_note: Option<String>,
    pub(super) operator: Option<String>,
    pub(super) host: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) temperature: Option<TempScale>,
    /// The correction of the only axis, in a file without `[[axis]]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) correction: Option<Correction>,
    pub(super) measured: Option<Measured>,
    pub(super) uncertainty: Option<Uncertainties>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) curve: Option<CurveRecord>,
    pub(super) noise: Option<NoiseRecord>,
    pub(super) validity: Option<Span>,
    pub(super) run: Option<Run>,
    /// The axes, in a file with `[[axis]]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) axis: Option<Vec<AxisForm>>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AxisForm {
    pub(super) name: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    pub(super) rate: Option<RateScale>,
    pub(super) correction: Correction,
    pub(super) measured: Option<Measured>,
    pub(super) uncertainty: Option<Uncertainties>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) curve: Option<CurveRecord>,
    pub(super) noise: Option<NoiseRecord>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RateScale {
    lsb_per_dps: f64,
    zero_code: i64,
    width_bits: u8,
    signed: Option<bool>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TempScale {
    lsb_per_c: f64,
    zero_code: i64,
    zero_c: f64,
    width_bits: u8,
    signed: Option<bool>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Span {
    pub(super) temp_min_c: f64,
    pub(super) temp_max_c: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) margin_c: Option<f64>,
}

impl RateScale {
    pub(super) fn scale(&self) -> Result<Scale, String> {
        let &Self { lsb_per_dps, zero_code, width_bits, signed } = self;
        Scale::checked(lsb_per_dps, 0.0, zero_code, width_bits, signed)
    }
}

impl TempScale {
    pub(super) fn scale(&self) -> Result<Scale, String> {
        let &Self { lsb_per_c, zero_code, zero_c, width_bits, signed } = self;
        Scale::checked(lsb_per_c, zero_c, zero_code, width_bits, signed)
    }
}

impl From<Scale> for RateScale {
    fn from(Scale { lsb_per_unit, zero_code, width_bits, signed, .. }: Scale) -> Self {
        Self { lsb_per_dps: lsb_per_unit, zero_code, width_bits, signed: Some(signed) }
    }
}

impl From<Scale> for TempScale {
    fn from(Scale { lsb_per_unit, zero_code, zero_value, width_bits, signed }: Scale) -> Self {
        Self { lsb_per_c: lsb_per_unit, zero_code, zero_c: zero_value, width_bits, signed: Some(signed) }
    }
}

impl CalibrationForm {
    /// Converts the tables. They must have passed [`CalibrationForm::check`].
    pub(super) fn into_calibration(self) -> Calibration {
        let only = Part::ADIS16130.axes[0].clone();
        let (temp, axes) = match self.axis {
            Some(axes) => {
                let temp = self.temperature.and_then(|scale| scale.scale().ok());
                (temp, axes.into_iter().map(AxisForm::into_axis).collect())
            }
            None => {
                let axis = self.correction.map(|correction| CalibratedAxis {
                    name: only.name.into_owned(),
                    warnings: Vec::new(),
                    rate: Some(only.axis.rate),
                    correction,
                    measured: self.measured,
                    uncertainty: self.uncertainty,
                    curve: self.curve,
                    noise: self.noise,
                });
                (Some(only.axis.temp), axis.into_iter().collect())
            }
        };
        Calibration {
            part: self.part,
            serial: self.serial,
            created: self.created,
            method: self.method,
            software: self.software,
            device: self.device,
            config: self.config,
            capture_sha256: self.capture_sha256,
            notes: Notes {
                supply: self.supply_note,
                ambient: self.ambient_note,
                operator: self.operator,
                host: self.host,
            },
            warnings: self.warnings,
            temp,
            axes,
            validity: self.validity.map(|span| span.validity()),
            run: self.run,
        }
    }
}

impl AxisForm {
    fn into_axis(self) -> CalibratedAxis {
        CalibratedAxis {
            name: self.name,
            warnings: self.warnings,
            rate: self.rate.and_then(|scale| scale.scale().ok()),
            correction: self.correction,
            measured: self.measured,
            uncertainty: self.uncertainty,
            curve: self.curve,
            noise: self.noise,
        }
    }

    fn new(axis: &CalibratedAxis) -> Self {
        let CalibratedAxis { name, warnings, rate, correction, measured, uncertainty, curve, noise } = axis.clone();
        Self { name, warnings, rate: rate.map(RateScale::from), correction, measured, uncertainty, curve, noise }
    }
}

impl Span {
    fn validity(&self) -> Validity {
        let &Self { temp_min_c, temp_max_c, margin_c } = self;
        Validity { temp_min_c, temp_max_c, margin_c: margin_c.unwrap_or(Validity::MARGIN_C) }
    }
}

impl Calibration {
    /// Version of the file format: the oldest that can express the whole calibration.
    #[must_use]
    pub fn schema(&self) -> u32 {
        let Notes { supply: _, ambient, operator, host } = &self.notes;
        match self.axes.iter().all(|axis| axis.correction.is_line() && axis.curve.is_none()) {
            _ if [ambient, operator, host].into_iter().any(Option::is_some) => NOTED,
            false => CURVED,
            true if self.is_plain() => 1,
            true => SEVERAL,
        }
    }

    /// Whether the part, the name of its only axis, scales and margin are those of the built-in ADIS16130, and this
    /// axis has no warnings of its own. The file and the exports then do not name the axis.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        let Part { name, axes, .. } = &Part::ADIS16130;
        let known = &axes[0];
        let same = |axis: &CalibratedAxis| {
            axis.name == known.name && axis.rate == Some(known.axis.rate) && axis.warnings.is_empty()
        };
        let margin_c = self.validity.map_or(Validity::MARGIN_C, |validity| validity.margin_c);
        self.part == *name
            && self.temp == Some(known.axis.temp)
            && margin_c == Validity::MARGIN_C
            && matches!(self.axes.as_slice(), [only] if same(only))
    }

    pub(super) fn form(&self) -> CalibrationForm {
        let Self { validity, run, ref notes, .. } = *self;
        let plain = self.is_plain();
        let only = self.axes.first().filter(|_| plain);
        CalibrationForm {
            schema: self.schema(),
            part: self.part.clone(),
            serial: self.serial.clone(),
            created: self.created.clone(),
            method: self.method.clone(),
            software: self.software.clone(),
            device: self.device.clone(),
            config: self.config.clone(),
            capture_sha256: self.capture_sha256.clone(),
            supply_note: notes.supply.clone(),
            ambient_note: notes.ambient.clone(),
            operator: notes.operator.clone(),
            host: notes.host.clone(),
            warnings: self.warnings.clone(),
            temperature: self.temp.filter(|_| !plain).map(TempScale::from),
            correction: only.map(|axis| axis.correction),
            measured: only.and_then(|axis| axis.measured),
            uncertainty: only.and_then(|axis| axis.uncertainty),
            curve: only.and_then(|axis| axis.curve.clone()),
            noise: only.and_then(|axis| axis.noise.clone()),
            validity: validity.map(|Validity { temp_min_c, temp_max_c, margin_c }| Span {
                temp_min_c,
                temp_max_c,
                margin_c: Some(margin_c).filter(|_| !plain),
            }),
            run,
            axis: (!plain).then(|| self.axes.iter().map(AxisForm::new).collect()),
        }
    }
}

impl Serialize for Calibration {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.form().serialize(serializer)
    }
}
