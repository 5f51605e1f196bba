//! The verdict on a run, and the number of runs in a class with each verdict.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// The verdict on a run, from the user's view.
pub enum Verdict {
    /// The result, or everything that was recorded until the end, is correct.
    Right,
    /// There is no result, and the stated reason is the true one.
    Refused,
    /// There is no result, and the stated reason is not the true one. The text is the stated reason.
    Misjudged(String),
    /// The result is wrong, and there is a warning.
    Warned,
    /// The result is wrong in a way that cannot be detected. Every result has a warning about this possibility.
    Unknowable,
    /// The result is wrong without a warning; the text says how. This must not happen.
    Silent(String),
    /// The run is not possible on this machine, for the given reason.
    Skipped(&'static str),
}

#[derive(Default, Deserialize, Serialize)]
pub struct Count {
    pub runs: u64,
    pub right: u64,
    pub refused: u64,
    pub misjudged: u64,
    pub warned: u64,
    pub unknowable: u64,
    pub silent: u64,
    pub skipped: Option<String>,
    /// The untrue reasons that were stated, and how often each was stated.
    pub other_causes: BTreeMap<String, u64>,
}

impl Count {
    pub fn add(&mut self, verdict: &Verdict) {
        self.runs += 1;
        match verdict {
            Verdict::Right => self.right += 1,
            Verdict::Refused => self.refused += 1,
            Verdict::Misjudged(said) => {
                self.misjudged += 1;
                *self.other_causes.entry(said.clone()).or_default() += 1;
            }
            Verdict::Warned => self.warned += 1,
            Verdict::Unknowable => self.unknowable += 1,
            Verdict::Silent(_) => self.silent += 1,
            Verdict::Skipped(why) => {
                self.runs -= 1;
                self.skipped = Some((*why).to_owned());
            }
        }
    }
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { runs, right, refused, misjudged, warned, unknowable, silent, .. } = self;
        write!(
            f,
            "{runs:4} runs: {right:4} right, {refused:4} refused, {misjudged:3} for another cause, {warned:3} warned, \
             {unknowable:2} unknowable, {silent} silent"
        )?;
        self.skipped.as_ref().map_or(Ok(()), |why| write!(f, "; SKIPPED: {why}"))?;
        self.other_causes.iter().try_for_each(|(said, times)| write!(f, "\n    {times} × {said}"))
    }
}
