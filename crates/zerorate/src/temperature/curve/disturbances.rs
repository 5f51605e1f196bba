//! Steps and glitches of the means, found in the whitened record beside the curve.

use super::evidence::{Model, Record, StepAt};
use super::search;
use crate::temperature::gls;
use alloc::vec;
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
    let products = record.products(&filters, &model.following)?;
    let solved = record.solve_shape(&products, &model.shape)?;
    let mut best: Option<Disturbance> = None;
    for (log, filter) in filters.iter().enumerate() {
        let columns = record.columns(log, &model.following);
        let whitened: Vec<Vec<f64>> = columns.iter().map(|column| filter.whiten(column).into_values()).collect();
        let (means, columns) = whitened.split_first()?;
        let mut left = means.clone();
        for (column, coefficient) in columns.iter().zip(&solved.coefficients) {
            left.iter_mut().zip(column).for_each(|(left, value)| *left -= coefficient * value);
        }
        let gain = |column: &[f64]| {
            let white = filter.whiten(column).into_values();
            let with_columns: Vec<f64> = columns.iter().map(|other| gls::dot(other, &white)).collect();
            let explained = solved.variance(&with_columns);
            let (square, free) = (gls::dot(&white, &white), gls::dot(&white, &white) - explained);
            // a step that the curve explains cannot be told
            let share = gls::dot(&white, &left);
            if free > LEAST_FREE * square { share * share / free } else { 0.0 }
        };
        let count = left.len();
        let mut column = vec![0.0; count];
        for at in (0..count).rev() {
            let mut pulse = vec![0.0; count];
            pulse[at] = 1.0;
            column[at] = 1.0;
            // a step at the very beginning is the level
            let is_inner = at >= NEAR_END && at + NEAR_END < count;
            let step = if is_inner { gain(&column) } else { 0.0 };
            let glitch = gain(&pulse);
            let found = Disturbance { gain: step.max(glitch), log, at, is_step: step > glitch };
            if found.gain > best.map_or(GAIN, |best| best.gain) {
                best = Some(found);
            }
        }
    }
    best
}

/// Share of a column that the curve must leave.
const LEAST_FREE: f64 = 0.02;
/// Blocks at each end without a step.
const NEAR_END: usize = 2;
