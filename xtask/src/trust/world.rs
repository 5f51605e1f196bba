//! The part works, but the world is not as the procedure wants it. Whole procedures of 53 minutes, in this process.

use super::faults::WRONG_U;
use super::{Bench, Class, Verdict};
use crate::trial::{self, Ended, FAULTS};
use anyhow::{Context, Result};
use zerorate::Plan;

/// What the classes are called, in the order of [`FAULTS`].
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

pub const CLASSES: &[Class] = &classes();

const fn classes() -> [Class; FAULTS.len()] {
    let mut classes = [Class { name: "", what: "", quick: 1, run: calibrate }; FAULTS.len()];
    let mut index = 0;
    while index < FAULTS.len() {
        classes[index].name = NAMES[index];
        classes[index].what = FAULTS[index].name;
        index += 1;
    }
    classes
}

/// Where nothing in the hour tells the world from a good one; the warning about the Earth's rotation, which each result has, says so.
const UNKNOWABLE: [&str; 4] = ["world step in 8", "world step at the end", "world slow sway", "world slower sway"];

fn calibrate(_: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let index = NAMES.iter().position(|name| *name == class).context("no such world")?;
    let ended = trial::run((FAULTS[index].spec)(seed), Plan::default())?;
    Ok(match &ended {
        Ended::Refused => Verdict::Refused,
        Ended::Calibrated { .. } if ended.worst() <= WRONG_U => Verdict::Right,
        Ended::Calibrated { warnings, .. } if !warnings.is_empty() => Verdict::Warned,
        Ended::Calibrated { .. } if UNKNOWABLE.contains(&class) => Verdict::Unknowable,
        Ended::Calibrated { unit, .. } => Verdict::Silent(format!("off by {:.1} u: {unit:?}", ended.worst())),
    })
}
