//! The bias as six numbers and their covariance, in a Kalman filter on fixed memory.
//!
//! The calibration leaves b(T) = offset + slope · d + curvature · d² + flicker, with d = T − T3. The offset is a
//! random walk with K, the flicker is three first-order processes, slope and curvature stay constant. Time and
//! temperature are arguments. All numbers are f32, which a Cortex-M4F computes in hardware.
//! `tests/core/track_on_twin.rs` checks the covariance over days.

use core::f64::consts::PI;
use libm::{exp, expf, log, sqrtf};

use crate::noise::{FLICKER_CUTOFF_HZ, NoiseModel};

/// Number of states: offset, slope, curvature, and the three parts of the flicker.
pub const STATES: usize = 6;
/// Number of different elements of a symmetric matrix with [`STATES`] rows.
pub const COVARIANCES: usize = STATES * (STATES + 1) / 2;
const FLICKERS: usize = 3;

const OFFSET: usize = 0;
const SLOPE: usize = 1;
const CURVATURE: usize = 2;
const FLICKER: usize = 3;

/// Frequency above which flicker counts as noise of a mean, Hz: 1/(2π · 4 s), for the shortest mean that is taken in.
const FLICKER_TOP_HZ: f64 = 0.04;
/// A time T, s: flicker above [`FLICKER_TOP_HZ`] adds at most T/τ · B²/π to the variance of a mean over τ. The exact
/// factor in place of T/τ is ∫ sinc²(τf)/f df from that frequency on: 0.96 for τ = 4 s, 0.38 for 8 s, 0.15 for 12 s,
/// 0.05 for 16 s.
const FLICKER_ABOVE_S: f64 = 4.0;
/// Largest relative amount by which rounding lets a squared covariance exceed the product of its two variances.
const ROUNDING: f32 = 1e-4;
/// Longest time step, s: 32 years. By then the random walk has made the bias unknown.
const LONGEST_S: f64 = 1e9;

/// The processes that drive the bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    walk_dps2_per_s: f32,
    flicker_dps2: f32,
    flicker_per_s: [f32; FLICKERS],
    fast_flicker_dps2_s: f32,
    white_dps2_s: f32,
    /// Temperature coefficient with which the play of the hysteresis is crossed, °/s/°C.
    tempco_dps_per_c: f32,
    /// Distance from one branch of the hysteresis to the other, °/s.
    play_dps: f32,
}

impl Drift {
    /// Models the flicker as three processes, with corners evenly spaced in log frequency (`noise.rs` has 34).
    pub(super) fn new(noise: &NoiseModel, tempco_dps_per_c: f64, hysteresis_dps: f64) -> Self {
        let density = noise.bias_instability_dps * noise.bias_instability_dps / PI;
        let cell = log(FLICKER_TOP_HZ / FLICKER_CUTOFF_HZ) / FLICKERS as f64;
        Self {
            walk_dps2_per_s: square(noise.rate_random_walk_dps_per_rt_s),
            flicker_dps2: (density * cell) as f32,
            flicker_per_s: core::array::from_fn(|k| {
                (2.0 * PI * FLICKER_CUTOFF_HZ * exp((k as f64 + 0.5) * cell)) as f32
            }),
            fast_flicker_dps2_s: (FLICKER_ABOVE_S * density) as f32,
            white_dps2_s: square(noise.white_dps_per_rt_hz) / 2.0,
            tempco_dps_per_c: tempco_dps_per_c.abs() as f32,
            play_dps: (2.0 * hysteresis_dps) as f32,
        }
    }

    /// Variance of a mean over this many seconds by noise outside of the filter's state, (°/s)².
    pub(super) fn of_mean(&self, length_s: f32) -> f32 {
        (self.white_dps2_s + self.fast_flicker_dps2_s) / length_s
    }

    /// Variance by the hysteresis after a change of the temperature. The bias may have stayed where it was, until the
    /// play is crossed.
    pub(super) fn of_play(&self, change_c: f32) -> f32 {
        let stayed = (self.tempco_dps_per_c * change_c.abs()).min(self.play_dps);
        0.5 * stayed * stayed
    }

    /// Variance that the random walk adds to the offset, (°/s)².
    pub(super) fn of_walk(&self, seconds: f32) -> f32 {
        self.walk_dps2_per_s * seconds
    }

    pub(super) fn over(&self, seconds: f64) -> Passing {
        let seconds = seconds.clamp(0.0, LONGEST_S) as f32;
        let decays = self.flicker_per_s.map(|rate| expf(-rate * seconds));
        Passing { walk_dps2: self.of_walk(seconds), decays, flicker_dps2: self.flicker_dps2 }
    }
}

/// The effect of a time step on the state of a filter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passing {
    walk_dps2: f32,
    decays: [f32; FLICKERS],
    flicker_dps2: f32,
}

/// The knowledge before any tracking, as standard deviations and one covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prior {
    /// Standard uncertainty of PBC, °/s.
    pub u_pbc_dps: f64,
    /// Standard uncertainty of BTC, °/s/°C.
    pub u_btc_dps_per_c: f64,
    /// Covariance of PBC and BTC, (°/s)²/°C.
    pub cov_pbc_btc_dps2_per_c: f64,
    /// Standard uncertainty of the quadratic term, °/s/°C²: from the calibration if it has one, else from the spread
    /// over units.
    pub u_curvature_dps_per_c2: f64,
}

/// The bias that the calibration leaves, and its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Offset (°/s), slope (°/s/°C), curvature (°/s/°C²) and flicker (°/s).
    pub state: [f32; STATES],
    /// Lower triangle of the covariance of the state, row by row.
    pub covariance: [f32; COVARIANCES],
    /// T − T3 at the last mean that was taken in, °C.
    pub at_c: f32,
}

/// A mean at rest compared with the value that the filter expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Innovation {
    /// The mean less its expected value, °/s.
    pub(super) dps: f32,
    /// Variance of `dps` for a part at rest, (°/s)².
    pub(super) dps2: f32,
}

impl Filter {
    pub(super) fn new(prior: &Prior, drift: &Drift) -> Self {
        let mut filter = Self { state: [0.0; STATES], covariance: [0.0; COVARIANCES], at_c: 0.0 };
        *filter.variance(OFFSET) = square(prior.u_pbc_dps);
        *filter.variance(SLOPE) = square(prior.u_btc_dps_per_c);
        *filter.variance(CURVATURE) = square(prior.u_curvature_dps_per_c2);
        filter.covariance[place(SLOPE, OFFSET)] = prior.cov_pbc_btc_dps2_per_c as f32;
        for part in FLICKER..STATES {
            *filter.variance(part) = drift.flicker_dps2;
        }
        filter
    }

    fn variance(&mut self, of: usize) -> &mut f32 {
        &mut self.covariance[place(of, of)]
    }

    /// Advances the state by a time step.
    pub(super) fn wait(&mut self, passing: &Passing) {
        *self.variance(OFFSET) += passing.walk_dps2;
        for (part, decay) in (FLICKER..STATES).zip(passing.decays) {
            if let Some(state) = self.state.get_mut(part) {
                *state *= decay;
            }
            for other in 0..STATES {
                // the variance of `part` itself is scaled once here and once more below
                self.covariance[place(part, other)] *= decay;
            }
            let variance = self.variance(part);
            *variance = *variance * decay + passing.flicker_dps2 * (1.0 - decay * decay);
        }
    }

    /// Adds the square of `u_dps`, °/s (1 σ), to the variance of the offset, as after a power-up.
    pub(super) fn inflate_bias_variance(&mut self, u_dps: f64) {
        *self.variance(OFFSET) += square(u_dps);
    }

    /// The slow bias beyond the calibration at T − T3, °/s, and its variance, (°/s)².
    pub(super) fn change(&self, d_c: f32, drift: &Drift) -> (f32, f32) {
        self.sum(&shape(d_c, 0.0), d_c, drift)
    }

    pub(super) fn innovation(&self, mean_dps: f32, length_s: f32, d_c: f32, drift: &Drift) -> Innovation {
        let (expected_dps, dps2) = self.sum(&shape(d_c, 1.0), d_c, drift);
        Innovation { dps: mean_dps - expected_dps, dps2: dps2 + drift.of_mean(length_s) }
    }

    fn sum(&self, shape: &[f32; STATES], d_c: f32, drift: &Drift) -> (f32, f32) {
        (dot(&self.state, shape), dot(shape, &self.times(shape)).max(0.0) + drift.of_play(d_c - self.at_c))
    }

    /// Updates the state by a mean at rest, °/s beyond the calibration, at T − T3.
    pub(super) fn learn(&mut self, mean_dps: f32, length_s: f32, d_c: f32, drift: &Drift) {
        *self.variance(OFFSET) += drift.of_play(d_c - self.at_c);
        self.at_c = d_c;
        let Innovation { dps, dps2 } = self.innovation(mean_dps, length_s, d_c, drift);
        let gains = self.times(&shape(d_c, 1.0));
        for (row, (state, gain)) in self.state.iter_mut().zip(&gains).enumerate() {
            *state += gain / dps2 * dps;
            for (column, other) in gains.iter().enumerate().take(row + 1) {
                self.covariance[place(row, column)] -= gain * other / dps2;
            }
        }
    }

    /// Mean and covariance of the mixture of both filters, with the probability `p` for this one.
    pub(super) fn mixed(&self, p: f32, other: &Self) -> Self {
        let mut apart = self.state;
        apart.iter_mut().zip(&other.state).for_each(|(apart, other)| *apart -= other);
        let mut mixed = if p < 0.5 { *other } else { *self };
        mixed.state = other.state;
        mixed.state.iter_mut().zip(&apart).for_each(|(state, apart)| *state += p * apart);
        for (row, gap) in apart.iter().enumerate() {
            for (column, across) in apart.iter().enumerate().take(row + 1) {
                let at = place(row, column);
                let between = p * (1.0 - p) * gap * across;
                mixed.covariance[at] = p * self.covariance[at] + (1.0 - p) * other.covariance[at] + between;
            }
        }
        mixed
    }

    fn times(&self, vector: &[f32; STATES]) -> [f32; STATES] {
        core::array::from_fn(|row| {
            (0..STATES).map(|column| self.covariance[place(row, column)] * vector[column]).sum::<f32>()
        })
    }

    /// Whether the state is possible: all numbers are finite, no variance is below zero, and no correlation exceeds 1.
    pub(super) fn is_sound(&self) -> bool {
        let finite = self.state.iter().chain(&self.covariance).chain([&self.at_c]).all(|number| number.is_finite());
        let squares = |row: usize, column: usize| {
            let (a, b) = (self.covariance[place(row, row)], self.covariance[place(column, column)]);
            let both = self.covariance[place(row, column)];
            a >= 0.0 && both * both <= a * b * (1.0 + ROUNDING)
        };
        finite && (0..STATES).all(|row| (0..=row).all(|column| squares(row, column)))
    }
}

/// The factor by which each state enters the bias at T − T3 = `d_c`. `flicker` is the factor of the three flicker
/// states: 1, or 0 to leave them out.
fn shape(d_c: f32, flicker: f32) -> [f32; STATES] {
    let mut shape = [flicker; STATES];
    (shape[OFFSET], shape[SLOPE], shape[CURVATURE]) = (1.0, d_c, d_c * d_c);
    shape
}

/// Index of a covariance. The remainder changes nothing, and spares an index check that could panic.
pub(super) const fn place(row: usize, column: usize) -> usize {
    let (row, column) = if row < column { (column, row) } else { (row, column) };
    (row * (row + 1) / 2 + column) % COVARIANCES
}

fn dot(a: &[f32; STATES], b: &[f32; STATES]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The square root of a variance. A negative one, by rounding, counts as 0.
pub(super) fn sd(variance: f32) -> f32 {
    sqrtf(variance.max(0.0))
}

fn square(x: f64) -> f32 {
    (x * x) as f32
}
