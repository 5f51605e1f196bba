//! Steps of the bias anywhere in the hour: a supply that jumped, or a platform that was touched between the averages.

use crate::noise::{NoiseModel, Window};
use crate::record::Second;
use alloc::vec::Vec;

/// Longest mean on either side of a step, s.
const LONGEST_SIDE_S: usize = 40;
/// Shortest mean on either side that can show one, s.
const SHORTEST_SIDE_S: usize = 5;
/// Standard deviations from which a step is reported.
const ALARM: f64 = 5.0;
/// Strongest steps that are reported.
const MOST: usize = 3;

/// A change of level at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) at_s: f64,
    pub(crate) size_dps: f64,
    sigmas: f64,
}

/// The strongest steps in a record of seconds, in the order of time, after the temperature's part was taken out with BTC.
pub(crate) fn find(seconds: &[Second], btc_dps_per_c: f64, u_btc_dps_per_c: f64, noise: &NoiseModel) -> Vec<Step> {
    let side = (seconds.len() / 8).min(LONGEST_SIDE_S);
    if side < SHORTEST_SIDE_S {
        return Vec::new();
    }
    let level_sd = noise.sd(&sides(side as f64));
    let candidate = |k: usize| {
        let (rate, temp) = change(seconds, k, side);
        let size_dps = rate + btc_dps_per_c * temp;
        let sigmas = size_dps.abs() / libm::hypot(level_sd, u_btc_dps_per_c * temp);
        Step { at_s: seconds[k].at_s, size_dps, sigmas }
    };
    let mut candidates: Vec<Step> = (side..=seconds.len() - side)
        .filter(|k| *k < seconds.len())
        .map(candidate)
        .filter(|step| step.sigmas > ALARM)
        .collect();
    candidates.sort_by(|a, b| b.sigmas.total_cmp(&a.sigmas));
    let mut strongest: Vec<Step> = Vec::new();
    for step in candidates {
        let apart = strongest.iter().all(|other| (step.at_s - other.at_s).abs() >= side as f64);
        if apart && strongest.len() < MOST {
            strongest.push(step);
        }
    }
    strongest.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    strongest
}

fn sides(side_s: f64) -> [Window; 2] {
    [Window { start_s: -side_s, end_s: 0.0, weight: -1.0 }, Window { start_s: 0.0, end_s: side_s, weight: 1.0 }]
}

/// Mean after minus mean before second `k`, of rate and temperature.
fn change(seconds: &[Second], k: usize, side: usize) -> (f64, f64) {
    let mean = |part: &[Second], of: fn(&Second) -> f64| part.iter().map(of).sum::<f64>() / part.len() as f64;
    let (before, after) = (&seconds[k - side..k], &seconds[k..k + side]);
    let difference = |of: fn(&Second) -> f64| mean(after, of) - mean(before, of);
    (difference(|second| second.rate_dps), difference(|second| second.temp_c))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(step_dps: f64) -> Vec<Second> {
        let rough = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        let second = |k: u32| Second {
            at_s: f64::from(k),
            rate_dps: 0.0305 * rough(k) + 0.04 * f64::from(k) * 1e-3 + if k >= 700 { step_dps } else { 0.0 },
            temp_c: 25.0 + f64::from(k) * 1e-3,
        };
        (0..1000).map(second).collect()
    }

    #[test]
    fn a_hundred_millivolt_are_found() {
        let steps = find(&record(0.02), -0.04, 0.001, &NoiseModel::TYPICAL);
        assert_eq!(steps.len(), 1, "{steps:?}");
        assert!((steps[0].at_s - 700.0).abs() <= 3.0 && (steps[0].size_dps - 0.02).abs() < 0.004);
    }

    #[test]
    fn nothing_is_found_in_noise_and_drift() {
        assert!(find(&record(0.0), -0.04, 0.001, &NoiseModel::TYPICAL).is_empty());
        assert!(find(&record(0.0)[..30], -0.04, 0.001, &NoiseModel::TYPICAL).is_empty());
    }
}
