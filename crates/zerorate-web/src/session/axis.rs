//! Collects the readings of one axis, and computes the values that the page shows.

use super::strips::{Strips, Values};
use crate::message::{AxisNow, Rest, RestVerdict};
use std::collections::VecDeque;
use zerorate::health::stationarity::{Verdict, judge};
use zerorate::health::{Health, Judged};
use zerorate::{Axis, Calibration, CodeSum, NamedAxis, Reading};

/// Length of a block of averaged samples, ns. The function `judge`, which detects rest, needs this length.
pub const BLOCK_NS: u64 = 100_000_000;
/// Length of a block, s: `BLOCK_NS`.
pub const BLOCK_S: f64 = 0.1;
/// Number of blocks in the displayed mean: one second.
const SHOWN: usize = 10;
/// Number of blocks for the verdict on rest: 10 s.
const JUDGED: usize = 100;
/// Number of blocks that are kept: one minute. The result of a calibration shows their mean rate with and without the
/// correction.
const KEPT: usize = 600;

/// The means over a block.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Rate, °/s; NaN if no reading is valid.
    pub rate_dps: f64,
    /// Corrected rate, °/s; NaN without a correction or a valid reading.
    pub corrected_dps: f64,
    /// Temperature, °C; NaN if none was read.
    pub temp_c: f64,
}

#[derive(Debug)]
pub struct AxisState {
    pub axis: Axis,
    pub name: String,
    pub health: Health,
    pub strips: Strips,
    pub angle: Angle,
    open: Sums,
    blocks: VecDeque<Block>,
    temp_c: f64,
    /// The last verdict on rest, updated once a second.
    rest: Rest,
    closed: u64,
}

#[derive(Debug, Default)]
struct Sums {
    rate: CodeSum,
    temp: CodeSum,
    corrected_dps: f64,
    corrected: u32,
}

impl AxisState {
    pub fn new(named: &NamedAxis) -> Self {
        Self {
            axis: named.axis,
            name: named.name.to_string(),
            health: Health::new(&named.axis),
            strips: Strips::default(),
            angle: Angle::default(),
            open: Sums::default(),
            blocks: VecDeque::new(),
            temp_c: f64::NAN,
            rest: Rest { verdict: RestVerdict::Unjudged, text: NOT_YET.to_owned() },
            closed: 0,
        }
    }

    /// Adds any reading, valid or not, to the strips. `at_ns` is its time since the first reading. Returns the judged
    /// reading that came two before it; `None` if there is none.
    #[inline]
    pub fn show(&mut self, at_ns: u64, reading: &Reading, correct: impl Fn(f64) -> Option<f64>) -> Option<Judged> {
        let rate_dps = self.axis.rate.value(reading.rate.into());
        if let Some(temp) = reading.temp {
            self.temp_c = self.axis.temp.value(temp.into());
        }
        let corrected_dps = correct(rate_dps).unwrap_or(f64::NAN);
        self.strips.push(at_ns, Values { rate_dps, corrected_dps, temp_c: self.temp_c });
        self.health.push(reading)
    }

    /// Adds the valid values of a judged reading to the block, and its valid rate to the angle.
    #[inline]
    pub fn count(&mut self, judged: &Judged, corrected_dps: Option<f64>) {
        if let Some(temp) = judged.temp() {
            self.open.temp.push(temp);
        }
        let Some(rate) = judged.rate() else { return };
        self.open.rate.push(rate);
        if let Some(corrected_dps) = corrected_dps {
            self.open.corrected_dps += corrected_dps;
            self.open.corrected += 1;
        }
        let rate_dps = corrected_dps.unwrap_or_else(|| self.axis.rate.value(rate.into()));
        self.angle.push(judged.reading.t_ns, rate_dps);
    }

    pub fn close_block(&mut self) -> Block {
        let sums = std::mem::take(&mut self.open);
        let or_none = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let block = Block {
            rate_dps: or_none(sums.rate.mean(&self.axis.rate)),
            corrected_dps: sums.corrected_dps / f64::from(sums.corrected),
            temp_c: or_none(sums.temp.mean(&self.axis.temp)),
        };
        if self.blocks.len() == KEPT {
            self.blocks.pop_front();
        }
        self.blocks.push_back(block);
        self.closed += 1;
        if self.closed.is_multiple_of(SHOWN as u64) {
            self.rest = self.judged();
        }
        block
    }

    pub fn now(&self, applied: Option<&Calibration>, extrapolated: bool) -> AxisNow {
        let shown = self.newest(SHOWN);
        let temp_c = mean(shown.iter().map(|block| block.temp_c));
        let white = self.white_dps_per_rt_hz();
        let u_rate_dps = white.map(|white| white / (2.0 * shown.len() as f64 * BLOCK_S).sqrt());
        let of_axis = applied.and_then(|calibration| calibration.axis(&self.name));
        let u_correction_dps = of_axis.zip(temp_c).and_then(|(axis, temp_c)| axis.u_correction_dps(temp_c));
        AxisNow {
            rate_dps: mean(shown.iter().map(|block| block.rate_dps)),
            u_rate_dps,
            corrected_dps: mean(shown.iter().map(|block| block.corrected_dps)),
            u_corrected_dps: u_rate_dps.zip(u_correction_dps).map(|(rate, correction)| rate.hypot(correction)),
            extrapolated,
            angle_deg: self.angle.deg,
            u_angle_deg: white.map(|white| self.angle.u_deg(white, u_correction_dps)),
            rest: self.rest.clone(),
        }
    }

    /// Mean rate, °/s, and mean temperature, °C, over the last minute; `None` if one of them is unknown.
    pub fn last_minute(&self) -> Option<(f64, f64)> {
        let blocks = self.newest(KEPT);
        Some((mean(blocks.iter().map(|block| block.rate_dps))?, mean(blocks.iter().map(|block| block.temp_c))?))
    }

    /// Mean temperature over the last second, °C; `None` if unknown.
    pub fn temp_c(&self) -> Option<f64> {
        mean(self.newest(SHOWN).iter().map(|block| block.temp_c))
    }

    fn newest(&self, count: usize) -> Vec<Block> {
        self.blocks.iter().skip(self.blocks.len().saturating_sub(count)).copied().collect()
    }

    /// One-sided noise density d, °/s/√Hz, over the last minute; `None` before there are ten differences of adjacent
    /// block means. Their variance is d²/τ, where τ is the block length.
    fn white_dps_per_rt_hz(&self) -> Option<f64> {
        let rates = self.blocks.iter().map(|block| block.rate_dps);
        let steps = rates.clone().zip(rates.skip(1)).map(|(one, next)| (next - one) * (next - one));
        let known: Vec<f64> = steps.filter(|square| !square.is_nan()).collect();
        (known.len() >= SHOWN).then(|| (known.iter().sum::<f64>() / known.len() as f64 * BLOCK_S).sqrt())
    }

    /// False if by the last verdict the part moves, or has more white noise than its type can have.
    pub fn is_at_rest(&self) -> bool {
        !matches!(self.rest.verdict, RestVerdict::Moving | RestVerdict::Noisy)
    }

    fn judged(&self) -> Rest {
        let rest = |verdict, text: String| Rest { verdict, text };
        let blocks = self.newest(JUDGED);
        let rates: Vec<f64> = blocks.iter().map(|block| block.rate_dps).filter(|rate| !rate.is_nan()).collect();
        if !self.axis.can_judge_rest() {
            return rest(RestVerdict::Unjudged, "the typical noise or tempco of this part is unknown".to_owned());
        }
        if rates.len() < JUDGED {
            return rest(RestVerdict::Unjudged, NOT_YET.to_owned());
        }
        if let Some(limit_dps) = self.axis.bias.largest_dps()
            && let Some(rate_dps) = mean(rates.iter().copied()).filter(|rate_dps| rate_dps.abs() > limit_dps)
        {
            let text = format!("it turns: {rate_dps:+.2} °/s is more than the largest bias, ±{limit_dps} °/s");
            return rest(RestVerdict::Moving, text);
        }
        match judge(&self.axis, &rates, slope_c_per_s(&blocks)) {
            Verdict::AtRest => rest(RestVerdict::AtRest, "noise explains how the rate varies".to_owned()),
            Verdict::Step { at_s, size_dps } => {
                let ago_s = rates.len() as f64 * BLOCK_S - at_s;
                rest(RestVerdict::Step, format!("a step of {size_dps:+.4} °/s, {ago_s:.0} s ago"))
            }
            Verdict::Moving { tau_s, seen_dps, limit_dps } => rest(
                RestVerdict::Moving,
                format!("means over {tau_s:.1} s vary by {seen_dps:.4} °/s, but noise explains {limit_dps:.4} °/s"),
            ),
            Verdict::Noisy { seen_dps_per_rt_hz, limit_dps_per_rt_hz } => rest(
                RestVerdict::Noisy,
                format!("noise of {seen_dps_per_rt_hz:.4} °/s/√Hz, above {limit_dps_per_rt_hz:.4} °/s/√Hz"),
            ),
        }
    }
}

const NOT_YET: &str = "it takes 10 s of readings";

/// The mean of the values that are not NaN; `None` if there are none.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) =
        values.filter(|value| !value.is_nan()).fold((0.0, 0u32), |(sum, n), value| (sum + value, n + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// The temperature's slope, from the means of the first and the second half, °C/s; 0 if one of them is unknown.
fn slope_c_per_s(blocks: &[Block]) -> f64 {
    let (early, late) = blocks.split_at(blocks.len() / 2);
    let [early, late] = [early, late].map(|half| mean(half.iter().map(|block| block.temp_c)));
    early.zip(late).map_or(0.0, |(early, late)| (late - early) / (blocks.len() as f64 / 2.0 * BLOCK_S))
}

/// An angle: the integral of a rate.
#[derive(Debug, Default)]
pub struct Angle {
    deg: f64,
    over_s: f64,
    last: Option<(u64, f64)>,
}

impl Angle {
    /// Integrates by the trapezoidal rule. Missing readings are interpolated linearly.
    #[inline]
    fn push(&mut self, t_ns: u64, rate_dps: f64) {
        if let Some((last_ns, last_dps)) = self.last.replace((t_ns, rate_dps)) {
            let dt_s = t_ns.saturating_sub(last_ns) as f64 * 1e-9;
            self.deg += 0.5 * (rate_dps + last_dps) * dt_s;
            self.over_s += dt_s;
        }
    }

    pub fn zero(&mut self) {
        (self.deg, self.over_s) = (0.0, 0.0);
    }

    /// Standard uncertainty due to angle random walk and the correction's error, °: √(d²t/2 + u²t²), with the noise
    /// density d, the standard uncertainty u of the correction and the time t.
    fn u_deg(&self, white_dps_per_rt_hz: f64, u_correction_dps: Option<f64>) -> f64 {
        let walk = white_dps_per_rt_hz * (self.over_s / 2.0).sqrt();
        walk.hypot(u_correction_dps.unwrap_or(0.0) * self.over_s)
    }
}
