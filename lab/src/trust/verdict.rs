//! How a run ended for its user.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// The state in which a run leaves its user.
pub enum Verdict {
    /// The result is right, or all that was recorded until then.
    Right,
    /// No result, and the reason is the true one.
    Refused,
    /// No result, for a reason that is not the true one: this.
    Misjudged(String),
    /// A wrong result, and a warning with it.
    Warned,
    /// A wrong result in a way that nothing could show. Every result of this kind warns of it.
    Unknowable,
    /// A wrong result without a warning: this is wrong.
    Silent(String),
    /// Nothing could be tried on this machine, and why.
    Skipped(&'static str),
}

/// The verdicts of a class.
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
    /// Other causes that were named, and how often.
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
