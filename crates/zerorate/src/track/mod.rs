//! Tracking of the bias: it is learned at rest and predicted in between, on fixed memory.
//!
//! A [`Tracker`] takes means over [`BLOCK_S`] of one axis. It tells rest from the rate alone (`rest.rs`), and follows
//! the bias that the calibration leaves with a Kalman filter (`filter.rs`). It believes a level by the probability
//! that it is not a slow turn (`level.rs`). `docs/tracking.md` derives the limits and states what was measured. The
//! tracker uses neither a clock nor allocation.
//!
//! ```
//! use zerorate::track::{Phase, Prior, Tracker, TrackerConfig};
//! use zerorate::{Axis, Correction};
//! let prior = Prior { u_pbc_dps: 0.003, u_btc_dps_per_c: 0.003, ..Prior::default() };
//! let correction = Correction::line(-0.25, -0.04, 33.0);
//! let mut tracker = Tracker::new(TrackerConfig::of(&Axis::ADIS16130, correction, prior));
//! // a minute at rest, and the bias is 0.004 °/s more than the calibration takes out
//! for _ in 0..600 {
//!     tracker.push(Some(0.254), Some(33.0), true);
//! }
//! let tracked = tracker.tracked(33.0);
//! assert_eq!(tracked.phase, Phase::Rest);
//! // flicker, which does not last, explains a part of it
//! assert!((0.001..0.004).contains(&tracked.change_dps), "{tracked:?}");
//! ```

#[cfg(feature = "file")]
mod file;
mod filter;
mod level;
mod rest;

#[cfg(feature = "file")]
pub use file::{TrackFile, TrackFileError};
pub use filter::{COVARIANCES, Filter, Prior, STATES};
pub use rest::BLOCK_S;

use crate::correction::Correction;
use crate::noise::NoiseModel;
use crate::part::Axis;
use filter::{Drift, Innovation, sd};
use rest::{QUAD_S, Quiet, Seen};

/// Number of quads in a mean that is learned from: 16 s.
const QUADS_PER_MEAN: u32 = 4;
/// Number of states that are kept to go back to, each 32 s older than the one before. They reach as far back as the
/// longest test of means.
const KEPT: usize = 4;
/// Number of means between two kept states.
const MEANS_PER_KEPT: u32 = 2;
/// Blocks per second.
const BLOCKS_PER_S: u32 = 10;

/// The bias to track, and the numbers of the tracking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerConfig {
    /// The calibration.
    pub correction: Correction,
    /// Uncertainty of the calibration.
    pub prior: Prior,
    /// The part's noise: white as measured, flicker, and the random walk that drives the bias.
    pub noise: NoiseModel,
    /// Half width of the hysteresis, °/s. It is zero if it is not known.
    pub hysteresis_dps: f64,
    /// Component of the Earth's rotation on the axis wherever it rests, °/s (F-16), if the calibration has subtracted
    /// it from PBC. Otherwise zero.
    pub earth_dps: f64,
    /// The slowest turn that must not be taken for bias, °/s.
    pub least_turn_dps: f64,
    /// Change of the bias from one power-up to the next, °/s (1 σ).
    pub power_up_dps: f64,
}

impl TrackerConfig {
    /// Default of the slowest turn, °/s: a setting.
    pub const LEAST_TURN_DPS: f64 = 0.02;
    /// Default change by a power-up, °/s: a setting, because no source states one for the ADIS16130. Six times the
    /// floor of its flicker (M-04).
    pub const POWER_UP_DPS: f64 = 0.01;

    /// Makes a configuration with the typical noise and hysteresis of an axis.
    #[must_use]
    pub fn of(axis: &Axis, correction: Correction, prior: Prior) -> Self {
        Self {
            correction,
            prior,
            noise: axis.typical_noise(),
            hysteresis_dps: axis.bias.hysteresis_dps.unwrap_or(0.0),
            earth_dps: 0.0,
            least_turn_dps: Self::LEAST_TURN_DPS,
            power_up_dps: Self::POWER_UP_DPS,
        }
    }
}

/// The motion of the part, as far as one axis shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// The part moves, or its readings cannot be believed.
    #[default]
    Moving,
    /// The part is quiet, for too short a time to say more.
    Quiet,
    /// The part rests, and its bias is learned.
    Rest,
    /// The part is quiet, but at a level that a slow turn explains better than a change of the bias.
    Doubtful,
}

/// The present estimate of the bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// Bias beyond the calibration, °/s.
    pub change_dps: f64,
    /// Standard uncertainty of the bias with its flicker, °/s, at rest or turning.
    pub u_dps: f64,
    /// The motion of the part.
    pub phase: Phase,
}

/// Counts since the tracker began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Seconds of rest from which the tracker learned.
    pub learned_s: u32,
    /// Quiet seconds whose level a slow turn explains better.
    pub doubtful_s: u32,
    /// Times that a turn began within a rest, and the last learning was dropped.
    pub rolled_back: u32,
}

/// The state that outlives a power-down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saved {
    /// Bias and covariance.
    pub filter: Filter,
    /// Counts so far.
    pub counts: Counts,
}

/// A saved state is impossible: not finite, or with an impossible covariance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unsound;

/// A mean that is being made.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    rate_dps: f64,
    d_c: f64,
    quads: u32,
}

/// A quiet stretch so far. The filter holds what it would teach if it were rest, and this holds the knowledge before
/// it.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    before: Filter,
    /// Sum over its seconds of the means less their expected values.
    innovation_dps_s: f64,
    seconds: u32,
    /// Probability that it was rest.
    probability: f64,
    /// States to go back to, oldest first, each with its seconds and the seconds since.
    kept: [Kept; KEPT],
    kept_count: usize,
    means: u32,
}

#[derive(Clone, Copy, Debug)]
struct Kept {
    filter: Filter,
    innovation_dps_s: f64,
    seconds: u32,
    age_s: u32,
}

/// Tracks the bias of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Tracker {
    config: TrackerConfig,
    drift: Drift,
    filter: Filter,
    quiet: Quiet,
    stretch: Stretch,
    sum: Sum,
    /// The newest quad waits for one more: a motion that ends a rest may have begun in it.
    newest: Option<(f64, f64)>,
    temp_c: Option<f64>,
    blocks: u32,
    phase: Phase,
    moves: bool,
    counts: Counts,
}

impl Stretch {
    fn after(filter: &Filter) -> Self {
        let none = Kept { filter: *filter, innovation_dps_s: 0.0, seconds: 0, age_s: 0 };
        Self {
            before: *filter,
            innovation_dps_s: 0.0,
            seconds: 0,
            probability: 1.0,
            kept: [none; KEPT],
            kept_count: 0,
            means: 0,
        }
    }

    /// Keeps the state before every second mean.
    fn keep(&mut self, filter: &Filter) {
        if self.means.is_multiple_of(MEANS_PER_KEPT) {
            if self.kept_count == KEPT {
                self.kept.rotate_left(1);
                self.kept_count -= 1;
            }
            let (innovation_dps_s, seconds) = (self.innovation_dps_s, self.seconds);
            if let Some(place) = self.kept.get_mut(self.kept_count) {
                *place = Kept { filter: *filter, innovation_dps_s, seconds, age_s: 0 };
                self.kept_count += 1;
            }
        }
        self.means = self.means.wrapping_add(1);
    }

    fn second(&mut self, drift: &Drift) {
        self.before.wait(1.0, drift);
        self.kept.iter_mut().for_each(|kept| kept.age_s = kept.age_s.saturating_add(1));
    }

    /// Judges the probability of rest by the whole stretch.
    fn judge(&mut self, d_c: f64, least_turn_dps: f64, drift: &Drift) {
        let length_s = f64::from(self.seconds);
        let expected = self.before.innovation(0.0, length_s, d_c, drift);
        let seen = Innovation { dps: self.innovation_dps_s / length_s, ..expected };
        self.probability = if self.seconds == 0 { 1.0 } else { level::rest_probability(&seen, least_turn_dps) };
    }
}

impl Tracker {
    /// Makes a tracker that begins from the calibration.
    #[must_use]
    pub fn new(config: TrackerConfig) -> Self {
        let tempco_dps_per_c = config.correction.btc_dps_per_c;
        let drift = Drift::new(&config.noise, tempco_dps_per_c, config.hysteresis_dps);
        let filter = Filter::new(&config.prior, &drift);
        Self {
            drift,
            filter,
            quiet: Quiet::new(&config.noise),
            stretch: Stretch::after(&filter),
            sum: Sum::default(),
            newest: None,
            temp_c: None,
            blocks: 0,
            phase: Phase::Moving,
            moves: false,
            counts: Counts::default(),
            config,
        }
    }

    /// Makes a tracker that continues from a saved state after a power-down of `off_s` seconds.
    ///
    /// # Errors
    /// The state is impossible.
    pub fn resume(config: TrackerConfig, saved: &Saved, off_s: f64) -> Result<Self, Unsound> {
        if !(saved.filter.is_sound() && off_s >= 0.0 && off_s.is_finite()) {
            return Err(Unsound);
        }
        let new = Self { filter: saved.filter, counts: saved.counts, ..Self::new(config) };
        Ok(new.aged(off_s))
    }

    /// Ages the tracker for a part that was switched on anew, this many seconds after the calibration.
    #[must_use]
    pub fn aged(mut self, since_s: f64) -> Self {
        self.filter.wait(since_s.max(0.0), &self.drift);
        self.filter.jolt(self.config.power_up_dps);
        self.stretch = Stretch::after(&self.filter);
        self
    }

    /// Returns the state to keep for [`Tracker::resume`].
    #[must_use]
    pub fn save(&self) -> Saved {
        Saved { filter: self.known(), counts: self.counts() }
    }

    /// Takes in the mean rate, °/s, and the mean temperature, °C, of the next [`BLOCK_S`]. They are none if they are
    /// missing. A rate without a temperature takes the last one. `still`: no other axis of the part
    /// [moves](Self::moves).
    pub fn push(&mut self, rate_dps: Option<f64>, temp_c: Option<f64>, still: bool) -> Phase {
        self.blocks += 1;
        if self.blocks == BLOCKS_PER_S {
            self.blocks = 0;
            self.filter.wait(1.0, &self.drift);
            self.stretch.second(&self.drift);
        }
        self.temp_c = temp_c.or(self.temp_c);
        let temp_c = self.temp_c.unwrap_or(f64::NAN);
        let rate_dps = rate_dps.map(|rate| self.config.correction.apply(rate, temp_c) - self.config.earth_dps);
        let seen = self.quiet.push(rate_dps, temp_c - self.config.correction.t3_c);
        self.moves = matches!(seen, Seen::Moving | Seen::Step);
        match seen {
            Seen::Quad(rate_dps, d_c) if still => self.quad((rate_dps, d_c)),
            Seen::Step if still => self.go_back(),
            Seen::Open if still => {}
            _ => {
                self.quiet.begin_anew();
                self.end();
            }
        }
        self.phase
    }

    /// Whether the last mean showed that this axis moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.moves
    }

    /// Lets time pass without a reading.
    pub fn wait(&mut self, seconds: f64) {
        self.quiet.begin_anew();
        self.end();
        self.filter.wait(seconds.max(0.0), &self.drift);
        self.stretch = Stretch::after(&self.filter);
    }

    /// Estimates the bias at a temperature, °C.
    #[must_use]
    pub fn tracked(&self, temp_c: f64) -> Tracked {
        let (d_c, p) = (temp_c - self.config.correction.t3_c, self.stretch.probability);
        let (rest_dps, rest_dps2) = self.filter.change(d_c, &self.drift);
        let (turn_dps, turn_dps2) = self.stretch.before.change(d_c, &self.drift);
        let apart_dps = rest_dps - turn_dps;
        let dps2 = p * rest_dps2 + (1.0 - p) * turn_dps2 + p * (1.0 - p) * apart_dps * apart_dps;
        Tracked { change_dps: turn_dps + p * apart_dps, u_dps: sd(dps2), phase: self.phase }
    }

    /// Corrects a rate, °/s, by the calibration and the tracked bias.
    #[must_use]
    pub fn correct(&self, rate_dps: f64, temp_c: f64) -> f64 {
        self.config.correction.apply(rate_dps, temp_c) - self.tracked(temp_c).change_dps
    }

    /// Counts so far, including the present rest.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let mut counts = self.counts;
        let of = if self.stretch.probability < 0.5 { &mut counts.doubtful_s } else { &mut counts.learned_s };
        *of = of.saturating_add(self.stretch.seconds);
        counts
    }

    fn known(&self) -> Filter {
        self.filter.mixed(self.stretch.probability, &self.stretch.before)
    }

    fn quad(&mut self, quad: (f64, f64)) {
        if self.phase == Phase::Moving {
            self.phase = Phase::Quiet;
        }
        if let Some((rate_dps, d_c)) = self.newest.replace(quad) {
            let Sum { rate_dps: rates_dps, d_c: sum_c, quads } = self.sum;
            self.sum = Sum { rate_dps: rates_dps + rate_dps, d_c: sum_c + d_c, quads: quads + 1 };
        }
        if self.sum.quads == QUADS_PER_MEAN {
            self.take();
        }
    }

    /// Takes a mean in as if it were one at rest, and judges the stretch anew.
    fn take(&mut self) {
        let Sum { rate_dps, d_c, quads } = core::mem::take(&mut self.sum);
        let (count, seconds) = (f64::from(quads), quads * QUAD_S);
        let (mean_dps, d_c, length_s) = (rate_dps / count, d_c / count, f64::from(seconds));
        let expected = self.stretch.before.innovation(mean_dps, length_s, d_c, &self.drift);
        self.stretch.keep(&self.filter);
        self.stretch.innovation_dps_s += expected.dps * length_s;
        self.stretch.seconds += seconds;
        self.filter.learn(mean_dps, length_s, d_c, &self.drift);
        self.stretch.judge(d_c, self.config.least_turn_dps, &self.drift);
        self.phase = if self.stretch.probability < 0.5 { Phase::Doubtful } else { Phase::Rest };
    }

    /// Ends the stretch after a motion. All of it counts, except for the last quad.
    fn end(&mut self) {
        if self.sum.quads > 0 {
            self.take();
        }
        self.close(Phase::Moving);
    }

    /// Handles a step within a stretch: a turn has begun or ended. The learning since its earliest beginning is
    /// dropped.
    fn go_back(&mut self) {
        if self.stretch.kept_count > 0 {
            let Kept { filter, innovation_dps_s, seconds, age_s } = self.stretch.kept[0];
            self.filter = filter;
            self.filter.wait(f64::from(age_s), &self.drift);
            (self.stretch.innovation_dps_s, self.stretch.seconds) = (innovation_dps_s, seconds);
            self.stretch.judge(self.filter.at_c, self.config.least_turn_dps, &self.drift);
            self.counts.rolled_back = self.counts.rolled_back.saturating_add(1);
        }
        self.close(Phase::Quiet);
    }

    /// Closes the stretch. Its learning counts by the probability that it was rest.
    fn close(&mut self, phase: Phase) {
        self.counts = self.counts();
        self.filter = self.known();
        self.stretch = Stretch::after(&self.filter);
        (self.sum, self.newest, self.phase) = (Sum::default(), None, phase);
    }
}
