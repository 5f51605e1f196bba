//! Checks of the values of a calibration file.

use super::form::{AxisForm, CURVED, CalibrationForm, NOTED, SEVERAL, Span};
use super::{CurveRecord, NoiseRecord, Run, SCHEMA, SIMULATED, SourcesRecord, Uncertainties, is_rfc3339};
use crate::correction::Correction;
use crate::part::{Axis, MAX_AXES, Part, Scale, is_word};
use crate::procedure::Measured;
use crate::temperature::TERMS;
use crate::temperature::gls::whitener;
use alloc::format;
use alloc::string::String;
use core::ops::RangeInclusive;
use toml::Spanned;
use toml::de::DeValue;
use zerorate_allan::entry::{Document, Entry, EntryError};

/// Allowed values of signed numbers, in any unit.
const NUMBERS: RangeInclusive<f64> = -1e9..=1e9;
/// Allowed uncertainties, durations, rates and other numbers that cannot be negative.
const SIZES: RangeInclusive<f64> = 0.0..=1e9;
const SHARES: RangeInclusive<f64> = 0.0..=1.0;
/// Share by which the sum of a variance's parts may exceed the variance, because of rounding.
const ROUNDING: f64 = 1e-9;
/// Temperatures that a temperature sensor may report, °C.
const TEMPS_C: RangeInclusive<f64> = -100.0..=200.0;
/// Largest rate that any gyroscope is assumed to measure, °/s.
const FASTEST_DPS: f64 = 1e5;

/// Limits of a correction: the largest absolute values of PBC and BTC, and the range of T3.
struct Limits {
    pbc_dps: f64,
    btc_dps_per_c: f64,
    t3_c: RangeInclusive<f64>,
}

/// Keys of the second- and third-order terms of a curve in the file.
const CURVE: [&str; 2] = ["btc2_dps_per_c2", "btc3_dps_per_c3"];

impl Limits {
    /// The limits of an ADIS16130: its range (F-08), 250 times its temperature coefficient (F-05), and temperatures
    /// somewhat beyond its operating range (F-08).
    const ADIS16130: Self = Self {
        pbc_dps: match Axis::ADIS16130.range_dps {
            Some(range_dps) => range_dps,
            None => FASTEST_DPS,
        },
        btc_dps_per_c: 10.0,
        t3_c: -60.0..=150.0,
    };

    /// The limits that the scales of the codes imply: BTC changes a rate by at most the whole scale in 1 °C.
    fn of(rate: Option<Scale>, temp: Option<Scale>) -> Self {
        let span_dps = rate.map_or(FASTEST_DPS, |rate| rate.span() / rate.lsb_per_unit);
        let t3_c = temp.map_or(TEMPS_C, |temp| {
            let values = temp.values();
            TEMPS_C.start().max(*values.start())..=TEMPS_C.end().min(*values.end())
        });
        Self { pbc_dps: span_dps, btc_dps_per_c: span_dps, t3_c }
    }
}

impl CalibrationForm {
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
        self.run.as_ref().map_or(Ok(()), |run| run.check(root.at("run")))?;
        let created = self.created.as_deref();
        let is_time = created.is_none_or(|created| created == SIMULATED || is_rfc3339(created));
        root.at("created").require(is_time, || "is not an RFC 3339 time, such as 2026-03-01T12:00:00Z".into())?;
        document.each(one_line)
    }

    /// Checks a file without `[[axis]]`, which belongs to an ADIS16130.
    fn check_only_axis(&self, root: Entry<'_>) -> Result<(), EntryError> {
        let Self { schema, part, correction, temperature, validity, .. } = self;
        let Self { measured, uncertainty, curve, noise, .. } = self;
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
        check_of_axis(root, correction, measured.as_ref(), uncertainty.as_ref(), noise.as_ref())
    }

    /// Checks a file with `[[axis]]`: schema 2 or higher.
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
            let AxisForm { correction, measured, uncertainty, noise, .. } = axis;
            check_of_axis(entry, correction, measured.as_ref(), uncertainty.as_ref(), noise.as_ref())?;
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
        check_coverage(table, curve.coverage, curve.coverage_factor)?;
        table.at("covariance").require(is_covariance(&curve.covariance), || COVARIANCE.into())?;
        let weights = curve.order_weights.iter().all(|weight| SHARES.contains(weight));
        table.at("order_weights").require(weights, || "must be probabilities".into())?;
        check_within(table, &SIZES, &[("lag_s", curve.lag_s), ("play_c", curve.play_c)])?;
        let steps = curve.steps.iter().all(|[at_s, size_dps]| SIZES.contains(at_s) && NUMBERS.contains(size_dps));
        table.at("steps").require(steps, || "must be pairs of a time and a size".into())?;
        let Some(sources) = curve.sources else { return Ok(()) };
        sources.check(table.at("sources"), [curve.covariance[0][0], curve.covariance[1][1]])
    }
}

impl SourcesRecord {
    /// Checks the sources against `variances`, the variances of PBC and BTC.
    fn check(&self, table: Entry<'_>, variances: [f64; 2]) -> Result<(), EntryError> {
        check_within(table, &SHARES, &[("sway_probability", self.sway_probability)])?;
        let of_pbc = [("u_models_pbc_dps", self.u_models_pbc_dps), ("u_sway_pbc_dps", self.u_sway_pbc_dps)];
        let of_btc = [
            ("u_models_btc_dps_per_c", self.u_models_btc_dps_per_c),
            ("u_sway_btc_dps_per_c", self.u_sway_btc_dps_per_c),
        ];
        for (parts, variance) in [of_pbc, of_btc].iter().zip(variances) {
            check_within(table, &SIZES, parts)?;
            check_parts(table.at(parts[0].0), parts.map(|(_, u)| u), variance)?;
        }
        Ok(())
    }
}

/// Checks that two parts of a variance, given as standard uncertainties, do not exceed it.
fn check_parts(entry: Entry<'_>, [one, other]: [f64; 2], variance: f64) -> Result<(), EntryError> {
    let fits = one * one + other * other <= variance * (1.0 + ROUNDING);
    entry.require(fits, || "does not fit: the parts of a variance must not exceed it".into())
}

fn curved() -> String {
    format!("belongs to schema {CURVED}")
}

const COVARIANCE: &str = "is not a covariance: it must be symmetric, and no sum may have a variance below 0";

/// Checks the tables of an axis that files with and without `[[axis]]` share, except its correction.
fn check_of_axis(
    axis: Entry<'_>,
    correction: &Correction,
    measured: Option<&Measured>,
    uncertainty: Option<&Uncertainties>,
    noise: Option<&NoiseRecord>,
) -> Result<(), EntryError> {
    measured.map_or(Ok(()), |measured| measured.check(axis.at("measured")))?;
    uncertainty.map_or(Ok(()), |uncertainty| uncertainty.check(axis.at("uncertainty"), correction))?;
    noise.map_or(Ok(()), |noise| noise.check(axis.at("noise")))
}

fn check_coverage(table: Entry<'_>, coverage: f64, factor: f64) -> Result<(), EntryError> {
    let is_probability = coverage > 0.0 && coverage < 1.0;
    table.at("coverage").require(is_probability, || "must be a probability between 0 and 1".into())?;
    let is_factor = factor > 0.0 && SIZES.contains(&factor);
    table.at("coverage_factor").require(is_factor, || "must be a number above 0".into())
}

fn check_within(
    table: Entry<'_>,
    limits: &RangeInclusive<f64>,
    numbers: &[(&'static str, f64)],
) -> Result<(), EntryError> {
    numbers.iter().try_for_each(|(key, number)| {
        let why = || format!("must be a number from {} to {}", limits.start(), limits.end());
        table.at(key).require(limits.contains(number), why)
    })
}

/// Whether a matrix can be a covariance: it is symmetric and positive semidefinite, up to rounding.
fn is_covariance<const N: usize>(matrix: &[[f64; N]; N]) -> bool {
    /// Allowed error of a correlation, enough for inputs that were rounded to seven digits.
    const ROUNDING: f64 = 1e-6;
    let sd = |k: usize| if matrix[k][k] > 0.0 { libm::sqrt(matrix[k][k]) } else { 1.0 };
    let correlation = |i: usize, j: usize| matrix[i][j] / sd(i) / sd(j);
    let is_sound = |i: usize, j: usize| {
        let (value, twin) = (correlation(i, j), correlation(j, i));
        value.is_finite() && (value - twin).abs() <= ROUNDING && (value == 0.0 || matrix[i][i] > 0.0)
    };
    let rounded = |i: usize, j: usize| correlation(i, j) + if i == j { ROUNDING } else { 0.0 };
    let lower = || (0..N).map(|i| (0..=i).map(|j| rounded(i, j)).collect()).collect();
    (0..N).all(|i| (0..N).all(|j| is_sound(i, j))) && whitener(lower()).is_some()
}

impl Measured {
    fn check(&self, table: Entry<'_>) -> Result<(), EntryError> {
        let &Self { b1_dps, t1_c, b2_dps, t2_c } = self;
        check_within(table, &NUMBERS, &[("b1_dps", b1_dps), ("b2_dps", b2_dps)])?;
        check_within(table, &TEMPS_C, &[("t1_c", t1_c), ("t2_c", t2_c)])
    }
}

impl Uncertainties {
    /// Checks the uncertainties of `correction`.
    fn check(&self, table: Entry<'_>, correction: &Correction) -> Result<(), EntryError> {
        check_coverage(table, self.coverage, self.coverage_factor)?;
        let sizes = [
            ("u_pbc_dps", self.u_pbc_dps),
            ("u_btc_dps_per_c", self.u_btc_dps_per_c),
            ("u_t3_c", self.u_t3_c),
            ("u_curvature_dps_per_c", self.u_curvature_dps_per_c),
            ("u_b1_dps", self.u_b1_dps),
            ("u_t1_c", self.u_t1_c),
            ("u_b2_dps", self.u_b2_dps),
            ("u_t2_c", self.u_t2_c),
        ];
        check_within(table, &SIZES, &sizes)?;
        let drift_dps = self.drift_dps.unwrap_or(0.0);
        check_within(table, &NUMBERS, &[("drift_dps", drift_dps)])?;
        let [pbc, btc, t3] = [self.u_pbc_dps, self.u_btc_dps_per_c, self.u_t3_c].map(|u| u * u);
        let (pbc_btc, pbc_t3, btc_t3) = (self.cov_pbc_btc_dps2_per_c, self.cov_pbc_t3_dps_c, self.cov_btc_t3_dps);
        let matrix = [[pbc, pbc_btc, pbc_t3], [pbc_btc, btc, btc_t3], [pbc_t3, btc_t3, t3]];
        let why = || "does not fit the uncertainties: the covariances must leave no variance below 0".into();
        table.at("cov_pbc_btc_dps2_per_c").require(is_covariance(&matrix), why)?;
        check_parts(table.at("drift_dps"), [drift_dps, correction.btc_dps_per_c * self.u_t3_c], pbc)?;
        check_parts(table.at("u_curvature_dps_per_c"), [self.u_curvature_dps_per_c, 0.0], btc)
    }
}

impl NoiseRecord {
    fn check(&self, table: Entry<'_>) -> Result<(), EntryError> {
        let sizes = [
            ("white_dps_per_rt_hz", self.white_dps_per_rt_hz),
            ("flicker_floor_dps", self.flicker_floor_dps),
            ("flicker_cutoff_hz", self.flicker_cutoff_hz),
            ("rate_random_walk_dps_per_rt_s", self.rate_random_walk_dps_per_rt_s),
        ];
        check_within(table, &SIZES, &sizes)
    }
}

impl Run {
    fn check(&self, table: Entry<'_>) -> Result<(), EntryError> {
        let sizes = [
            ("duration_s", self.duration_s),
            ("rate_hz", self.rate_hz),
            ("rdy_hz", self.rdy_hz),
            ("average_s", self.average_s),
            ("warmup_s", self.warmup_s),
            ("settle_s", self.settle_s),
            ("offset_s", self.offset_s),
            ("max_u_btc_dps_per_c", self.max_u_btc_dps_per_c),
        ];
        check_within(table, &SIZES, &sizes)?;
        check_within(table, &SHARES, &[("max_lost", self.max_lost)])?;
        check_within(table, &NUMBERS, &[("earth_dps", self.earth_dps.unwrap_or(0.0))])
    }
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

/// Checks that no text has control characters. Each text must be one line, because the check lines count lines.
fn one_line(key: &str, value: &DeValue<'_>) -> Result<(), String> {
    let many = value.as_array().into_iter().flatten().map(Spanned::get_ref);
    if many.chain([value]).filter_map(DeValue::as_str).any(|text| text.contains(char::is_control)) {
        return Err(format!("`{key}` holds control characters; it must be one line of plain text"));
    }
    Ok(())
}
