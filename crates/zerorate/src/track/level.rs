//! The probability that the level of a quiet stretch is the bias, and not a slow turn.
//!
//! A turn that is slower than a possible change of the bias cannot be told from that change. So nothing is decided.
//! With the probability of a turn the bias stays as uncertain as it was before, and the uncertainty says so.

use super::filter::{Innovation, sd};
use libm::exp;

/// Rates of quiet turns, in units of the least turn to be told. Quiet turns are assumed to be as frequent as rests,
/// and all these rates to be equally likely in both directions. Faster turns are told beyond doubt.
const TURNS: [f64; 6] = [0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
/// Standard deviations beyond which a bias does not explain a level. Noise exceeds them once in 16 000.
const MOST: f64 = 4.0;

/// The probability that a part was at rest, from its quiet mean and the slowest turn to be told, °/s.
///
/// p = g(ν)/(g(ν) + mean of g(ν − ω)) over the turns ω, with g the normal density of variance S and ν the innovation
/// (Bayes, even odds).
pub(super) fn rest_probability(seen: &Innovation, least_turn_dps: f64) -> f64 {
    let sd_dps = sd(seen.dps2);
    let deviations = seen.dps.abs() / sd_dps;
    if deviations.is_nan() || deviations > MOST {
        return 0.0;
    }
    let density = |turn_dps: f64| {
        let deviations = (seen.dps - turn_dps) / sd_dps;
        exp(-0.5 * deviations * deviations)
    };
    let both = |turn: f64| density(turn * least_turn_dps) + density(-turn * least_turn_dps);
    let turning = TURNS.into_iter().map(both).sum::<f64>() / (2.0 * TURNS.len() as f64);
    let resting = density(0.0);
    resting / (resting + turning)
}
