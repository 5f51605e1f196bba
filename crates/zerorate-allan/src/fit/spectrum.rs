//! From a record to its bins: one transform of a complete record, two bands of one with gaps.

use super::bins::{Bin, Response, bins, empty_bins};
use super::density::{LOW, is_below};
use super::lines::{Narrow, take_out_narrow};
use super::transform::{cosine_transform, smooth_length};
use alloc::vec::Vec;
use realfft::FftError;

/// A record's cosine spectrum.
#[derive(Clone, Debug)]
pub(super) struct Spectrum {
    pub(super) bins: Vec<Bin>,
    /// The first coefficients times √dt.
    pub(super) low: Vec<f64>,
    /// The lines that left the bins.
    pub(super) narrow: Vec<Narrow>,
    /// Samples that entered, lost ones included.
    pub(super) samples: usize,
}

/// Samples of an average of the slow band, and the fewest averages.
const SLOT: usize = 64;
const FEWEST_SLOTS: usize = 1024;
/// An average of fewer samples, as a share of the typical number, is dropped: its noise would dominate all.
const FEWEST_IN_A_SLOT: f64 = 0.5;
/// The slow band ends at this share of the averages' rate, and the fast one begins at this multiple of it.
const SLOW_BELOW: f64 = 1.0 / 6.0;
const FAST_ABOVE: f64 = 4.0;
/// Lags over which it is judged whether samples are lost one by one or in bursts.
const NEIGHBOURS: usize = 16;

impl Spectrum {
    /// The spectrum of a rate; NaN is a missing sample.
    pub(super) fn of(rate: &[f64], rate_hz: f64) -> Result<Self, FftError> {
        match rate.iter().any(|value| value.is_nan()) {
            false => Self::whole(&rate[..smooth_length(rate.len())], rate_hz),
            true => Self::with_gaps(rate, rate_hz),
        }
    }

    /// Frequency and density of the bins above `top_hz`.
    pub(super) fn above(&self, top_hz: f64, rate_hz: f64) -> Vec<(f64, f64)> {
        let hz = rate_hz / (2.0 * self.samples as f64);
        let above = self.bins.iter().filter(|bin| !is_below((bin.end as f64 - 0.5) * hz, top_hz));
        above.map(|bin| (bin.middle() * hz, (bin.power - bin.response.offset) / bin.response.white)).collect()
    }

    fn whole(rate: &[f64], rate_hz: f64) -> Result<Self, FftError> {
        let coefficients = cosine_transform(&centred(rate))?;
        let power: Vec<f64> = coefficients.iter().map(|c| c * c / rate_hz).collect();
        let mut bins = bins(&power);
        let narrow = take_out_narrow(&power, &mut bins, rate_hz / (2.0 * rate.len() as f64));
        let low = coefficients.iter().take(LOW).map(|c| c / libm::sqrt(rate_hz)).collect();
        Ok(Self { bins, low, narrow, samples: rate.len() })
    }

    /// The slow band is the transform of averages over the samples present. The fast band is the transform of the
    /// rest, zero where samples are missing.
    fn with_gaps(rate: &[f64], rate_hz: f64) -> Result<Self, FftError> {
        let slot = slot_length(rate.len());
        let slots = smooth_length(rate.len() / slot);
        let samples = slots * slot;
        let averages = Averages::of(&rate[..samples], slot);
        let slot_rate_hz = rate_hz / slot as f64;
        let coefficients = cosine_transform(&centred(&averages.means))?;
        let power: Vec<f64> = coefficients.iter().map(|c| c * c / slot_rate_hz).collect();
        let low = coefficients.iter().take(LOW).map(|c| c / libm::sqrt(slot_rate_hz)).collect();
        let slow_end = (2.0 * SLOW_BELOW * slots as f64) as usize;
        let (fast, narrow) = fast_band(&rate[..samples], &averages, rate_hz)?;
        let slow = empty_bins(samples).into_iter().filter(|bin| bin.end <= slow_end).map(|bin| {
            let mean = power[bin.first - 1..bin.end - 1].iter().sum::<f64>() / bin.freedom;
            let angle = core::f64::consts::PI * bin.middle() / (2 * slots) as f64;
            let sinc = libm::sin(angle) / angle;
            let response = Response { offset: 0.0, slow: sinc * sinc, white: averages.white_at(2.0 * angle) };
            Bin { power: mean, response, freedom: bin.freedom * averages.present, ..bin }
        });
        Ok(Self { bins: slow.chain(fast).collect(), low, narrow, samples })
    }
}

/// Samples of an average, a power of two.
pub(super) fn slot_length(samples: usize) -> usize {
    core::iter::successors(Some(SLOT), |slot| Some(slot / 2))
        .find(|slot| *slot <= 4 || samples / slot >= FEWEST_SLOTS)
        .unwrap_or(4)
}

/// Averages over the samples present. Where hardly any are, the line between the neighbours.
pub(super) struct Averages {
    slot: usize,
    pub(super) means: Vec<f64>,
    /// Factor of white noise in them away from lines: slot·Σ1/count over all of them.
    pub(super) white: f64,
    /// Share of them that were measured.
    present: f64,
    /// The averages beside lines.
    beside: Vec<Beside>,
}

/// An average whose noise the lines beside it carry on.
struct Beside {
    /// slot/count.
    white: f64,
    /// Averages in the line before and after; at the ends of the record the line is level.
    lines: [Option<(usize, bool)>; 2],
}

impl Beside {
    ///
    /// 1 + Σ w e^(iωd)
    /// ², w the share of this average in the one that is d further on.
    fn gain(&self, angle: f64) -> f64 {
        let (mut re, mut im) = (1.0, 0.0);
        for (line, sign) in self.lines.iter().zip([-1.0, 1.0]) {
            let Some((length, level)) = *line else { continue };
            for d in 1..=length {
                let part = if level { 1.0 } else { 1.0 - d as f64 / (length + 1) as f64 };
                let (sin, cos) = libm::sincos(angle * d as f64);
                (re, im) = (re + part * cos, im + sign * part * sin);
            }
        }
        re * re + im * im
    }
}

impl Averages {
    pub(super) fn of(rate: &[f64], slot: usize) -> Self {
        let slots = rate.chunks_exact(slot).map(|slot| {
            let there = || slot.iter().filter(|value| !value.is_nan());
            (there().sum::<f64>() / there().count() as f64, there().count())
        });
        let (mut means, mut counts): (Vec<f64>, Vec<usize>) = slots.unzip();
        let used = counts.iter().filter(|count| **count > 0).count().max(1);
        let typical = counts.iter().sum::<usize>() as f64 / used as f64;
        let few = |(_, count): &(&mut f64, &mut usize)| (**count as f64) < FEWEST_IN_A_SLOT * typical;
        for (mean, count) in means.iter_mut().zip(&mut counts).filter(few) {
            (*mean, *count) = (f64::NAN, 0);
        }
        let white = |count: usize| if count > 0 { slot as f64 / count as f64 } else { 0.0 };
        let all = means.len().max(1) as f64;
        let present = counts.iter().filter(|count| **count > 0).count() as f64 / all;
        let sum: f64 = counts.iter().map(|&count| white(count)).sum();
        let beside = beside(&counts, white);
        fill_gaps(&mut means);
        Self { slot, white: sum / all, present, beside, means }
    }

    /// Factor of white noise in a coefficient at `angle` radians per average. Interpolated values repeat their
    /// neighbours' noise: 60 bursts of up to 7 s in an hour otherwise made B 10 % too large.
    fn white_at(&self, angle: f64) -> f64 {
        let repeated = self.beside.iter().map(|beside| beside.white * (beside.gain(angle) - 1.0));
        self.white + repeated.sum::<f64>() / self.means.len().max(1) as f64
    }

    /// The line through the averages at a sample.
    fn at(&self, sample: usize) -> f64 {
        let at = (sample as f64 + 0.5) / self.slot as f64 - 0.5;
        let before = (libm::floor(at).max(0.0) as usize).min(self.means.len().saturating_sub(2));
        match self.means.get(before + 1) {
            Some(next) => self.means[before] + (next - self.means[before]) * (at - before as f64).clamp(0.0, 1.0),
            None => self.means[before],
        }
    }
}

/// The bins of the fast band. Losses mix its spectrum with white noise of the same variance, unless they are
/// neighbours.
fn fast_band(
    rate: &[f64],
    averages: &Averages,
    rate_hz: f64,
) -> Result<(impl Iterator<Item = Bin> + use<>, Vec<Narrow>), FftError> {
    let n = rate.len();
    let rest = |(i, value): (usize, &f64)| if value.is_nan() { 0.0 } else { value - averages.at(i) };
    let rest: Vec<f64> = rate.iter().enumerate().map(rest).collect();
    let there = rate.iter().filter(|value| !value.is_nan()).count() as f64;
    let variance = rest.iter().map(|rest| rest * rest).sum::<f64>() / there;
    let part = there / n as f64;
    let kept = neighbours(rate) / part;
    let coefficients = cosine_transform(&rest)?;
    let power: Vec<f64> = coefficients.iter().map(|c| c * c / rate_hz / part).collect();
    let from = (FAST_ABOVE * 2.0 * n as f64 / averages.slot as f64) as usize;
    let mut bins: Vec<Bin> = bins(&power).into_iter().filter(|bin| bin.first >= from).collect();
    let narrow = take_out_narrow(&power, &mut bins, rate_hz / (2.0 * n as f64));
    let response = Response { offset: (1.0 - kept) * variance / rate_hz, slow: kept, white: kept };
    Ok((bins.into_iter().map(move |bin| Bin { response, freedom: bin.freedom * part, ..bin }), narrow))
}

/// The averages next to a line, and the length of the line.
fn beside(counts: &[usize], white: impl Fn(usize) -> f64) -> Vec<Beside> {
    let empty = |slots: &mut dyn Iterator<Item = &usize>| slots.take_while(|count| **count == 0).count();
    let mut found = Vec::new();
    for (j, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let (before, after) = (empty(&mut counts[..j].iter().rev()), empty(&mut counts[j + 1..].iter()));
        let line = |length: usize, to_the_end: usize| (length > 0).then_some((length, length == to_the_end));
        let lines = [line(before, j), line(after, counts.len() - 1 - j)];
        if lines.iter().any(Option::is_some) {
            found.push(Beside { white: white(*count), lines });
        }
    }
    found
}

/// How often a sample and one of the next few are both present.
fn neighbours(rate: &[f64]) -> f64 {
    let both = |lag: usize| {
        let pairs = rate.iter().zip(&rate[lag..]);
        pairs.filter(|(a, b)| !a.is_nan() && !b.is_nan()).count() as f64 / (rate.len() - lag) as f64
    };
    (1..=NEIGHBOURS).map(both).sum::<f64>() / NEIGHBOURS as f64
}

/// Straight lines where values are missing, level at the ends.
pub(super) fn fill_gaps(values: &mut [f64]) {
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

fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| value - mean).collect()
}
