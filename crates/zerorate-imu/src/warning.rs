//! Warnings about the axes of an IMU together.

use super::Kind;
use std::fmt;
use zerorate_allan::{AllanWarning, Fit, MotionKind, SettingName, motion, rows};
use zerorate_logs::{Names, Setting};

/// A warning about several axes.
#[derive(Clone, Debug, PartialEq)]
pub enum ImuWarning {
    /// The same happens to several axes at once, at these moments.
    Motion(MotionKind, Vec<Moment>),
    /// The log has no column of a kind. The name is of the setting that chose the columns, if one did.
    KindAbsent(Kind, Option<SettingName>),
}

/// A moment at which several axes jump, or have a glitch.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time from the start, s.
    pub at_s: f64,
    /// The names of the axes.
    pub axes: Vec<String>,
    /// The kind of motion.
    pub kind: MotionKind,
}

impl Moment {
    /// The moments that the axes of one log share. Each axis comes with its name.
    #[must_use]
    pub fn all(axes: &[(&str, &Fit)]) -> Vec<Self> {
        let fits: Vec<&Fit> = axes.iter().map(|(_, fit)| *fit).collect();
        let names = |found: Vec<usize>| found.into_iter().map(|axis| axes[axis].0.to_owned()).collect();
        motion(&fits).into_iter().map(|of| Self { at_s: of.at_s, axes: names(of.axes), kind: of.kind }).collect()
    }
}

/// A warning about a record as scripts read it, `code: text`, with the names of the settings that help.
#[must_use]
pub fn coded(warning: &AllanWarning, names: Names) -> String {
    let help = match warning {
        AllanWarning::FollowsTemperature { .. } => {
            format!(" ({}, {})", names.of(Setting::Detrend), names.of(Setting::Skip))
        }
        _ => String::new(),
    };
    format!("{}: {warning}{help}", warning.code())
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

    /// The warning as scripts read it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}

rows!(match ImuWarning {
    Self::Motion(MotionKind::Jump, ref moments) => Row {
        code: "motion",
        text: format_args!("several axes jump together at {}; cut the log there", Named(moments)),
    },
    Self::Motion(MotionKind::Knock, ref moments) => Row {
        code: "motion",
        text: format_args!("several axes have a glitch together at {}; knocked?", Named(moments)),
    },
    Self::KindAbsent(kind, None) =>
        Row { code: "kind-absent", text: format_args!("the log has no {}; fill in its numbers", kind.name()) },
    Self::KindAbsent(kind, Some(setting)) =>
        Row { code: "kind-absent", text: format_args!("{setting} names no {}; fill in its numbers", kind.name()) },
});

impl fmt::Display for ImuWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

/// The first moments in words, and the number of those that follow.
struct Named<'a>(&'a [Moment]);

/// Moments that a text names.
const NAMED: usize = 1;

impl fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = |moment: &Moment| format!("{:.1} s ({})", moment.at_s, moment.axes.join(", "));
        f.write_str(&self.0.iter().take(NAMED).map(words).collect::<Vec<_>>().join(", "))?;
        match self.0.len().saturating_sub(NAMED) {
            0 => Ok(()),
            more => write!(f, " + {more} more"),
        }
    }
}
