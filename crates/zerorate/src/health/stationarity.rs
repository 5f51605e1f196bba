//! The test for rest. It compares block means with the noise floor, at averaging times from a block to a quarter of
//! the window.

use super::block_means::{Adjacent, BLOCK_S, adjacent};
use crate::noise::NoiseModel;
use crate::part::Axis;
use crate::temperature::{self, Block};
use alloc::vec::Vec;

/// Multiple of the typical white noise above which a part is called noisy instead of at rest.
const NOISY: f64 = 3.0;
/// Allowed ratio of the flicker floor and the random walk of a good unit to their typical values.
const SPREAD: f64 = 2.0;
/// One-sided normal quantile of the tests: one false alarm in fifty million tests.
const ALARM_Z: f64 = 5.5;

/// The verdict on a window.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are the numbers with their units")]
pub enum Verdict {
    /// Noise explains the window.
    AtRest,
    /// The part was at rest except for one step, `at_s` after the window's start.
    Step { at_s: f64, size_dps: f64 },
    /// At `tau_s`, the Allan deviation is `seen_dps`, and noise and drift explain at most `limit_dps`.
    Moving { tau_s: f64, seen_dps: f64, limit_dps: f64 },
    /// The white noise is `seen_dps_per_rt_hz`, and the part has at most `limit_dps_per_rt_hz`.
    Noisy { seen_dps_per_rt_hz: f64, limit_dps_per_rt_hz: f64 },
}

/// Judges a window by its Allan variances alone: of single blocks, and of averages of `m` blocks if `averages`
/// returns them. A step counts as motion then. A part whose typical noise or temperature coefficient is not known
/// cannot be judged, and passes.
pub(crate) fn judge_variances(
    axis: &Axis,
    blocks: Adjacent,
    averages: impl Fn(usize) -> Option<Adjacent>,
    temp_slope_c_per_s: f64,
) -> Verdict {
    match (axis.noise, axis.bias.largest_tempco_dps_per_c()) {
        (Some(noise), Some(tempco_dps_per_c)) => {
            ladder(&noise.model(), blocks, averages, tempco_dps_per_c * temp_slope_c_per_s)
        }
        _ => Verdict::AtRest,
    }
}

/// Judges the means of a window over blocks of 0.1 s, °/s, while the temperature changes by `temp_slope_c_per_s`. A
/// part whose typical noise or temperature coefficient is not known passes.
///
/// ```
/// use zerorate::{Axis, health::stationarity::{Verdict, judge}};
/// let still: Vec<f64> = (0..100).map(|k| 0.02 * [1.0, -0.5, 0.3, -0.8][k % 4]).collect();
/// assert_eq!(judge(&Axis::ADIS16130, &still, 0.0), Verdict::AtRest);
/// let swaying: Vec<f64> = (0..100).map(|k| 0.2 * (k as f64 / 15.0).sin()).collect();
/// assert!(matches!(judge(&Axis::ADIS16130, &swaying, 0.0), Verdict::Moving { .. }));
/// ```
#[must_use]
pub fn judge(axis: &Axis, rates_dps: &[f64], temp_slope_c_per_s: f64) -> Verdict {
    let ladder = |rates_dps: &[f64]| {
        let averages = |m| Some(adjacent(rates_dps, m));
        judge_variances(axis, adjacent(rates_dps, 1), averages, temp_slope_c_per_s)
    };
    match ladder(rates_dps) {
        Verdict::AtRest => Verdict::AtRest,
        moving => {
            let step = Step::best(rates_dps);
            let small = step.size_dps.abs() <= axis.bias.largest_supply_step_dps();
            if small && ladder(&step.removed_from(rates_dps, |rate_dps, dps| rate_dps - dps)) == Verdict::AtRest {
                Verdict::Step { at_s: step.at as f64 * BLOCK_S, size_dps: step.size_dps }
            } else {
                moving
            }
        }
    }
}

/// Judges the means of blocks of 0.1 s after removing their dependence on temperature. A step is fitted together
/// with the temperature. A polynomial that is removed first would bend around the step, and the rest would look
/// like motion.
pub(crate) fn judge_without_temperature(axis: &Axis, blocks: &[Block]) -> Verdict {
    let ladder = |blocks: &[Block]| {
        let rates_dps = temperature::without_temperature(blocks);
        judge_variances(axis, adjacent(&rates_dps, 1), |m| Some(adjacent(&rates_dps, m)), 0.0)
    };
    match ladder(blocks) {
        Verdict::AtRest => Verdict::AtRest,
        moving => {
            let (at, size_dps) = temperature::step_beside_temperature(blocks);
            let step = Step { at, size_dps };
            let small = size_dps.abs() <= axis.bias.largest_supply_step_dps();
            let less = |block: &Block, dps: f64| Block { rate_dps: block.rate_dps - dps, ..*block };
            if small && ladder(&step.removed_from(blocks, less)) == Verdict::AtRest {
                Verdict::Step { at_s: at as f64 * BLOCK_S, size_dps }
            } else {
                moving
            }
        }
    }
}

/// One-sided white noise density from adjacent blocks, °/s/√Hz: their differences have the variance d²/τ.
pub(crate) fn white_density(blocks: Adjacent) -> f64 {
    libm::sqrt(2.0 * BLOCK_S * blocks.variance)
}

/// Factor by which an Allan variance of `pairs` adjacent differences may exceed its expectation at the normal quantile
/// `z`. It is χ²/ν by Wilson and Hilferty (1931), with 2/3 of the pairs as degrees of freedom, as for white noise.
pub(crate) fn allowance(pairs: usize, z: f64) -> f64 {
    let spread = 2.0 / (9.0 * (pairs as f64 * 2.0 / 3.0).max(1.0));
    let root = 1.0 - spread + z * libm::sqrt(spread);
    root * root * root
}

fn ladder(
    typical: &NoiseModel,
    blocks: Adjacent,
    averages: impl Fn(usize) -> Option<Adjacent>,
    drift_dps_per_s: f64,
) -> Verdict {
    let white = white_density(blocks);
    let limit = NOISY * typical.white_dps_per_rt_hz;
    if white > limit {
        return Verdict::Noisy { seen_dps_per_rt_hz: white, limit_dps_per_rt_hz: limit };
    }
    let lengths = core::iter::successors(Some(2), |m| Some(m * 2)).take_while(|m| m * 4 <= blocks.count);
    lengths
        .map_while(averages)
        .map(|seen| rung(typical, seen, white, drift_dps_per_s))
        .find(|v| *v != Verdict::AtRest)
        .unwrap_or(Verdict::AtRest)
}

fn rung(typical: &NoiseModel, seen: Adjacent, white_dps_per_rt_hz: f64, drift_dps_per_s: f64) -> Verdict {
    let tau_s = seen.m as f64 * BLOCK_S;
    let noise = NoiseModel {
        white_dps_per_rt_hz,
        bias_instability_dps: SPREAD * typical.bias_instability_dps,
        rate_random_walk_dps_per_rt_s: SPREAD * typical.rate_random_walk_dps_per_rt_s,
    };
    let drift = drift_dps_per_s * tau_s;
    let limit = noise.allan_variance(tau_s) * allowance(seen.count - 1, ALARM_Z) + drift * drift / 2.0;
    if seen.variance > limit {
        Verdict::Moving { tau_s, seen_dps: libm::sqrt(seen.variance), limit_dps: libm::sqrt(limit) }
    } else {
        Verdict::AtRest
    }
}

/// A change of the level before block `at`.
struct Step {
    at: usize,
    size_dps: f64,
}

impl Step {
    /// Finds the step that explains most of the variance.
    fn best(rates_dps: &[f64]) -> Self {
        let total: f64 = rates_dps.iter().sum();
        let len = rates_dps.len() as f64;
        let (mut before, mut best, mut explained) = (0.0, Self { at: 0, size_dps: 0.0 }, 0.0);
        for (at, rate) in rates_dps.iter().enumerate().take(rates_dps.len().saturating_sub(1)) {
            before += rate;
            let n = (at + 1) as f64;
            let size_dps = (total - before) / (len - n) - before / n;
            let gain = size_dps * size_dps * n * (len - n);
            if gain > explained {
                (best, explained) = (Self { at: at + 1, size_dps }, gain);
            }
        }
        best
    }

    /// Returns the blocks without the step. `less` lowers a block by a level, °/s. A block in which a step happens
    /// fits neither level, so the three blocks around the step are left out.
    fn removed_from<T>(&self, blocks: &[T], less: impl Fn(&T, f64) -> T) -> Vec<T> {
        let level = |k: usize| if k >= self.at { self.size_dps } else { 0.0 };
        let beside = |k: &usize| k.abs_diff(self.at) > 1;
        (0..blocks.len()).filter(beside).map(|k| less(&blocks[k], level(k))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::tests::Normal;

    const WHITE_DPS_PER_RT_HZ: f64 = 0.0125;

    fn judge(rates_dps: &[f64], temp_slope_c_per_s: f64) -> Verdict {
        super::judge(&Axis::ADIS16130, rates_dps, temp_slope_c_per_s)
    }

    /// Block means of white noise with the density of F-02.
    fn at_rest(blocks: usize, seed: u64) -> Vec<f64> {
        let sd = WHITE_DPS_PER_RT_HZ / (2.0 * BLOCK_S).sqrt();
        let mut random = Normal(seed * 2 + 1);
        (0..blocks).map(|_| sd * random.next()).collect()
    }

    fn with(mut rates: Vec<f64>, add: impl Fn(f64) -> f64) -> Vec<f64> {
        for (k, rate) in rates.iter_mut().enumerate() {
            *rate += add(k as f64 * BLOCK_S);
        }
        rates
    }

    #[test]
    fn noise_alone_is_at_rest_and_its_density_is_found() {
        for seed in 1..200 {
            assert_eq!(judge(&at_rest(100, seed), 0.0), Verdict::AtRest, "10 s, seed {seed}");
            let rates = at_rest(1500, seed);
            assert_eq!(judge(&rates, 0.0), Verdict::AtRest, "150 s, seed {seed}");
            assert!((white_density(adjacent(&rates, 1)) / WHITE_DPS_PER_RT_HZ - 1.0).abs() < 0.15);
        }
    }

    #[test]
    fn slow_and_fast_motion_is_seen() {
        for (hz, size_dps) in [(0.02, 0.05), (0.2, 0.05), (1.0, 0.05), (4.0, 0.5)] {
            let sway = with(at_rest(1500, 3), |t| size_dps * (2.0 * core::f64::consts::PI * hz * t).sin());
            let verdict = judge(&sway, 0.0);
            assert!(matches!(verdict, Verdict::Moving { .. } | Verdict::Noisy { .. }), "{hz} Hz: {verdict:?}");
        }
        let knock = with(at_rest(100, 4), |t| if (4.0..4.2).contains(&t) { 2.0 } else { 0.0 });
        assert!(!matches!(judge(&knock, 0.0), Verdict::AtRest | Verdict::Step { .. }));
    }

    #[test]
    fn a_step_is_told_from_motion() {
        let stepped = with(at_rest(1500, 5), |t| if t > 70.0 { 0.09 } else { 0.0 });
        let Verdict::Step { at_s, size_dps } = judge(&stepped, 0.0) else { panic!("{:?}", judge(&stepped, 0.0)) };
        assert!((at_s - 70.0).abs() < 2.0 && (size_dps - 0.09).abs() < 0.005);
        let large = with(at_rest(1500, 5), |t| if t > 70.0 { 0.4 } else { 0.0 });
        assert!(matches!(judge(&large, 0.0), Verdict::Moving { .. }));
    }

    #[test]
    fn drift_is_allowed_as_far_as_the_temperature_explains_it() {
        let drifting = with(at_rest(1500, 6), |t| 0.04 * 0.035 * t);
        assert_eq!(judge(&drifting, 0.035), Verdict::AtRest);
        assert!(matches!(judge(&drifting, 0.0), Verdict::Moving { .. } | Verdict::Step { .. }));
    }

    #[test]
    fn shaking_is_noise() {
        let shaking: Vec<f64> = at_rest(100, 7).iter().map(|rate| rate * 5.0).collect();
        assert!(matches!(judge(&shaking, 0.0), Verdict::Noisy { .. }));
    }

    /// Upper 0.1 % points of χ²/ν from tables: ν = 10: 2.959; ν = 100: 1.494.
    #[test]
    fn wilson_hilferty_against_tables() {
        assert!((allowance(15, 3.0902) - 2.959).abs() < 0.02);
        assert!((allowance(150, 3.0902) - 1.494).abs() < 0.005);
    }
}
