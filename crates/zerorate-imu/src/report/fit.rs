//! The noise model as plain data.

use crate::{B, Named, coefficients};
use serde::Serialize;
#[cfg(feature = "types")]
use ts_rs::TS;
use zerorate_allan::{Coefficient, Estimate, Fit, Term};
use zerorate_logs::Quantity;

/// A noise model.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct FitReport {
    /// Angle random walk, or velocity random walk.
    pub n: CoefficientReport,
    /// Bias instability.
    pub b: CoefficientReport,
    /// Rate random walk, or acceleration random walk.
    pub k: CoefficientReport,
    /// Quantisation Q; `None` if it is not significant, and without a model.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub q: Option<CoefficientReport>,
    /// Rate ramp R; `None` if it is not significant, and without a model.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub r: Option<CoefficientReport>,
    /// Relative error ε of the model, from the spectrum or the Allan curve; `None` without a model.
    pub model_error: Option<f64>,
    /// The ratio of the standard deviation in loud windows of ten seconds to that in quiet windows, if the sensor
    /// moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub motion_ratio: Option<f64>,
    /// Probability of a larger scatter than the measured one, if the model with ε is right.
    pub p_value: Option<f64>,
    /// The frequency up to which the model holds, Hz.
    pub f_max_hz: Option<f64>,
    /// True if the model is rejected: its error is too large, or the sensor moves. Nothing is identified then.
    pub rejected: bool,
    /// The other terms, in the unit of the rate.
    #[cfg_attr(feature = "types", ts(type = "({ kind: string } & Record<string, unknown>)[]"))]
    pub terms: Vec<Term>,
    /// The units that people use for a value in the unit of the rate, the usual one first.
    pub rate_units: Vec<UnitReport>,
}

/// A coefficient with its 95 % interval.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CoefficientReport {
    /// The name, as in `angle random walk`.
    pub name: &'static str,
    /// The value; `None` without a model.
    pub value: Option<f64>,
    /// Lower end of the 95 % interval.
    pub lo: Option<f64>,
    /// Upper end of the 95 % interval.
    pub hi: Option<f64>,
    /// Unit of `value`, `lo` and `hi`.
    pub unit: String,
    /// True if the record shows this noise: zero is outside the interval. If not, only `hi` has a meaning.
    pub identified: bool,
    /// The length of a record that would identify the coefficient, s. `None` if identified or unknown.
    pub needed_s: Option<f64>,
    /// The text to show if the coefficient is not identified; otherwise empty.
    pub remark: String,
    /// The units that people use for the coefficient, the usual one first.
    pub units: Vec<UnitReport>,
}

/// A unit that people use.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct UnitReport {
    /// The symbol, such as `°/√h`.
    pub unit: String,
    /// The number of this unit in one unit of the report.
    pub factor: f64,
}

impl FitReport {
    /// Reports on the model of a record of this quantity. Without a model, the coefficients have no numbers.
    #[must_use]
    pub fn new(fit: Option<&Fit>, quantity: Option<Quantity>) -> Self {
        let named = fit.map_or_else(Vec::new, |fit| coefficients(fit, quantity));
        let of = |letter: char| named.iter().find(|named| named.letter == letter).map(CoefficientReport::new);
        Self {
            n: of('N').unwrap_or_default(),
            b: of('B').unwrap_or_default(),
            k: of('K').unwrap_or_default(),
            q: of('Q'),
            r: of('R'),
            model_error: fit.map(|fit| fit.model_error),
            motion_ratio: fit.and_then(|fit| fit.motion_ratio),
            p_value: fit.map(|fit| fit.p_value),
            f_max_hz: fit.map(|fit| fit.max_freq_hz),
            rejected: fit.is_some_and(|fit| fit.is_rejected),
            terms: fit.map(|fit| fit.terms.clone()).unwrap_or_default(),
            rate_units: units(&B.of(quantity)),
        }
    }

    /// The coefficients with their letters in IEEE Std 952-1997; N, B and K come first.
    pub fn coefficients(&self) -> impl Iterator<Item = (char, &CoefficientReport)> {
        let always = [('N', &self.n), ('B', &self.b), ('K', &self.k)].into_iter();
        always.chain(self.q.iter().map(|q| ('Q', q))).chain(self.r.iter().map(|r| ('R', r)))
    }
}

impl CoefficientReport {
    /// Value and limits in the unit at `index`; `None` without a model or without such a unit.
    #[must_use]
    pub fn in_unit(&self, index: usize) -> Option<Estimate> {
        let factor = self.units.get(index)?.factor;
        Some(Estimate { value: self.value? * factor, lo: self.lo? * factor, hi: self.hi? * factor })
    }

    fn new(named: &Named<'_>) -> Self {
        let &Coefficient { value, lo, hi, identified, needed_s } = named.coefficient;
        let [value, lo, hi] = [value, lo, hi].map(Some);
        let base = named.units.iter().find(|(_, factor)| *factor == 1.0);
        Self {
            name: named.name,
            value,
            lo,
            hi,
            unit: base.map(|(unit, _)| unit.clone()).unwrap_or_default(),
            identified,
            needed_s,
            remark: named.remark(),
            units: units(&named.units),
        }
    }
}

fn units(units: &[(String, f64)]) -> Vec<UnitReport> {
    units.iter().map(|(unit, factor)| UnitReport { unit: unit.clone(), factor: *factor }).collect()
}
