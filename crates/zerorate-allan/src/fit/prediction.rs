//! The uncertainty of a model when it predicts another record.

use super::model::{MeasuredSpectrum, Model};
use super::scoring::{Optimum, Problem, Q2};
use super::steadiness::Scatter;
use crate::linear::Square;
use alloc::vec;
use alloc::vec::Vec;
use realfft::FftError;

/// Step of a numerical slope, as a share of a parameter's standard deviation.
const SMALL: f64 = 1e-3;

/// The uncertainty of ln σ²(τ) in another record.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PredictionError {
    /// The variances at each octave of the averaging time, in samples.
    by_length: Vec<(u64, Variances)>,
}

/// Variances of ln σ²(τ).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Variances {
    /// The variance due to the uncertainty of the fit.
    pub(super) own: f64,
    /// The variance between parts of the record.
    pub(super) scatter: f64,
}

impl PredictionError {
    /// `scatter` is `None` for a model of several records.
    pub(super) fn of(
        (problem, found): (&Problem, &Optimum),
        model: &Model,
        measured: &MeasuredSpectrum,
        scatter: Option<&Scatter>,
    ) -> Result<Self, FftError> {
        let lengths = super::super::octaves((measured.record_s * measured.rate_hz) as usize);
        let own = own_variance(problem, found, model, &lengths, measured)?;
        let with_scatter = |(m, own)| (m, Variances { own, scatter: scatter.map_or(0.0, |scatter| scatter.near(m)) });
        Ok(Self { by_length: lengths.into_iter().zip(own).map(with_scatter).collect() })
    }

    /// The variances at the octave at or above an averaging time; beyond the last octave, those of the last.
    pub(super) fn at(&self, m: u64) -> Variances {
        let at = self.by_length.partition_point(|(length, _)| *length < m);
        self.by_length.get(at).or(self.by_length.last()).map(|(_, variances)| *variances).unwrap_or_default()
    }
}

/// The variance of ln σ², from its slopes by the parameters and the information on the parameters. N, B and K can move
/// even if they are zero. Any other parameter at a bound stays there.
fn own_variance(
    problem: &Problem,
    found: &Optimum,
    model: &Model,
    lengths: &[u64],
    measured: &MeasuredSpectrum,
) -> Result<Vec<f64>, FftError> {
    let curvature = problem.information(found);
    let may_move = |i: usize| i < Q2 || (i > Q2 || found.form.quantised) && problem.is_free(found, i);
    let free: Vec<usize> = (0..curvature.n).filter(|&i| curvature.at(i, i) > 0.0 && may_move(i)).collect();
    let deviation = |i: usize| core::f64::consts::SQRT_2 / libm::sqrt(curvature.at(i, i));
    let slope = |&i: &usize| {
        let mut beside = found.clone();
        beside.at[i] += SMALL * deviation(i);
        let beside = Model::new(&beside, measured)?;
        let by_length = |&m: &u64| (beside.allan_variance(m) - model.allan_variance(m)) / model.allan_variance(m);
        Ok(lengths.iter().map(by_length).map(|change| change / SMALL).collect::<Vec<f64>>())
    };
    let slopes = free.iter().map(slope).collect::<Result<Vec<Vec<f64>>, FftError>>()?;
    // half the curvature of the deviance; the unit of each parameter is its standard deviation with the others fixed
    let cell = |a: usize, b: usize| {
        let (i, j) = (free[a], free[b]);
        curvature.at(i, j) * deviation(i) * deviation(j) / 2.0 + if a == b { 1e-9 } else { 0.0 }
    };
    let Some(factor) = Square::from_fn(free.len(), cell).cholesky() else { return Ok(vec![0.0; lengths.len()]) };
    let variance = |l: usize| {
        let white = factor.whiten(slopes.iter().map(|slope| slope[l]));
        white.iter().map(|part| part * part).sum()
    };
    Ok((0..lengths.len()).map(variance).collect())
}
