//! What several axes of one sensor do at the same moment is no noise of theirs: the sensor moved.

use super::Fit;
use alloc::vec::Vec;

/// Several axes jump at the same moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// When, s from the start: the mean of the axes.
    pub at_s: f64,
    /// Which, ascending.
    pub axes: Vec<usize>,
}

/// Jumps so near to each other are one; the time of a jump is certain to some tenths of a second at best.
const TOGETHER_S: f64 = 1.0;

/// The moments at which the level of more than one axis jumps, whether the jumps were taken out or were so many that
/// they were put back. The axes are those of one log, on one clock.
#[must_use]
pub fn motion(axes: &[&Fit]) -> Vec<Motion> {
    let of = |(axis, fit): (usize, &&Fit)| {
        let steps = fit.cleaned.steps.iter().chain(&fit.cleaned.put_back);
        steps.map(move |step| (step.at_s, axis)).collect::<Vec<_>>()
    };
    let mut jumps: Vec<(f64, usize)> = axes.iter().enumerate().flat_map(of).collect();
    jumps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let together = jumps.chunk_by(|a, b| b.0 - a.0 <= TOGETHER_S).map(|jumps| {
        let mut axes: Vec<usize> = jumps.iter().map(|(_, axis)| *axis).collect();
        axes.sort_unstable();
        axes.dedup();
        Motion { at_s: jumps.iter().map(|(at_s, _)| at_s).sum::<f64>() / jumps.len() as f64, axes }
    });
    together.filter(|motion| motion.axes.len() > 1).collect()
}
