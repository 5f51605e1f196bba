//! Finds steps and outliers in the whitened residuals of the curve.

use super::evidence::{Model, Record, StepAt};
use super::search;
use crate::temperature::gls;
use alloc::vec::Vec;

/// Gain in χ² from which a step or an outlier is accepted. Noise reaches it in fewer than one of a thousand records.
const GAIN: f64 = 30.0;
/// Largest number of steps in all logs together.
const MOST_STEPS: usize = 8;
/// Largest share of the blocks that may be left out as outliers.
const MOST_GLITCHES: f64 = 0.05;
/// Largest number of searches for the noise model, each without the disturbances that were found before.
const ROUNDS: usize = 3;

/// The most likely disturbance of a log.
#[derive(Clone, Copy, Debug)]
struct Disturbance {
    gain: f64,
    log: usize,
    /// Index of the block.
    at: usize,
    is_step: bool,
}

/// Removes steps and outliers from the record. Returns the number of outliers, and the best model without them.
pub(super) fn take_out(record: &mut Record, first: Model) -> (usize, Model) {
    let blocks: usize = record.logs.iter().map(|log| log.blocks().len()).sum();
    let most = (MOST_GLITCHES * blocks as f64) as usize;
    let (mut model, mut glitches) = (first, 0);
    for _ in 0..ROUNDS {
        let mut found = false;
        while let Some(Disturbance { log, at, is_step, .. }) = strongest(record, &model) {
            found = true;
            if is_step && record.steps.len() < MOST_STEPS {
                let at_s = record.logs[log].blocks()[at].start_s;
                record.steps.push(StepAt { log, at_s });
            } else if !is_step && glitches < most {
                record.logs[log].remove(at);
                glitches += 1;
            } else {
                return (glitches, model);
            }
        }
        match search::best(record).filter(|_| found) {
            Some(better) => model = better,
            None => break,
        }
    }
    (glitches, model)
}

/// Returns the strongest step or outlier under a model, if one is significant.
fn strongest(record: &Record, model: &Model) -> Option<Disturbance> {
    let filters = record.filters(&model.noise);
    let all = record.all_columns(&model.following);
    let solved = record.solve_shape(&Record::products(&filters, &all)?, &model.shape)?;
    let mut best: Option<Disturbance> = None;
    for (log, (filter, columns)) in filters.iter().zip(&all).enumerate() {
        let whitened = filter.whiten_all(columns);
        let (means, columns) = whitened.split_first()?;
        let mut left = means.clone();
        for (column, coefficient) in columns.iter().zip(&solved.coefficients) {
            left.iter_mut().zip(column).for_each(|(left, value)| *left -= coefficient * value);
        }
        let gain = |white: &Vec<f64>| {
            let with_columns: Vec<f64> = columns.iter().map(|other| gls::dot(other, white)).collect();
            let square = gls::dot(white, white);
            let (free, share) = (square - solved.variance(&with_columns), gls::dot(white, &left));
            // a step that the curve could explain as well is not found
            if free > LEAST_FREE * square { share * share / free } else { 0.0 }
        };
        let places: Vec<usize> = (0..left.len()).collect();
        for some in places.chunks(AT_ONCE) {
            let shapes: Vec<Vec<f64>> = some.iter().flat_map(|at| shapes(*at, left.len())).collect();
            let gains: Vec<f64> = filter.whiten_all(&shapes).iter().map(gain).collect();
            for (at, pair) in some.iter().zip(gains.chunks_exact(2)) {
                // no step is looked for near the ends, or among codes without noise, which step by themselves
                let is_rounded = record.logs[log].rounding > 0.0;
                let is_inner = *at >= NEAR_END && at + NEAR_END < left.len() && !is_rounded;
                let (glitch, step) = (pair[0], if is_inner { pair[1] } else { 0.0 });
                let found = Disturbance { gain: step.max(glitch), log, at: *at, is_step: step > glitch };
                if found.gain > best.map_or(GAIN, |best| best.gain) {
                    best = Some(found);
                }
            }
        }
    }
    best
}

/// Returns the shapes of an outlier in one block, and of a step that begins with this block.
fn shapes(at: usize, count: usize) -> [Vec<f64>; 2] {
    let is = |of: fn(&usize, &usize) -> bool| (0..count).map(|block| f64::from(u8::from(of(&block, &at)))).collect();
    [is(usize::eq), is(usize::ge)]
}

/// Number of blocks that are tried at once.
const AT_ONCE: usize = 4;
/// Smallest share of the squared norm of a step or outlier that the curve must leave. Below it, none is found.
const LEAST_FREE: f64 = 0.02;
/// Number of blocks at each end in which no step is looked for.
const NEAR_END: usize = 2;
