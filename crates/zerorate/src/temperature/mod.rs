//! The bias over temperature from a whole recording at rest, by generalised least squares over all its blocks under
//! its own noise.
//!
//! rate = bias(T) + flicker + random walk + white noise. The bias is a polynomial of order 0 to 3 in the temperature
//! that it follows (`follow.rs`), and the noises are the states of a Kalman filter (`filter.rs`). The result is the
//! bias at the end, including the walk. The order, the strength of the slow noises, lag and play are not known
//! beforehand: each combination is a model with an evidence (`posterior.rs`, `model_averaging.rs`). The order with
//! most evidence is taken, unless it is more likely too low than not. The uncertainty covers all models together, so
//! models that the recording cannot tell apart widen it (Hoeting et al., Bayesian Model Averaging, Statistical Science
//! 14, 1999). The uncertainties of PBC and of the slope at T3 are widened further if models disagree more than a
//! variance can describe (`interval.rs`).

mod base_motion;
mod basis;
pub mod curve;
mod filter;
mod follow;
pub(crate) mod gls;
mod interval;
mod model_averaging;
mod posterior;
pub(crate) mod sweeps;
#[cfg(test)]
mod tests;

use crate::correction::Correction;
use crate::noise::NoiseModel;
use crate::part::{Axis, TypicalBias};
use crate::uncertainty::Uncertainty;
use alloc::vec::Vec;
use basis::Basis;
pub use follow::{FollowedTemperature, LagAndPlay};
use interval::{Peak, honest_u};
pub(crate) use model_averaging::geometric;
use model_averaging::{Weighed, weigh};
use posterior::{Powers, Record};

/// Largest number of steps of the bias that are removed for a curve.
pub const MOST_STEPS: usize = 4;
/// Number of coefficients of a bias over temperature, from the constant to the cubic one.
pub const TERMS: usize = 4;

/// The mean over a short window of a recording. All blocks of a recording have the same length, and there may be
/// gaps between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Start of the block, s.
    pub start_s: f64,
    /// Length of the block, s.
    pub length_s: f64,
    /// Mean rate, °/s.
    pub rate_dps: f64,
    /// Mean temperature, °C.
    pub temp_c: f64,
}

impl Block {
    fn middle_s(&self) -> f64 {
        self.start_s + self.length_s / 2.0
    }

    fn end_s(&self) -> f64 {
        self.start_s + self.length_s
    }

    /// Share of the block that lies after a time.
    fn share_after(&self, at_s: f64) -> f64 {
        ((self.end_s() - at_s) / self.length_s).clamp(0.0, 1.0)
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Noise {
    white_dps_per_rt_hz: f64,
    bias_instability_dps: f64,
    rate_random_walk_dps_per_rt_s: f64,
    /// Gauss–Markov processes: standard deviation, °/s, and correlation time, s.
    gauss_markov: Vec<(f64, f64)>,
}

/// Knowledge and assumptions about a recording in addition to its blocks.
#[derive(Clone, Copy, Debug)]
pub struct Assumed<'a> {
    /// The axis with its typical properties, which give the prior probabilities of coefficients and noises.
    pub axis: &'a Axis,
    /// One-sided density of the white noise of this recording, °/s/√Hz.
    pub white_dps_per_rt_hz: f64,
    /// Gauss–Markov processes in the noise: standard deviation, °/s, and correlation time, s.
    pub gauss_markov: &'a [(f64, f64)],
    /// Times of suspected steps, s, the strongest first. The first [`MOST_STEPS`] are tried, and the models decide
    /// whether they are real.
    pub steps_s: &'a [f64],
    /// Frequencies of possible base motions, Hz, in rising order. The models decide whether one is real. If there
    /// are none, no base motion is looked for.
    pub motions_hz: &'a [f64],
    /// The highest order that is tried, 0 to 3.
    pub max_order: usize,
    /// The temperature that the coefficients refer to, °C.
    pub t3_c: f64,
}

/// The bias over temperature at the end of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasCurve {
    /// The correction that is added to a rate: minus the bias.
    pub correction: Correction,
    /// Covariance of PBC, BTC, and the terms of second and third order. Entry (i, j) is in (°/s)²/°C^(i + j). If
    /// orders disagree on PBC or BTC, the distribution has two peaks, and intervals from its variance would miss the
    /// smaller peak too often. So the variances of PBC and BTC are enlarged.
    pub covariance: [[f64; TERMS]; TERMS],
    /// Sources of the variances of PBC and BTC.
    pub sources: Sources,
    /// The order of the polynomial that `correction` holds, 0 to 3.
    pub order: usize,
    /// Posterior probability of each of the orders 0 to 3.
    pub order_weights: [f64; TERMS],
    /// The lag and the play of the bias, as the mean over all models.
    pub following: LagAndPlay,
    /// Whether the bias lags with a probability above one half.
    pub is_late: bool,
    /// The noise: white as given, B and K the geometric means over all models.
    pub noise: NoiseModel,
    /// Whether the recording determined B and K, each clearly better than the prior.
    pub noise_told: [bool; 2],
    /// Steps that are real with a probability above one half.
    pub steps: [Option<Step>; MOST_STEPS],
    /// The base motion, if one is real with a probability above one half.
    pub base_motion: Option<BaseMotion>,
    /// Lowest and highest temperature of the blocks, °C.
    pub span_c: (f64, f64),
}

impl BiasCurve {
    /// Standard uncertainty of BTC, °/s/°C.
    #[must_use]
    pub fn u_btc_dps_per_c(&self) -> f64 {
        libm::sqrt(self.covariance[1][1])
    }

    /// Standard uncertainty of the correction at a temperature, °/s.
    #[must_use]
    pub fn u_dps(&self, temp_c: f64) -> f64 {
        u_dps(&self.covariance, temp_c - self.correction.t3_c)
    }

    /// Effect of the base motion, and of the steps relative to the level at the end, on the mean over a block, °/s.
    pub(crate) fn disturbed_dps(&self, block: &Block) -> f64 {
        let stepped = |step: &Step| step.size_dps * (block.share_after(step.at_s) - 1.0);
        let motion_dps = self.base_motion.map_or(0.0, |motion| motion.at(block.middle_s()));
        self.steps.iter().flatten().map(stepped).sum::<f64>() + motion_dps
    }
}

/// Contributions to the standard uncertainties of PBC, °/s, and BTC, °/s/°C, in addition to the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sources {
    /// Disagreement of the models on order, lag, play, steps and strength of the noise.
    pub u_models: [f64; 2],
    /// Possible slow base motion, by the weight of the models that have one.
    pub u_base_motion: [f64; 2],
    /// Posterior probability of a base motion.
    pub base_motion_probability: f64,
}

/// A change of the level that was removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Time of the step, s.
    pub at_s: f64,
    /// The level after the step less the level before it, °/s.
    pub size_dps: f64,
    /// Standard uncertainty of the size, °/s.
    pub u_dps: f64,
}

/// An oscillation of the base that was removed, as in the most likely model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseMotion {
    /// Frequency, Hz.
    pub hz: f64,
    /// Amplitude of the sine, °/s. The phase of the sine is zero at time 0.
    pub sine_dps: f64,
    /// Amplitude of the cosine, °/s.
    pub cosine_dps: f64,
}

impl BaseMotion {
    /// Peak rate, °/s.
    #[must_use]
    pub fn size_dps(&self) -> f64 {
        libm::hypot(self.sine_dps, self.cosine_dps)
    }

    /// Rate of the base at a time, °/s.
    #[must_use]
    pub fn at(&self, at_s: f64) -> f64 {
        let (sine, cosine) = libm::sincos(2.0 * core::f64::consts::PI * self.hz * at_s);
        self.sine_dps * sine + self.cosine_dps * cosine
    }
}

/// The reason why a recording does not give a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThermalError {
    /// The recording has fewer blocks than a fit needs.
    TooFew {
        /// Number of blocks.
        blocks: usize,
        /// Smallest number of blocks.
        needed: usize,
    },
    /// A rate or temperature is not a finite number, or nothing varies.
    Degenerate,
}

/// Smallest number of blocks for a fit.
const FEWEST: usize = 40;

/// Finds the bias over temperature at the end of a recording.
///
/// # Errors
/// Returns an error if there are too few blocks, or no model can explain them.
pub fn fit(blocks: &[Block], assumed: &Assumed<'_>) -> Result<BiasCurve, ThermalError> {
    if blocks.len() < FEWEST {
        return Err(ThermalError::TooFew { blocks: blocks.len(), needed: FEWEST });
    }
    let basis = Basis::over(blocks);
    let prior_dps = prior(&assumed.axis.bias, &basis, blocks);
    let steps_s = &assumed.steps_s[..assumed.steps_s.len().min(MOST_STEPS)];
    let (t3_c, max_order) = (assumed.t3_c, assumed.max_order.min(TERMS - 1));
    let record = Record { blocks, basis: &basis, steps_s, t3_c, prior_dps, max_order };
    let models = weigh(&record, assumed);
    if models.is_empty() { Err(ThermalError::Degenerate) } else { Ok(average(&record, assumed.axis, &models)) }
}

/// Returns the rates without their dependence on temperature up to order 3, significant or not. The mean rate stays.
pub(crate) fn without_temperature(blocks: &[Block]) -> Vec<f64> {
    let basis = Basis::over(blocks);
    let mut left: Vec<f64> = blocks.iter().map(|block| block.rate_dps).collect();
    for degree in 1..TERMS {
        let column: Vec<f64> = blocks.iter().map(|block| basis.at(degree, block.temp_c)).collect();
        let square = gls::dot(&column, &column);
        let share = if square > 0.0 { gls::dot(&column, &left) / square } else { 0.0 };
        left.iter_mut().zip(&column).for_each(|(rate_dps, value)| *rate_dps -= share * value);
    }
    left
}

/// Finds the step that explains most of the rates in addition to a level and a polynomial over temperature, by
/// least squares over all three. Returns the index of the first block after the step, and the size of the step, °/s.
pub(crate) fn step_beside_temperature(blocks: &[Block]) -> (usize, f64) {
    let basis = Basis::over(blocks);
    let column = |degree| blocks.iter().map(|block| basis.at(degree, block.temp_c)).collect::<Vec<f64>>();
    let columns: [Vec<f64>; TERMS] = core::array::from_fn(column);
    let squares: [f64; TERMS] = core::array::from_fn(|degree| gls::dot(&columns[degree], &columns[degree]));
    let mut left: Vec<f64> = blocks.iter().map(|block| block.rate_dps).collect();
    for (column, square) in columns.iter().zip(squares).filter(|(_, square)| *square > 0.0) {
        let share = gls::dot(column, &left) / square;
        left.iter_mut().zip(column).for_each(|(rate_dps, value)| *rate_dps -= share * value);
    }
    // sums over the blocks after the step
    let (mut behind, mut sums, mut most) = (0.0, [0.0; TERMS], (0.0, 0, 0.0));
    for at in (1..blocks.len()).rev() {
        behind += left[at];
        sums.iter_mut().zip(&columns).for_each(|(sum, column)| *sum += column[at]);
        let explained = sums.iter().zip(squares).filter(|(_, square)| *square > 0.0);
        let square = (blocks.len() - at) as f64 - explained.map(|(sum, square)| sum * sum / square).sum::<f64>();
        // next to an end, level and polynomial may explain nearly all of the step
        let gain = if square > 0.5 { behind * behind / square } else { 0.0 };
        if gain > most.0 {
            most = (gain, at, behind / square);
        }
    }
    (most.1, most.2)
}

/// Forecasts the covariance of a curve, which does not depend on the rates. It assumes the typical slow noises and the
/// highest order. `None` if the part states no temperature coefficient and all rates are equal.
pub(crate) fn expected(blocks: &[Block], assumed: &Assumed<'_>) -> Option<BiasCurve> {
    let basis = Basis::over(blocks);
    let prior_dps = prior(&assumed.axis.bias, &basis, blocks);
    let Assumed { t3_c, max_order, .. } = *assumed;
    let record = Record { blocks, basis: &basis, steps_s: &[], t3_c, prior_dps, max_order };
    let model = model_averaging::typical(&record, assumed)?;
    Some(average(&record, assumed.axis, &[model]))
}

/// Prior spreads of the coefficients of the basis, °/s. If the part states no temperature coefficient, the linear
/// spread is the range of the rates. If it states no curvature, the quadratic spread is a tenth of the linear one, and
/// the cubic spread a fiftieth.
fn prior(typical: &TypicalBias, basis: &Basis, blocks: &[Block]) -> [f64; TERMS] {
    let half_span_c = basis.half_span_c;
    let rates = || blocks.iter().map(|block| block.rate_dps);
    let seen_dps = rates().fold(f64::MIN, f64::max) - rates().fold(f64::MAX, f64::min);
    let tempco = typical.tempco_dps_per_c.zip(typical.tempco_spread_dps_per_c);
    let linear_dps = tempco.map_or(seen_dps, |(typical, spread)| libm::hypot(typical, spread) * half_span_c);
    let quadratic_dps =
        typical.curvature_dps_per_c2.map_or(linear_dps / 10.0, |curvature| curvature * half_span_c * half_span_c);
    let cubic_dps =
        typical.curvature_dps_per_c2.map_or(linear_dps / 50.0, |_| quadratic_dps * half_span_c / HALF_RANGE_C);
    [0.0, linear_dps, quadratic_dps, cubic_dps]
}

/// Distance at which a typical cubic term is as large as a typical quadratic one, °C: half of the range that parts are
/// specified for (F-08).
const HALF_RANGE_C: f64 = 62.5;

/// Ratio of the posterior to the prior spread below which a quantity counts as measured by the recording.
const TOLD: f64 = 0.7;

/// Averages the models of the chosen order, and computes the covariance of all models about this mean.
fn average(record: &Record<'_>, axis: &Axis, models: &[Weighed]) -> BiasCurve {
    let mut order_weights = [0.0; TERMS];
    models.iter().for_each(|model| order_weights[model.posterior.order] += model.weight);
    let order = order_taken(&order_weights);
    let of_order = || models.iter().filter(|model| model.posterior.order == order);
    let mut bias = [0.0; TERMS];
    for model in of_order() {
        let share = model.weight / order_weights[order];
        bias.iter_mut().zip(&model.posterior.bias).for_each(|(mean, value)| *mean += share * value);
    }
    let mut covariance = covariance_about(models, &bias);
    let variances = [covariance[0][0], covariance[1][1]];
    let excess = [0, 1].map(|k| excess(models, k, bias[k], variances[k]));
    (0..2).for_each(|k| covariance[k][k] += excess[k]);
    let mean = |of: fn(&Weighed) -> f64| models.iter().map(|model| model.weight * of(model)).sum::<f64>();
    let noise = |of| libm::exp(mean_logarithm(models, of));
    let told = |of, before| libm::sqrt(variance_of_logarithm(models, of)) < TOLD * before;
    BiasCurve {
        correction: Correction::against(bias, record.t3_c),
        covariance,
        sources: sources(models, variances, excess),
        order,
        order_weights,
        following: LagAndPlay {
            lag_s: mean(|model| model.hypothesis.following.lag_s),
            play_c: mean(|model| model.hypothesis.following.play_c),
        },
        noise: NoiseModel {
            white_dps_per_rt_hz: noise(|noise| noise.white_dps_per_rt_hz),
            bias_instability_dps: noise(|noise| noise.bias_instability_dps),
            rate_random_walk_dps_per_rt_s: noise(|noise| noise.rate_random_walk_dps_per_rt_s),
        },
        noise_told: [
            told(|noise| noise.bias_instability_dps, model_averaging::spread(axis)[0]),
            told(|noise| noise.rate_random_walk_dps_per_rt_s, model_averaging::spread(axis)[1]),
        ],
        steps: steps(record, models),
        is_late: mean(|model| f64::from(u8::from(model.hypothesis.following.lag_s > 0.0))) > 0.5,
        base_motion: base_motion(models),
        span_c: record.span_c(),
    }
}

fn covariance_about(models: &[Weighed], bias: &Powers) -> [Powers; TERMS] {
    let mut covariance = [[0.0; TERMS]; TERMS];
    for Weighed { weight, posterior, .. } in models {
        let off: Powers = core::array::from_fn(|k| posterior.bias[k] - bias[k]);
        for (i, row) in covariance.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value += weight * (posterior.covariance[i][j] + off[i] * off[j]);
            }
        }
    }
    covariance
}

fn mean_logarithm(models: &[Weighed], of: fn(&Noise) -> f64) -> f64 {
    models.iter().map(|model| model.weight * libm::log(of(&model.hypothesis.noise))).sum()
}

fn variance_of_logarithm(models: &[Weighed], of: fn(&Noise) -> f64) -> f64 {
    let centre = mean_logarithm(models, of);
    let off = |model: &Weighed| libm::log(of(&model.hypothesis.noise)) - centre;
    models.iter().map(|model| model.weight * (off(model) * off(model))).sum()
}

/// Chooses the most likely order, but none above which the higher orders together are more likely than not. So a line
/// loses against quadratic and cubic models that are more likely together, even if it is more likely than each of
/// them.
fn order_taken(order_weights: &[f64; TERMS]) -> usize {
    let above = |order: usize| order_weights[order + 1..].iter().sum::<f64>();
    let high_enough = (0..TERMS).filter(|order| above(*order) <= 0.5);
    high_enough.max_by(|a, b| order_weights[*a].total_cmp(&order_weights[*b])).unwrap_or(0)
}

fn base_motion_probability(models: &[Weighed]) -> f64 {
    models.iter().filter(|model| model.hypothesis.motion_hz.is_some()).fold(0.0, |sum, model| sum + model.weight)
}

/// Probability above which models with a base motion form peaks of their own, because the stated intervals could
/// miss them. A less likely base motion counts in the variance by its weight. Intervals that contain the rarest
/// one as well would be useless for a platform at rest.
const MOTION_PEAK: f64 = 1.0 - Uncertainty::COVERAGE;

/// Excess variance that a coefficient needs so that its intervals keep their stated probability. The models of each
/// order form one peak, or two if those with a base motion are split off.
fn excess(models: &[Weighed], k: usize, value: f64, variance: f64) -> f64 {
    let is_split = base_motion_probability(models) > MOTION_PEAK;
    let index =
        |model: &Weighed| 2 * model.posterior.order + usize::from(is_split && model.hypothesis.motion_hz.is_some());
    let peak = |peak: usize| {
        let of_peak = || models.iter().filter(|model| index(model) == peak);
        let weight: f64 = of_peak().map(|model| model.weight).sum();
        let share = |of: &dyn Fn(&Weighed) -> f64| of_peak().map(|model| model.weight / weight * of(model)).sum();
        let mean: f64 = share(&|model| model.posterior.bias[k]);
        let off = |model: &Weighed| model.posterior.bias[k] - mean;
        let variance = share(&|model| model.posterior.covariance[k][k] + off(model) * off(model));
        Peak { weight, mean, variance }
    };
    let peaks: [Peak; 2 * TERMS] = core::array::from_fn(peak);
    let sd = libm::sqrt(variance);
    let u = honest_u(&peaks, value, sd);
    if u > sd { u * u - variance } else { 0.0 }
}

/// Splits the variances of PBC and BTC into their sources. Noise gets the variance for a known model and a known base
/// motion. Base motion gets the variance by its unknown size, and the squared distance between models with and without
/// it. Disagreement of models gets the rest. `excess` counts as base motion if models with a base motion form peaks of
/// their own.
fn sources(models: &[Weighed], variances: [f64; 2], excess: [f64; 2]) -> Sources {
    let probability = base_motion_probability(models);
    let sum = |of: &dyn Fn(&Weighed) -> f64| models.iter().map(|model| model.weight * of(model)).sum::<f64>();
    let moves = |model: &Weighed| f64::from(u8::from(model.hypothesis.motion_hz.is_some()));
    let both = [0, 1].map(|k| {
        // for two groups of models with the weights p and 1 − p, this is p (1 − p) times the distance of their means
        let apart = sum(&|model| (moves(model) - probability) * model.posterior.bias[k]);
        let product = probability * (1.0 - probability);
        let between = if product > 0.0 { apart * apart / product } else { 0.0 };
        let from_motion = sum(&|model| model.posterior.from_motion[k]);
        let noise = sum(&|model| model.posterior.covariance[k][k]) - from_motion;
        let (motion, models) = (from_motion + between, variances[k] - noise - from_motion - between);
        let parts =
            if probability > MOTION_PEAK { [models, motion + excess[k]] } else { [models + excess[k], motion] };
        parts.map(|variance| libm::sqrt(variance.max(0.0)))
    });
    let (u_models, u_base_motion) = (both.map(|[models, _]| models), both.map(|[_, motion]| motion));
    Sources { u_models, u_base_motion, base_motion_probability: probability }
}

/// The steps that are real with a probability above one half, with their mean sizes.
fn steps(record: &Record<'_>, models: &[Weighed]) -> [Option<Step>; MOST_STEPS] {
    let step = |index: usize| {
        let with = || models.iter().filter(move |model| model.posterior.steps.len() > index);
        let weight: f64 = with().map(|model| model.weight).sum();
        let mean = |of: &dyn Fn(f64, f64) -> f64| {
            let size = |model: &Weighed| of(model.posterior.steps[index].0, model.posterior.steps[index].1);
            with().map(|model| model.weight * size(model)).sum::<f64>() / weight
        };
        let size_dps = mean(&|size, _| size);
        let variance = mean(&|size, variance| variance + (size - size_dps) * (size - size_dps));
        (weight > 0.5).then_some(Step { at_s: record.steps_s[index], size_dps, u_dps: libm::sqrt(variance) })
    };
    core::array::from_fn(|index| if index < record.steps_s.len() { step(index) } else { None })
}

/// The base motion of the most likely model that has one, if base motion has a probability above one half.
fn base_motion(models: &[Weighed]) -> Option<BaseMotion> {
    let with = models.iter().filter_map(|model| Some((model, model.hypothesis.motion_hz?)));
    let (model, hz) = with.max_by(|a, b| a.0.weight.total_cmp(&b.0.weight))?;
    let [sine_dps, cosine_dps] = model.posterior.motion_dps;
    (base_motion_probability(models) > 0.5).then_some(BaseMotion { hz, sine_dps, cosine_dps })
}

/// Standard uncertainty of a polynomial, °/s, at `distance_c` °C from its reference, from the covariance of its
/// coefficients.
#[must_use]
pub fn u_dps(covariance: &[[f64; TERMS]; TERMS], distance_c: f64) -> f64 {
    let powers = [1.0, distance_c, distance_c * distance_c, distance_c * distance_c * distance_c];
    let row = |row: &[f64; TERMS]| row.iter().zip(&powers).map(|(value, power)| value * power).sum::<f64>();
    let variance: f64 = covariance.iter().zip(&powers).map(|(values, power)| row(values) * power).sum();
    libm::sqrt(variance.max(0.0))
}
