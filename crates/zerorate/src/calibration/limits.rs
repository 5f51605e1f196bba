//! What the numbers of a calibration can be.

use super::form::{AxisForm, CURVED, Form, SEVERAL};
use super::places::{Place, Places};
use super::{CurveRecord, FileError, SCHEMA, Uncertainties};
use crate::Correction;
use crate::part::{Axis, MAX_AXES, Part, Scale, is_word};
use crate::thermal::TERMS;
use alloc::format;
use alloc::string::String;
use core::ops::RangeInclusive;
use toml::Spanned;
use toml::de::DeValue;

/// No number of a calibration is larger, whatever its unit.
const LARGEST: f64 = 1e9;
/// Temperatures that a sensor may state, °C.
const TEMPS_C: RangeInclusive<f64> = -100.0..=200.0;
/// No gyroscope turns faster, °/s.
const FASTEST_DPS: f64 = 1e5;

/// Within what a correction must lie.
struct Limits {
    pbc_dps: f64,
    btc_dps_per_c: f64,
    t3_c: RangeInclusive<f64>,
}

/// The terms of a curve, as the file calls them.
const CURVE: [&str; 2] = ["btc2_dps_per_c2", "btc3_dps_per_c3"];

impl Limits {
    /// The range of the part (F-08), 250 times its temperature coefficient (F-05), and temperatures around those it is
    /// specified for.
    const ADIS16130: Self = Self {
        pbc_dps: match Axis::ADIS16130.range_dps {
            Some(range_dps) => range_dps,
            None => FASTEST_DPS,
        },
        btc_dps_per_c: 10.0,
        t3_c: -60.0..=150.0,
    };

    /// What the codes can say: BTC changes a rate by the whole scale in 1 °C.
    fn of(rate: Option<Scale>, temp: Option<Scale>) -> Self {
        let span_dps = rate.map_or(FASTEST_DPS, |rate| rate.span() / rate.lsb_per_unit);
        let t3_c = temp.map_or(TEMPS_C, |temp| {
            let (first, last) = temp.codes();
            let value = |code| temp.value(code - temp.zero_code);
            TEMPS_C.start().max(value(first))..=TEMPS_C.end().min(value(last))
        });
        Self { pbc_dps: span_dps, btc_dps_per_c: span_dps, t3_c }
    }
}

/// A form and where its keys stand.
pub(super) struct Inspected<'a> {
    pub(super) form: &'a Form,
    pub(super) places: &'a Places<'a>,
}

impl Inspected<'_> {
    /// Whether this is a calibration that one can compute with.
    pub(super) fn check(&self) -> Result<(), FileError> {
        match &self.form.axis {
            None if self.form.schema != SEVERAL => self.check_only_axis()?,
            Some(axes) if self.form.schema >= SEVERAL => self.check_axes(axes)?,
            Some(_) => self.require(None, &["axis"], false, || format!("belongs to schema {SEVERAL}"))?,
            None => self.require(None, &["schema"], false, || "says several axes, but there is no [[axis]]".into())?,
        }
        self.check_span()?;
        self.places.each(plain)
    }

    /// The plain form: schema 1, or 3 of a curve.
    fn check_only_axis(&self) -> Result<(), FileError> {
        let Form { schema, part, correction, uncertainty, curve, temperature, validity, .. } = self.form;
        let other =
            || format!("is not {}: schema {schema} without [[axis]] is of that part alone", Part::ADIS16130.name);
        self.require(None, &["part"], *part == Part::ADIS16130.name, other)?;
        self.require(None, &["schema"], *schema >= 1, || format!("must be 1 to {SCHEMA}"))?;
        let belongs = || format!("belongs to schema {SEVERAL}, into a file with [[axis]]");
        self.require(None, &["temperature"], temperature.is_none(), belongs)?;
        let margin_c = validity.as_ref().and_then(|span| span.margin_c);
        self.require(None, &["validity", "margin_c"], margin_c.is_none(), belongs)?;
        let Some(correction) = correction else {
            return self.require(None, &["correction"], false, || "is missing".into());
        };
        self.check_correction(None, correction, &Limits::ADIS16130)?;
        self.check_curve(None, curve.as_ref())?;
        self.check_coverage(None, uncertainty.as_ref())
    }

    /// The form of several axes: schema 2, or 3 of curves.
    fn check_axes(&self, axes: &[AxisForm]) -> Result<(), FileError> {
        let Form { part, temperature, correction, measured, uncertainty, curve, noise, .. } = self.form;
        let spelt = || "must be up to 40 letters, digits, -, _ and .".into();
        self.require(None, &["part"], is_word(part), spelt)?;
        for (key, is_there) in [
            ("correction", correction.is_some()),
            ("measured", measured.is_some()),
            ("uncertainty", uncertainty.is_some()),
            ("curve", curve.is_some()),
            ("noise", noise.is_some()),
        ] {
            self.require(None, &[key], !is_there, || "belongs into an [[axis]]".into())?;
        }
        let count = axes.len();
        let some = (1..=MAX_AXES).contains(&count);
        self.require(None, &["axis"], some, || format!("stands {count} times; 1 to {MAX_AXES} can be"))?;
        let temp = temperature.as_ref().map(|scale| scale.scale()).transpose();
        let temp = temp.map_err(|why| self.refused(None, &["temperature"], why))?;
        for (index, axis) in axes.iter().enumerate() {
            self.require(Some(index), &["name"], is_word(&axis.name), spelt)?;
            let alone = axes[..index].iter().all(|other| other.name != axis.name);
            self.require(Some(index), &["name"], alone, || "is that of another axis".into())?;
            let rate = axis.rate.as_ref().map(|scale| scale.scale()).transpose();
            let rate = rate.map_err(|why| self.refused(Some(index), &["rate"], why))?;
            self.check_correction(Some(index), &axis.correction, &Limits::of(rate, temp))?;
            self.check_curve(Some(index), axis.curve.as_ref())?;
            self.check_coverage(Some(index), axis.uncertainty.as_ref())?;
        }
        Ok(())
    }

    fn check_correction(&self, axis: Option<usize>, of: &Correction, limits: &Limits) -> Result<(), FileError> {
        let Limits { pbc_dps, btc_dps_per_c, t3_c } = limits;
        let check = |name, holds, why: &dyn Fn() -> String| self.require(axis, &["correction", name], holds, why);
        check("pbc_dps", of.pbc_dps.abs() <= *pbc_dps, &|| format!("must be a number within ±{pbc_dps:.0} °/s"))?;
        check("btc_dps_per_c", of.btc_dps_per_c.abs() <= *btc_dps_per_c, &|| {
            format!("must be a number within ±{btc_dps_per_c:.0} °/s/°C")
        })?;
        let belongs = || format!("belongs to schema {CURVED}");
        for (name, value, unit) in [(CURVE[0], of.btc2_dps_per_c2, "C²"), (CURVE[1], of.btc3_dps_per_c3, "C³")] {
            check(name, value == 0.0 || self.form.schema >= CURVED, &belongs)?;
            check(name, value.abs() <= *btc_dps_per_c, &|| {
                format!("must be a number within ±{btc_dps_per_c:.0} °/s/°{unit}")
            })?;
        }
        check("t3_c", t3_c.contains(&of.t3_c), &|| {
            format!("must be a temperature within {:.0} … {:.0} °C", t3_c.start(), t3_c.end())
        })
    }

    fn check_coverage(&self, axis: Option<usize>, uncertainty: Option<&Uncertainties>) -> Result<(), FileError> {
        let holds = uncertainty.is_none_or(|u| u.coverage > 0.0 && u.coverage < 1.0);
        let why = || "must be a probability between 0 and 1".into();
        self.require(axis, &["uncertainty", "coverage"], holds, why)
    }

    fn check_curve(&self, axis: Option<usize>, curve: Option<&CurveRecord>) -> Result<(), FileError> {
        let Some(curve) = curve else { return Ok(()) };
        let check = |name, holds, why: &dyn Fn() -> String| self.require(axis, &["curve", name], holds, why);
        check("order", self.form.schema >= CURVED, &|| format!("belongs to schema {CURVED}"))?;
        check("order", curve.order < TERMS, &|| format!("must be 0 to {}", TERMS - 1))?;
        check("coverage", curve.coverage > 0.0 && curve.coverage < 1.0, &|| {
            "must be a probability between 0 and 1".into()
        })?;
        let is_covariance =
            |k: usize| curve.covariance[k][k] >= 0.0 && curve.covariance[k].iter().all(|v| v.is_finite());
        check("covariance", (0..TERMS).all(is_covariance), &|| {
            "must be numbers, none below 0 on its diagonal".into()
        })?;
        let weights = curve.order_weights.iter().all(|weight| (0.0..=1.0).contains(weight));
        check("order_weights", weights, &|| "must be probabilities".into())?;
        let steps = curve.steps.iter().flatten().all(|number| number.is_finite());
        check("steps", steps, &|| "must be pairs of a time and a size".into())
    }

    fn check_span(&self) -> Result<(), FileError> {
        let Some(span) = &self.form.validity else { return Ok(()) };
        let check = |name, holds, why: &str| self.require(None, &["validity", name], holds, || why.into());
        check("temp_min_c", span.temp_min_c <= span.temp_max_c, "must not lie above temp_max_c")?;
        for (name, temp_c) in [("temp_min_c", span.temp_min_c), ("temp_max_c", span.temp_max_c)] {
            check(name, TEMPS_C.contains(&temp_c), "must be a temperature within −100 … 200 °C")?;
        }
        let margin = span.margin_c.is_none_or(|margin_c| (0.0..=100.0).contains(&margin_c));
        check("margin_c", margin, "must be a number within 0 … 100 °C")
    }

    fn require(
        &self,
        axis: Option<usize>,
        path: &[&'static str],
        holds: bool,
        why: impl FnOnce() -> String,
    ) -> Result<(), FileError> {
        if holds { Ok(()) } else { Err(self.refused(axis, path, why())) }
    }

    fn refused(&self, axis: Option<usize>, path: &[&'static str], why: String) -> FileError {
        let Place { line, axis } = self.places.of(axis, path);
        FileError::Value { line, axis, name: path.last().copied().unwrap_or_default(), why }
    }
}

/// What holds for every value, wherever it stands: numbers are such that one can compute with them, and texts are one
/// line each, because the check lines count lines.
fn plain(name: &str, value: &DeValue<'_>, place: Place) -> Result<(), FileError> {
    let refused = |what: &str| {
        let Place { line, axis } = place;
        Err(FileError::Syntax { line, axis, message: format!("`{name}` {what}") })
    };
    let number = value.as_float().and_then(|float| float.as_str().parse::<f64>().ok());
    if number.is_some_and(|number| number.is_nan() || number.abs() > LARGEST) {
        return refused("is no number that a measurement can have");
    }
    let many = value.as_array().into_iter().flatten().map(Spanned::get_ref);
    if many.chain([value]).filter_map(DeValue::as_str).any(|text| text.contains(char::is_control)) {
        return refused("holds control characters; it must be one line of plain text");
    }
    Ok(())
}
