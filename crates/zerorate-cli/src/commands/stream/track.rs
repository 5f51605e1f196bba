//! `stream --track`: options and messages of tracking the bias whenever the sensor is at rest.

use crate::exit::Usage;
use crate::output::{Outputs, say, warn};
use crate::wording::coded;
use anyhow::{Error, Result};
use clap::Args;
use std::path::PathBuf;
use zerorate::Calibration;
use zerorate::track::{Counts, TrackerConfig};
use zerorate_host::DeviceInfo;
use zerorate_jobs::stream::{LearnedAxis, TrackOptions, Tracking, UnusableState};

/// Options for tracking the bias.
#[derive(Args, Debug)]
pub struct TrackArgs {
    /// Learn the bias whenever the sensor rests, and correct with it.
    ///
    /// The rows gain the columns bias_dps, u_bias_dps (with NAME_ before them for several axes) and phase. phase is
    /// moving, quiet, rest or doubtful. A doubtful phase is as quiet as rest but may be a slow turn.
    #[arg(long)]
    track: bool,

    /// Keep what was learned in this file: read at the start, written every minute and at the end. It is created if it
    /// does not exist.
    #[arg(long, value_name = "FILE", requires = "track")]
    state: Option<PathBuf>,

    /// The Earth's rotation on the axis at rest, °/s, at most 0.0042 [default: as in the calibration].
    ///
    /// Give it only if the calibration was made with --earth-dps.
    #[arg(long, value_name = "DPS", requires = "track")]
    earth_dps: Option<f64>,

    /// The slowest steady turn that must not be learned as bias.
    #[arg(long, value_name = "DPS", requires = "track", default_value_t = TrackerConfig::LEAST_TURN_DPS)]
    least_turn_dps: f64,

    /// The change of the bias from one power-up to the next (1 σ). Every start counts as a power-up.
    #[arg(long, value_name = "DPS", requires = "track", default_value_t = TrackerConfig::POWER_UP_DPS)]
    power_up_dps: f64,
}

impl TrackArgs {
    pub fn begin(
        &self,
        facts: &DeviceInfo,
        calibration: &Calibration,
        outputs: &mut Outputs,
    ) -> Result<Option<Tracking>> {
        if !self.track {
            return Ok(None);
        }
        let &Self { least_turn_dps, power_up_dps, .. } = self;
        for (name, value) in [("--least-turn-dps", least_turn_dps), ("--power-up-dps", power_up_dps)] {
            if !(1e-6..=100.0).contains(&value) {
                return Err(Usage(format!("{name} is {value}; it must lie between 0.000001 and 100 °/s")).into());
            }
        }
        let earth_dps = self.earth(calibration)?;
        let options = TrackOptions { state: self.state.clone(), earth_dps, least_turn_dps, power_up_dps };
        let mut warn = |warning| warn(&[coded(warning)]);
        Tracking::begin(&options, facts, calibration, outputs, &mut warn)
            .map(Some)
            .map_err(|error| self.unusable(error))
    }

    fn unusable(&self, error: Error) -> Error {
        let name = self.state.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
        match error.downcast() {
            Ok(UnusableState(why)) => why.context(format!(
                "{name} is not a usable state; delete it to begin from the calibration, or name another --state"
            )),
            Err(error) => error,
        }
    }

    /// The Earth's rotation that a sensor at rest measures beyond its calibrated bias, °/s.
    fn earth(&self, calibration: &Calibration) -> Result<f64> {
        let taken_out = calibration.run.and_then(|run| run.earth_dps);
        match (self.earth_dps, taken_out) {
            (Some(dps), _) if dps.is_nan() || dps.abs() > 0.0042 => {
                Err(Usage(format!("--earth-dps is {dps}; the Earth turns by 0.0042 °/s at most (F-16)")).into())
            }
            (Some(dps), None) if dps != 0.0 => Err(Usage(
                "--earth-dps: the calibration was made without it, so its PBC already includes the Earth's rotation. \
                 Leave it out, or calibrate with --earth-dps"
                    .to_owned(),
            )
            .into()),
            (given, taken_out) => Ok(given.or(taken_out).unwrap_or(0.0)),
        }
    }
}

pub fn say_learned(learned: &LearnedAxis<'_>) {
    let LearnedAxis { name, counts: Counts { learned_s, rolled_back, .. }, tracked } = learned;
    let change = tracked.map_or(String::new(), |tracked| {
        let (change_dps, u_dps) = (tracked.change_dps, 1.96 * tracked.u_dps);
        format!("; the bias is {change_dps:+.4} ± {u_dps:.4} °/s (95 %) from its calibration")
    });
    say(format_args!("tracked {name}: {learned_s} s of rest learned from{change}"));
    if *rolled_back > 0 {
        say(format_args!(
            "tracked {name}: {rolled_back} times a turn began during a rest, and its samples were dropped"
        ));
    }
}
