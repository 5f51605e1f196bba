//! Turns a record into the bins of its spectrum.
//!
//! A complete record of up to 2²⁰ samples is one cosine transform. A longer record, or one with gaps, goes through
//! levels: its samples, and means over more and more samples. Segments of a level give the upper part of its band, and
//! the next level gives the rest. The last level is one cosine transform, which is exact for white noise and a random
//! walk. Sines are removed from the samples first (`search.rs`).

pub(super) mod averages;
mod levels;
mod search;
mod segments;

use super::bins::{Bin, LINEAR, all_edges, edges};
use super::density::{LOW, is_below};
use super::lines::{Line, Narrow, take_out_narrow};
use super::sines::Sine;
use super::transform::{cosine_transform, smooth_length};
use alloc::borrow::Cow;
use alloc::vec::Vec;
use averages::{centred, fill_gaps};
use levels::{Level, MeasuredLevels};
use realfft::FftError;

/// A record's cosine spectrum.
#[derive(Clone, Debug)]
pub(super) struct Spectrum {
    pub(super) bins: Vec<Bin>,
    /// The first coefficients times √dt, with their signs.
    pub(super) low: Vec<f64>,
    /// The lines that were removed from the bins or from the samples.
    pub(super) narrow: Vec<Narrow>,
    /// Number of samples used, lost ones included.
    pub(super) samples: usize,
    /// The lines that were sines, which were also removed from the samples.
    sines: Vec<Sine>,
    /// Whether the spectrum has more than one transform.
    pub(super) has_levels: bool,
}

/// Largest number of values in one transform.
const LONGEST: usize = 1 << 20;
/// The last level has at most `LONGEST` values, of which more than this share is present, or fewer than `FEW` values.
const NEARLY_COMPLETE: f64 = 0.99;
const FEW: usize = 256;
/// Segments give coefficients from max(length/`USED_FROM`, `FIRST`) on. Jumps at their ends disturb lower ones.
const USED_FROM: usize = 128;
const FIRST: usize = 4;
/// Rounds of the search for sines: a strong one hides weak ones.
const ROUNDS: usize = 3;
/// The removal of a sine takes `OF_A_SINE` degrees of freedom from its bin. The bin is dropped unless more than the
/// share `LEAST_LEFT` of them remains. The line of a sine has `BESIDE` coefficients on either side.
const OF_A_SINE: f64 = 3.0;
const LEAST_LEFT: f64 = 0.5;
const BESIDE: usize = 4;
/// Largest number of values in a mean of the next level.
const NEXT: usize = 16;

impl Spectrum {
    /// The spectrum of a rate; NaN is a missing sample.
    pub(super) fn of(rate: &[f64], rate_hz: f64) -> Result<Self, FftError> {
        let (mut spectrum, mut sines) = (Self::with_sines(rate, rate_hz)?, Vec::new());
        let mut left = Cow::Borrowed(rate);
        for _ in 0..ROUNDS {
            let found = search::take_out_sines(&spectrum, &mut left, rate_hz)?;
            if found.is_empty() {
                break;
            }
            sines.extend(found);
            spectrum = Self::with_sines(&left, rate_hz)?;
        }
        sines.iter().for_each(|sine| spectrum.stands_beside(sine, rate_hz));
        Ok(Self { sines, ..spectrum })
    }

    pub(super) fn without_sines<'a>(&self, rate: &'a [f64], rate_hz: f64) -> Cow<'a, [f64]> {
        let mut left = Cow::Borrowed(rate);
        self.sines.iter().for_each(|sine| sine.take_out(left.to_mut(), rate_hz));
        left
    }

    /// Adds a sine that was removed from the samples to the lines. Its removal also took noise at its frequency.
    fn stands_beside(&mut self, sine: &Sine, rate_hz: f64) {
        let hz = rate_hz / (2.0 * self.samples as f64);
        let k = libm::round(sine.hz / hz) as usize;
        let run = (k.saturating_sub(BESIDE), k + BESIDE + 1);
        let is_left = |narrow: &Narrow| !narrow.is_gone && narrow.run.0 < run.1 && run.0 < narrow.run.1;
        let left: f64 = self.narrow.iter().filter(|one| is_left(one)).map(|one| one.line.rms * one.line.rms).sum();
        self.narrow.retain(|narrow| !is_left(narrow));
        let variance = sine.variance() + left;
        let line = Line { frequency_hz: sine.hz, width_hz: 2.0 * hz, rms: libm::sqrt(variance) };
        self.narrow.push(Narrow { line, run, sines: [(variance / 4.0, sine.hz); 4], is_gone: true });
        self.bins.retain_mut(|bin| {
            if !(bin.first..bin.end).contains(&k) {
                return true;
            }
            let noise = bin.power - bin.response.offset;
            let left = (bin.freedom - OF_A_SINE) / bin.freedom;
            bin.power = bin.response.offset + noise / left;
            bin.freedom -= OF_A_SINE;
            left > LEAST_LEFT
        });
    }

    /// The spectrum of a rate, without a search for sines.
    fn with_sines(rate: &[f64], rate_hz: f64) -> Result<Self, FftError> {
        let is_complete = !rate.iter().any(|value| value.is_nan());
        if !is_complete || rate.len() > LONGEST {
            return Self::of_levels(rate, rate_hz);
        }
        let samples = smooth_length(rate.len());
        let Part { bins, low, narrow, .. } = Part::transform(&rate[..samples], rate_hz, all_edges(samples))?;
        Ok(Self { bins, low, narrow, samples, sines: Vec::new(), has_levels: false })
    }

    fn of_levels(rate: &[f64], rate_hz: f64) -> Result<Self, FftError> {
        let (mut parts, mut known) = (Vec::new(), MeasuredLevels::default());
        let (mut level, mut end_hz) = (Level::first(rate, rate_hz), rate_hz / 2.0);
        loop {
            let is_last = level.step > 1 && level.is_last();
            let mut part = if is_last { level.transformed(end_hz)? } else { level.segmented(end_hz)? };
            part.respond(&level, &known);
            known.add_below(part.bins.iter().map(|bin| (bin.middle() * part.hz, bin.density())), &part.narrow);
            end_hz = part.lowest_hz();
            parts.push(part);
            if is_last {
                return Ok(Self::joined(parts, rate_hz));
            }
            level = Level::of(rate, rate_hz, level.step * level.next())?;
        }
    }

    /// Joins the parts of all levels, which start with the fastest, in coefficients of the last.
    fn joined(parts: Vec<Part>, rate_hz: f64) -> Self {
        let hz = parts.last().map_or(rate_hz, |part| part.hz);
        let low = parts.last().map_or_else(Vec::new, |part| part.low.clone());
        let parts: Vec<Part> = parts.into_iter().rev().map(|part| part.in_units_of(hz)).collect();
        Self {
            bins: parts.iter().flat_map(|part| part.bins.iter().copied()).collect(),
            low,
            narrow: parts.into_iter().flat_map(|part| part.narrow).collect(),
            samples: libm::round(rate_hz / (2.0 * hz)) as usize,
            sines: Vec::new(),
            has_levels: true,
        }
    }

    /// Frequency and density of the bins above `top_hz`.
    pub(super) fn above(&self, top_hz: f64, rate_hz: f64) -> Vec<(f64, f64)> {
        let hz = rate_hz / (2.0 * self.samples as f64);
        let above = self.bins.iter().filter(|bin| !is_below((bin.end as f64 - 0.5) * hz, top_hz));
        above.map(|bin| (bin.middle() * hz, bin.density())).collect()
    }
}

/// The part of the spectrum from one level, in coefficients that are `hz` apart.
struct Part {
    hz: f64,
    bins: Vec<Bin>,
    low: Vec<f64>,
    narrow: Vec<Narrow>,
}

impl Part {
    fn transform(values: &[f64], rate_hz: f64, edges: Vec<Bin>) -> Result<Self, FftError> {
        let coefficients = cosine_transform(&centred(values))?;
        let power: Vec<f64> = coefficients.iter().map(|c| c * c / rate_hz).collect();
        let hz = rate_hz / (2.0 * values.len() as f64);
        let low = coefficients.iter().take(LOW).map(|c| c / libm::sqrt(rate_hz)).collect();
        let mut bins = with_power(edges, &power);
        let narrow = take_out_narrow(&power, &mut bins, hz, |width| width as f64);
        Ok(Self { hz, bins, low, narrow })
    }

    fn lowest_hz(&self) -> f64 {
        self.bins.first().map_or(0.0, |bin| (bin.first as f64 - 0.5) * self.hz)
    }

    /// Sets the response of each bin: from the density of the samples to the density of the level.
    fn respond(&mut self, level: &Level<'_>, known: &MeasuredLevels) {
        let scattered = level.scattered(known);
        for bin in &mut self.bins {
            let f_hz = bin.middle() * self.hz;
            bin.response.gain = level.gain(f_hz);
            bin.response.offset += level.folded(f_hz, known) + scattered;
        }
    }

    /// Converts bins and lines to coefficients that are `hz` apart.
    fn in_units_of(mut self, hz: f64) -> Self {
        let scale = self.hz / hz;
        let edge = |k: usize| libm::round((k as f64 - 0.5) * scale + 0.5) as usize;
        self.bins.iter_mut().for_each(|bin| (bin.first, bin.end) = (edge(bin.first), edge(bin.end)));
        self.narrow.iter_mut().for_each(|narrow| narrow.run = (edge(narrow.run.0), edge(narrow.run.1)));
        Self { hz, ..self }
    }
}

impl Level<'_> {
    /// Whether one transform gives the rest of the spectrum.
    fn is_last(&self) -> bool {
        let values = self.values.len();
        values < FEW || values <= LONGEST && self.present > NEARLY_COMPLETE
    }

    /// Number of values in a mean of the next level. The band of such means reaches well above the lowest frequency
    /// that the segments of this level give.
    fn next(&self) -> usize {
        (segments::length(self.values.len()) / (USED_FROM / FIRST)).clamp(2, NEXT)
    }

    /// The bins below `end_hz` from one transform. Missing values are filled by straight lines.
    fn transformed(&self, end_hz: f64) -> Result<Part, FftError> {
        let mut values = self.values[..smooth_length(self.values.len())].to_vec();
        fill_gaps(&mut values);
        let hz = self.rate_hz() / (2.0 * values.len() as f64);
        let end = (libm::floor(end_hz / hz + 0.5) as usize).min(values.len());
        let mut part = Part::transform(&values, self.rate_hz(), edges(1, end, usize::MAX))?;
        part.bins.iter_mut().for_each(|bin| bin.freedom *= self.present);
        part.low.truncate(end - 1); // the other levels give the bins above
        Ok(part)
    }

    /// The bins below `end_hz` from segments, down to the lowest frequency that they reach.
    fn segmented(&self, end_hz: f64) -> Result<Part, FftError> {
        let length = segments::length(self.values.len());
        let has_gaps = self.values.iter().any(|value| value.is_nan());
        let power = if has_gaps { segments::masked } else { segments::complete }(&self.values, length)?;
        let hz = self.rate_hz() / length as f64;
        let end = (libm::floor(end_hz / hz + 0.5) as usize).min(length / 2);
        let widest = if self.step == 1 { length / 2 / LINEAR } else { usize::MAX };
        let density = |power: &[f64]| -> Vec<f64> { power[1..].iter().map(|power| power / self.rate_hz()).collect() };
        let (raw, fair) = (density(&power.raw), density(&power.fair));
        let mut bins = with_power(edges((length / USED_FROM).max(FIRST), end, widest), &raw);
        // The taper correlates adjacent frequencies, and the overlap adjacent segments. So a frequency of a segment
        // counts as one degree of freedom instead of two.
        let freedom = |width: usize| width as f64 * power.count * self.present;
        bins.iter_mut().for_each(|bin| bin.freedom = freedom(bin.end - bin.first));
        let narrow = take_out_narrow(&raw, &mut bins, hz, freedom);
        let is_line = |k: &usize| narrow.iter().any(|narrow| (narrow.run.0..narrow.run.1).contains(k));
        for bin in bins.iter_mut().filter(|_| has_gaps) {
            let kept: Vec<usize> = (bin.first..bin.end).filter(|k| !is_line(k)).collect();
            let added: f64 = kept.iter().map(|k| raw[k - 1] - fair[k - 1]).sum();
            bin.response.offset = added / kept.len().max(1) as f64;
        }
        Ok(Part { hz, bins, low: Vec::new(), narrow })
    }
}

fn with_power(mut bins: Vec<Bin>, power: &[f64]) -> Vec<Bin> {
    for bin in &mut bins {
        let inside = &power[bin.first - 1..bin.end - 1];
        bin.power = inside.iter().sum::<f64>() / inside.len() as f64;
    }
    bins
}
