//! `stream --track`: the bias that is learned whenever the part rests, and its state between runs.

use crate::exit::Usage;
use crate::output::{Outputs, Slot, say, warn};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use jiff::{SignedDuration, Timestamp};
use serde::Serialize;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use zerorate::health::Judged;
use zerorate::track::{BLOCK_S, Counts, Phase, TrackFile, Tracker, TrackerConfig};
use zerorate::{Calibration, CodeSum, Part, Scale};
use zerorate_record::limits;

/// Options of tracking.
#[derive(Args, Debug)]
pub struct TrackArgs {
    /// Learn the bias whenever the part rests, and correct with it: the rows have the columns bias_dps, u_bias_dps
    /// (NAME_ before each, of several axes) and phase as well. phase is moving, quiet, rest or doubtful, which is as
    /// quiet as rest but may be a slow turn.
    #[arg(long)]
    track: bool,

    /// What was learned is kept in this file: written every minute and at the end, taken up at the start. It is made
    /// where there is none.
    #[arg(long, value_name = "FILE", requires = "track")]
    state: Option<PathBuf>,

    /// Component of the Earth's rotation on the axis at rest, °/s, where the calibration has taken it out as well: at
    /// most 0.0042 [default: that of the calibration].
    #[arg(long, value_name = "DPS", requires = "track", allow_negative_numbers = true)]
    earth_dps: Option<f64>,

    /// The slowest steady turn that must not be learned as bias.
    #[arg(long, value_name = "DPS", requires = "track", default_value_t = TrackerConfig::LEAST_TURN_DPS)]
    least_turn_dps: f64,

    /// How far the bias changes from one power-up to the next (1 σ): every start counts as one.
    #[arg(long, value_name = "DPS", requires = "track", default_value_t = TrackerConfig::POWER_UP_DPS)]
    power_up_dps: f64,
}

/// How often the state is written, s of the part's time.
const SAVE_EVERY_S: u64 = 60;
const BLOCK_NS: u64 = (BLOCK_S * 1e9) as u64;

/// The trackers of all axes of a part.
pub struct Tracking {
    trackers: Vec<Tracker>,
    scales: Vec<Scale>,
    temp_scale: Option<Scale>,
    names: Vec<String>,
    phases: Vec<Phase>,
    /// Of the block that is being read.
    block: u64,
    rates: Vec<CodeSum>,
    temp: CodeSum,
    lost: bool,
    store: Option<Store>,
    saved_s: u64,
}

/// Where the state is kept.
struct Store {
    slot: Slot,
    calibration: Calibration,
    /// The time of day at the first sample, where there is one.
    began: Option<Timestamp>,
    /// What was learned last could not be written.
    is_behind: bool,
}

/// What a row says of the bias.
#[derive(Serialize)]
pub struct TrackedRow {
    /// Each with bias, u and their columns.
    #[serde(flatten, serialize_with = "by_name")]
    axes: Vec<(String, f64)>,
    phase: &'static str,
    #[serde(skip)]
    pub changes_dps: Vec<f64>,
}

fn by_name<S: serde::Serializer>(axes: &[(String, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(axes.iter().map(|(name, value)| (name, value)))
}

impl TrackedRow {
    pub fn csv(&self, out: &mut impl Write) -> io::Result<()> {
        for (_, value) in &self.axes {
            write!(out, ",{value:.6}")?;
        }
        write!(out, ",{}", self.phase)
    }
}

impl TrackArgs {
    /// Begins to track, if that is asked for; `created` is when the first sample was taken, as far as that is known.
    pub fn begin(
        &self,
        part: &Part,
        calibration: &Calibration,
        created: &str,
        outputs: &mut Outputs,
    ) -> Result<Option<Tracking>> {
        if !self.track {
            return Ok(None);
        }
        let began: Option<Timestamp> = created.parse().ok();
        let configs = self.configs(part, calibration)?;
        let names: Vec<String> = part.axes.iter().map(|axis| axis.name.to_string()).collect();
        let slot = self.state.as_deref().map(|path| outputs.slot(path)).transpose()?;
        let store = slot.map(|slot| Store { slot, calibration: calibration.clone(), began, is_behind: false });
        let known = store.as_ref().map(|store| store.load()).transpose()?.flatten();
        let trackers = match &known {
            Some(file) => {
                taken_up(file, calibration, &names, &configs, began).with_context(|| refusal(self.state.as_deref()))?
            }
            None => {
                let age_s = since(calibration.created.as_deref(), began).unwrap_or(0.0);
                configs.iter().map(|config| Tracker::new(*config).aged(age_s)).collect()
            }
        };
        let mut tracking = Tracking {
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
        // a file that cannot be written is better known now
        tracking.save(0)?;
        Ok(Some(tracking))
    }

    fn configs(&self, part: &Part, calibration: &Calibration) -> Result<Vec<TrackerConfig>> {
        let earth_dps = self.earth(calibration)?;
        for (name, value) in [("--least-turn-dps", self.least_turn_dps), ("--power-up-dps", self.power_up_dps)] {
            if !(1e-6..=100.0).contains(&value) {
                return Err(Usage(format!("{name} is {value}; it must lie between 0.000001 and 100 °/s")).into());
            }
        }
        let config = |axis: &zerorate::NamedAxis| {
            let calibrated = calibration.axis(&axis.name).ok_or_else(|| anyhow!("no axis {}", axis.name))?;
            let config = TrackerConfig::of_calibration(calibrated, &axis.axis).ok_or_else(|| {
                anyhow!(
                    "neither the calibration nor the part says how noisy axis {} is, and rest is told by that: \
                     state the noise in the part's file (docs/formats/part.md)",
                    axis.name
                )
            })?;
            let (least_turn_dps, power_up_dps) = (self.least_turn_dps, self.power_up_dps);
            Ok(TrackerConfig { earth_dps, least_turn_dps, power_up_dps, ..config })
        };
        part.axes.iter().map(config).collect()
    }

    /// The Earth's rotation that a part at rest shows beyond its calibrated bias.
    fn earth(&self, calibration: &Calibration) -> Result<f64> {
        let taken_out = calibration.run.and_then(|run| run.earth_dps);
        match (self.earth_dps, taken_out) {
            (Some(dps), _) if dps.is_nan() || dps.abs() > 0.0042 => {
                Err(Usage(format!("--earth-dps is {dps}; the Earth turns by 0.0042 °/s at most (F-16)")).into())
            }
            (Some(dps), None) if dps != 0.0 => Err(Usage(
                "--earth-dps: the calibration was made without it, so that its PBC holds the Earth's rotation \
                 already; leave it out, or calibrate with --earth-dps"
                    .to_owned(),
            )
            .into()),
            (given, taken_out) => Ok(given.or(taken_out).unwrap_or(0.0)),
        }
    }
}

fn refusal(path: Option<&Path>) -> String {
    let name = path.map(|path| path.display().to_string()).unwrap_or_default();
    format!(
        "{name} is no state that can be taken up; delete it to begin from the calibration, or name another --state"
    )
}

/// Seconds from a time of day to another; none where one of them is not known.
fn since(from: Option<&str>, to: Option<Timestamp>) -> Option<f64> {
    let from: Timestamp = from?.parse().ok()?;
    Some(to?.duration_since(from).as_secs_f64())
}

/// The trackers as they were left, with what may have happened since.
fn taken_up(
    file: &TrackFile,
    calibration: &Calibration,
    names: &[String],
    configs: &[TrackerConfig],
    began: Option<Timestamp>,
) -> Result<Vec<Tracker>> {
    let off_s = since(file.saved.as_deref(), began);
    match off_s {
        Some(off_s) if off_s < 0.0 => bail!(
            "it was written {:.0} s after what is read now began: a state of a later time, or a clock is wrong",
            -off_s
        ),
        Some(_) => {}
        None => warn(&["state-age-unknown: nothing tells how old the state is; it is taken as of now".to_owned()]),
    }
    let tracker = |(name, config): (&String, &TrackerConfig)| {
        let saved = file.of(calibration, name)?;
        Tracker::resume(*config, &saved, off_s.unwrap_or(0.0))
            .map_err(|_| anyhow!("its numbers of axis {name} are no covariance"))
    };
    names.iter().zip(configs).map(tracker).collect()
}

impl Store {
    /// The state that is there; none where there is no file.
    fn load(&self) -> Result<Option<TrackFile>> {
        let path = self.slot.path();
        let text = match self.slot.content(limits::TEXT) {
            Ok(Some(text)) => text,
            Ok(None) => return Ok(None),
            Err(error) if matches!(error.kind(), ErrorKind::InvalidData | ErrorKind::FileTooLarge) => {
                return Err(error).with_context(|| refusal(Some(path)));
            }
            Err(error) => return Err(error).with_context(|| format!("cannot read {}", path.display())),
        };
        TrackFile::parse(&text).map(Some).with_context(|| refusal(Some(path)))
    }
}

impl Tracking {
    /// Headings of the columns, each with a comma before it.
    pub fn headings(&self) -> String {
        let columns: String =
            (0..self.names.len()).map(|axis| format!(",{},{}", self.bias(axis), self.u(axis))).collect();
        columns + ",phase"
    }

    fn bias(&self, axis: usize) -> String {
        if self.names.len() == 1 { "bias_dps".to_owned() } else { format!("{}_bias_dps", self.names[axis]) }
    }

    fn u(&self, axis: usize) -> String {
        if self.names.len() == 1 { "u_bias_dps".to_owned() } else { format!("{}_u_bias_dps", self.names[axis]) }
    }

    /// Takes in the next sample of all axes.
    #[inline]
    pub fn push(&mut self, t_ns: u64, axes: &[Judged]) {
        let block = t_ns / BLOCK_NS;
        if block != self.block {
            self.close(block);
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

    /// The block is over, and the next one is this.
    #[cold]
    fn close(&mut self, next: u64) {
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
            self.save_or_say(now_s);
        }
    }

    /// The rows are worth more than the state: a disk may have room again within the next minute.
    fn save_or_say(&mut self, after_s: u64) {
        let saved = self.save(after_s);
        let Some(store) = &mut self.store else { return };
        let was_behind = std::mem::replace(&mut store.is_behind, saved.is_err());
        match saved {
            Err(error) if !was_behind => warn(&[format!(
                "not-kept: what was learned cannot be written: {error:#}; the rows go on, and it is tried again every \
                 {SAVE_EVERY_S} s"
            )]),
            Ok(()) if was_behind => say(format_args!("what was learned is in {} again", store.slot.path().display())),
            _ => {}
        }
    }

    /// What a row says, for rates that were corrected by `correction` alone.
    pub fn row(&self, temp_c: f64, corrections_dps: &[f64]) -> TrackedRow {
        let tracked: Vec<_> = self.trackers.iter().map(|tracker| tracker.tracked(temp_c)).collect();
        let axes = tracked.iter().zip(corrections_dps).enumerate().flat_map(|(axis, (tracked, correction_dps))| {
            [(self.bias(axis), tracked.change_dps - correction_dps), (self.u(axis), tracked.u_dps)]
        });
        let phase = self.phases.iter().copied().min_by_key(|phase| *phase as u8).unwrap_or_default();
        TrackedRow {
            axes: axes.collect(),
            phase: match phase {
                Phase::Moving => "moving",
                Phase::Quiet => "quiet",
                Phase::Rest if self.phases.contains(&Phase::Doubtful) => "doubtful",
                Phase::Rest => "rest",
                Phase::Doubtful => "doubtful",
            },
            changes_dps: tracked.iter().map(|tracked| tracked.change_dps).collect(),
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

    /// Keeps what was learned, and says what that was.
    pub fn finish(&mut self, temp_c: Option<f64>) -> Result<()> {
        let saved = self.save(self.block * BLOCK_NS / 1_000_000_000);
        for (name, tracker) in self.names.iter().zip(&self.trackers) {
            let Counts { learned_s, doubtful_s, rolled_back } = tracker.save().counts;
            let tracked = temp_c.map(|temp_c| tracker.tracked(temp_c));
            let change = tracked.map(|tracked| {
                format!(
                    "; the bias is {:+.4} ± {:.4} °/s (95 %) from its calibration",
                    tracked.change_dps,
                    1.96 * tracked.u_dps
                )
            });
            say(format_args!("tracked {name}: {learned_s} s of rest learned from{}", change.unwrap_or_default()));
            if rolled_back > 0 {
                say(format_args!(
                    "tracked {name}: {rolled_back} times a turn began within a rest; what it taught was dropped"
                ));
            }
            if doubtful_s > 0 {
                warn(&[format!(
                    "slow-turn: {name} was quiet for {doubtful_s} s at a level that a slow turn explains better than \
                     a change of the bias: next to nothing was learned from it; if the part was at rest, \
                     calibrate it anew"
                )]);
            }
        }
        saved
    }
}

/// More samples than these lost in a row, and a mean is not one of its block.
const MOST_LOST: u32 = 100;
