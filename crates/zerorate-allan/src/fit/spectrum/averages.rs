//! Averages over the samples that are present.

use alloc::vec::Vec;
use core::ops::Range;

/// The longest average that [`slot_length`] chooses, and the least number of averages of more than 4 samples.
const SLOT: usize = 64;
const FEWEST_SLOTS: usize = 1024;
/// An average of less than this share of the typical number of samples is dropped: its noise would dominate.
const FEWEST_IN_A_SLOT: f64 = 0.5;

/// Chooses the number of samples in an average of a record: a power of two from 4 to `SLOT`.
pub(in crate::fit) fn slot_length(samples: usize) -> usize {
    core::iter::successors(Some(SLOT), |slot| Some(slot / 2))
        .find(|slot| *slot <= 4 || samples / slot >= FEWEST_SLOTS)
        .unwrap_or(4)
}

/// For every `slot` samples, the mean and the number of those present; NaN and 0 if too few are present.
pub(in crate::fit) fn averages(rate: &[f64], slot: usize) -> (Vec<f64>, Vec<usize>) {
    let mean = |slot: &[f64]| {
        let sum: f64 = slot.iter().sum();
        if !sum.is_nan() {
            return (sum / slot.len() as f64, slot.len());
        }
        let there = || slot.iter().filter(|value| !value.is_nan());
        (there().sum::<f64>() / there().count() as f64, there().count())
    };
    let slots = rate.chunks_exact(slot).map(mean);
    let (mut means, mut counts): (Vec<f64>, Vec<usize>) = slots.unzip();
    let used = counts.iter().filter(|count| **count > 0).count().max(1);
    let typical = counts.iter().sum::<usize>() as f64 / used as f64;
    let few = |(_, count): &(&mut f64, &mut usize)| (**count as f64) < FEWEST_IN_A_SLOT * typical;
    for (mean, count) in means.iter_mut().zip(&mut counts).filter(few) {
        (*mean, *count) = (f64::NAN, 0);
    }
    (means, counts)
}

/// Factor by which gaps raise the white noise of averages: the mean of slot/count over all averages, 0 for empty ones.
pub(in crate::fit) fn white_in(counts: &[usize], slot: usize) -> f64 {
    let there = counts.iter().filter(|count| **count > 0);
    there.map(|&count| slot as f64 / count as f64).sum::<f64>() / counts.len().max(1) as f64
}

pub(in crate::fit) fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| value - mean).collect()
}

/// Fills gaps with straight lines, which are level at the ends of the record. A line goes through the means of as many
/// values on each side as are missing. So it has about the slow power of the white noise or random walk it replaces.
pub(in crate::fit) fn fill_gaps(values: &mut [f64]) {
    let lines: Vec<(Range<usize>, Line)> = gaps(values).map(|gap| (gap.clone(), Line::across(values, &gap))).collect();
    for (gap, line) in lines {
        gap.for_each(|i| values[i] = line.at(i));
    }
}

fn gaps(values: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    core::iter::from_fn(move || {
        let first = end + values[end..].iter().position(|value| value.is_nan())?;
        end = first + values[first..].iter().take_while(|value| value.is_nan()).count();
        Some(first..end)
    })
}

struct Line {
    from: (f64, f64),
    to: (f64, f64),
}

impl Line {
    fn across(values: &[f64], gap: &Range<usize>) -> Self {
        let before = centre(values, gap.start.saturating_sub(gap.len())..gap.start);
        let after = centre(values, gap.end..(gap.end + gap.len()).min(values.len()));
        let (from, to) = (before.or(after), after.or(before));
        Self { from: from.unwrap_or_default(), to: to.unwrap_or_default() }
    }

    fn at(&self, i: usize) -> f64 {
        let ((from, a), (to, b)) = (self.from, self.to);
        if to > from { a + (b - a) * (i as f64 - from) / (to - from) } else { a }
    }
}

/// The mean index and the mean of the values that are present.
fn centre(values: &[f64], within: Range<usize>) -> Option<(f64, f64)> {
    let there = || within.clone().filter(|&i| !values[i].is_nan());
    let count = there().count() as f64;
    let place = there().map(|i| i as f64).sum::<f64>() / count;
    (count > 0.0).then(|| (place, there().map(|i| values[i]).sum::<f64>() / count))
}
