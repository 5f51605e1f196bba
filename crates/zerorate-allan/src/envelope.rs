//! A record reduced to the smallest and the largest sample of each stretch, for a plot over time.

use alloc::vec::Vec;

/// The envelope of a record of any length, for a plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Envelope {
    /// Length of the record, s.
    pub span_s: f64,
    /// Mean of the samples that are present; 0 if there are none.
    pub mean: f64,
    /// Smallest and largest sample of each stretch, `None` if it has no samples. Lengths differ by at most one sample.
    pub stretches: Vec<Option<(f64, f64)>>,
}

impl Envelope {
    /// Largest number of stretches: the width of the plot in pixels.
    const STRETCHES: usize = 840;

    /// Makes the envelope of samples. NaN marks a missing sample.
    #[must_use]
    pub fn new(samples: &[f64], rate_hz: f64) -> Self {
        let there = || samples.iter().filter(|value| value.is_finite());
        let count = samples.len().min(Self::STRETCHES);
        // 64 bits: in a browser `usize` has 32, and `index * samples.len()` overflows with six million samples
        let begin = |index: usize| (index as u64 * samples.len() as u64 / count as u64) as usize;
        let stretch = |index: usize| {
            let part = &samples[begin(index)..begin(index + 1)];
            let there = part.iter().filter(|value| value.is_finite());
            let (low, high) =
                there.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
            (low <= high).then_some((low, high))
        };
        Self {
            span_s: samples.len() as f64 / rate_hz,
            mean: there().sum::<f64>() / there().count().max(1) as f64,
            stretches: (0..count).map(stretch).collect(),
        }
    }
}
