//! Steps and glitches of the means, found in the whitened record beside the curve.

use super::evidence::{Model, Record, StepAt};
use super::search;
use crate::temperature::gls;
use alloc::vec::Vec;

/// Gain in χ² from which a step or a glitch is believed. By chance, one record in a thousand has one.
const GAIN: f64 = 30.0;
/// Most steps of all logs.
const MOST_STEPS: usize = 8;
/// Largest share of the blocks that are left out as glitches.
const MOST_GLITCHES: f64 = 0.05;
/// Searches for the noise, each with what was found before.
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

/// Takes steps and glitches out of the record. Returns the number of glitches, and the best model without
/// them.
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

/// The strongest step or glitch under a model, if one is believed.
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
            // a step that the curve explains cannot be told
            if free > LEAST_FREE * square { share * share / free } else { 0.0 }
        };
        let places: Vec<usize> = (0..left.len()).collect();
        for some in places.chunks(AT_ONCE) {
            let shapes: Vec<Vec<f64>> = some.iter().flat_map(|at| shapes(*at, left.len())).collect();
            let gains: Vec<f64> = filter.whiten_all(&shapes).iter().map(gain).collect();
            for (at, pair) in some.iter().zip(gains.chunks_exact(2)) {
                // a step at the very beginning is the level
                let is_inner = *at >= NEAR_END && at + NEAR_END < left.len();
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

/// A glitch of one block, and a step from it on.
fn shapes(at: usize, count: usize) -> [Vec<f64>; 2] {
    let is = |of: fn(&usize, &usize) -> bool| (0..count).map(|block| f64::from(u8::from(of(&block, &at)))).collect();
    [is(usize::eq), is(usize::ge)]
}

/// Blocks that are tried at once.
const AT_ONCE: usize = 4;
/// Least share of the squared norm of a step or glitch that the curve must not explain. Below it, none is looked for.
const LEAST_FREE: f64 = 0.02;
/// Blocks at each end without a step.
const NEAR_END: usize = 2;
