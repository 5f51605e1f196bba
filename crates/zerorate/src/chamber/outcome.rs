//! Computes the bias over temperature of each axis from the record of a chamber.

use super::record::{Record, Soak};
use super::refusal::ChamberRefusal;
use crate::noise::WeightedMean;
use crate::notice::Warning;
use crate::part::{Axis, NamedAxis, Part};
use crate::plan::Plan;
use crate::procedure::{Second, deviations, motions_hz, steps_s, taken_out, turning};
use crate::temperature::{self, Assumed, BiasCurve, Block};
use alloc::vec::Vec;

/// The result of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ChamberOutcome {
    /// The bias over temperature at the end of the measurement.
    pub curve: BiasCurve,
    /// The data of the curve for plots: means over 2 to 60 s each, with their residuals after the correction.
    pub residuals: Vec<Residual>,
    /// Residual of each soak point after the correction, without the removed steps and base motion, °/s.
    pub soak_residuals_dps: Vec<f64>,
    /// The hysteresis loop. `None` if the part did not pass the same bin of 5 °C in both directions.
    pub branches: Option<Branches>,
}

impl ChamberOutcome {
    /// The warnings about this axis: an unusual bias, the steps and base motion that were removed, and that rest could
    /// not be judged.
    pub fn warnings(&self, axis: &Axis) -> impl Iterator<Item = Warning> {
        let unjudged = (!axis.can_judge_rest()).then_some(Warning::RestUnjudged);
        turning(axis, self.curve.correction.pbc_dps).into_iter().chain(taken_out(&self.curve)).chain(unjudged)
    }
}

/// A corrected mean, without the steps and the base motion that were removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Middle of the averaging window, s from the start of the measurement.
    pub at_s: f64,
    /// Temperature, °C.
    pub temp_c: f64,
    /// Corrected rate, °/s.
    pub residual_dps: f64,
    /// Whether the part was warming (true), cooling (false), or neither.
    pub warming: Option<bool>,
}

/// The hysteresis loop of the bias between warming and cooling.
///
/// `half_width_dps` is half of the difference between the mean bias while cooling and the mean bias while warming,
/// over the temperatures that were passed in both directions. If the bias falls with temperature, the sign is
/// reversed, so a bias that lags has a positive half width. Both hysteresis and a lag of the sensing element open
/// the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches {
    /// Half width of the loop, °/s.
    pub half_width_dps: f64,
    /// Standard uncertainty of the half width, °/s, from all noise terms. They include the random walk between warming
    /// and cooling.
    pub u_dps: f64,
    /// Temperatures that were passed in both directions, from the coldest to the warmest, in bins of 5 °C.
    pub span_c: (f64, f64),
}

/// Largest number of means for a curve, except for a record longer than 1600 · 60 s. More would add no information.
const MOST_BLOCKS: usize = 1600;
/// Shortest and longest averaging time of a mean, s: short compared with all slow effects in a part.
const BLOCK_S: (usize, usize) = (2, 60);
/// Largest change of temperature within a mean, °C. A mean over a larger change belongs to no single temperature.
const BLOCK_SPAN_C: f64 = 5.0;
/// Smallest temperature span of a record, °C. Self-heating alone covers as much without a chamber.
const LEAST_SPAN_C: f64 = 5.0;
/// Width of the bins in which temperatures count as the same, °C.
const BIN_C: f64 = 5.0;
/// Slowest change of temperature that counts as warming or cooling, °C/s: 0.2 °C/min.
const STILL_C_PER_S: f64 = 0.2 / 60.0;
/// T3, to which the correction refers, is the mean temperature over this many seconds at the end.
const T3_S: usize = 10;

impl Record {
    /// Finds the bias over temperature of each axis of the part. `earth_dps` is the component of the Earth's rotation
    /// on the axis, °/s, which is subtracted, and `max_order` the highest order of the curve that is tried.
    ///
    /// # Errors
    /// Returns a refusal if the temperature hardly changed, the record does not determine a curve, the base moved too
    /// much, or the uncertainty of BTC is above the limit.
    pub fn outcomes(
        &self,
        part: &Part,
        earth_dps: Option<f64>,
        max_order: usize,
    ) -> Result<Vec<ChamberOutcome>, ChamberRefusal> {
        let span_c = self.span_c().map_or(0.0, |(low_c, high_c)| high_c - low_c);
        if span_c < LEAST_SPAN_C {
            return Err(ChamberRefusal::Span { span_c, least_c: LEAST_SPAN_C });
        }
        let outcome =
            |(index, axis): (usize, &NamedAxis)| self.outcome(&axis.axis, index, earth_dps.unwrap_or(0.0), max_order);
        part.axes.iter().enumerate().take(self.rates_dps.len()).map(outcome).collect()
    }

    fn outcome(
        &self,
        axis: &Axis,
        index: usize,
        earth_dps: f64,
        max_order: usize,
    ) -> Result<ChamberOutcome, ChamberRefusal> {
        let rates_dps = &self.rates_dps[index];
        let blocks = self.blocks(rates_dps, earth_dps);
        let last = &self.temp_c[self.len().saturating_sub(T3_S)..];
        let white_dps_per_rt_hz = white_density(rates_dps);
        let (steps_s, motions_hz) = self.suspects(axis, rates_dps, white_dps_per_rt_hz);
        let assumed = Assumed {
            axis,
            white_dps_per_rt_hz,
            gauss_markov: &[],
            steps_s: &steps_s,
            motions_hz: &motions_hz,
            max_order,
            t3_c: last.iter().sum::<f64>() / last.len() as f64,
        };
        let curve = temperature::fit(&blocks, &assumed).map_err(ChamberRefusal::NoCurve)?;
        let limit_dps = axis.bias.largest_supply_step_dps();
        if let Some(motion) = curve.base_motion.filter(|motion| motion.size_dps() > limit_dps) {
            return Err(ChamberRefusal::BaseMotion { hz: motion.hz, size_dps: motion.size_dps(), limit_dps });
        }
        let u_btc_dps_per_c = curve.u_btc_dps_per_c();
        let wanted_dps_per_c = Plan::default().max_u_btc_dps_per_c;
        if u_btc_dps_per_c > wanted_dps_per_c {
            return Err(ChamberRefusal::Uncertain { u_btc_dps_per_c, wanted_dps_per_c });
        }
        let residuals: Vec<Residual> = residuals(&blocks, &curve);
        let left = |soak: &Soak| {
            let &Soak { start_s, end_s, temp_c, .. } = soak;
            let rate_dps = soak.rates_dps[index] - earth_dps;
            let block = Block { start_s, length_s: end_s - start_s, rate_dps, temp_c };
            rate_dps + curve.correction.at(temp_c) - curve.disturbed_dps(&block)
        };
        let soak_residuals_dps = self.soaks.iter().map(left).collect();
        let length_s = blocks.first().map_or(1.0, |block| block.length_s);
        let branches = branches(&residuals, length_s, &curve);
        Ok(ChamberOutcome { curve, residuals, soak_residuals_dps, branches })
    }

    /// Returns the times of suspected bias steps, s, and the frequencies of possible base motions, Hz.
    fn suspects(&self, axis: &Axis, rates_dps: &[f64], white_dps_per_rt_hz: f64) -> (Vec<f64>, Vec<f64>) {
        let second = |k: usize| Second { at_s: self.start_s[k], rate_dps: rates_dps[k], temp_c: self.temp_c[k] };
        let seconds: Vec<Second> = (0..self.len()).filter(|k| self.at_rest[*k]).map(second).collect();
        let times_s = seconds.first().zip(seconds.last()).map(|(first, last)| (first.at_s, last.at_s + 1.0));
        let (Some(times_s), Some((low_c, high_c))) = (times_s, self.span_c()) else { return Default::default() };
        let found = deviations(axis, white_dps_per_rt_hz, times_s, high_c - low_c, &seconds);
        (steps_s(found.as_ref()), motions_hz(times_s.1 - times_s.0, found.as_ref()))
    }

    /// Returns the means over windows of equal length in which the part was at rest, without gaps or fast changes.
    fn blocks(&self, rates_dps: &[f64], earth_dps: f64) -> Vec<Block> {
        let length = self.len().div_ceil(MOST_BLOCKS).clamp(BLOCK_S.0, BLOCK_S.1);
        let (mut blocks, mut from) = (Vec::new(), 0);
        while from + length <= self.len() {
            let to = from + length;
            let whole_s = self.start_s[to - 1] - self.start_s[from];
            // with a gap or motion in the window, try again one second later
            if whole_s > (length - 1) as f64 + 0.5 || self.at_rest[from..to].contains(&false) {
                from += 1;
                continue;
            }
            let mean = |values: &[f64]| values[from..to].iter().sum::<f64>() / length as f64;
            let (rate_dps, temp_c) = (mean(rates_dps) - earth_dps, mean(&self.temp_c));
            let way_c = self.temp_c[to - 1] - self.temp_c[from];
            let block = Block { start_s: self.start_s[from], length_s: length as f64, rate_dps, temp_c };
            blocks.extend((way_c.abs() <= BLOCK_SPAN_C).then_some(block));
            from = to;
        }
        blocks
    }
}

/// One-sided density d of the white noise, °/s/√Hz, from the median absolute difference of adjacent seconds. The
/// differences have the variance d², and the median ignores the few seconds in which the temperature changes fast.
fn white_density(rates_dps: &[f64]) -> f64 {
    /// Median of the absolute value of a normal number of unit variance.
    const MEDIAN: f64 = 0.674_489_750_196_081_7;
    let mut steps: Vec<f64> = rates_dps.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    *median / MEDIAN
}

fn residuals(blocks: &[Block], curve: &BiasCurve) -> Vec<Residual> {
    let slope = |index: usize| {
        let (before, after) = (&blocks[index.saturating_sub(1)], &blocks[(index + 1).min(blocks.len() - 1)]);
        (after.temp_c - before.temp_c) / (after.start_s - before.start_s).max(1.0)
    };
    let residual = |(index, block): (usize, &Block)| {
        let c_per_s = slope(index);
        Residual {
            at_s: block.start_s + block.length_s / 2.0,
            temp_c: block.temp_c,
            residual_dps: block.rate_dps + curve.correction.at(block.temp_c) - curve.disturbed_dps(block),
            warming: (c_per_s.abs() > STILL_C_PER_S).then_some(c_per_s > 0.0),
        }
    };
    blocks.iter().enumerate().map(residual).collect()
}

fn branches(residuals: &[Residual], length_s: f64, curve: &BiasCurve) -> Option<Branches> {
    let bin = |residual: &Residual| libm::floor(residual.temp_c / BIN_C) as i64;
    let count =
        |of: i64, warming: bool| residuals.iter().filter(|one| bin(one) == of && one.warming == Some(warming)).count();
    let mut bins: Vec<i64> = residuals.iter().map(bin).collect();
    bins.sort_unstable();
    bins.dedup();
    let shared: Vec<(i64, usize, usize)> = bins
        .iter()
        .map(|of| (*of, count(*of, true), count(*of, false)))
        .filter(|(_, up, down)| up * down > 0)
        .collect();
    let is_shared =
        |residual: &&Residual| residual.warming.is_some() && shared.iter().any(|(of, ..)| *of == bin(residual));
    let temps_c = || residuals.iter().filter(is_shared).map(|residual| residual.temp_c);
    let span_c = (temps_c().reduce(f64::min)?, temps_c().reduce(f64::max)?);
    let share = |residual: &Residual| {
        let (_, up, down) = *shared.iter().find(|(of, ..)| *of == bin(residual))?;
        // where the bias rises, the correction falls
        let falls = curve.correction.slope_dps_per_c(residual.temp_c - curve.correction.t3_c) < 0.0;
        let one = if falls { 0.5 } else { -0.5 } / shared.len() as f64;
        Some(if residual.warming? { -one / up as f64 } else { one / down as f64 })
    };
    let parts = residuals.iter().filter_map(|residual| Some(share(residual)? * residual.residual_dps));
    Some(Branches { half_width_dps: parts.sum(), u_dps: curve.noise.sd(&windows(residuals, length_s, share)), span_c })
}

/// The windows of a weighted sum of residuals. Adjacent residuals with the same share become one window.
fn windows(residuals: &[Residual], length_s: f64, share: impl Fn(&Residual) -> Option<f64>) -> Vec<WeightedMean> {
    let mut windows: Vec<(f64, WeightedMean)> = Vec::new();
    for residual in residuals {
        let Some(weight) = share(residual) else { continue };
        let (start_s, end_s) = (residual.at_s - length_s / 2.0, residual.at_s + length_s / 2.0);
        match windows.last_mut() {
            Some((one, last)) if *one == weight && (last.end_s - start_s).abs() < 0.5 => {
                (last.end_s, last.weight) = (end_s, last.weight + weight);
            }
            _ => windows.push((weight, WeightedMean { start_s, end_s, weight })),
        }
    }
    windows.into_iter().map(|(_, window)| window).collect()
}
