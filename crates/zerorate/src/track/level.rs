//! The probability that the level of a quiet period is the bias, and not a slow rotation.
//!
//! A rotation that is slower than a possible change of the bias cannot be told from that change. So nothing is
//! decided: `hypothesis_bank.rs` keeps both possibilities. The frequency of rotations is learned from the quiet
//! periods so far.

use super::filter::{Innovation, sd};
use libm::expf;

/// Number of rotation rates that are compared with a level.
const ROTATIONS: usize = 9;
/// Slowest rotation rate that is compared, in units of the slowest rotation to be detected.
const SLOWEST: f32 = 0.7;
/// Ratio of each rate to the one before. All are equally likely, in both directions.
const RATIO: f32 = core::f32::consts::SQRT_2;
/// Relative standard deviation of a rate about the listed one, so that the rates in between are as likely.
const SPREAD: f32 = 0.17;
/// Number of standard deviations above which a bias does not explain a level. Noise exceeds them once in 16 000.
const MOST: f32 = 4.0;

/// Densities of a level for a sensor at rest and for one that rotates, without the factor 1/√2π. `seen` is the mean of
/// the quiet period less its expected value, and `least_turn_dps` the slowest rotation to be detected, °/s.
pub(super) fn densities(seen: &Innovation, least_turn_dps: f32) -> (f32, f32) {
    let normal = |x_dps: f32, dps2: f32| expf(-0.5 * x_dps * x_dps / dps2) / sd(dps2);
    let rest = if seen.dps.abs() > MOST * sd(seen.dps2) { 0.0 } else { normal(seen.dps, seen.dps2) };
    let rates = core::iter::successors(Some(SLOWEST * least_turn_dps), |rate_dps| Some(RATIO * rate_dps));
    let fastest_dps = rates.clone().nth(ROTATIONS - 1).unwrap_or(least_turn_dps);
    // a faster rotation is recognised beyond doubt, and says nothing about the bias
    let level_dps = seen.dps.max(-fastest_dps).min(fastest_dps);
    let both = |rate_dps: f32| {
        let dps2 = seen.dps2 + SPREAD * SPREAD * rate_dps * rate_dps;
        normal(level_dps - rate_dps, dps2) + normal(level_dps + rate_dps, dps2)
    };
    (rest, rates.take(ROTATIONS).map(both).sum::<f32>() / (2 * ROTATIONS) as f32)
}

/// The prior probability that a quiet period is rest, from the periods so far. Each period counts as rest and as
/// rotation, by its probability of either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestPrior {
    /// Number of rests so far, plus one. Beyond about a hundred quiet periods, old ones count less.
    pub rests: f32,
    /// Number of rotations so far, plus one. Beyond about a hundred quiet periods, old ones count less.
    pub rotations: f32,
}

/// Number of quiet periods beyond which old ones are forgotten.
const REMEMBERED: f32 = 100.0;
/// Share of rotations up to which every change of the bias is accepted.
const FEW: f32 = 0.6;

impl RestPrior {
    /// The prior before the first quiet period: one half.
    pub const EVEN: Self = Self { rests: 1.0, rotations: 1.0 };

    /// Probability that the next quiet period is a rest.
    pub(super) fn probability(&self) -> f32 {
        self.rests / (self.rests + self.rotations)
    }

    /// Excess of rotations: 0 up to the share [`FEW`] of the quiet periods, 1 if all of them are rotations.
    pub(super) fn rotation_excess(&self) -> f32 {
        ((1.0 - self.probability() - FEW) / (1.0 - FEW)).max(0.0)
    }

    /// Counts a quiet period that was a rest with this probability.
    pub(super) fn count(&mut self, rest: f32) {
        let forget = (REMEMBERED / (self.rests + self.rotations + 1.0)).min(1.0);
        (self.rests, self.rotations) = ((self.rests + rest) * forget, (self.rotations + 1.0 - rest) * forget);
    }

    pub(super) fn is_sound(&self) -> bool {
        [self.rests, self.rotations].iter().all(|count| *count > 0.0 && *count < 2.0 * REMEMBERED)
    }
}
