//! Averages over the samples that are present.

use alloc::vec::Vec;

/// Samples of an average, and the fewest averages.
const SLOT: usize = 64;
const FEWEST_SLOTS: usize = 1024;
/// An average of fewer samples, as a share of the typical number, is dropped: its noise would dominate all.
const FEWEST_IN_A_SLOT: f64 = 0.5;

/// Samples of an average, a power of two.
pub(in crate::fit) fn slot_length(samples: usize) -> usize {
    core::iter::successors(Some(SLOT), |slot| Some(slot / 2))
        .find(|slot| *slot <= 4 || samples / slot >= FEWEST_SLOTS)
        .unwrap_or(4)
}

/// The mean of every `slot` samples that are present, and their number. It is NaN and 0 where hardly any are.
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

/// Factor of white noise in the averages: slot·Σ1/count over all of them.
pub(in crate::fit) fn white_in(counts: &[usize], slot: usize) -> f64 {
    let there = counts.iter().filter(|count| **count > 0);
    there.map(|&count| slot as f64 / count as f64).sum::<f64>() / counts.len().max(1) as f64
}

/// Straight lines where values are missing, level at the ends.
pub(in crate::fit) fn fill_gaps(values: &mut [f64]) {
    let mut last = None;
    for i in 0..values.len() {
        if values[i].is_nan() {
            continue;
        }
        match last {
            Some(before) if before + 1 < i => {
                let (a, b): (f64, f64) = (values[before], values[i]);
                let step = (b - a) / (i - before) as f64;
                (before + 1..i).for_each(|j| values[j] = a + step * (j - before) as f64);
            }
            None => (0..i).for_each(|j| values[j] = values[i]),
            _ => {}
        }
        last = Some(i);
    }
    if let Some(before) = last {
        (before + 1..values.len()).for_each(|j| values[j] = values[before]);
    }
}
