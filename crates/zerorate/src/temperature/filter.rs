//! Least squares under correlated noise: a Kalman filter whose states are the noise, run over the rates and over every
//! column of the model at once.
//!
//! The gains of a Kalman filter do not depend on the data, so it is a linear map of a series to its innovations, which
//! are white. The innovations of all series give the normal equations of generalised least squares, in a time that is
//! linear in the blocks. The method comes from Harvey, Forecasting, Structural Time Series Models and the Kalman
//! Filter, 1989, section 3.4.2. The random walk at the end is the part of the bias that no column describes.

use super::{Block, Noise, gls};
use crate::noise::FLICKER_CUTOFF_HZ;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{LN_2, PI};

/// Highest frequency at which flicker is modelled, Hz.
const FLICKER_TOP_HZ: f64 = 10.0;
/// A process counts as white if a block is more than this many times as long as its correlation time.
const WHITE_FROM: f64 = 3.0;

/// Number of series that are whitened at once.
const LANES: usize = 8;

/// The gains of the filter and the variances of the innovations, for the blocks of a recording. They do not depend on
/// the data.
pub(super) struct Filter {
    states: usize,
    /// One step for each block.
    steps: Vec<Step>,
    /// Factors by which the states decay from a block to the next, for each distance of blocks. Recordings have
    /// few different distances.
    decays: Vec<Vec<f64>>,
    /// Gains of all states, block after block.
    gains: Vec<f64>,
    log_determinant: f64,
    walk_variance: f64,
}

struct Step {
    decay: usize,
    variance: f64,
}

#[derive(Clone, Debug)]
pub(super) struct White {
    /// The innovations in units of their standard deviations.
    values: Vec<f64>,
    /// Estimate, from this series alone, of the random walk at the last block.
    walk: f64,
}

/// Whitened series, and the lower triangle of the sums of their products.
#[derive(Clone, Debug)]
pub(super) struct Whites {
    series: Vec<White>,
    gram: Vec<Vec<f64>>,
}

#[derive(Clone, Debug)]
pub(super) struct Filtered {
    /// Sums of products of the whitened series: the lower triangle.
    pub(super) gram: Vec<Vec<f64>>,
    /// Logarithm of the determinant of the blocks' covariance.
    pub(super) log_determinant: f64,
    /// Estimate, from each series alone, of the random walk at the last block.
    pub(super) walk: Vec<f64>,
    /// Variance of the random walk at the end for a known model, (°/s)².
    pub(super) walk_variance: f64,
}

impl Filter {
    /// Computes the gains for blocks of one length.
    pub(super) fn new(noise: &Noise, blocks: &[Block]) -> Self {
        let mut covariance = Covariance::new(noise, blocks.first().map_or(1.0, |block| block.length_s));
        let states = covariance.rows.len();
        let mut filter = Self {
            states,
            steps: Vec::with_capacity(blocks.len()),
            decays: Vec::new(),
            gains: Vec::with_capacity(blocks.len() * states),
            log_determinant: 0.0,
            walk_variance: 0.0,
        };
        let mut passed: Vec<f64> = Vec::new();
        let mut last_s = blocks.first().map_or(0.0, Block::middle_s);
        for block in blocks {
            let time_s = block.middle_s() - last_s;
            last_s = block.middle_s();
            // times are multiples of a block, up to rounding
            let near = |known: &f64| (known - time_s).abs() < 1e-6 * block.length_s;
            let decay = passed.iter().position(near).unwrap_or(passed.len());
            if decay == passed.len() {
                passed.push(time_s);
                filter.decays.push(covariance.decays(time_s));
            }
            covariance.pass(time_s, &filter.decays[decay]);
            let variance = covariance.observe(&mut filter.gains);
            filter.log_determinant += libm::log(variance);
            filter.steps.push(Step { decay, variance });
        }
        filter.walk_variance = covariance.rows[0][0];
        filter
    }

    /// Whitens series that have one value for each block.
    pub(super) fn whites(&self, series: &[Vec<f64>]) -> Whites {
        let series: Vec<White> = series.chunks(LANES).flat_map(|some| self.whiten(some)).collect();
        let row = |k: usize| series[..=k].iter().map(|other| gls::dot(&series[k].values, &other.values)).collect();
        Whites { gram: (0..series.len()).map(row).collect(), series }
    }

    /// The sums of products of the series in `whites` and `more`, and the estimates of the random walk. `None` if a
    /// sum or the determinant is not finite.
    pub(super) fn filtered(&self, whites: &Whites, more: &[White]) -> Option<Filtered> {
        let mut gram = whites.gram.clone();
        for (k, one) in more.iter().enumerate() {
            let others = whites.series.iter().chain(&more[..=k]);
            gram.push(others.map(|other| gls::dot(&one.values, &other.values)).collect());
        }
        let is_finite = self.log_determinant.is_finite() && gram.iter().flatten().all(|value| value.is_finite());
        is_finite.then(|| Filtered {
            gram,
            log_determinant: self.log_determinant,
            walk: whites.series.iter().chain(more).map(|white| white.walk).collect(),
            walk_variance: self.walk_variance,
        })
    }

    /// The innovations of each series, in units of their standard deviations.
    pub(super) fn whiten_all(&self, series: &[Vec<f64>]) -> Vec<Vec<f64>> {
        series.chunks(LANES).flat_map(|some| self.whiten(some)).map(|white| white.values).collect()
    }

    /// Runs the filter over up to [`LANES`] series.
    pub(super) fn whiten(&self, series: &[Vec<f64>]) -> Vec<White> {
        match series.len() {
            1 | 2 => self.whiten_some::<2>(series).collect(),
            3 | 4 => self.whiten_some::<4>(series).collect(),
            _ => self.whiten_some::<LANES>(series).collect(),
        }
    }

    /// Runs the filter over some series in lockstep, which compilers turn into vector instructions.
    fn whiten_some<const LANES: usize>(&self, series: &[Vec<f64>]) -> impl Iterator<Item = White> + use<LANES> {
        let mut states = vec![[0.0; LANES]; self.states];
        let mut values: [Vec<f64>; LANES] = core::array::from_fn(|_| Vec::with_capacity(self.steps.len()));
        for (at, (step, gains)) in self.steps.iter().zip(self.gains.chunks_exact(self.states)).enumerate() {
            let block: [f64; LANES] = core::array::from_fn(|lane| series.get(lane).map_or(0.0, |series| series[at]));
            let mut expected = [0.0; LANES];
            for (state, decay) in states.iter_mut().zip(&self.decays[step.decay]) {
                for (state, expected) in state.iter_mut().zip(&mut expected) {
                    *state *= decay;
                    *expected += *state;
                }
            }
            let innovation: [f64; LANES] = core::array::from_fn(|lane| block[lane] - expected[lane]);
            let scaled = innovation.map(|innovation| innovation / step.variance);
            for (state, gain) in states.iter_mut().zip(gains) {
                state.iter_mut().zip(&scaled).for_each(|(state, scaled)| *state += gain * scaled);
            }
            let deviation = libm::sqrt(step.variance);
            values.iter_mut().zip(innovation).for_each(|(values, innovation)| values.push(innovation / deviation));
        }
        let walk = states[0];
        values.into_iter().zip(walk).map(|(values, walk)| White { values, walk }).take(series.len())
    }
}

/// Covariance of the states (random walk, then the processes that are slow compared with a block), and their noise.
struct Covariance {
    white_variance: f64,
    walk_variance_per_s: f64,
    processes: Vec<Process>,
    rows: Vec<Vec<f64>>,
}

/// A stationary first-order process.
#[derive(Clone, Copy)]
struct Process {
    variance: f64,
    rate_per_s: f64,
}

impl Covariance {
    /// The covariance before the first block.
    fn new(noise: &Noise, length_s: f64) -> Self {
        let all = flicker(noise.bias_instability_dps).chain(noise.gauss_markov.iter().map(Process::of));
        let (fast, slow): (Vec<Process>, Vec<Process>) = all
            .filter(|process| process.variance > 0.0)
            .partition(|process| process.rate_per_s * length_s > WHITE_FROM);
        let processes: Vec<Process> = slow.iter().map(|process| process.of_means(length_s)).collect();
        let states = processes.len() + 1;
        let mut rows = vec![vec![0.0; states]; states];
        processes.iter().enumerate().for_each(|(k, process)| rows[k + 1][k + 1] = process.variance);
        let white = noise.white_dps_per_rt_hz * noise.white_dps_per_rt_hz / (2.0 * length_s);
        Self {
            white_variance: white + fast.iter().map(|process| process.mean_variance(length_s)).sum::<f64>(),
            walk_variance_per_s: noise.rate_random_walk_dps_per_rt_s * noise.rate_random_walk_dps_per_rt_s,
            processes,
            rows,
        }
    }

    fn decays(&self, time_s: f64) -> Vec<f64> {
        let left = self.processes.iter().map(|process| libm::exp(-process.rate_per_s * time_s));
        core::iter::once(1.0).chain(left).collect()
    }

    fn pass(&mut self, time_s: f64, decays: &[f64]) {
        for (row, decay) in self.rows.iter_mut().zip(decays) {
            row.iter_mut().zip(decays).for_each(|(value, other)| *value *= decay * other);
        }
        self.rows[0][0] += self.walk_variance_per_s * time_s;
        for (k, process) in self.processes.iter().enumerate() {
            self.rows[k + 1][k + 1] += process.variance * (1.0 - decays[k + 1] * decays[k + 1]);
        }
    }

    /// Takes in a block. Returns the variance of its innovation, and appends its gains to `gains`.
    fn observe(&mut self, gains: &mut Vec<f64>) -> f64 {
        let start = gains.len();
        gains.extend(self.rows.iter().map(|row| row.iter().sum::<f64>()));
        let gains = &gains[start..];
        let variance = gains.iter().sum::<f64>() + self.white_variance;
        for (row, gain) in self.rows.iter_mut().zip(gains) {
            let scaled = gain / variance;
            row.iter_mut().zip(gains).for_each(|(value, other)| *value -= scaled * other);
        }
        variance
    }
}

impl Process {
    fn of(&(sigma_dps, tau_s): &(f64, f64)) -> Self {
        Self { variance: sigma_dps * sigma_dps, rate_per_s: 1.0 / tau_s }
    }

    fn mean_variance(&self, length_s: f64) -> f64 {
        let x = self.rate_per_s * length_s;
        self.variance * 2.0 * (libm::expm1(-x) + x) / (x * x)
    }

    /// The process as it appears in means over this time.
    fn of_means(&self, length_s: f64) -> Self {
        Self { variance: self.mean_variance(length_s), ..*self }
    }
}

/// The processes of a 1/f spectrum, one to an octave. The corner of each is at the middle of its octave on a
/// logarithmic scale, and its variance is the integral of S(f) = B²/(πf) over the octave.
fn flicker(bias_instability_dps: f64) -> impl Iterator<Item = Process> {
    let octaves = libm::ceil(libm::log2(FLICKER_TOP_HZ / FLICKER_CUTOFF_HZ));
    let variance = bias_instability_dps * bias_instability_dps / PI * LN_2;
    (0..octaves as u32).map(move |octave| {
        let corner_hz = FLICKER_CUTOFF_HZ * libm::exp2(f64::from(octave) + 0.5);
        Process { variance, rate_per_s: 2.0 * PI * corner_hz }
    })
}
