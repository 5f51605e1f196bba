//! Computes PBC, BTC and T3 from the recorded windows, each with its standard uncertainty.

use super::blocks::{Blocks, Second};
use super::drift_checks::{self, Findings, SearchInput};
use super::window_sums::Summary;
use crate::correction::Correction;
use crate::health::block_means::{Adjacent, BLOCK_S};
use crate::health::{Tally, stationarity};
use crate::noise::{NoiseModel, WeightedMean};
use crate::notice::{Deviation, Refusal, Warning};
use crate::part::Axis;
use crate::plan::{Plan, STATES, State};
use crate::temperature::BiasCurve;
use crate::temperature::curve::{AxisRecord, LogCurve, MeansBuilder};
use crate::uncertainty::Uncertainty;
use alloc::vec;
use alloc::vec::Vec;
use zerorate_allan::FLOOR_PER_B;

pub(crate) struct Evidence<'a> {
    pub(crate) axis: &'a Axis,
    pub(crate) plan: &'a Plan,
    pub(crate) windows: [Summary; STATES],
    pub(crate) tally: &'a Tally,
}

impl Evidence<'_> {
    fn window(&self, state: State) -> &Summary {
        &self.windows[state as usize]
    }

    /// The typical flicker floor, or zero if it is not known.
    fn flicker_floor_dps(&self) -> f64 {
        self.axis.noise.map_or(0.0, |noise| noise.flicker_floor_dps)
    }

    /// The typical curvature. It is zero if the plan assumes a linear bias, and for a part that states none.
    fn curvature_dps_per_c2(&self) -> f64 {
        if self.plan.assume_linear { 0.0 } else { self.axis.bias.curvature_dps_per_c2.unwrap_or(0.0) }
    }

    /// The typical noise with the white part as measured.
    fn noise(&self) -> NoiseModel {
        NoiseModel { white_dps_per_rt_hz: white_density(self), ..self.axis.typical_noise() }
    }
}

/// The result of the procedure.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome<W = Vec<Warning>> {
    /// Means of steps 4 and 6 of F-51. `None` for another method.
    pub means: Option<Measured>,
    /// PBC, BTC and T3.
    pub correction: Correction,
    /// Uncertainty of PBC, BTC and T3.
    pub uncertainty: Uncertainty,
    /// The noise that the uncertainties are computed from.
    pub noise: Noise,
    /// Edges of data ready per second.
    pub rdy_hz: f64,
    /// Rate samples per second.
    pub rate_hz: f64,
    /// Rate samples read.
    pub samples: u64,
    /// Rate samples lost.
    pub lost_samples: u64,
    /// Readings with an impossible rate or temperature. No mean includes the impossible value.
    pub impossible_readings: u64,
    /// Time from the first sample to the last, s.
    pub duration_s: f64,
    /// Lowest temperature seen (mean over 0.1 s), °C.
    pub temp_min_c: f64,
    /// Highest temperature seen (mean over 0.1 s), °C.
    pub temp_max_c: f64,
    /// The plan that was carried out.
    pub plan: Plan,
    /// The warnings about the result.
    pub warnings: W,
    /// The bias over temperature. `None` for AN-1042.
    pub curve: Option<BiasCurve>,
}

/// Means of steps 4 and 6 of F-51.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "file", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[expect(missing_docs, reason = "the names of F-51, with their units")]
pub struct Measured {
    pub b1_dps: f64,
    pub t1_c: f64,
    pub b2_dps: f64,
    pub t2_c: f64,
}

impl Outcome {
    /// Returns the warnings that the outcomes of all axes of a part have in common, with the same numbers.
    pub fn shared_warnings(outcomes: &[Self]) -> impl Iterator<Item = &Warning> {
        let by_all = |warning: &&Warning| outcomes.iter().all(|outcome| outcome.warnings.contains(warning));
        outcomes.iter().take(1).flat_map(|first| &first.warnings).filter(by_all)
    }
}

/// The noise at the output. White noise is measured, and the other terms are measured as far as the record allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// White noise, flicker and random walk. White noise is always measured.
    pub model: NoiseModel,
    /// Whether the flicker was measured. Otherwise it is the part's typical value (M-04). For a curve it is then only
    /// close to this value, because its record is too short to determine it.
    pub flicker_measured: bool,
    /// Whether the rate random walk was measured.
    pub walk_measured: bool,
}

impl Noise {
    pub(crate) fn of_curve(curve: &BiasCurve) -> Self {
        let [flicker_measured, walk_measured] = curve.noise_told;
        Self { model: curve.noise, flicker_measured, walk_measured }
    }
}

/// Refuses after step 6 if the span of temperature cannot give the wanted uncertainty of BTC.
pub(crate) fn span_suffices(seen: &Evidence<'_>) -> Result<(), Refusal> {
    let slope = Slope::new(seen)?;
    let u_noise = slope.u_noise(&seen.noise());
    // T3 will be no lower than T2 if the part goes on warming, so this is the least effect of curvature.
    let u_curvature = slope.u_curvature(seen, slope.measured.t2_c);
    slope.accept(u_noise, u_curvature, seen.plan)
}

/// The warnings that need only the sums over the windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowWarnings([Option<Warning>; 13]);

impl WindowWarnings {
    /// The warnings that apply.
    pub fn iter(&self) -> impl Iterator<Item = &Warning> {
        self.0.iter().flatten()
    }
}

/// Returns the result of a finished procedure that kept the means of all seconds. If the part's noise is known,
/// deviations of the rate are searched for in these means.
pub(crate) fn outcome_of_hour(seen: &Evidence<'_>, blocks: &Blocks) -> Result<Outcome, Refusal> {
    let seconds: Vec<Second> = blocks.seconds().collect();
    let hour = match seen.axis.noise {
        Some(_) => drift_checks::findings(&seconds, &question(seen)?),
        None => None,
    };
    let eighths = match &hour {
        // A step would count as flicker, so the disturbances that were found are removed first.
        Some(hour) => blocks.eighths_less(State::Offset, |start_s, end_s| hour.disturbance_dps(start_s, end_s)),
        None => seen.window(State::Offset).eighths,
    };
    let noise = match seen.axis.noise {
        Some(_) => measured_noise(seen, eighths),
        None => noise_of_hour(seen, &seconds),
    };
    outcome(seen, hour.as_ref(), noise, |warnings| {
        let found = hour.iter().flat_map(Findings::distinct).map(Warning::Found);
        let restless = hour.iter().filter(|hour| hour.unexplained).map(|_| Warning::Restless);
        warnings.iter().copied().chain(found).chain(restless).collect()
    })
}

/// Returns the result of a finished procedure that kept only the sums over its windows.
pub(crate) fn outcome_of_windows(seen: &Evidence<'_>) -> Result<Outcome<WindowWarnings>, Refusal> {
    let noise = measured_noise(seen, seen.window(State::Offset).eighths);
    outcome(seen, None, noise, |warnings| warnings)
}

fn question(seen: &Evidence<'_>) -> Result<SearchInput, Refusal> {
    let slope = Slope::new(seen)?;
    Ok(SearchInput {
        averages: AVERAGES.map(|state| window(seen, state, 1.0)),
        span_c: slope.span_c(),
        t3_c: Level::new(seen, slope.btc_dps_per_c())?.t3_c,
        noise: seen.noise(),
        curvature_dps_per_c2: seen.curvature_dps_per_c2(),
        supply_dps_per_mv: seen.axis.bias.supply_dps_per_mv,
    })
}

fn outcome<W>(
    seen: &Evidence<'_>,
    hour: Option<&Findings>,
    noise: Noise,
    complete: impl FnOnce(WindowWarnings) -> W,
) -> Result<Outcome<W>, Refusal> {
    let plan = *seen.plan;
    let slope = Slope::new(seen)?;
    let level = Level::new(seen, slope.btc_dps_per_c())?;
    let uncertainty = uncertainty(seen, &slope, &level, &noise.model, hour);
    accept(seen, &slope, &level, &noise, &uncertainty, hour)?;

    let correction = Correction::line(level.pbc_dps, slope.btc_dps_per_c(), level.t3_c);
    let warnings = complete(warnings(seen, &level, &uncertainty, &noise, hour));
    let (tally, (temp_min_c, temp_max_c)) = (seen.tally, temperature_range(seen));
    Ok(Outcome {
        means: Some(slope.measured),
        correction,
        uncertainty,
        noise,
        rdy_hz: tally.rdy_hz(),
        rate_hz: tally.rate_hz(),
        samples: tally.samples,
        lost_samples: tally.lost,
        impossible_readings: seen.windows.iter().map(|window| window.faulty).sum(),
        duration_s: tally.duration_s(),
        temp_min_c,
        temp_max_c,
        plan,
        warnings,
        curve: None,
    })
}

/// Refuses a measurement that must not become a calibration, and names the cause. It checks the demands of the plan
/// first, and then the deviations of this unit.
fn accept(
    seen: &Evidence<'_>,
    slope: &Slope,
    level: &Level,
    noise: &Noise,
    uncertainty: &Uncertainty,
    hour: Option<&Findings>,
) -> Result<(), Refusal> {
    let bias_instability_dps = seen.axis.typical_noise().bias_instability_dps;
    let typical = NoiseModel { bias_instability_dps, ..noise.model };
    let u_curvature = slope.u_curvature(seen, level.t3_c);
    slope.accept(slope.u_noise(&typical), u_curvature, seen.plan)?;

    let wanted_dps_per_c = seen.plan.max_u_btc_dps_per_c;
    let u_btc_dps_per_c = libm::hypot(slope.u_noise(&noise.model), u_curvature);
    if u_btc_dps_per_c > wanted_dps_per_c {
        let floor_dps = FLOOR_PER_B * noise.model.bias_instability_dps;
        let typical_dps = seen.flicker_floor_dps();
        return Err(Refusal::Unsteady { floor_dps, typical_dps, u_btc_dps_per_c, wanted_dps_per_c });
    }
    let limit_dps = seen.axis.bias.largest_supply_step_dps();
    for finding in hour.iter().flat_map(|hour| &hour.found) {
        if let Deviation::BaseMotion { hz, size_dps } = finding.deviation
            && size_dps > limit_dps
        {
            return Err(Refusal::BaseMotion { hz, size_dps, limit_dps });
        }
    }
    match hour.and_then(Findings::worst_of_btc) {
        Some(finding) if uncertainty.u_btc_dps_per_c > wanted_dps_per_c => {
            let u_btc_dps_per_c = uncertainty.u_btc_dps_per_c;
            Err(Refusal::Found { finding, u_btc_dps_per_c, wanted_dps_per_c })
        }
        _ => Ok(()),
    }
}

/// Steps 4 and 6: two means and the line through them.
struct Slope {
    measured: Measured,
    windows: [WeightedMean; 2],
    u_t_c: f64,
}

impl Slope {
    fn new(seen: &Evidence<'_>) -> Result<Self, Refusal> {
        let (b1_dps, t1_c) = means(seen, State::FirstAverage)?;
        let (b2_dps, t2_c) = means(seen, State::SecondAverage)?;
        let windows = [window(seen, State::FirstAverage, -1.0), window(seen, State::SecondAverage, 1.0)];
        let measured = Measured { b1_dps, t1_c, b2_dps, t2_c };
        Ok(Self { measured, windows, u_t_c: u_temp_c(seen, State::SecondAverage) })
    }

    fn span_c(&self) -> f64 {
        self.measured.t2_c - self.measured.t1_c
    }

    /// F-51 step 6: BTC = −(B2 − B1)/(T2 − T1).
    fn btc_dps_per_c(&self) -> f64 {
        -(self.measured.b2_dps - self.measured.b1_dps) / self.span_c()
    }

    /// Uncertainty of BTC by noise of the two rates and of the two temperatures, °/s/°C.
    fn u_noise(&self, noise: &NoiseModel) -> f64 {
        let temps_dps = self.btc_dps_per_c() * self.u_t_c * core::f64::consts::SQRT_2;
        libm::hypot(noise.sd(&self.windows), temps_dps) / self.span_c().abs()
    }

    /// Uncertainty of BTC by a typical curvature, which makes the secant through T1 and T2 differ from the tangent
    /// at T3, and by the two branches of the hysteresis. It is zero if the plan assumes a linear bias.
    fn u_curvature(&self, seen: &Evidence<'_>, t3_c: f64) -> f64 {
        if seen.plan.assume_linear {
            return 0.0;
        }
        let Measured { t1_c, t2_c, .. } = self.measured;
        let curvature = seen.curvature_dps_per_c2() * (t1_c + t2_c - 2.0 * t3_c).abs();
        let branches = 2.0 * seen.axis.bias.hysteresis_dps.unwrap_or(0.0) / libm::sqrt(3.0) / self.span_c().abs();
        libm::hypot(curvature, branches)
    }

    /// The uncertainty of [`Self::u_curvature`], or a larger one if the measurement shows more. It is never
    /// smaller, because the measurement covers only a few degrees and depends on a noise model.
    fn u_curvature_seen(&self, seen: &Evidence<'_>, t3_c: f64, hour: Option<&Findings>) -> f64 {
        let typical = self.u_curvature(seen, t3_c);
        hour.map_or(typical, |hour| hour.u_curvature_dps_per_c.max(typical))
    }

    fn accept(&self, u_noise: f64, u_curvature: f64, plan: &Plan) -> Result<(), Refusal> {
        let (u_btc_dps_per_c, wanted_dps_per_c) = (libm::hypot(u_noise, u_curvature), plan.max_u_btc_dps_per_c);
        if u_btc_dps_per_c <= wanted_dps_per_c {
            Ok(())
        } else if u_curvature > u_noise {
            Err(Refusal::Curvature { u_btc_dps_per_c, u_curvature_dps_per_c: u_curvature, wanted_dps_per_c })
        } else {
            let Measured { t1_c, t2_c, .. } = self.measured;
            Err(Refusal::Span { t1_c, t2_c, u_btc_dps_per_c, wanted_dps_per_c })
        }
    }
}

/// Steps 8 and 9: the level of the bias, and T3.
struct Level {
    pbc_dps: f64,
    t3_c: f64,
    u_t3_c: f64,
    /// T3 minus the mean temperature of step 8, °C.
    drift_c: f64,
    /// Shift of PBC by `drift_c`, °/s.
    shift_dps: f64,
    btc_dps_per_c: f64,
}

impl Level {
    fn new(seen: &Evidence<'_>, btc_dps_per_c: f64) -> Result<Self, Refusal> {
        let (rate_dps, mean_c) = means(seen, State::Offset)?;
        let last = seen.window(State::FinalTemperature);
        let t3_c = last.temp_c.ok_or(seen.tally.no_temperature(State::FinalTemperature))?;
        let drift_c = t3_c - mean_c;
        let pbc_dps = seen.plan.earth_dps.unwrap_or(0.0) - rate_dps;
        let u_t3_c = u_temp_c(seen, State::FinalTemperature);
        Ok(Self { pbc_dps, t3_c, u_t3_c, drift_c, shift_dps: -btc_dps_per_c * drift_c, btc_dps_per_c })
    }
}

fn uncertainty(
    seen: &Evidence<'_>,
    slope: &Slope,
    level: &Level,
    noise: &NoiseModel,
    hour: Option<&Findings>,
) -> Uncertainty {
    let steady = noise.without_random_walk();
    let mean = [window(seen, State::Offset, 1.0)];
    let t3_dps = slope.btc_dps_per_c() * level.u_t3_c;
    let u_curvature_dps_per_c = slope.u_curvature_seen(seen, level.t3_c, hour);
    let (found_pbc, found_btc) = hour.map_or((0.0, 0.0), |hour| (hour.u_pbc_dps, hour.u_btc_dps_per_c));
    let u_pbc_dps = libm::hypot(u_offset_noise(seen, noise), libm::hypot(level.shift_dps, t3_dps));
    let u_btc_dps_per_c = libm::hypot(slope.u_noise(noise), u_curvature_dps_per_c);
    Uncertainty {
        u_b1_dps: steady.sd(&slope.windows[..1]),
        u_b2_dps: steady.sd(&slope.windows[1..]),
        u_t1_c: slope.u_t_c,
        u_t2_c: slope.u_t_c,
        u_pbc_dps: libm::hypot(u_pbc_dps, found_pbc),
        u_btc_dps_per_c: libm::hypot(u_btc_dps_per_c, found_btc),
        u_curvature_dps_per_c,
        u_t3_c: level.u_t3_c,
        cov_pbc_btc: steady.covariance(&mean, &slope.windows) / slope.span_c(),
        cov_pbc_t3: -slope.btc_dps_per_c() * level.u_t3_c * level.u_t3_c,
        drift_dps: level.shift_dps,
    }
}

/// Uncertainty of PBC by noise, °/s: white noise and flicker of the mean of step 8, and the random walk from that
/// mean to the end of the step.
fn u_offset_noise(seen: &Evidence<'_>, noise: &NoiseModel) -> f64 {
    let mean = window(seen, State::Offset, 1.0);
    let end = WeightedMean { start_s: mean.end_s - 1e-3, end_s: mean.end_s + 1e-3, weight: -1.0 };
    let walk = NoiseModel { white_dps_per_rt_hz: 0.0, bias_instability_dps: 0.0, ..*noise };
    libm::hypot(noise.without_random_walk().sd(&[mean]), walk.sd(&[mean, end]))
}

fn means(seen: &Evidence<'_>, state: State) -> Result<(f64, f64), Refusal> {
    let summary = seen.window(state);
    let rate_dps = summary.rate_dps.ok_or(Refusal::TooFew { window: state, tenths: 0, needed: 1 })?;
    Ok((rate_dps, summary.temp_c.ok_or(seen.tally.no_temperature(state))?))
}

fn window(seen: &Evidence<'_>, state: State, weight: f64) -> WeightedMean {
    let &Summary { start_s, end_s, .. } = seen.window(state);
    WeightedMean { start_s, end_s, weight }
}

/// Standard uncertainty of the mean temperature of a window, °C, from the scatter of adjacent block means.
fn u_temp_c(seen: &Evidence<'_>, state: State) -> f64 {
    let temps = seen.window(state).temps;
    libm::sqrt(temps.variance / temps.count.max(1) as f64)
}

const AVERAGES: [State; 3] = [State::FirstAverage, State::SecondAverage, State::Offset];

/// White noise density over the averages so far, °/s/√Hz.
fn white_density(seen: &Evidence<'_>) -> f64 {
    let (mut squares, mut blocks) = (0.0, 0.0);
    for state in AVERAGES {
        let rates = seen.window(state).rates;
        let density = stationarity::white_density(rates);
        squares += density * density * rates.count as f64;
        blocks += rates.count as f64;
    }
    libm::sqrt(squares / blocks)
}

/// Upper 0.1 % point of the normal distribution.
const SIGNIFICANT_Z: f64 = 3.09;

/// Returns the white noise as measured. Flicker has its typical size, unless the rate wanders significantly more in
/// step 8. Then flicker is as large as step 8 shows.
fn measured_noise(seen: &Evidence<'_>, eighths: Adjacent) -> Noise {
    let typical = seen.noise();
    let expected = typical.allan_variance(eighths.m as f64 * BLOCK_S);
    let allowance = stationarity::allowance(eighths.count.saturating_sub(1), SIGNIFICANT_Z);
    if seen.axis.noise.is_none() || eighths.variance <= expected * allowance {
        return Noise { model: typical, flicker_measured: false, walk_measured: false };
    }
    let floor_dps = seen.flicker_floor_dps();
    let floor = libm::sqrt(eighths.variance - expected + floor_dps * floor_dps);
    let model = NoiseModel { bias_instability_dps: floor / FLOOR_PER_B, ..typical };
    Noise { model, flicker_measured: true, walk_measured: false }
}

/// Returns the noise of a part whose typical noise is not known: white noise as measured, and the flicker and
/// random walk that the whole measurement shows beside the temperature. These two are zero if it gives no curve.
fn noise_of_hour(seen: &Evidence<'_>, seconds: &[Second]) -> Noise {
    let last_s = seconds.last().map_or(0.0, |second| second.at_s);
    let mut by_second = vec![(f64::NAN, f64::NAN); last_s as usize + 1];
    seconds.iter().for_each(|second| by_second[second.at_s as usize] = (second.rate_dps, second.temp_c));
    let mut means = MeansBuilder::new(by_second.len(), 1.0);
    by_second.into_iter().for_each(|(rate_dps, temp_c)| means.push(rate_dps, temp_c));
    let found = AxisRecord::new(vec![means.finish()]).and_then(|record| record.curve(&[]));
    let Ok(LogCurve { noise, .. }) = found else {
        return Noise { model: seen.noise(), flicker_measured: false, walk_measured: false };
    };
    let model = NoiseModel { white_dps_per_rt_hz: white_density(seen), ..noise };
    Noise { model, flicker_measured: true, walk_measured: true }
}

fn temperature_range(seen: &Evidence<'_>) -> (f64, f64) {
    let ranges = seen.windows.iter().map(|window| window.temp_range_c);
    ranges.fold((f64::INFINITY, f64::NEG_INFINITY), |all, range| (all.0.min(range.0), all.1.max(range.1)))
}

fn warnings(
    seen: &Evidence<'_>,
    level: &Level,
    uncertainty: &Uncertainty,
    noise: &Noise,
    hour: Option<&Findings>,
) -> WindowWarnings {
    let (plan, model) = (seen.plan, &noise.model);
    let &Level { btc_dps_per_c, drift_c, shift_dps, .. } = level;
    let (lost, samples, rate_hz) = (seen.tally.lost, seen.tally.samples, seen.tally.rate_hz());
    let faulty: u64 = seen.windows.iter().map(|window| window.faulty).sum();
    let bias = &seen.axis.bias;
    let needed_hz = seen.axis.bandwidth_hz.map(|hz| 2.0 * hz);
    let known = bias.curvature_dps_per_c2.is_some() && bias.hysteresis_dps.is_some();
    // no warning about a small BTC if a finding may hide the temperature coefficient: the finding has its own warning
    let hidden = hour.map_or(0.0, |hour| hour.u_btc_dps_per_c);
    let flat = bias.least_tempco_dps_per_c().is_some_and(|least| btc_dps_per_c.abs() + hidden < least);
    let when = |condition: bool, warning: Warning| condition.then_some(warning);
    WindowWarnings([
        Some(plan.earth_dps.map_or(Warning::EarthIncluded, |earth_dps| Warning::EarthSubtracted { earth_dps })),
        when(
            !plan.assume_linear && known,
            Warning::CurvatureUnseen { u_dps_per_c: uncertainty.u_curvature_dps_per_c },
        ),
        when(
            shift_dps.abs() > u_offset_noise(seen, model),
            Warning::Drifting { drift_c, shift_dps, u_pbc_dps: uncertainty.u_pbc_dps },
        ),
        when(
            seen.axis.noise.is_some() && plan.offset_s < model.best_averaging_s() / 2.0,
            Warning::ShortAverage { average_s: plan.offset_s, best_s: model.best_averaging_s() },
        ),
        needed_hz.filter(|needed_hz| rate_hz < *needed_hz).map(|needed_hz| Warning::Aliased { rate_hz, needed_hz }),
        when(lost > 0, Warning::Lost { lost, fraction: lost as f64 / (lost + samples) as f64 }),
        when(
            noise.flicker_measured && seen.axis.noise.is_some(),
            Warning::Wandering {
                floor_dps: FLOOR_PER_B * model.bias_instability_dps,
                typical_dps: seen.flicker_floor_dps(),
            },
        ),
        when(faulty > 0, Warning::Impossible { count: faulty, fraction: faulty as f64 / samples as f64 }),
        when(flat, Warning::Flat { btc_dps_per_c, typical_dps_per_c: -bias.tempco_dps_per_c.unwrap_or(0.0) }),
        turning(seen.axis, level.pbc_dps),
        when(hour.is_none(), Warning::HourUnchecked),
        when(!seen.axis.can_judge_rest(), Warning::RestUnjudged),
        when(!plan.assume_linear && !known, Warning::CurvatureUnknown),
    ])
}

/// Returns a warning if the bias is more than three times the spread over units, as in one unit of 370, because it may
/// be a rotation.
pub(crate) fn turning(axis: &Axis, pbc_dps: f64) -> Option<Warning> {
    let typical_dps = axis.bias.initial_dps.filter(|typical_dps| pbc_dps.abs() > 3.0 * typical_dps)?;
    Some(Warning::Turning { rate_dps: -pbc_dps, typical_dps })
}
