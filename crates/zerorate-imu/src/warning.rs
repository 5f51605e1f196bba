//! Warnings about the axes of an IMU together.

use super::Kind;
use std::fmt;
use zerorate_allan::{AllanWarning, Fit, Motion, MotionKind, SettingName, motion, rows};
use zerorate_logs::{Names, Setting};

/// A warning about several axes.
#[derive(Clone, Debug, PartialEq)]
pub enum ImuWarning {
    /// The sensor moves in these times, from and to in s. The longest rest could be analysed alone.
    Moves(Vec<(f64, f64)>, Rest),
    /// Several axes jump at once, at these moments. The longest time without a jump could be analysed alone.
    Jumps(Vec<Moment>, Rest),
    /// Several axes have a glitch at once, at these moments.
    Knocks(Vec<Moment>),
    /// No axis of this kind was read. The name is that of the setting that chose the columns, if a setting did.
    KindAbsent(Kind, Option<SettingName>),
}

/// A moment at which several axes jump, or have a glitch.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time from the start of the log, s.
    pub at_s: f64,
    /// The names of the axes.
    pub axes: Vec<String>,
    /// A jump of the level, or a glitch.
    pub kind: MotionKind,
}

impl Moment {
    /// The moments that the axes of one log share. Each axis has a name. The first `skipped_s` seconds of the log were
    /// left out of the fits.
    #[must_use]
    pub fn all(axes: &[(&str, &Fit)], skipped_s: f64) -> Vec<Self> {
        let fits: Vec<&Fit> = axes.iter().map(|(_, fit)| *fit).collect();
        let names = |found: Vec<usize>| found.into_iter().map(|axis| axes[axis].0.to_owned()).collect();
        let named = |Motion { at_s, axes, kind }| Self { at_s: skipped_s + at_s, axes: names(axes), kind };
        motion(&fits).into_iter().map(named).collect()
    }
}

/// The longest part of a log without motion, with the options that choose it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    from_s: f64,
    until_s: f64,
    options: [SettingName; 2],
}

/// Time between a motion and the rest before or after it, s.
const AROUND_S: f64 = 1.0;

impl Rest {
    /// The longest rest between these times of motion in a record from `start_s` to `end_s`.
    #[must_use]
    pub fn between(motion_s: &[(f64, f64)], (start_s, end_s): (f64, f64), names: Names) -> Self {
        let ends = motion_s.iter().map(|(from_s, _)| from_s - AROUND_S).chain([end_s]);
        let starts = [start_s].into_iter().chain(motion_s.iter().map(|(_, to_s)| to_s + AROUND_S));
        let longest = starts.zip(ends).max_by(|one, other| (one.1 - one.0).total_cmp(&(other.1 - other.0)));
        let (from_s, until_s) = longest.unwrap_or((start_s, end_s));
        Self {
            from_s: from_s.ceil(),
            until_s: until_s.floor(),
            options: [Setting::Skip, Setting::Until].map(|of| names.of(of)),
        }
    }
}

impl fmt::Display for Rest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from_s, until_s, options: [skip, until] } = self;
        write!(f, "{skip} {from_s} {until} {until_s}")
    }
}

/// A warning about a record as scripts read it, `code: text`. `unit` is that of the rate, if it is known. If the rate
/// follows the temperature, the text names the settings that help.
#[must_use]
pub fn coded(warning: &AllanWarning, unit: Option<&str>, names: Names) -> String {
    let help = match warning {
        AllanWarning::FollowsTemperature { .. } => {
            format!(" ({}, {})", names.of(Setting::Detrend), names.of(Setting::Skip))
        }
        _ => String::new(),
    };
    format!("{}: {}{help}", warning.code(), warning.in_unit(unit.unwrap_or("unit")))
}

impl ImuWarning {
    /// One warning for all jumps, and one for all common glitches. The longest rest also leaves out the times
    /// `moving_s`.
    #[must_use]
    pub fn of_motion(axes: &[(&str, &Fit)], moving_s: &[(f64, f64)], skipped_s: f64, names: Names) -> Vec<Self> {
        let (jumps, knocks): (Vec<Moment>, Vec<Moment>) =
            Moment::all(axes, skipped_s).into_iter().partition(|moment| moment.kind == MotionKind::Jump);
        let end_s = axes.iter().map(|(_, fit)| skipped_s + 2.0 * fit.span_s.1).fold(skipped_s, f64::max);
        let at_s = jumps.iter().map(|jump| (jump.at_s, jump.at_s)).chain(moving_s.iter().copied());
        let mut at_s: Vec<(f64, f64)> = at_s.collect();
        at_s.sort_by(|one, other| one.0.total_cmp(&other.0));
        let rest = Rest::between(&at_s, (skipped_s, end_s), names);
        let jumps = (!jumps.is_empty()).then_some(Self::Jumps(jumps, rest));
        jumps.into_iter().chain((!knocks.is_empty()).then_some(Self::Knocks(knocks))).collect()
    }

    /// The warning as scripts read it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}

rows!(match ImuWarning as Display {
    Self::Moves(ref spans, rest) =>
        Row { code: "motion", text: format_args!("the sensor moves {}; the longest rest: {rest}", times(spans)) },
    Self::Jumps(ref moments, rest) =>
        Row { code: "motion", text: format_args!("axes jump together {}; longest rest: {rest}", jumps(moments)) },
    Self::Knocks(ref moments) => Row {
        code: "motion",
        text: format_args!("axes glitch together at {}; was the sensor knocked?", first(moments)),
    },
    Self::KindAbsent(kind, None) =>
        Row { code: "kind-absent", text: format_args!("the log has no {}; fill in its numbers", kind.name()) },
    Self::KindAbsent(kind, Some(setting)) =>
        Row { code: "kind-absent", text: format_args!("{setting} names no {}; fill in its numbers", kind.name()) },
});

/// Times of motion in words: the start of the first, the end of the last, and their number.
fn times(spans: &[(f64, f64)]) -> String {
    match spans {
        [] => String::new(),
        [(from_s, to_s)] => format!("from {from_s:.0} s to {to_s:.0} s"),
        [(from_s, _), .., (_, to_s)] => format!("from {from_s:.0} s to {to_s:.0} s ({} times)", spans.len()),
    }
}

fn jumps(moments: &[Moment]) -> String {
    match moments {
        [] => String::new(),
        [only] => format!("at {:.1} s", only.at_s),
        [first, .., last] => format!("{} times from {:.1} s to {:.1} s", moments.len(), first.at_s, last.at_s),
    }
}

/// The first moment in words, and the number of those that follow.
fn first(moments: &[Moment]) -> String {
    let [first, others @ ..] = moments else { return String::new() };
    let words = format!("{:.1} s ({})", first.at_s, first.axes.join(", "));
    if others.is_empty() { words } else { format!("{words} + {} more", others.len()) }
}
