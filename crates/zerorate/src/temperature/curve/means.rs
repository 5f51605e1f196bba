//! Means over short blocks of a log, from its samples one by one.

use super::thermometer::{Thermometer, line, smooth, without_failures};
use crate::temperature::follow::LagAndPlay;
use crate::temperature::{Block, gls};
use alloc::vec::Vec;

/// Number of parts of a block. The parts show the course of the temperature within the block, and the white noise.
const PARTS: usize = 8;
/// Approximate number of blocks of a log. A short log has fewer, because a block has at least [`SHORTEST_S`] and eight
/// samples.
const BLOCKS: f64 = 900.0;
/// Shortest block, s, before the number of samples in each of its parts is rounded.
const SHORTEST_S: f64 = 1.0;
/// Share of its samples that a block must have at least.
const LEAST_SAMPLES: f64 = 0.5;
/// Time at the start of a log over which the change of the temperature is taken, s.
const START_S: f64 = 60.0;
/// Share of the temperature span by which the temperature must change in `START_S` to count as changing at the start.
const CHANGES: f64 = 0.01;
/// Distance of a reading from the median of its part from which it is an outlier, °C.
const OUTLIER_C: f64 = 2.0;
/// Ratio of the code step to the deviation of samples above which rounding remains in the means.
const ROUNDED: f64 = 2.0;
/// The samples of a block count as constant if their variance is at most this share of the median over the blocks.
const STANDS: f64 = 1e-6;
/// The sensor counts as moving in a block whose variance is more than this many times the median over the blocks.
const MOVES: f64 = 4.0;

/// The means of one log for one axis.
#[derive(Clone, Debug)]
pub struct LogMeans {
    blocks: Vec<Block>,
    /// Position of each block in the log, counted in blocks.
    indices: Vec<usize>,
    length_s: f64,
    /// Temperature of each part of a block, without gaps, °C.
    parts_c: Vec<f64>,
    /// One-sided density of the white noise, in the unit of the samples per √Hz.
    white: f64,
    /// One-sided density of the white noise of the temperature, °C/√Hz.
    temps_white: f64,
    /// Standard uncertainty by rounding to codes. It is zero if the noise averages the rounding out.
    pub(super) rounding: f64,
    /// Times in which the sensor moves: begin and end, s.
    moving_s: Vec<(f64, f64)>,
    /// Number of blocks with enough samples that vary, and with a temperature, whether the sensor moves or not.
    seen: usize,
    thermometer: Thermometer,
    /// Whether the sensor was on before the log began. `None` if that is not known.
    was_on: Option<bool>,
}

/// Sums over a part of a block.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    count: u32,
    sum: f64,
    squares: f64,
    temp_c: Option<f64>,
    last_c: Option<f64>,
}

impl Part {
    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / f64::from(self.count))
    }
}

/// Builds [`LogMeans`] from the samples of a log.
#[derive(Debug)]
pub struct MeansBuilder {
    rate_hz: f64,
    /// Number of samples in a part.
    per_part: usize,
    parts: Vec<Part>,
    samples: usize,
    /// Readings of the temperature in the last part, °C.
    readings_c: Vec<f64>,
    last: f64,
    /// Smallest difference between successive samples that differ.
    quantum: f64,
    /// The first sample that is a number. It is subtracted before summing, so that squares keep their digits.
    origin: Option<f64>,
    was_on: Option<bool>,
}

impl MeansBuilder {
    /// Begins the means of a log with this many samples, missing ones included.
    #[must_use]
    pub fn new(samples: usize, rate_hz: f64) -> Self {
        let length_s = (samples as f64 / rate_hz / BLOCKS).max(SHORTEST_S);
        let per_part = (libm::round(length_s * rate_hz / PARTS as f64) as usize).max(1);
        Self {
            rate_hz,
            per_part,
            parts: Vec::new(),
            samples: 0,
            readings_c: Vec::new(),
            last: f64::NAN,
            quantum: f64::MAX,
            origin: None,
            was_on: None,
        }
    }

    /// Says whether the sensor was on before the log began, if that is known. If it was on, a bias that lags is behind
    /// from the start. If it was off, the bias begins in balance.
    #[must_use]
    pub fn was_on(self, was_on: Option<bool>) -> Self {
        Self { was_on, ..self }
    }

    /// Takes the next sample and its temperature, °C. NaN marks a missing value.
    pub fn push(&mut self, value: f64, temp_c: f64) {
        if self.samples.is_multiple_of(self.per_part) {
            self.end_part();
            self.parts.push(Part::default());
        }
        self.samples += 1;
        let change = (value - self.last).abs();
        if change > 0.0 && change < self.quantum {
            self.quantum = change;
        }
        self.last = value;
        if !temp_c.is_nan() {
            self.readings_c.push(temp_c);
        }
        let Some(part) = self.parts.last_mut() else { return };
        if !value.is_nan() {
            let value = value - *self.origin.get_or_insert(value);
            part.count += 1;
            part.sum += value;
            part.squares += value * value;
        }
    }

    /// Sets the temperature of the last part: the mean of its readings without outliers.
    fn end_part(&mut self) {
        let Some(part) = self.parts.last_mut() else { return };
        let middle_c = median(self.readings_c.clone());
        let is_near = |temp_c: &&f64| (**temp_c - middle_c).abs() < OUTLIER_C;
        let (sum, count) = self.readings_c.iter().filter(is_near).fold((0.0, 0.0), |(sum, n), c| (sum + c, n + 1.0));
        part.temp_c = (count > 0.0).then(|| sum / count);
        part.last_c = self.readings_c.iter().rfind(is_near).copied();
        self.readings_c.clear();
    }

    /// Returns the means over the blocks. An incomplete last block is left out.
    #[must_use]
    pub fn finish(mut self) -> LogMeans {
        self.end_part();
        let part_s = self.per_part as f64 / self.rate_hz;
        let length_s = PARTS as f64 * part_s;
        let last_c: Vec<f64> = self.parts.iter().map(|part| part.last_c.unwrap_or(f64::NAN)).collect();
        let means_c: Vec<f64> = self.parts.iter().map(|part| part.temp_c.unwrap_or(f64::NAN)).collect();
        let (last_c, means_c) = (without_failures(last_c), without_failures(means_c));
        let (parts_c, thermometer) = smooth(&last_c, &means_c, part_s);
        let least = LEAST_SAMPLES * (PARTS * self.per_part) as f64;
        let is_full = |parts: &[Part]| f64::from(parts.iter().map(|part| part.count).sum::<u32>()) >= least;
        let is_known = |k: usize| parts_c[k * PARTS..(k + 1) * PARTS].iter().all(|temp_c| !temp_c.is_nan());
        let full = self.parts.chunks_exact(PARTS).enumerate().filter(|(k, parts)| is_full(parts) && is_known(*k));
        let mut full: Vec<(usize, &[Part], f64)> = full.map(|(k, parts)| (k, parts, variance(parts))).collect();
        let usual = median(full.iter().map(|(.., variance)| *variance).collect());
        // if most blocks vary, others are clipped or constant
        full.retain(|(.., variance)| usual == 0.0 || *variance > STANDS * usual);
        let moves = |variance: f64| variance > MOVES * usual && usual > 0.0;
        let moving_s = spans(full.iter().filter(|(.., variance)| moves(*variance)).map(|(k, ..)| *k), length_s);
        let seen = full.len();
        let still = || full.iter().filter(|(.., variance)| !moves(*variance));
        let white = libm::sqrt(2.0 * part_s * median(still().map(|(_, parts, _)| white_variance(parts)).collect()));
        let block = |(k, parts, _): &(usize, &[Part], f64)| Block {
            start_s: *k as f64 * length_s,
            length_s,
            rate_dps: self.origin.unwrap_or(0.0) + mean(parts),
            temp_c: parts_c[k * PARTS..(k + 1) * PARTS].iter().sum::<f64>() / PARTS as f64,
        };
        let (blocks, indices) = (still().map(block).collect(), still().map(|(k, ..)| *k).collect());
        let temps_white = libm::sqrt(2.0 * part_s * median(white_temps(&parts_c)));
        let is_rounded = self.quantum < f64::MAX && self.quantum > ROUNDED * libm::sqrt(usual);
        let rounding = if is_rounded { self.quantum / libm::sqrt(12.0) } else { 0.0 };
        let (parts_c, was_on) = (filled(parts_c), self.was_on);
        LogMeans {
            blocks,
            indices,
            length_s,
            parts_c,
            white,
            temps_white,
            rounding,
            moving_s,
            seen,
            thermometer,
            was_on,
        }
    }
}

fn mean(parts: &[Part]) -> f64 {
    let count: u32 = parts.iter().map(|part| part.count).sum();
    parts.iter().map(|part| part.sum).sum::<f64>() / f64::from(count)
}

/// Variance of the samples within a block.
fn variance(parts: &[Part]) -> f64 {
    let count = f64::from(parts.iter().map(|part| part.count).sum::<u32>());
    let mean = mean(parts);
    parts.iter().map(|part| part.squares).sum::<f64>() / count - mean * mean
}

/// Ratio of the median to the expectation of the mean square of seven adjacent differences.
const MEDIAN_OF_DIFFERENCES: f64 = 0.87;

/// Variance of the means of parts, from their differences, which slow changes hardly affect.
fn white_variance(parts: &[Part]) -> f64 {
    let differences = parts.windows(2).filter_map(|pair| Some(pair[1].mean()? - pair[0].mean()?));
    let (sum, count) = differences.fold((0.0, 0u32), |(sum, count), d| (sum + d * d, count + 1));
    if count == 0 { 0.0 } else { sum / f64::from(2 * count) / MEDIAN_OF_DIFFERENCES }
}

/// Variances by white noise of the temperatures of parts, one for each block without gaps.
fn white_temps(parts_c: &[f64]) -> Vec<f64> {
    let of_block = |temps_c: &[f64]| {
        // second differences, which slow changes of the temperature hardly affect
        let squares = temps_c.windows(3).map(|three| three[0] - 2.0 * three[1] + three[2]).map(|d| d * d);
        squares.sum::<f64>() / 6.0 / (temps_c.len().max(3) - 2) as f64
    };
    parts_c.chunks_exact(PARTS).map(of_block).filter(|variance| !variance.is_nan()).collect()
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Joins adjacent blocks, and returns their times: begin and end, s.
fn spans(blocks: impl Iterator<Item = usize>, length_s: f64) -> Vec<(f64, f64)> {
    let mut spans: Vec<(f64, f64)> = Vec::new();
    for k in blocks {
        let (from_s, to_s) = (k as f64 * length_s, (k + 1) as f64 * length_s);
        match spans.last_mut() {
            Some(last) if from_s - last.1 < length_s / 2.0 => last.1 = to_s,
            _ => spans.push((from_s, to_s)),
        }
    }
    spans
}

/// Slope of a line through means.
pub(super) fn slope_per_c<'a>(blocks: impl Iterator<Item = &'a Block> + Clone) -> f64 {
    let count = blocks.clone().count().max(1) as f64;
    let mean = |of: fn(&Block) -> f64| blocks.clone().map(of).sum::<f64>() / count;
    let (temp_c, value) = (mean(|block| block.temp_c), mean(|block| block.rate_dps));
    let products = blocks.map(|block| (block.temp_c - temp_c, block.rate_dps - value));
    let (square, product) = products.fold((0.0, 0.0), |(square, product), (t, v)| (square + t * t, product + t * v));
    if square > 0.0 { product / square } else { 0.0 }
}

/// Fits a parabola to each value and the `reach` values to either side, and returns its value and slope there. Near
/// the ends, the same number of values is used.
fn local_parabolas(values: &[f64], reach: usize) -> Vec<[f64; 2]> {
    let width = (2 * reach + 1).min(values.len());
    let smoothed = |at: usize| {
        let from = at.saturating_sub(reach).min(values.len() - width);
        let powers = |k: usize| (0..width).map(|j| libm::pow((from + j) as f64 - at as f64, k as f64)).collect();
        let columns: Vec<Vec<f64>> = (0..PARABOLA).map(powers).collect();
        let fit = gls::Fit::new(&columns, &values[from..from + width]);
        fit.map_or([values[at], 0.0], |fit| [fit.coefficients[0], fit.coefficients[1]])
    };
    (0..values.len()).map(smoothed).collect()
}

const PARABOLA: usize = 3;

/// Returns the temperatures with gaps filled by linear interpolation, and at the ends by the nearest temperature.
fn filled(mut temps_c: Vec<f64>) -> Vec<f64> {
    let known: Vec<usize> = (0..temps_c.len()).filter(|k| !temps_c[*k].is_nan()).collect();
    if let (Some(&first), Some(&last)) = (known.first(), known.last()) {
        let (first_c, last_c) = (temps_c[first], temps_c[last]);
        temps_c[..first].fill(first_c);
        temps_c[last..].fill(last_c);
    }
    known.windows(2).for_each(|pair| line(&mut temps_c, pair[0], pair[1]));
    temps_c
}

impl LogMeans {
    /// The means, without outliers that were removed, and without those of a moving sensor.
    #[must_use]
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Times in which the sensor moves: begin and end, s.
    #[must_use]
    pub fn moving_s(&self) -> &[(f64, f64)] {
        &self.moving_s
    }

    /// Share of the blocks in which the sensor moves, as long as no outliers were removed.
    #[must_use]
    pub fn moving_share(&self) -> f64 {
        if self.seen == 0 { 0.0 } else { 1.0 - self.blocks.len() as f64 / self.seen as f64 }
    }

    /// The steps, the sticking, the smoothing and the lag of the thermometer.
    #[must_use]
    pub fn thermometer(&self) -> Thermometer {
        self.thermometer
    }

    /// Length of the log, s.
    #[must_use]
    pub fn length_of_log_s(&self) -> f64 {
        self.parts_c.len() as f64 * self.length_s / PARTS as f64
    }

    /// Density of the white noise, including the noise of the temperature for this slope of the bias.
    pub(super) fn white(&self, slope_per_c: f64) -> f64 {
        libm::hypot(self.white, slope_per_c * self.temps_white)
    }

    /// The same means with the temperature smoothed by a local parabola over `reach` blocks to either side. It is also
    /// corrected for a thermometer that lags the sensor by `late_s`. Without smoothing, a lag would be found where
    /// there is none, because a lag averages the noise of the thermometer.
    #[must_use]
    pub(super) fn smoothed(&self, reach: usize, late_s: f64) -> Self {
        let parabolas = local_parabolas(&self.block_temps_c(), reach);
        let temps_c: Vec<f64> =
            parabolas.into_iter().map(|[temp_c, per_block]| temp_c + per_block / self.length_s * late_s).collect();
        let thermometer =
            Thermometer { smoothed_s: (2 * reach + 1) as f64 * self.length_s, late_s, ..self.thermometer };
        let last = temps_c.len().saturating_sub(1);
        let at = |part: usize| {
            let place = (part as f64 + 0.5) / PARTS as f64 - 0.5;
            let from = (libm::floor(place.max(0.0)) as usize).min(last.saturating_sub(1));
            let to = (from + 1).min(last);
            temps_c[from] + (temps_c[to] - temps_c[from]) * (place - from as f64)
        };
        let parts_c: Vec<f64> = (0..self.parts_c.len()).map(at).collect();
        let mut blocks = self.blocks.clone();
        blocks.iter_mut().zip(&self.indices).for_each(|(block, k)| block.temp_c = temps_c[*k]);
        Self { blocks, parts_c, temps_white: 0.0, thermometer, ..self.clone() }
    }

    /// Mean temperature of each block, without gaps, °C.
    fn block_temps_c(&self) -> Vec<f64> {
        self.parts_c.chunks(PARTS).map(|parts_c| parts_c.iter().sum::<f64>() / parts_c.len() as f64).collect()
    }

    /// Ratio of the noise that the thermometer brings into a mean to the white noise of the mean.
    pub(super) fn noise_by_temperature(&self) -> f64 {
        let temps_c = self.block_temps_c();
        let squares = temps_c.windows(3).map(|three| three[0] - 2.0 * three[1] + three[2]).map(|d| d * d);
        let noise_c = libm::sqrt(squares.sum::<f64>() / 6.0 / temps_c.len().max(1) as f64);
        let of_mean = self.white / libm::sqrt(2.0 * self.length_s);
        (slope_per_c(self.blocks.iter()) * noise_c).abs() / of_mean.max(f64::MIN_POSITIVE)
    }

    pub(super) fn block_s(&self) -> f64 {
        self.length_s
    }

    pub(super) fn remove(&mut self, at: usize) {
        self.blocks.remove(at);
        self.indices.remove(at);
    }

    /// Keeps the blocks that `other` has as well. Both must come from the same log.
    pub(super) fn keep_blocks_of(&mut self, other: &Self) {
        let kept: Vec<bool> = self.indices.iter().map(|index| other.indices.binary_search(index).is_ok()).collect();
        self.keep(|place| kept[place]);
    }

    /// Keeps the blocks whose place in `blocks` fulfils a condition.
    pub(super) fn keep(&mut self, is_kept: impl Fn(usize) -> bool) {
        let kept: Vec<usize> = (0..self.blocks.len()).filter(|place| is_kept(*place)).collect();
        self.blocks = kept.iter().map(|place| self.blocks[*place]).collect();
        self.indices = kept.iter().map(|place| self.indices[*place]).collect();
    }

    /// The temperature that the bias follows, for each block, °C. `was_on` is whether the sensor was on before the log
    /// began. It counts only if the log does not state this.
    #[must_use]
    pub fn followed_c(&self, following: &LagAndPlay, was_on: bool) -> Vec<f64> {
        self.followed(following, was_on, 1.0).0
    }

    /// For each block the temperature that the bias follows, °C, and the place of the lagging temperature in a play
    /// of ±`play_c`, from −1 while the temperature falls to 1 while it rises.
    pub(super) fn followed(&self, following: &LagAndPlay, was_on: bool, play_c: f64) -> (Vec<f64>, Vec<f64>) {
        let part_s = self.length_s / PARTS as f64;
        let decay = if following.lag_s > 0.0 { libm::exp(-part_s / following.lag_s) } else { 0.0 };
        let first_c = self.first_c(following, was_on);
        let (mut late_c, mut held_c, mut turned_c) = (first_c, first_c, first_c);
        let (mut sums, mut places) = (Vec::new(), Vec::new());
        for parts_c in self.parts_c.chunks(PARTS) {
            let (mut sum_c, mut place) = (0.0, 0.0);
            for temp_c in parts_c {
                late_c = temp_c + (late_c - temp_c) * decay;
                held_c = held_c.clamp(late_c - following.play_c, late_c + following.play_c);
                turned_c = turned_c.clamp(late_c - play_c, late_c + play_c);
                sum_c += held_c;
                place += (late_c - turned_c) / play_c;
            }
            sums.push(sum_c / parts_c.len() as f64);
            places.push(place / parts_c.len() as f64);
        }
        let of = |all: Vec<f64>| self.indices.iter().map(|k| all[*k]).collect();
        (of(sums), of(places))
    }

    /// The temperature that the bias follows at the start of the log, °C.
    fn first_c(&self, following: &LagAndPlay, was_on: bool) -> f64 {
        let behind_c = if self.was_on(was_on) { self.start_c_per_s() * following.lag_s } else { 0.0 };
        self.parts_c.first().copied().unwrap_or(0.0) - behind_c
    }

    /// Whether the sensor was on before the log began. Returns `unknown` if the log does not state this.
    pub(super) fn was_on(&self, unknown: bool) -> bool {
        self.was_on.unwrap_or(unknown)
    }

    /// Whether the log does not state if the sensor was on before, and its temperature changes from the start. False
    /// for a coarse thermometer, which does not show how the temperature starts.
    pub(super) fn may_have_been_on(&self) -> bool {
        let ends = |(low, high): (f64, f64), c: &f64| (low.min(*c), high.max(*c));
        let (low_c, high_c) = self.parts_c.iter().fold((f64::MAX, f64::MIN), ends);
        let tells = self.was_on.is_none() && self.thermometer.coarse_step_c.is_none();
        tells && self.start_c_per_s().abs() * START_S > CHANGES * (high_c - low_c)
    }

    pub(super) fn start_c_per_s(&self) -> f64 {
        let part_s = self.length_s / PARTS as f64;
        let later = ((START_S / part_s) as usize).max(PARTS).min(self.parts_c.len() - 1);
        (self.parts_c[later] - self.parts_c[0]) / (later as f64 * part_s)
    }

    /// Returns the temperature at the end of the log, and the one that the bias follows there without a play, °C.
    pub(super) fn at_end(&self, following: &LagAndPlay, was_on: bool) -> Option<(f64, f64)> {
        let last_c = *self.parts_c.last()?;
        let part_s = self.length_s / PARTS as f64;
        let decay = if following.lag_s > 0.0 { libm::exp(-part_s / following.lag_s) } else { 0.0 };
        let follow = |late_c, temp_c: &f64| temp_c + (late_c - temp_c) * decay;
        let late_c = self.parts_c.iter().fold(self.first_c(following, was_on), follow);
        Some((last_c, late_c))
    }
}
