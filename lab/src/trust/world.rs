//! The part works, but the conditions are not as the procedure requires. These runs call the procedure directly,
//! without the program.

use super::faults::WRONG_U;
use super::{Bench, Class, Verdict};
use crate::trial::{self, FAULTS, HOUR_S, Rig, TrialEnd};
use adis16130_twin::{Motion, Roa, Spec};
use anyhow::{Context, Result};
use zerorate::{Method, Plan};

/// The names of the classes, in the order of [`FAULTS`].
const NAMES: [&str; FAULTS.len()] = [
    "world ordinary",
    "world step",
    "world step in 4",
    "world step at 6",
    "world step in 8",
    "world step at the end",
    "world sway",
    "world slow sway",
    "world slower sway",
    "world lag",
    "world curvature",
    "world hysteresis",
];

/// Slow base motion during the methods that use the whole recording.
const SWAYS: [Class; 2] = [
    Class { name: "world warmup slow sway", what: SWAY, quick: 1, run: |_, _, seed| record(Method::Warmup, seed) },
    Class { name: "world cycle slow sway", what: SWAY, quick: 1, run: |_, _, seed| record(Method::Cycle, seed) },
];
const SWAY: &str = "sway of 0.01 to 0.2 °/s, 0.0001 to 0.001 Hz, of a whole recording";

pub fn classes() -> Vec<Class> {
    let of_faults = NAMES.into_iter().zip(FAULTS).map(|(name, fault)| Class::new(name, fault.name, 1, calibrate));
    of_faults.chain(SWAYS).collect()
}

/// Noise of a mean over n seconds, expressed as a step of the supply, mV (0.0002 °/s/mV, F-01): white noise of
/// 0.0088/√n °/s (F-02), and flicker of about 0.002 °/s, whatever the duration (M-04).
const WHITE_MV: f64 = 44.0;
const FLICKER_MV: f64 = 10.0;
/// Size of a step that is always detected, in standard deviations. The threshold is 4.7 (`drift_checks.rs`), and noise
/// may hide three more standard deviations.
const SEEN_SIGMA: f64 = 8.0;
/// Duration from the start of step 8 to the end, s. If the supply steps earlier, both levels are visible for long
/// enough.
const STEP_8_S: f64 = 160.0;
/// Frequency, Hz, below which an oscillation of the base has less than a full period in the hour.
const SEEN_HZ: f64 = 3e-4;
/// What a line over the temperature leaves of a slow base motion, °/s rms, up to which nothing tells the motion from
/// the bias of the part: three times its flicker (M-04).
const LIKE_BIAS_DPS: f64 = 0.006;
/// One run in this many has the part's own clock and bandwidth. The other runs have a fiftieth of the clock and a
/// bandwidth of 50 Hz (F-04). Everything that happens in the hour stays the same, and such a run takes a thirtieth of
/// the time.
const FULL_RATE: u64 = 25;

fn calibrate(_: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let index = NAMES.iter().position(|name| *name == class).context("no such world")?;
    let spec = at_its_rate((FAULTS[index].spec)(seed), seed);
    let ended = Rig::new(spec.clone()).run(Plan::default())?;
    Ok(match &ended {
        TrialEnd::Refused => Verdict::Refused,
        TrialEnd::Calibrated { .. } if ended.worst() <= WRONG_U => Verdict::Right,
        TrialEnd::Calibrated { warnings, .. } if !warnings.is_empty() => Verdict::Warned,
        TrialEnd::Calibrated { .. } if is_unknowable(&spec) => Verdict::Unknowable,
        TrialEnd::Calibrated { unit, .. } => Verdict::Silent(format!("off by {:.1} u: {unit:?}", ended.worst())),
    })
}

fn at_its_rate(spec: Spec, seed: u64) -> Spec {
    if seed.is_multiple_of(FULL_RATE) {
        return spec;
    }
    Spec { mclk_hz: spec.mclk_hz / 50.0, roa: Roa::TenNanofarad, ..spec }
}

/// Runs a method that uses the whole recording, with slow base motion. A wrong result counts as silent even with a
/// warning, because the uncertainty must include such motion.
fn record(method: Method, seed: u64) -> Result<Verdict> {
    let (spec, plan) = (at_its_rate(trial::slow_sway(seed), seed), trial::plan(method));
    let turns = spec.sway_hz * plan.total_s();
    let mut rig = Rig::new(spec.clone());
    let ended = rig.run(plan)?;
    let left_dps = left_by_a_line(&spec, &rig.temps);
    Ok(match &ended {
        TrialEnd::Refused => Verdict::Refused,
        TrialEnd::Calibrated { .. } if ended.worst() <= WRONG_U => Verdict::Right,
        TrialEnd::Calibrated { .. } if left_dps < LIKE_BIAS_DPS => Verdict::Unknowable,
        TrialEnd::Calibrated { unit, .. } => {
            let sway = format!("{:.4} °/s, {turns:.2} turns", spec.sway_dps);
            Verdict::Silent(format!(
                "{sway}, {left_dps:.4} °/s not as the temperature: off by {:.1} u: {unit:?}",
                ended.worst()
            ))
        }
    })
}

/// What a straight line over the temperature leaves of the base motion, °/s rms.
fn left_by_a_line(spec: &Spec, temps: &[(f64, f64)]) -> f64 {
    let of_rate = |t_s: f64| spec.sway_dps * (std::f64::consts::TAU * spec.sway_hz * t_s).sin();
    let mean =
        |of: &dyn Fn(f64, f64) -> f64| temps.iter().map(|&(t_s, c)| of(t_s, c)).sum::<f64>() / temps.len() as f64;
    let (mean_dps, mean_c) = (mean(&|t_s, _| of_rate(t_s)), mean(&|_, c| c));
    let both = mean(&|t_s, c| (of_rate(t_s) - mean_dps) * (c - mean_c));
    let slope = both / mean(&|_, c| (c - mean_c).powi(2));
    mean(&|t_s, c| (of_rate(t_s) - mean_dps - slope * (c - mean_c)).powi(2)).sqrt()
}

/// True if nothing in the hour distinguishes the unit's conditions from good ones. The warning about the Earth's
/// rotation, which every result has, covers them.
fn is_unknowable(spec: &Spec) -> bool {
    let last_s = spec.fault_at_s.map_or(f64::INFINITY, |at_s| (HOUR_S - at_s).max(1.0));
    let sigma_mv = (WHITE_MV * WHITE_MV / last_s + FLICKER_MV * FLICKER_MV).sqrt();
    let late_step = last_s < STEP_8_S && spec.supply_step_mv.abs() < SEEN_SIGMA * sigma_mv;
    let slow_sway = matches!(spec.motion, Motion::Sway) && spec.sway_hz < SEEN_HZ;
    late_step || slow_sway
}
