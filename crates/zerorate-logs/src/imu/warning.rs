//! What is to be said of the axes of an IMU together.

use super::Kind;
use std::fmt;
use zerorate_allan::{Fit, MotionKind, motion};

/// A warning about several axes.
#[derive(Clone, Debug, PartialEq)]
pub enum ImuWarning {
    /// The same happens to several axes at once, at these moments.
    Motion(MotionKind, Vec<Moment>),
    /// The log has nothing of a kind; or, by the name of the setting that chose the columns, they have not.
    KindAbsent(Kind, Option<&'static str>),
}

/// A moment at which several axes jump, or have a glitch.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// When, s from the start.
    pub at_s: f64,
    /// The names of the axes.
    pub axes: Vec<String>,
    /// What happens.
    pub kind: MotionKind,
}

impl Moment {
    /// Those of the axes of one log, each by its name.
    #[must_use]
    pub fn all(axes: &[(&str, &Fit)]) -> Vec<Self> {
        let fits: Vec<&Fit> = axes.iter().map(|(_, fit)| *fit).collect();
        let names = |found: Vec<usize>| found.into_iter().map(|axis| axes[axis].0.to_owned()).collect();
        motion(&fits).into_iter().map(|of| Self { at_s: of.at_s, axes: names(of.axes), kind: of.kind }).collect()
    }
}

impl ImuWarning {
    /// A warning for the jumps, and one for the knocks.
    #[must_use]
    pub fn of_motion(axes: &[(&str, &Fit)]) -> Vec<Self> {
        let all = Moment::all(axes);
        let of = |kind| (kind, all.iter().filter(|moment| moment.kind == kind).cloned().collect::<Vec<_>>());
        let found = [MotionKind::Jump, MotionKind::Knock].map(of).into_iter().filter(|(_, all)| !all.is_empty());
        found.map(|(kind, moments)| Self::Motion(kind, moments)).collect()
    }

    /// The name that scripts and `zerorate explain` know.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Motion(..) => "motion",
            Self::KindAbsent(..) => "kind-absent",
        }
    }
}

/// Moments that a text names.
const NAMED: usize = 6;

/// For people and scripts `code: text`.
impl fmt::Display for ImuWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.code())?;
        match self {
            Self::Motion(kind, moments) => {
                let (what, meaning) = match kind {
                    MotionKind::Jump => (
                        "jump",
                        "the sensor moved, which is no noise of it; record where nothing moves, or cut the log there",
                    ),
                    MotionKind::Knock => {
                        ("have a glitch", "a knock, or a sample of all that broke; keep the sensor from being touched")
                    }
                };
                let words = |moment: &Moment| format!("{:.1} s ({})", moment.at_s, moment.axes.join(", "));
                let named = moments.iter().take(NAMED).map(words).collect::<Vec<_>>().join(", ");
                write!(f, "several axes {what} together at {named}")?;
                if moments.len() > NAMED {
                    write!(f, " and {} times more", moments.len() - NAMED)?;
                }
                write!(f, ": {meaning}")
            }
            Self::KindAbsent(kind, chosen_by) => {
                match chosen_by {
                    Some(setting) => write!(f, "{setting} names no")?,
                    None => write!(f, "the log has no")?,
                }
                write!(f, " {}: its numbers are left to be filled in", kind.name())
            }
        }
    }
}
