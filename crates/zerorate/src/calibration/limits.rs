//! Limits of the numbers of a calibration.

use super::form::{AxisForm, CURVED, CalibrationForm, NOTED, SEVERAL, Span};
use super::{CurveRecord, SCHEMA, Uncertainties};
use crate::Correction;
use crate::part::{Axis, MAX_AXES, Part, Scale, is_word};
use crate::thermal::TERMS;
use alloc::format;
use alloc::string::String;
use core::ops::RangeInclusive;
use toml::Spanned;
use toml::de::DeValue;
use zerorate_allan::entry::{Document, Entry, EntryError};

/// Largest number in a calibration, in any unit.
const LARGEST: f64 = 1e9;
/// Temperatures that a sensor may state, °C.
const TEMPS_C: RangeInclusive<f64> = -100.0..=200.0;
/// Fastest rate of any gyroscope, °/s.
const FASTEST_DPS: f64 = 1e5;

/// Limits of the coefficients of a correction.
struct Limits {
    pbc_dps: f64,
    btc_dps_per_c: f64,
    t3_c: RangeInclusive<f64>,
}

/// Names of the terms of a curve in the file.
const CURVE: [&str; 2] = ["btc2_dps_per_c2", "btc3_dps_per_c3"];

impl Limits {
    /// The range of the part (F-08), 250 times its temperature coefficient (F-05), and temperatures around its
    /// specified range.
    const ADIS16130: Self = Self {
        pbc_dps: match Axis::ADIS16130.range_dps {
            Some(range_dps) => range_dps,
            None => FASTEST_DPS,
        },
        btc_dps_per_c: 10.0,
        t3_c: -60.0..=150.0,
    };

    /// The limits that the codes set: BTC changes a rate by at most the whole scale in 1 °C.
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

impl CalibrationForm {
    /// Checks that one can compute with this calibration.
    pub(super) fn check(&self, document: &Document<'_>) -> Result<(), EntryError> {
        let root = document.root();
        for (key, note) in [("ambient_note", &self.ambient_note), ("operator", &self.operator), ("host", &self.host)] {
            let belongs = || format!("belongs to schema {NOTED}");
            root.at(key).require(note.is_none() || self.schema >= NOTED, belongs)?;
        }
        match &self.axis {
            None if self.schema != SEVERAL => self.check_only_axis(root)?,
            Some(axes) if self.schema >= SEVERAL => self.check_axes(root, axes)?,
            Some(_) => return Err(root.at("axis").error(format_args!("belongs to schema {SEVERAL}"))),
            None => return Err(root.at("schema").error("says several axes, but there is no [[axis]]")),
        }
        self.validity.as_ref().map_or(Ok(()), |span| span.check(root.at("validity")))?;
        document.each(plain)
    }

    /// Checks the plain form: schema 1, or 3 for a curve.
    fn check_only_axis(&self, root: Entry<'_>) -> Result<(), EntryError> {
        let Self { schema, part, correction, uncertainty, curve, temperature, validity, .. } = self;
        root.at("part").require(*part == Part::ADIS16130.name, || {
            format!("is not {}: schema {schema} without [[axis]] is of that part alone", Part::ADIS16130.name)
        })?;
        root.at("schema").require(*schema >= 1, || format!("must be 1 to {SCHEMA}"))?;
        let belongs = || format!("belongs to schema {SEVERAL}, into a file with [[axis]]");
        root.at("temperature").require(temperature.is_none(), belongs)?;
        let margin_c = validity.as_ref().and_then(|span| span.margin_c);
        root.at("validity").at("margin_c").require(margin_c.is_none(), belongs)?;
        let Some(correction) = correction else { return Err(root.at("correction").error("is missing")) };
        self.check_correction(root.at("correction"), correction, &Limits::ADIS16130)?;
        self.check_curve(root.at("curve"), curve.as_ref())?;
        check_coverage(root.at("uncertainty"), uncertainty.as_ref())
    }

    /// Checks the form of several axes: schema 2, or 3 for curves.
    fn check_axes(&self, root: Entry<'_>, axes: &[AxisForm]) -> Result<(), EntryError> {
        let Self { part, temperature, correction, measured, uncertainty, curve, noise, .. } = self;
        let spelt = || "must be up to 40 letters, digits, -, _ and .".into();
        root.at("part").require(is_word(part), spelt)?;
        for (key, is_there) in [
            ("correction", correction.is_some()),
            ("measured", measured.is_some()),
            ("uncertainty", uncertainty.is_some()),
            ("curve", curve.is_some()),
            ("noise", noise.is_some()),
        ] {
            root.at(key).require(!is_there, || "belongs into an [[axis]]".into())?;
        }
        let count = axes.len();
        let some = (1..=MAX_AXES).contains(&count);
        root.at("axis").require(some, || format!("stands {count} times; give 1 to {MAX_AXES}"))?;
        let temp = temperature.as_ref().map(|scale| scale.scale()).transpose();
        let temp = temp.map_err(|why| root.at("temperature").error(why))?;
        for (index, axis) in axes.iter().enumerate() {
            let entry = root.at("axis").item(index);
            entry.at("name").require(is_word(&axis.name), spelt)?;
            let alone = axes[..index].iter().all(|other| other.name != axis.name);
            entry.at("name").require(alone, || "is the name of another axis".into())?;
            let rate = axis.rate.as_ref().map(|scale| scale.scale()).transpose();
            let rate = rate.map_err(|why| entry.at("rate").error(why))?;
            self.check_correction(entry.at("correction"), &axis.correction, &Limits::of(rate, temp))?;
            self.check_curve(entry.at("curve"), axis.curve.as_ref())?;
            check_coverage(entry.at("uncertainty"), axis.uncertainty.as_ref())?;
        }
        Ok(())
    }

    fn check_correction(&self, table: Entry<'_>, of: &Correction, limits: &Limits) -> Result<(), EntryError> {
        let Limits { pbc_dps, btc_dps_per_c, t3_c } = limits;
        let pbc = of.pbc_dps.abs() <= *pbc_dps;
        table.at("pbc_dps").require(pbc, || format!("must be a number within ±{pbc_dps:.0} °/s"))?;
        let btc = |key, value: f64, per| {
            let why = || format!("must be a number within ±{btc_dps_per_c:.0} °/s/°{per}");
            table.at(key).require(value.abs() <= *btc_dps_per_c, why)
        };
        btc("btc_dps_per_c", of.btc_dps_per_c, "C")?;
        for (key, value, per) in [(CURVE[0], of.btc2_dps_per_c2, "C²"), (CURVE[1], of.btc3_dps_per_c3, "C³")] {
            table.at(key).require(value == 0.0 || self.schema >= CURVED, curved)?;
            btc(key, value, per)?;
        }
        table.at("t3_c").require(t3_c.contains(&of.t3_c), || {
            format!("must be a temperature within {:.0} … {:.0} °C", t3_c.start(), t3_c.end())
        })
    }

    fn check_curve(&self, table: Entry<'_>, curve: Option<&CurveRecord>) -> Result<(), EntryError> {
        let Some(curve) = curve else { return Ok(()) };
        table.at("order").require(self.schema >= CURVED, curved)?;
        table.at("order").require(curve.order < TERMS, || format!("must be 0 to {}", TERMS - 1))?;
        table.at("coverage").require(is_coverage(curve.coverage), || PROBABILITY.into())?;
        let is_covariance =
            |k: usize| curve.covariance[k][k] >= 0.0 && curve.covariance[k].iter().all(|v| v.is_finite());
        let covariances = (0..TERMS).all(is_covariance);
        table.at("covariance").require(covariances, || "must be numbers, none below 0 on its diagonal".into())?;
        let weights = curve.order_weights.iter().all(|weight| (0.0..=1.0).contains(weight));
        table.at("order_weights").require(weights, || "must be probabilities".into())?;
        let steps = curve.steps.iter().flatten().all(|number| number.is_finite());
        table.at("steps").require(steps, || "must be pairs of a time and a size".into())
    }
}

fn curved() -> String {
    format!("belongs to schema {CURVED}")
}

const PROBABILITY: &str = "must be a probability between 0 and 1";

fn is_coverage(coverage: f64) -> bool {
    coverage > 0.0 && coverage < 1.0
}

fn check_coverage(table: Entry<'_>, uncertainty: Option<&Uncertainties>) -> Result<(), EntryError> {
    let holds = uncertainty.is_none_or(|u| is_coverage(u.coverage));
    table.at("coverage").require(holds, || PROBABILITY.into())
}

impl Span {
    fn check(&self, table: Entry<'_>) -> Result<(), EntryError> {
        let &Self { temp_min_c, temp_max_c, margin_c } = self;
        table.at("temp_min_c").require(temp_min_c <= temp_max_c, || "must not lie above temp_max_c".into())?;
        for (key, temp_c) in [("temp_min_c", temp_min_c), ("temp_max_c", temp_max_c)] {
            let why = || "must be a temperature within −100 … 200 °C".into();
            table.at(key).require(TEMPS_C.contains(&temp_c), why)?;
        }
        let margin = margin_c.is_none_or(|margin_c| (0.0..=100.0).contains(&margin_c));
        table.at("margin_c").require(margin, || "must be a number within 0 … 100 °C".into())
    }
}

/// Checks any value: one must be able to compute with a number, and a text must be one line, because the check lines
/// count lines.
fn plain(key: &str, value: &DeValue<'_>) -> Result<(), String> {
    let number = value.as_float().and_then(|float| float.as_str().parse::<f64>().ok());
    if number.is_some_and(|number| number.is_nan() || number.abs() > LARGEST) {
        return Err(format!("`{key}` is not a number that a measurement can have"));
    }
    if key.starts_with("u_") && number.is_some_and(|number| number < 0.0) {
        return Err(format!("`{key}` is below 0, which no uncertainty is"));
    }
    if key == "coverage_factor" && number.is_some_and(|number| number <= 0.0) {
        return Err(format!("`{key}` must be above 0"));
    }
    let many = value.as_array().into_iter().flatten().map(Spanned::get_ref);
    if many.chain([value]).filter_map(DeValue::as_str).any(|text| text.contains(char::is_control)) {
        return Err(format!("`{key}` holds control characters; it must be one line of plain text"));
    }
    Ok(())
}
