//! Cross-validation: the bias that remains if the curve comes from the other parts of the record.

use super::BeforeAfter;
use super::evidence::{Model, Record};
use alloc::vec::Vec;

/// Number of parts of a log, which are left out one at a time.
const PARTS: usize = 10;
/// Approximate number of means of the record that are compared.
const MEANS: usize = 60;

/// Returns the span of the means without the steps, before and after a correction by the model of the other parts.
pub(super) fn span(record: &Record, model: &Model) -> BeforeAfter {
    let (mut before, mut after) = (Ends::default(), Ends::default());
    let blocks: usize = record.logs.iter().map(|log| log.blocks().len()).sum();
    let per_mean = (blocks / MEANS).max(1);
    for index in 0..record.logs.len() {
        let columns = record.columns(index, &model.following);
        let count = columns[0].len();
        let mut left = Vec::with_capacity(count);
        for part in 0..PARTS {
            let (from, to) = (count * part / PARTS, count * (part + 1) / PARTS);
            let coefficients = without(record, model, index, from..to);
            let bias =
                |at: usize| columns[1..].iter().zip(&coefficients).map(|(of, value)| of[at] * value).sum::<f64>();
            left.extend((from..to).map(|at| columns[0][at] - bias(at)));
        }
        let steps = columns.len() - record.steps.len();
        let sizes = &model.all[steps - 1..];
        let stepped = |at: usize| columns[steps..].iter().zip(sizes).map(|(of, size)| of[at] * size).sum::<f64>();
        let unstepped: Vec<f64> = (0..count).map(|at| columns[0][at] - stepped(at)).collect();
        before.take(&unstepped, per_mean);
        after.take(&left, per_mean);
    }
    BeforeAfter { before: before.span(), after: after.span() }
}

/// Returns the coefficients of the record without a part of one log, or those of `model` if these cannot be computed.
fn without(record: &Record, model: &Model, index: usize, part: core::ops::Range<usize>) -> Vec<f64> {
    let others = record.others(index, |at| !part.contains(&at));
    let filters = others.filters(&model.noise);
    let solved = Record::products(&filters, &others.all_columns(&model.following))
        .and_then(|of| others.solve_shape(&of, &model.shape));
    solved.map_or_else(|| model.all.clone(), |solved| solved.coefficients)
}

/// Smallest and largest mean.
#[derive(Default)]
struct Ends(Option<(f64, f64)>);

impl Ends {
    fn take(&mut self, values: &[f64], per_mean: usize) {
        for means in values.chunks_exact(per_mean) {
            let mean = means.iter().sum::<f64>() / per_mean as f64;
            let (low, high) = self.0.unwrap_or((mean, mean));
            self.0 = Some((low.min(mean), high.max(mean)));
        }
    }

    fn span(&self) -> f64 {
        self.0.map_or(0.0, |(low, high)| high - low)
    }
}
