//! Tracks the bias whenever the part is at rest, and saves the learned state for the next run.

use super::{Listener, TrackedRow};
use crate::output::{Outputs, Slot};
use crate::warning::JobWarning;
use anyhow::{Context, Result, anyhow, bail};
use jiff::{SignedDuration, Timestamp};
use std::io::ErrorKind;
use std::path::PathBuf;
use zerorate::health::Judged;
use zerorate::track::{BLOCK_S, Counts, Phase, TrackFile, Tracked, Tracker, TrackerConfig};
use zerorate::{Calibration, CodeSum, Part, Scale};
use zerorate_host::DeviceInfo;
use zerorate_input::limits;

/// The settings for tracking the bias, and the file for the learned state.
#[derive(Clone, Debug)]
pub struct TrackOptions {
    /// The file of the saved state; `None` to save nothing.
    pub state: Option<PathBuf>,
    /// The Earth's rotation that a part at rest measures beyond its calibrated bias, °/s.
    pub earth_dps: f64,
    /// The slowest steady rotation that must not be learned as bias, °/s.
    pub least_turn_dps: f64,
    /// The change of the bias from one power-up to the next (1 σ), °/s.
    pub power_up_dps: f64,
}

/// A saved state that cannot be used. The user deletes it, or names another file.
#[derive(Debug, thiserror::Error)]
#[error("{0:#}")]
pub struct UnusableState(pub anyhow::Error);

/// The tracked bias of an axis at a row.
#[derive(Clone, Copy, Debug)]
pub struct TrackedAxis {
    /// The tracked bias, °/s.
    pub bias_dps: f64,
    /// The change of the bias since the calibration, and its uncertainty.
    pub tracked: Tracked,
}

/// The learned bias of an axis.
#[derive(Debug)]
pub struct LearnedAxis<'a> {
    /// The name of the axis.
    pub name: &'a str,
    /// Counts since tracking began, over all power-ups.
    pub counts: Counts,
    /// The change of the bias since the calibration, at the last temperature; `None` without a temperature.
    pub tracked: Option<Tracked>,
}

/// Period at which the state is saved, s by the time stamps of the samples.
const SAVE_EVERY_S: u64 = 60;
const BLOCK_NS: u64 = (BLOCK_S * 1e9) as u64;

/// The trackers of all axes of a part.
pub struct Tracking {
    trackers: Vec<Tracker>,
    scales: Vec<Scale>,
    temp_scale: Option<Scale>,
    names: Vec<String>,
    phases: Vec<Phase>,
    /// Index of the current block of `BLOCK_S` seconds, counted from the first sample.
    block: u64,
    rates: Vec<CodeSum>,
    temp: CodeSum,
    lost: bool,
    store: Option<Store>,
    saved_s: u64,
}

struct Store {
    slot: Slot,
    calibration: Calibration,
    /// The wall-clock time at the first sample, if it is known.
    began: Option<Timestamp>,
    /// True if the latest state could not be saved.
    is_behind: bool,
}

impl Tracking {
    /// Starts tracking the part in `facts`, from its saved state if there is one, or else from its calibration.
    ///
    /// # Errors
    /// Returns [`UnusableState`] if the saved state cannot be used, or an error if an axis has no calibration or no
    /// known noise, or if the state cannot be read or written.
    pub fn begin(
        options: &TrackOptions,
        facts: &DeviceInfo,
        calibration: &Calibration,
        outputs: &mut Outputs,
        warn: &mut dyn FnMut(JobWarning),
    ) -> Result<Self> {
        let part = &facts.part;
        let began: Option<Timestamp> = facts.info.created.parse().ok();
        let configs = options.configs(part, calibration)?;
        let names: Vec<String> = part.axes.iter().map(|axis| axis.name.to_string()).collect();
        let slot = options.state.as_deref().map(|path| outputs.slot(path)).transpose()?;
        let store = slot.map(|slot| Store { slot, calibration: calibration.clone(), began, is_behind: false });
        let known = store.as_ref().map(Store::load).transpose()?.flatten();
        let trackers = match &known {
            Some(file) => taken_up(file, calibration, &names, &configs, began, warn).map_err(UnusableState)?,
            None => {
                let age_s = since(calibration.created.as_deref(), began).unwrap_or(0.0);
                configs.iter().map(|config| Tracker::new(*config).aged(age_s)).collect()
            }
        };
        let mut tracking = Self {
            phases: vec![Phase::Moving; trackers.len()],
            rates: vec![CodeSum::default(); trackers.len()],
            trackers,
            scales: part.axes.iter().map(|axis| axis.axis.rate).collect(),
            temp_scale: part.axes.first().map(|first| first.axis.temp),
            names,
            block: 0,
            temp: CodeSum::default(),
            lost: false,
            store,
            saved_s: 0,
        };
        // a file that cannot be written is then reported before the stream starts
        tracking.save(0)?;
        Ok(tracking)
    }
}

impl TrackOptions {
    fn configs(&self, part: &Part, calibration: &Calibration) -> Result<Vec<TrackerConfig>> {
        let &Self { earth_dps, least_turn_dps, power_up_dps, .. } = self;
        let config = |axis: &zerorate::NamedAxis| {
            let calibrated = calibration.axis(&axis.name).ok_or_else(|| anyhow!("no axis {}", axis.name))?;
            let config = TrackerConfig::of_calibration(calibrated, &axis.axis).ok_or_else(|| {
                anyhow!(
                    "neither the calibration nor the part says how noisy axis {} is, and rest is told by that: \
                     state the noise in the part's file (docs/formats/part.md)",
                    axis.name
                )
            })?;
            Ok(TrackerConfig { earth_dps, least_turn_dps, power_up_dps, ..config })
        };
        part.axes.iter().map(config).collect()
    }
}

/// `None` if one of the times is unknown.
fn since(from: Option<&str>, to: Option<Timestamp>) -> Option<f64> {
    let from: Timestamp = from?.parse().ok()?;
    Some(to?.duration_since(from).as_secs_f64())
}

/// Restores the trackers from the file. Their uncertainty grows with the time since the file was saved.
fn taken_up(
    file: &TrackFile,
    calibration: &Calibration,
    names: &[String],
    configs: &[TrackerConfig],
    began: Option<Timestamp>,
    warn: &mut dyn FnMut(JobWarning),
) -> Result<Vec<Tracker>> {
    let off_s = since(file.saved.as_deref(), began);
    match off_s {
        Some(off_s) if off_s < 0.0 => bail!(
            "it was written {:.0} s after this run began: the state is of a later time, or a clock is wrong",
            -off_s
        ),
        Some(_) => {}
        None => warn(JobWarning::StateAgeUnknown),
    }
    let tracker = |(name, config): (&String, &TrackerConfig)| {
        let saved = file.of(calibration, name)?;
        Tracker::resume(*config, &saved, off_s.unwrap_or(0.0))
            .map_err(|_| anyhow!("its numbers of axis {name} are not a covariance"))
    };
    names.iter().zip(configs).map(tracker).collect()
}

impl Store {
    fn load(&self) -> Result<Option<TrackFile>> {
        let path = self.slot.path();
        let text = match self.slot.content(limits::TEXT) {
            Ok(Some(text)) => text,
            Ok(None) => return Ok(None),
            Err(error) if matches!(error.kind(), ErrorKind::InvalidData | ErrorKind::FileTooLarge) => {
                return Err(UnusableState(error.into()).into());
            }
            Err(error) => return Err(error).with_context(|| format!("cannot read {}", path.display())),
        };
        Ok(Some(TrackFile::parse(&text).map_err(|error| UnusableState(error.into()))?))
    }
}

impl Tracking {
    /// Adds the next sample of all axes.
    #[inline]
    pub fn push(&mut self, t_ns: u64, axes: &[Judged], listener: &mut dyn Listener) {
        let block = t_ns / BLOCK_NS;
        if block != self.block {
            self.close(block, listener);
        }
        for (sum, judged) in self.rates.iter_mut().zip(axes) {
            if let Some(rate) = judged.rate() {
                sum.push(rate);
            }
        }
        if let Some(first) = axes.first() {
            if let Some(temp) = first.temp() {
                self.temp.push(temp);
            }
            self.lost |= first.reading.lost > MOST_LOST;
        }
    }

    /// Evaluates the finished block and starts the block `next`.
    #[cold]
    fn close(&mut self, next: u64, listener: &mut dyn Listener) {
        let temp_c = self.temp_scale.and_then(|scale| self.temp.mean(&scale));
        let (whole, moved) = (!self.lost, self.trackers.iter().map(Tracker::moves).collect::<Vec<_>>());
        for axis in 0..self.trackers.len() {
            let rate_dps = self.rates[axis].mean(&self.scales[axis]).filter(|_| whole);
            let still = moved.iter().enumerate().all(|(other, moved)| other == axis || !moved);
            self.phases[axis] = self.trackers[axis].push(rate_dps, temp_c, still);
            if next > self.block + 1 {
                self.trackers[axis].wait((next - self.block - 1) as f64 * BLOCK_S);
            }
        }
        self.rates.fill(CodeSum::default());
        (self.temp, self.lost, self.block) = (CodeSum::default(), false, next);
        let now_s = next * BLOCK_NS / 1_000_000_000;
        if now_s >= self.saved_s + SAVE_EVERY_S {
            self.saved_s = now_s;
            self.save_or_warn(now_s, listener);
        }
    }

    /// Saves the state. A failure does not end the stream, because the disk may have space again a minute later.
    fn save_or_warn(&mut self, after_s: u64, listener: &mut dyn Listener) {
        let saved = self.save(after_s);
        let Some(store) = &mut self.store else { return };
        let was_behind = std::mem::replace(&mut store.is_behind, saved.is_err());
        match saved {
            Err(error) if !was_behind => {
                listener.warn(JobWarning::StateNotKept { why: format!("{error:#}"), again_s: SAVE_EVERY_S });
            }
            Ok(()) if was_behind => listener.kept_again(store.slot.path()),
            _ => {}
        }
    }

    /// The tracked bias of each axis at `temp_c`, and the state of motion. `correction_dps` returns the calibrated
    /// correction of an axis at this temperature, °/s.
    pub fn row(&self, temp_c: f64, correction_dps: impl Fn(usize) -> f64) -> TrackedRow {
        let axis = |(axis, tracker): (usize, &Tracker)| {
            let tracked = tracker.tracked(temp_c);
            TrackedAxis { tracked, bias_dps: tracked.change_dps - correction_dps(axis) }
        };
        let phase = self.phases.iter().copied().min_by_key(|phase| *phase as u8).unwrap_or_default();
        TrackedRow {
            axes: self.trackers.iter().enumerate().map(axis).collect(),
            phase: match phase {
                Phase::Moving => "moving",
                Phase::Quiet => "quiet",
                Phase::Rest if self.phases.contains(&Phase::Doubtful) => "doubtful",
                Phase::Rest => "rest",
                Phase::Doubtful => "doubtful",
            },
        }
    }

    fn save(&mut self, after_s: u64) -> Result<()> {
        let Some(store) = &mut self.store else { return Ok(()) };
        let passed = SignedDuration::from_secs(after_s as i64);
        let saved = store.began.and_then(|began| began.checked_add(passed).ok()).map(|now| now.to_string());
        let axes = self.names.iter().map(String::as_str).zip(self.trackers.iter().map(Tracker::save));
        let text = TrackFile::new(&store.calibration, saved, axes).to_toml();
        Ok(store.slot.put(text.as_bytes())?)
    }

    /// Saves the learned state and reports it to `listener`.
    pub fn finish(&mut self, temp_c: Option<f64>, listener: &mut dyn Listener) -> Result<()> {
        let saved = self.save(self.block * BLOCK_NS / 1_000_000_000);
        for (name, tracker) in self.names.iter().zip(&self.trackers) {
            let counts = tracker.save().counts;
            let tracked = temp_c.map(|temp_c| tracker.tracked(temp_c));
            listener.learned(&LearnedAxis { name, counts, tracked });
            if counts.doubtful_s > 0 {
                listener.warn(JobWarning::SlowTurn { axis: name.clone(), doubtful_s: counts.doubtful_s });
            }
        }
        saved
    }
}

/// A block with more samples lost in a row than this is discarded.
const MOST_LOST: u32 = 100;
