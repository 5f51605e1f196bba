//! Compares the results of a method with the truth, for one recording and for many.

use super::unit::{Recording, TEMPS};
use crate::residuals::{DPH_PER_DPS, median, rms};
use std::time::Instant;
use zerorate::temperature::{self, BiasCurve, TERMS};
use zerorate::{Correction, Uncertainty};

pub struct MethodResult {
    pub correction: Correction,
    /// Covariance of the coefficients; `None` if the method states none.
    pub covariance: Option<[[f64; TERMS]; TERMS]>,
    /// The order that the method chose; `None` if its order is fixed.
    pub order: Option<usize>,
}

impl From<Correction> for MethodResult {
    fn from(correction: Correction) -> Self {
        Self { correction, covariance: None, order: None }
    }
}

impl From<BiasCurve> for MethodResult {
    fn from(curve: BiasCurve) -> Self {
        let BiasCurve { correction, covariance, order, .. } = curve;
        Self { correction, covariance: Some(covariance), order: Some(order) }
    }
}

/// The errors of a result at the end of the recording, at temperatures over the measured span, in ascending order.
pub struct Comparison {
    errors_dps: [f64; TEMPS],
    u_dps: Option<[f64; TEMPS]>,
    order: Option<usize>,
    fit_s: f64,
}

impl Comparison {
    /// Runs a method on a recording. `None` if the method gives no result.
    pub fn of(recording: &Recording, fit: impl FnOnce(&Recording) -> Option<MethodResult>) -> Option<Self> {
        let start = Instant::now();
        let fitted = fit(recording)?;
        let fit_s = start.elapsed().as_secs_f64();
        let temps_c = recording.temps_c();
        let MethodResult { correction, covariance, order } = fitted;
        Some(Self {
            errors_dps: temps_c.map(|temp_c| correction.at(temp_c) + recording.truth.bias_dps(temp_c)),
            u_dps: covariance.map(|all| temps_c.map(|temp_c| temperature::u_dps(&all, temp_c - correction.t3_c))),
            order,
            fit_s,
        })
    }

    fn inside(&self) -> Option<[bool; TEMPS]> {
        let u_dps = self.u_dps?;
        Some(std::array::from_fn(|k| self.errors_dps[k].abs() <= Uncertainty::FACTOR * u_dps[k]))
    }
}

/// The results of one method for all units of a kind.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Residual bias: rms over units and temperatures, °/h.
    pub residual_dph: f64,
    /// Residual bias without each unit's mean over the temperatures, °/h.
    pub shape_dph: f64,
    /// Residual bias at each temperature: rms over units, °/h.
    pub at_temps_dph: [f64; TEMPS],
    pub coverage: Option<Coverage>,
    /// Shares of the chosen orders, %.
    pub orders: Option<[f64; TERMS]>,
    pub fit_ms: f64,
}

/// How well the 95 % intervals cover the truth.
#[derive(Clone, Copy, Debug)]
pub struct Coverage {
    /// Share of units inside their interval at each temperature, %.
    pub at_temps: [f64; TEMPS],
    /// Share of units inside their intervals at all temperatures, %.
    pub everywhere: f64,
    /// Ratio of the error to the standard uncertainty, rms.
    pub ratio: f64,
}

impl Coverage {
    pub fn mean(&self) -> f64 {
        self.at_temps.iter().sum::<f64>() / TEMPS as f64
    }

    /// The share at the temperature where it differs most from 95 %.
    pub fn worst(&self) -> f64 {
        let off = |share: &&f64| (**share - 100.0 * Uncertainty::COVERAGE).abs();
        self.at_temps.iter().max_by(|a, b| off(a).total_cmp(&off(b))).copied().unwrap_or(0.0)
    }
}

impl Summary {
    pub fn of(all: &[&Comparison]) -> Self {
        let shape = |judged: &&Comparison| {
            let mean = judged.errors_dps.iter().sum::<f64>() / TEMPS as f64;
            judged.errors_dps.map(|error| error - mean)
        };
        let at_temp = |k: usize| rms(all.iter().map(|judged| judged.errors_dps[k]));
        Self {
            residual_dph: DPH_PER_DPS * rms(all.iter().flat_map(|judged| judged.errors_dps)),
            shape_dph: DPH_PER_DPS * rms(all.iter().flat_map(shape)),
            at_temps_dph: std::array::from_fn(|k| DPH_PER_DPS * at_temp(k)),
            coverage: coverage(all),
            orders: orders(all),
            fit_ms: 1e3 * median(all.iter().map(|judged| judged.fit_s).collect()),
        }
    }
}

fn coverage(all: &[&Comparison]) -> Option<Coverage> {
    let inside: Vec<[bool; TEMPS]> = all.iter().filter_map(|judged| judged.inside()).collect();
    let share =
        |holds: &dyn Fn(&[bool; TEMPS]) -> bool| percent(inside.iter().filter(|unit| holds(unit)).count(), all);
    let ratios = all.iter().filter_map(|judged| Some((judged.errors_dps, judged.u_dps?)));
    let ratios = ratios.flat_map(|(errors, u)| (0..TEMPS).map(move |k| errors[k] / u[k]));
    (!inside.is_empty()).then(|| Coverage {
        at_temps: std::array::from_fn(|k| share(&|unit| unit[k])),
        everywhere: share(&|unit| unit.iter().all(|inside| *inside)),
        ratio: rms(ratios),
    })
}

fn orders(all: &[&Comparison]) -> Option<[f64; TERMS]> {
    all.iter().any(|judged| judged.order.is_some()).then(|| {
        std::array::from_fn(|order| percent(all.iter().filter(|judged| judged.order == Some(order)).count(), all))
    })
}

fn percent<T>(count: usize, all: &[T]) -> f64 {
    100.0 * count as f64 / all.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(errors_dps: [f64; TEMPS], u_dps: f64, order: usize) -> Comparison {
        Comparison { errors_dps, u_dps: Some([u_dps; TEMPS]), order: Some(order), fit_s: 0.002 }
    }

    #[test]
    fn a_summary_is_what_its_units_say() {
        let tilted = std::array::from_fn(|k| 0.001 * (k as f64 - 3.0));
        let units = [judged([0.002; TEMPS], 0.002, 1), judged(tilted, 0.001, 2)];
        let summary = Summary::of(&units.iter().collect::<Vec<_>>());
        // squared errors in (0.001 °/s)²: 9 · 4 of the first unit, and 9 4 1 0 1 4 9 16 25 of the second
        assert!((summary.residual_dph - 3.6 * (105.0f64 / 18.0).sqrt()).abs() < 1e-9, "{summary:?}");
        // without the units' mean errors, 2 and 1, the squared errors are 0 and 16 9 4 1 0 1 4 9 16
        assert!((summary.shape_dph - 3.6 * (60.0f64 / 18.0).sqrt()).abs() < 1e-9, "{summary:?}");
        assert!((summary.at_temps_dph[3] - 3.6 * 2f64.sqrt()).abs() < 1e-9);
        let coverage = summary.coverage.unwrap();
        // the errors of the second unit, in 0.001 °/s, are within ±1.96 at three of nine temperatures
        assert_eq!((coverage.at_temps[0], coverage.at_temps[3], coverage.everywhere), (50.0, 100.0, 50.0));
        assert_eq!(coverage.worst(), 50.0);
        assert_eq!(summary.orders, Some([0.0, 50.0, 50.0, 0.0]));
        assert!((summary.fit_ms - 2.0).abs() < 1e-9);
    }
}
