//! Detects motion: several axes of one sensor react at the same moment, which noise does not do.

use super::Fit;
use crate::chi2::chi2_above;
use alloc::vec::Vec;

/// A motion that several axes show at the same moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The time, s from the start of the record: the mean over the jumps or glitches.
    pub at_s: f64,
    /// Indices of the axes, ascending.
    pub axes: Vec<usize>,
    /// Whether the levels jump, or the axes have a glitch.
    pub kind: MotionKind,
}

/// The common reaction of several axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// The levels of the axes jump and stay: something tilted.
    Jump,
    /// The axes have a glitch: a knock, or one damaged sample of all axes.
    Knock,
}

/// Jumps within this time, s, are one motion. The time of a jump is known to some tenths of a second at best.
const JUMP_TOGETHER_S: f64 = 1.0;
/// Glitches within this time, s, are one motion. At low rates the time is `KNOCK_TOGETHER_SAMPLES` samples.
const KNOCK_TOGETHER_S: f64 = 0.05;
const KNOCK_TOGETHER_SAMPLES: f64 = 2.0;
/// Glitches that fall together by chance with more than this probability do not count as motion.
const CHANCE: f64 = 0.01;

/// The moments at which the level of more than one axis jumps, or at which several axes have a glitch. Jumps count
/// whether they were removed or were too many to remove. Glitches do not count if as many would coincide by chance.
/// The axes must share one clock. The result has jumps before knocks, each in the order of time.
#[must_use]
pub fn motion(axes: &[&Fit]) -> Vec<Motion> {
    let jumps = |fit: &Fit| {
        let steps = fit.cleaned.steps.iter().chain(&fit.cleaned.put_back);
        steps.map(|step| step.at_s).collect::<Vec<f64>>()
    };
    let mut found = together(axes, MotionKind::Jump, JUMP_TOGETHER_S, jumps);
    let near_s = axes.iter().map(|fit| KNOCK_TOGETHER_SAMPLES * fit.span_s.0).fold(KNOCK_TOGETHER_S, f64::max);
    let knocks = together(axes, MotionKind::Knock, near_s, |fit| fit.cleaned.glitches_s.clone());
    if !knocks.is_empty() && by_chance(axes, near_s, knocks.len()) < CHANCE {
        found.extend(knocks);
    }
    found
}

fn together(axes: &[&Fit], kind: MotionKind, near_s: f64, times_s: impl Fn(&Fit) -> Vec<f64>) -> Vec<Motion> {
    let of = |(axis, fit): (usize, &&Fit)| times_s(fit).into_iter().map(move |at_s| (at_s, axis)).collect::<Vec<_>>();
    let mut all: Vec<(f64, usize)> = axes.iter().enumerate().flat_map(of).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let moments = all.chunk_by(|a, b| b.0 - a.0 <= near_s).map(|moment| {
        let mut axes: Vec<usize> = moment.iter().map(|(_, axis)| *axis).collect();
        axes.sort_unstable();
        axes.dedup();
        Motion { at_s: moment.iter().map(|(at_s, _)| at_s).sum::<f64>() / moment.len() as f64, axes, kind }
    });
    moments.filter(|motion| motion.axes.len() > 1).collect()
}

/// The probability of this many pairs, or more, if the glitches of the axes are independent. The number of pairs has a
/// Poisson distribution, whose tail is that of χ² with 2·`pairs` degrees of freedom.
fn by_chance(axes: &[&Fit], near_s: f64, pairs: usize) -> f64 {
    let count = |fit: &&Fit| fit.cleaned.glitches as f64;
    let sum: f64 = axes.iter().map(count).sum();
    let squares: f64 = axes.iter().map(|fit| count(fit) * count(fit)).sum();
    let record_s = axes.iter().map(|fit| 2.0 * fit.span_s.1).fold(0.0, f64::max);
    let expected = (sum * sum - squares) / 2.0 * 2.0 * near_s / record_s;
    1.0 - chi2_above(2.0 * expected, 2.0 * pairs as f64)
}
