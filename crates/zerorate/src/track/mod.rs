//! Tracking of the bias: it is learned at rest and predicted in between, on fixed memory.
//!
//! A [`Tracker`] takes means over [`BLOCK_S`] of one axis. It detects rest from the rate alone (`rest.rs`), and
//! follows the bias that the calibration leaves with a Kalman filter (`filter.rs`). A level may also be a slow
//! rotation (`level.rs`), so the tracker keeps a few hypotheses (`hypothesis_bank.rs`), and merges them into its
//! estimate (`estimate.rs`).
//! `docs/tracking.md` derives the limits and states what was measured. The tracker uses neither a clock nor
//! allocation.
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

mod estimate;
#[cfg(feature = "file")]
mod file;
mod filter;
mod hypothesis_bank;
mod level;
mod rest;

#[cfg(feature = "file")]
pub use file::{TrackFile, TrackFileError};
pub use filter::{COVARIANCES, Filter, Prior, STATES};
pub use level::RestPrior;
pub use rest::BLOCK_S;

use crate::correction::{Correction, CorrectionF32};
use crate::noise::NoiseModel;
use crate::part::Axis;
use estimate::Estimate;
use filter::Drift;
use hypothesis_bank::HypothesisBank;
use rest::{BLOCKS_PER_S, MOST_LATE, Quiet, Seen};

/// Largest number of windows in a mean that is learned from: 16 s.
const WINDOWS_PER_MEAN: u32 = 4;

/// The configuration of a tracker: the calibration, the part's noise, and the limits of the tracking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerConfig {
    /// The calibration.
    pub correction: Correction,
    /// Uncertainty of the calibration.
    pub prior: Prior,
    /// The part's noise: white noise, flicker, and the random walk that drives the bias.
    pub noise: NoiseModel,
    /// Half width of the hysteresis, °/s. It is zero if it is not known.
    pub hysteresis_dps: f64,
    /// Component of the Earth's rotation on the axis, °/s (F-16), if the calibration has subtracted it from the bias.
    /// Otherwise zero. It must be the same wherever the part rests.
    pub earth_dps: f64,
    /// The slowest rotation that must not be taken for bias, °/s.
    pub least_turn_dps: f64,
    /// Change of the bias from one power-up to the next, °/s (1 σ).
    pub power_up_dps: f64,
}

impl TrackerConfig {
    /// Default of `least_turn_dps`, °/s. It is a choice.
    pub const LEAST_TURN_DPS: f64 = 0.02;
    /// Default of `power_up_dps`, °/s. It is a choice, because no source states a value for the ADIS16130: about six
    /// times the floor of its flicker (M-04).
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
    /// The part moves, or its readings are not valid.
    #[default]
    Moving,
    /// The part is quiet, for too short a time to say more.
    Quiet,
    /// The part rests, and its bias is learned.
    Rest,
    /// The part is quiet, but at a level that a slow rotation explains better than a change of the bias.
    Doubtful,
}

/// The present estimate of the bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// Slow bias that the calibration leaves, without flicker, °/s.
    pub change_dps: f64,
    /// Standard uncertainty of `change_dps`, °/s. It holds whether the part rests or rotates.
    pub u_dps: f64,
    /// The motion of the part.
    pub phase: Phase,
}

/// Counts since tracking began, over all power-ups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Seconds of rest from which the tracker learned.
    pub learned_s: u32,
    /// Quiet seconds whose level a slow rotation explains better.
    pub doubtful_s: u32,
    /// Number of times that a rotation began within a rest, so that the last learning was dropped.
    pub rolled_back: u32,
}

/// The state that outlives a power-down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saved {
    /// Bias and covariance, of all hypotheses together.
    pub filter: Filter,
    /// Prior probability of rest, from the quiet periods.
    pub rest_prior: RestPrior,
    /// Counts so far.
    pub counts: Counts,
}

/// The error for a saved state or a time without power that is impossible, such as a negative variance or NaN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unsound;

/// Tracks the bias of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Tracker {
    config: TrackerConfig,
    correction: CorrectionF32,
    least_turn_dps: f32,
    drift: Drift,
    bank: HypothesisBank,
    estimate: Estimate,
    /// Seconds that have passed since the hypothesis bank was last brought up to date.
    due_s: u32,
    quiet: Quiet,
    /// Number of windows of the quiet period that were learned from. `sure` of these windows are too old for a
    /// rotation to have begun in them.
    taken: u32,
    sure: u32,
    temp_c: Option<f32>,
    blocks: u32,
    phase: Phase,
    moves: bool,
    counts: Counts,
}

impl Tracker {
    /// Makes a tracker that begins from the calibration.
    #[must_use]
    pub fn new(config: TrackerConfig) -> Self {
        let tempco_dps_per_c = config.correction.btc_dps_per_c;
        let drift = Drift::new(&config.noise, tempco_dps_per_c, config.hysteresis_dps);
        let bank = HypothesisBank::new(&Filter::new(&config.prior, &drift), RestPrior::EVEN);
        let least_turn_dps = config.least_turn_dps as f32;
        Self {
            correction: config.correction.to_f32(),
            least_turn_dps,
            drift,
            estimate: Estimate::new(&bank.known(), bank.rest_prior.rotation_excess(), least_turn_dps),
            bank,
            due_s: 0,
            quiet: Quiet::new(&config.noise),
            taken: 0,
            sure: 0,
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
    /// Returns [`Unsound`] if the state or `off_s` is impossible.
    pub fn resume(config: TrackerConfig, saved: &Saved, off_s: f64) -> Result<Self, Unsound> {
        if !(saved.filter.is_sound() && saved.rest_prior.is_sound() && off_s >= 0.0 && off_s.is_finite()) {
            return Err(Unsound);
        }
        let bank = HypothesisBank::new(&saved.filter, saved.rest_prior);
        let new = Self { bank, counts: saved.counts, ..Self::new(config) };
        Ok(new.aged(off_s))
    }

    /// Ages the tracker for a part that was switched on anew, `since_s` seconds after the calibration or saved state.
    #[must_use]
    pub fn aged(mut self, since_s: f64) -> Self {
        self.bank.wait(since_s, &self.drift);
        self.bank.inflate_bias_variance(self.config.power_up_dps);
        self.prepare();
        self
    }

    /// Returns the state to keep for [`Tracker::resume`].
    #[must_use]
    pub fn save(&self) -> Saved {
        let mut filter = self.bank.known();
        filter.wait(&self.drift.over(f64::from(self.due_s)));
        Saved { filter, rest_prior: self.bank.rest_prior, counts: self.counts() }
    }

    /// Takes in the mean rate, °/s, and the mean temperature, °C, over the next [`BLOCK_S`] seconds. A missing mean is
    /// `None`. A rate without a temperature takes the last temperature. `still` means that no other axis of the part
    /// [moves](Self::moves).
    pub fn push(&mut self, rate_dps: Option<f64>, temp_c: Option<f64>, still: bool) -> Phase {
        self.blocks += 1;
        if self.blocks == BLOCKS_PER_S {
            self.blocks = 0;
            self.due_s = self.due_s.saturating_add(1);
        }
        self.temp_c = temp_c.map(|temp_c| temp_c as f32).or(self.temp_c);
        let temp_c = self.temp_c.unwrap_or(f32::NAN);
        let earth_dps = self.config.earth_dps as f32;
        let rate_dps = rate_dps.map(|rate| self.correction.apply(rate as f32, temp_c) - earth_dps);
        let seen = self.quiet.push(rate_dps, temp_c - self.correction.t3_c);
        self.moves = matches!(seen, Seen::Moving | Seen::Step(_));
        match seen {
            Seen::Window if still => self.window(),
            Seen::Step(late) if still => self.step(late),
            Seen::Open if still => {}
            _ => self.end(),
        }
        self.phase
    }

    /// Whether the last mean showed that this axis moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.moves
    }

    /// Lets `seconds` pass without a reading. This ends the present quiet period.
    pub fn wait(&mut self, seconds: f64) {
        self.end();
        self.pass();
        self.bank.wait(seconds, &self.drift);
        self.prepare();
    }

    /// Estimates the bias at a temperature, °C.
    #[must_use]
    pub fn tracked(&self, temp_c: f64) -> Tracked {
        let d_c = temp_c as f32 - self.correction.t3_c;
        let (change_dps, u_dps) = self.estimate.at(d_c, self.due_s as f32, &self.drift);
        Tracked { change_dps: f64::from(change_dps), u_dps: f64::from(u_dps), phase: self.phase }
    }

    /// Corrects a rate, °/s, by the calibration and the tracked bias.
    #[must_use]
    pub fn correct(&self, rate_dps: f64, temp_c: f64) -> f64 {
        self.config.correction.apply(rate_dps, temp_c) - self.tracked(temp_c).change_dps
    }

    /// Counts so far, including the present quiet period.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let mut counts = self.counts;
        let of = if self.is_doubtful() { &mut counts.doubtful_s } else { &mut counts.learned_s };
        *of = of.saturating_add(self.bank.seconds as u32);
        counts
    }

    fn is_doubtful(&self) -> bool {
        self.bank.rest().is_some_and(|rest| rest < 0.5)
    }

    fn window(&mut self) {
        if self.phase == Phase::Moving {
            self.phase = Phase::Quiet;
        }
        let windows = self.quiet.windows();
        // the newest window waits for one more: a motion that ends a rest may have begun in it
        if windows > self.taken + WINDOWS_PER_MEAN {
            self.take_until(windows - 1);
            self.judge();
        }
        if windows > self.sure + WINDOWS_PER_MEAN + MOST_LATE - 2 {
            let mean = self.quiet.mean(windows - self.sure - WINDOWS_PER_MEAN, WINDOWS_PER_MEAN);
            self.sure += WINDOWS_PER_MEAN;
            self.bank.make_sure(&mean, &self.drift);
        }
    }

    /// Learns from the windows of the quiet period up to `end`, in means of up to 16 s.
    fn take_until(&mut self, end: u32) {
        self.pass();
        while self.taken < end {
            let windows = WINDOWS_PER_MEAN.min(end - self.taken);
            let mean = self.quiet.mean(self.quiet.windows() - self.taken - windows, windows);
            self.taken += windows;
            self.bank.take(&mean, &self.drift);
        }
    }

    fn judge(&mut self) {
        self.bank.judge(self.least_turn_dps, &self.drift);
        self.phase = if self.is_doubtful() { Phase::Doubtful } else { Phase::Rest };
        self.prepare();
    }

    /// Brings the hypothesis bank to the present time.
    fn pass(&mut self) {
        self.bank.wait(f64::from(core::mem::take(&mut self.due_s)), &self.drift);
    }

    fn prepare(&mut self) {
        self.estimate = Estimate::new(&self.bank.known(), self.bank.rest_prior.rotation_excess(), self.least_turn_dps);
    }

    /// Ends the quiet period after a motion. All of its windows count, except for the last one.
    fn end(&mut self) {
        self.close(self.quiet.windows().saturating_sub(1), Phase::Moving);
        self.quiet.begin_anew();
    }

    /// Handles a step within a quiet period: a rotation has begun or ended in its last windows, which are dropped.
    fn step(&mut self, late: u32) {
        let end = self.quiet.windows().saturating_sub(late);
        if end < self.taken {
            self.pass();
            self.bank.go_back();
            self.taken = self.sure;
            self.counts.rolled_back = self.counts.rolled_back.saturating_add(1);
        }
        self.close(end, Phase::Quiet);
        self.quiet.begin_stretch();
    }

    /// Closes the quiet period after window `end`. Its learning counts by the probability that it was rest.
    fn close(&mut self, end: u32, phase: Phase) {
        if self.quiet.windows() > 0 {
            self.take_until(end);
            self.bank.judge(self.least_turn_dps, &self.drift);
            self.counts = self.counts();
            self.bank.close(&self.drift);
            self.prepare();
        }
        (self.taken, self.sure, self.phase) = (0, 0, phase);
    }
}
