//! Finds the bias over temperature from one recording of a part at rest. It looks for deviations that stand out, and
//! then all blocks go into one estimate ([`temperature`](crate::temperature)).

use super::blocks::{Blocks, Second};
use super::drift_checks::{self, Findings, SearchInput};
use super::estimate::{Evidence, Noise, Outcome, turning};
use super::window_sums::{Summary, WindowSums};
#[cfg(feature = "std")]
use crate::health::block_means::BLOCK_S;
use crate::health::stationarity;
use crate::noise::{NoiseModel, WeightedMean};
use crate::notice::{Deviation, Finding, Refusal, Warning};
use crate::part::{Axis, SelfHeating};
use crate::plan::{Method, Plan, State};
use crate::temperature::sweeps::covered_c;
use crate::temperature::{self, Assumed, BaseMotion, BiasCurve, Block, ThermalError};
use crate::uncertainty::Uncertainty;
use alloc::vec::Vec;
#[cfg(feature = "std")]
use zerorate_allan::{self as allan, FitOptions, Input, Term};

/// Largest number of blocks of a recording. More blocks add no information.
const MOST_BLOCKS: f64 = 1600.0;
/// Shortest block, s.
const SHORTEST_S: f64 = 2.0;

/// The uncertainties that a recording would have if it ended now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// Standard uncertainty of the correction, rms over the temperatures seen, °/s.
    pub u_dps: f64,
    /// Standard uncertainty of PBC, °/s.
    pub u_pbc_dps: f64,
    /// Standard uncertainty of BTC, °/s/°C.
    pub u_btc_dps_per_c: f64,
    /// Expected time until the temperature has settled, s, if it changes as by a typical self-heating. Infinite in the
    /// first minute.
    pub left_s: f64,
    /// Whether the temperature has settled: the remaining change is within the margin of the calibration.
    pub settled: bool,
}

/// Time constant with which a typical self-heating settles, s (M-03).
const SETTLING_S: f64 = 600.0;
/// Least time over which the slope of the temperature is taken, s.
const SLOPE_S: f64 = 60.0;

impl Reached {
    /// Returns the time of the next estimate after the one at `looked_s`, s. The intervals grow, because an estimate
    /// takes longer for a longer recording.
    #[must_use]
    pub const fn next_look_s(looked_s: f64) -> f64 {
        looked_s + (looked_s / 10.0).max(60.0)
    }

    /// Combines two axes: each number comes from the worse axis.
    pub(crate) fn or_worse(self, other: Self) -> Self {
        Self {
            u_dps: self.u_dps.max(other.u_dps),
            u_pbc_dps: self.u_pbc_dps.max(other.u_pbc_dps),
            u_btc_dps_per_c: self.u_btc_dps_per_c.max(other.u_btc_dps_per_c),
            left_s: self.left_s.max(other.left_s),
            settled: self.settled && other.settled,
        }
    }
}

pub(crate) fn reached(seen: &Evidence<'_>, sums: &Blocks) -> Result<Reached, Refusal> {
    let Outcome { uncertainty, curve, .. } = outcome(seen, sums)?;
    let left_s = settles_in_s(&sums.seconds().collect::<Vec<_>>(), seen.axis.temp_margin_c());
    Ok(Reached {
        u_dps: curve.as_ref().map_or(f64::INFINITY, rms_u_dps),
        u_pbc_dps: uncertainty.u_pbc_dps,
        u_btc_dps_per_c: uncertainty.u_btc_dps_per_c,
        left_s,
        settled: left_s <= 0.0,
    })
}

/// Time until the remaining change of temperature is within the margin, s. The temperature is assumed to change as by
/// self-heating.
fn settles_in_s(seconds: &[Second], margin_c: f64) -> f64 {
    let Some(last) = seconds.last() else { return f64::INFINITY };
    let before = seconds.iter().rev().find(|second| second.at_s <= last.at_s - SLOPE_S);
    before.map_or(f64::INFINITY, |before| {
        let to_come_c = (last.temp_c - before.temp_c) / (last.at_s - before.at_s) * SETTLING_S;
        (SETTLING_S * libm::log(to_come_c.abs() / margin_c)).max(0.0)
    })
}

/// The forecast for a recording before it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Time at which the recording ends, s.
    pub after_s: f64,
    /// Standard uncertainty of the correction by then, rms over the temperatures of a typical self-heating, °/s.
    pub u_dps: f64,
}

impl Axis {
    /// Forecasts when a typical unit has settled and its correction reaches the standard uncertainty `target_dps`,
    /// °/s. The forecast is for `total_s`, s, if the correction does not reach that uncertainty earlier. `None` if the
    /// noise, the self-heating or the temperature coefficient is not known.
    #[must_use]
    pub fn forecast(&self, target_dps: f64, total_s: f64) -> Option<Forecast> {
        let heating = self.self_heating?;
        let settled_s = heating.settles_to_s(self.temp_margin_c()).min(total_s);
        let at = |after_s: f64| Some(Forecast { after_s, u_dps: self.expected_u_dps(&heating, after_s)? });
        let mut forecasts = temperature::geometric(settled_s, total_s, 1.25).filter_map(at);
        forecasts.find(|forecast| forecast.u_dps <= target_dps).or_else(|| at(total_s))
    }

    /// Standard uncertainty that is expected at a time, °/s. It depends on temperatures and noise, not on the rates.
    fn expected_u_dps(&self, heating: &SelfHeating, after_s: f64) -> Option<f64> {
        let noise = self.noise?;
        let count = libm::floor(after_s / SHORTEST_S) as u32;
        let block = |k: u32| {
            let start_s = f64::from(k) * SHORTEST_S;
            let temp_c = heating.rise_c(start_s + SHORTEST_S / 2.0);
            Block { start_s, length_s: SHORTEST_S, rate_dps: 0.0, temp_c }
        };
        let blocks: Vec<Block> = (0..count).map(block).collect();
        let assumed = Assumed {
            axis: self,
            white_dps_per_rt_hz: noise.white_dps_per_rt_hz,
            gauss_markov: &[],
            steps_s: &[],
            motions_hz: &[],
            max_order: 1,
            t3_c: blocks.last()?.temp_c,
        };
        temperature::expected(&blocks, &assumed).map(|curve| rms_u_dps(&curve))
    }
}

pub(crate) fn outcome(seen: &Evidence<'_>, sums: &Blocks) -> Result<Outcome, Refusal> {
    let seconds: Vec<Second> = sums.seconds().collect();
    let summary = sums.summary(State::Recording);
    turned(seen.plan, &seconds)?;
    let (low_c, high_c) = summary.temp_range_c;
    let white_dps_per_rt_hz = stationarity::white_density(summary.rates);
    let times_s = (summary.start_s, summary.end_s);
    let hour = deviations(seen.axis, white_dps_per_rt_hz, times_s, high_c - low_c, &seconds);
    let mut curve = curve(seen, sums, &summary, &seconds, hour.as_ref())?;
    curve.correction.pbc_dps += seen.plan.earth_dps.unwrap_or(0.0);
    accept(seen, &curve, hour.as_ref())?;
    let (tally, (temp_min_c, temp_max_c)) = (seen.tally, summary.temp_range_c);
    Ok(Outcome {
        means: None,
        correction: curve.correction,
        uncertainty: uncertainty_of(&curve),
        noise: Noise::of_curve(&curve),
        rdy_hz: tally.rdy_hz(),
        rate_hz: tally.rate_hz(),
        samples: tally.samples,
        lost_samples: tally.lost,
        impossible_readings: summary.faulty,
        duration_s: tally.duration_s(),
        temp_min_c,
        temp_max_c,
        // a recording has no steps
        plan: Plan { average_s: 0.0, warmup_s: 0.0, settle_s: 0.0, offset_s: 0.0, ..*seen.plan },
        warnings: warnings(seen, &summary, &curve, hour.as_ref()),
        curve: Some(curve),
    })
}

/// Checks that a cycle shows both branches of a hysteresis: it must cover at least half of its span while rising and
/// while falling.
fn turned(plan: &Plan, seconds: &[Second]) -> Result<(), Refusal> {
    if plan.method != Method::Cycle {
        return Ok(());
    }
    let temps_c = seconds.iter().map(|second| second.temp_c);
    let (low_c, high_c) = temps_c.clone().fold((f64::MAX, f64::MIN), |(low, high), c| (low.min(c), high.max(c)));
    let half_c = (high_c - low_c) / 2.0;
    let (rise_c, fall_c) = covered_c(temps_c);
    if rise_c >= half_c && fall_c >= half_c && half_c > 0.0 {
        return Ok(());
    }
    Err(Refusal::OneWay { rise_c, fall_c })
}

/// Looks for deviations of the rate in a recording with this beginning and end, s, whose highest temperature is
/// `span_c` above its lowest. `None` if the part's noise is not known, or the seconds are too few for a search.
pub(crate) fn deviations(
    axis: &Axis,
    white_dps_per_rt_hz: f64,
    (start_s, end_s): (f64, f64),
    span_c: f64,
    seconds: &[Second],
) -> Option<Findings> {
    axis.noise?;
    let tenth_s = (end_s - start_s) / 10.0;
    let window = |start_s: f64| WeightedMean { start_s, end_s: start_s + tenth_s, weight: 1.0 };
    let question = SearchInput {
        averages: [window(start_s), window(start_s + 4.5 * tenth_s), window(end_s - tenth_s)],
        span_c: span_c.max(f64::MIN_POSITIVE),
        t3_c: final_temp_c(seconds)?,
        noise: NoiseModel { white_dps_per_rt_hz, ..axis.typical_noise() },
        curvature_dps_per_c2: axis.bias.curvature_dps_per_c2.unwrap_or(0.0),
        supply_dps_per_mv: axis.bias.supply_dps_per_mv,
    };
    drift_checks::findings(seconds, &question)
}

/// Returns the times of suspected steps, s.
pub(crate) fn steps_s(hour: Option<&Findings>) -> Vec<f64> {
    let found = hour.into_iter().flat_map(|hour| &hour.found);
    found
        .filter_map(|finding| if let Deviation::Step { at_s, .. } = finding.deviation { Some(at_s) } else { None })
        .collect()
}

/// Cycles per recording of the slowest and of the fastest base motion that is always tried.
const SLOW_CYCLES: (f64, f64) = (0.25, 4.0);
/// Ratio of adjacent frequencies of the base motions that are always tried.
const BASE_MOTION_RATIO: f64 = 1.15;

/// Returns the frequencies of possible base motions, Hz, in rising order: slow ones, which look like a bias that
/// wanders, and those near the oscillations that were found.
pub(crate) fn motions_hz(length_s: f64, hour: Option<&Findings>) -> Vec<f64> {
    let cycles = temperature::geometric(SLOW_CYCLES.0, SLOW_CYCLES.1, BASE_MOTION_RATIO);
    let mut all: Vec<f64> = cycles.map(|count| count / length_s).collect();
    for finding in hour.into_iter().flat_map(|hour| &hour.found) {
        if let Deviation::BaseMotion { hz, .. } = finding.deviation {
            all.extend([-0.5, -0.25, 0.0, 0.25, 0.5].map(|cycles| hz + cycles / length_s));
        }
    }
    all.retain(|hz| *hz * length_s >= SLOW_CYCLES.0);
    all.sort_by(f64::total_cmp);
    all
}

/// Returns the noise of the recording itself: the white noise as a one-sided density, °/s/√Hz, and σ (°/s) and τ (s)
/// of each Gauss–Markov term. It comes from a model of the rates minus the curve and the base motion, without outliers
/// and steps. `None` if the recording is too short for a model, no model fits, or the model has no white noise.
#[cfg(feature = "std")]
fn own_noise(sums: &Blocks, curve: &BiasCurve) -> Option<(f64, Vec<(f64, f64)>)> {
    let left = |(k, (rate_dps, temp_c)): (usize, (f64, f64))| {
        let motion_dps = curve.base_motion.map_or(0.0, |motion| motion.at((k as f64 + 0.5) * BLOCK_S));
        rate_dps + curve.correction.at(temp_c) - motion_dps
    };
    let left: Vec<f64> = sums.tenths(State::Recording).enumerate().map(left).collect();
    let fit = allan::fit(&Input::Rate(&left), 1.0 / BLOCK_S, &FitOptions::default()).ok()?;
    let term = |term: &Term| match term {
        Term::GaussMarkov { sigma, tau_s } => Some((sigma.value, tau_s.value)),
        _ => None,
    };
    let terms = fit.terms.iter().filter_map(term).collect();
    (!fit.is_rejected && fit.n.value > 0.0).then_some((core::f64::consts::SQRT_2 * fit.n.value, terms))
}

/// Without the feature `std` there is no model of the spectrum, and the white noise comes from adjacent blocks.
#[cfg(not(feature = "std"))]
fn own_noise(_: &Blocks, _: &BiasCurve) -> Option<(f64, Vec<(f64, f64)>)> {
    None
}

fn no_curve(error: ThermalError) -> Refusal {
    match error {
        ThermalError::TooFew { blocks, needed } => Refusal::TooFewMeans { means: blocks, needed },
        ThermalError::Degenerate => Refusal::NoCurve,
    }
}

/// Fits a curve under the white noise of adjacent blocks, and again under the recording's own noise, if that is known.
/// The models of the curve decide whether the suspected steps and base motions are real.
fn curve(
    seen: &Evidence<'_>,
    sums: &Blocks,
    summary: &Summary,
    seconds: &[Second],
    hour: Option<&Findings>,
) -> Result<BiasCurve, Refusal> {
    let (steps_s, motions_hz) = (steps_s(hour), motions_hz(summary.end_s - summary.start_s, hour));
    let assumed = Assumed {
        axis: seen.axis,
        white_dps_per_rt_hz: stationarity::white_density(summary.rates),
        gauss_markov: &[],
        steps_s: &steps_s,
        motions_hz: &motions_hz,
        max_order: if seen.plan.assume_linear { 1 } else { temperature::TERMS - 1 },
        t3_c: final_temp_c(seconds).ok_or(seen.tally.no_temperature(State::Recording))?,
    };
    let blocks = blocks(seconds);
    let first = temperature::fit(&blocks, &assumed).map_err(no_curve)?;
    let Some((white_dps_per_rt_hz, terms)) = own_noise(sums, &first) else { return Ok(first) };
    let assumed = Assumed { white_dps_per_rt_hz, gauss_markov: &terms, ..assumed };
    temperature::fit(&blocks, &assumed).map_err(no_curve)
}

/// Takes the uncertainties and the covariance of PBC and BTC from a curve. All others are zero.
fn uncertainty_of(curve: &BiasCurve) -> Uncertainty {
    let covariance = &curve.covariance;
    Uncertainty {
        u_pbc_dps: libm::sqrt(covariance[0][0]),
        u_btc_dps_per_c: curve.u_btc_dps_per_c(),
        cov_pbc_btc: covariance[0][1],
        ..Uncertainty::default()
    }
}

/// T3: the mean temperature of the last second, as in step 9 of F-51.
fn final_temp_c(seconds: &[Second]) -> Option<f64> {
    seconds.last().map(|second| second.temp_c)
}

/// Puts the seconds into blocks of one length. Blocks with less than half of their seconds are left out.
fn blocks(seconds: &[Second]) -> Vec<Block> {
    let total_s = seconds.last().map_or(0.0, |second| second.at_s + 1.0);
    let length_s = libm::ceil(total_s / MOST_BLOCKS).max(SHORTEST_S);
    let index = |second: &Second| libm::floor((second.at_s + 0.5) / length_s);
    seconds
        .chunk_by(|a, b| index(a) == index(b))
        .filter(|chunk| 2.0 * chunk.len() as f64 >= length_s)
        .map(|chunk| {
            let mean = |of: fn(&Second) -> f64| chunk.iter().map(of).sum::<f64>() / chunk.len() as f64;
            Block {
                start_s: index(&chunk[0]) * length_s,
                length_s,
                rate_dps: mean(|s| s.rate_dps),
                temp_c: mean(|s| s.temp_c),
            }
        })
        .collect()
}

/// Standard uncertainty of the correction, rms over the span, °/s.
fn rms_u_dps(curve: &BiasCurve) -> f64 {
    let (low_c, high_c) = curve.span_c;
    let squares = (0..9).map(|k| curve.u_dps(low_c + (high_c - low_c) * f64::from(k) / 8.0)).map(|u| u * u);
    libm::sqrt(squares.sum::<f64>() / 9.0)
}

/// Refuses a large base motion, and a slope that is too uncertain.
fn accept(seen: &Evidence<'_>, curve: &BiasCurve, hour: Option<&Findings>) -> Result<(), Refusal> {
    let limit_dps = seen.axis.bias.largest_supply_step_dps();
    if let Some(motion) = curve.base_motion
        && motion.size_dps() > limit_dps
    {
        return Err(Refusal::BaseMotion { hz: motion.hz, size_dps: motion.size_dps(), limit_dps });
    }
    let wanted_dps_per_c = seen.plan.max_u_btc_dps_per_c;
    let u_btc_dps_per_c = curve.u_btc_dps_per_c();
    if u_btc_dps_per_c <= wanted_dps_per_c {
        return Ok(());
    }
    let found = hour.into_iter().flat_map(|hour| &hour.found);
    let step = found.into_iter().find(|finding| matches!(finding.deviation, Deviation::Step { .. })).copied();
    // a base motion that was removed causes no error
    let taken = |motion: BaseMotion| {
        let deviation = Deviation::BaseMotion { hz: motion.hz, size_dps: motion.size_dps() };
        Finding { deviation, pbc_dps: 0.0, btc_dps_per_c: 0.0 }
    };
    match curve.base_motion.map(taken).or(step) {
        Some(finding) => Err(Refusal::StepOrTemperature { finding, u_btc_dps_per_c, wanted_dps_per_c }),
        None => {
            let (t1_c, t2_c) = curve.span_c;
            Err(Refusal::Span { t1_c, t2_c, u_btc_dps_per_c, wanted_dps_per_c })
        }
    }
}

fn warnings(seen: &Evidence<'_>, summary: &Summary, curve: &BiasCurve, hour: Option<&Findings>) -> Vec<Warning> {
    let (plan, axis, tally) = (seen.plan, seen.axis, seen.tally);
    let (lost, samples, faulty, rate_hz) = (tally.lost, tally.samples, summary.faulty, tally.rate_hz());
    let needed_hz = axis.bandwidth_hz.map(|hz| 2.0 * hz);
    let (u_dps, lag_s) = (rms_u_dps(curve), curve.following.lag_s);
    let when = |condition: bool, warning: Warning| condition.then_some(warning);
    let of_run = [
        Some(plan.earth_dps.map_or(Warning::EarthIncluded, |earth_dps| Warning::EarthSubtracted { earth_dps })),
        needed_hz.filter(|needed_hz| rate_hz < *needed_hz).map(|needed_hz| Warning::Aliased { rate_hz, needed_hz }),
        when(lost > 0, Warning::Lost { lost, fraction: lost as f64 / (lost + samples) as f64 }),
        when(faulty > 0, Warning::Impossible { count: faulty, fraction: faulty as f64 / samples as f64 }),
        when(!axis.can_judge_rest(), Warning::RestUnjudged),
        turning(axis, curve.correction.pbc_dps),
        when(hour.is_none(), Warning::HourUnchecked),
        plan.target_dps.filter(|target| u_dps > *target).map(|target_dps| Warning::TargetMissed { u_dps, target_dps }),
        when(plan.method == Method::Warmup, Warning::OneBranch { hysteresis_dps: axis.bias.hysteresis_dps }),
        when(curve.is_late && lag_s > LAG_WORTH_SAYING_S, Warning::Late { lag_s }),
        when(hour.is_some_and(|hour| hour.unexplained), Warning::Restless),
    ];
    of_run.into_iter().flatten().chain(taken_out(curve)).collect()
}

/// The warnings about steps and a base motion that were removed from a curve.
pub(crate) fn taken_out(curve: &BiasCurve) -> impl Iterator<Item = Warning> {
    let taken =
        |step: temperature::Step| Warning::StepTaken { at_s: step.at_s, size_dps: step.size_dps, u_dps: step.u_dps };
    let removed = |motion: BaseMotion| Warning::BaseMotionRemoved { hz: motion.hz, size_dps: motion.size_dps() };
    curve.steps.into_iter().flatten().map(taken).chain(curve.base_motion.map(removed))
}

/// Shortest lag with a warning, s. A shorter one moves a bias by less than its uncertainty.
const LAG_WORTH_SAYING_S: f64 = 5.0;
