//! Tests the estimator on simulated logs whose bias curve is known.

use super::*;
use crate::noise::tests::Normal;
use std::vec;

const RATE_HZ: f64 = 10.0;

/// A log of a sensor that warms from 5 °C for 30 minutes.
struct Simulated {
    seed: u64,
    /// Time constant with which the bias lags the thermometer, s.
    lag_s: f64,
    /// Half width of the play, °C.
    play_c: f64,
    /// Whether the sensor cools again, for another 30 minutes.
    cools: bool,
    /// Offset of the bias in this log.
    offset: f64,
    /// Step of the thermometer, °C.
    step_c: f64,
    /// Time from switch-on to the start of the log, samples.
    begins: usize,
    /// Coefficients of the bias in powers of (T − 25 °C)/20 °C, the constant first.
    bias: [f64; 4],
}

const WARMING: Simulated = Simulated {
    seed: 1,
    lag_s: 0.0,
    play_c: 0.0,
    cools: false,
    offset: 0.0,
    step_c: 0.003,
    begins: 0,
    bias: [0.5, 0.4, -0.08, 0.03],
};
const N: f64 = 0.002;

impl Simulated {
    fn bias(&self, temp_c: f64) -> f64 {
        let d = (temp_c - 25.0) / 20.0;
        self.bias.iter().rev().fold(0.0, |sum, term| sum * d + term)
    }

    /// Returns the rate and the temperature, °C, of each sample.
    fn samples(&self) -> Vec<(f64, f64)> {
        let half = 18_000;
        let warm = |k: usize| 5.0 + 40.0 * (1.0 - libm::exp(-(k as f64) / RATE_HZ / 500.0));
        let top_c = warm(half);
        let temp = |k: usize| {
            let course_c = match k.checked_sub(half) {
                None => warm(k),
                Some(after) => 5.0 + (top_c - 5.0) * libm::exp(-(after as f64) / RATE_HZ / 600.0),
            };
            // without the sine, a lag and a bent curve would look alike
            course_c + 0.3 * libm::sin(k as f64 / RATE_HZ / 100.0)
        };
        let mut random = Normal(self.seed);
        let decay = if self.lag_s > 0.0 { libm::exp(-1.0 / RATE_HZ / self.lag_s) } else { 0.0 };
        let (mut late_c, mut held_c) = (5.0_f64, 5.0_f64);
        let count = if self.cools { 2 * half } else { half };
        let sample = |k: usize| {
            let temp_c = temp(k);
            late_c = temp_c + (late_c - temp_c) * decay;
            held_c = held_c.clamp(late_c - self.play_c, late_c + self.play_c);
            let rate = self.bias(held_c) + self.offset + random.next() * N * libm::sqrt(RATE_HZ / 2.0);
            (rate, libm::round(temp_c / self.step_c) * self.step_c)
        };
        (0..count).map(sample).skip(self.begins).collect()
    }

    fn means(&self) -> LogMeans {
        means(&self.samples())
    }
}

fn means(samples: &[(f64, f64)]) -> LogMeans {
    let mut builder = MeansBuilder::new(samples.len(), RATE_HZ);
    samples.iter().for_each(|(rate, temp_c)| builder.push(*rate, *temp_c));
    builder.finish()
}

fn curve(logs: Vec<LogMeans>) -> LogCurve {
    AxisRecord::new(logs).unwrap().curve(&[]).unwrap()
}

/// Largest error of a curve between 8 and 40 °C, and the largest ratio of an error to its stated uncertainty.
fn error(curve: &LogCurve, truth: impl Fn(f64) -> f64) -> (f64, f64) {
    let errors = (8..=40).map(|c| (curve.at(c.into()) - truth(c.into()), curve.u_at(c.into())));
    errors.fold((0.0, 0.0), |(most, ratio): (f64, f64), (e, u)| (most.max(e.abs()), ratio.max(e.abs() / u)))
}

#[test]
fn a_bias_that_follows_at_once_is_found_without_a_lag() {
    let found = curve(vec![WARMING.means()]);
    let (most, ratio) = error(&found, |c| WARMING.bias(c));
    assert!(most < 0.001 && ratio < 3.5, "{most} {ratio} {found:?}");
    assert!(found.late_probability < 0.5 && found.log_odds > 100.0, "{found:?}");
    assert_eq!((found.hysteresis, found.spread_of_starts), (None, None));
    assert!(found.span.after < 0.05 * found.span.before, "{:?}", found.span);
    let warnings = found.warnings(&[WARMING.means()], "°/s");
    assert_eq!(warnings, [CurveWarning::OneDirection]);
}

#[test]
fn a_lag_is_found_and_the_curve_is_true() {
    let late = Simulated { lag_s: 60.0, ..WARMING };
    let found = curve(vec![late.means()]);
    assert!((found.following.lag_s - 60.0).abs() < 6.0, "{:?}", found.following);
    let (most, ratio) = error(&found, |c| late.bias(c));
    assert!(most < 0.004 && ratio < 3.5, "{most} {ratio}");
}

/// In a log that begins two minutes after switch-on, the bias is behind from the start.
#[test]
fn a_lag_is_found_where_the_sensor_was_on_before() {
    let late = Simulated { lag_s: 60.0, begins: 1200, ..WARMING };
    let found = curve(vec![late.means()]);
    assert!(found.was_on && (found.following.lag_s - 60.0).abs() < 10.0, "{:?}", found.following);
    let off = (15..=40).map(|c| (found.at(c.into()) - late.bias(c.into())).abs());
    assert!(off.fold(0.0, f64::max) < 0.005);
    assert!(!curve(vec![Simulated { begins: 0, ..late }.means()]).was_on);
}

#[test]
fn the_other_axes_tell_the_lag_of_a_flat_axis() {
    let steep = Simulated { lag_s: 60.0, ..WARMING };
    let flat = Simulated { lag_s: 60.0, bias: [0.0, 0.001, 0.0, 0.0], seed: 3, ..WARMING };
    let [steep, flat] = [steep, flat].map(|axis| AxisRecord::new(vec![axis.means()]).unwrap());
    let alone = flat.curve(&[]).unwrap();
    let together = flat.curve(&[steep.lag()]).unwrap();
    assert!((together.following.lag_s - 60.0).abs() < 8.0, "{:?}", together.following);
    assert!((alone.following.lag_s - 60.0).abs() > 15.0, "{:?}", alone.following);
}

/// Returns the curve that another thermometer gives, its largest error, and the largest ratio of an error to its
/// uncertainty.
fn with_thermometer(of: &Simulated, thermometer: impl Fn(usize, f64, &mut Normal) -> f64) -> (LogCurve, f64, f64) {
    let mut random = Normal(77);
    let mut samples = of.samples();
    samples.iter_mut().enumerate().for_each(|(k, (_, temp_c))| *temp_c = thermometer(k, *temp_c, &mut random));
    let found = curve(vec![means(&samples)]);
    let (most, ratio) = error(&found, |c| of.bias(c));
    (found, most, ratio)
}

/// A lag averages the noise of the thermometer. If the readings are not smoothed, a lag is found where there is none,
/// and the curve is off by 0.03 °/s.
#[test]
fn noise_of_the_thermometer_is_not_a_lag() {
    let (found, most, ratio) = with_thermometer(&WARMING, |_, temp_c, random| temp_c + 0.5 * random.next());
    assert!(found.lag_s() < 3.0 && most < 0.005 && ratio < 4.0, "{} {most} {ratio}", found.lag_s());
}

/// A lag averages a draught that only the thermometer feels. The curve with that lag is off by 0.1 °/s.
#[test]
fn a_draught_at_the_thermometer_is_not_taken_for_a_lag() {
    for (draught_c, memory_s, largest) in [(0.3, 10.0, 0.01), (1.0, 60.0, 0.1)] {
        let (air_c, kept) = (std::cell::Cell::new(0.0), libm::exp(-1.0 / RATE_HZ / memory_s));
        let draughty = |_: usize, temp_c: f64, random: &mut Normal| {
            air_c.set(kept * air_c.get() + draught_c * libm::sqrt(1.0 - kept * kept) * random.next());
            temp_c + air_c.get()
        };
        let (found, most, ratio) = with_thermometer(&WARMING, draughty);
        let said = found.lag_or_draught_s;
        assert!(said.is_some() && found.lag_s() < 3.0, "{said:?} {}", found.lag_s());
        assert!(most < largest && ratio < 2.5, "{most} {ratio}");
    }
}

#[test]
fn failed_readings_of_the_temperature_are_left_out() {
    let failing = |k: usize, temp_c: f64, _: &mut Normal| if k % 900 < 12 { 0.0 } else { temp_c };
    let (found, most, ratio) = with_thermometer(&WARMING, failing);
    assert!(found.lag_s() < 3.0 && most < 0.002 && ratio < 3.5, "{} {most} {ratio}", found.lag_s());
}

#[test]
fn a_thermometer_that_lags_the_sensor_is_found() {
    let late_c = std::cell::Cell::new(f64::NAN);
    let late = |_: usize, temp_c: f64, _: &mut Normal| {
        let before_c = if late_c.get().is_nan() { temp_c } else { late_c.get() };
        late_c.set(temp_c + (before_c - temp_c) * libm::exp(-1.0 / RATE_HZ / 20.0));
        late_c.get()
    };
    let (found, most, ratio) = with_thermometer(&WARMING, late);
    assert!((found.lag_s() + 20.0).abs() < 5.0 && most < 0.004 && ratio < 4.0, "{} {most} {ratio}", found.lag_s());
}

/// A kink that no series of order 6 follows looks like a lag of a sixth of the log. A curve with this lag is off by
/// 0.4 °/s.
#[test]
fn a_lag_at_the_longest_that_is_tried_is_not_taken() {
    let mut samples = WARMING.samples();
    samples.iter_mut().for_each(|(rate, temp_c)| *rate += 0.02 * (*temp_c - 25.0).abs());
    let found = curve(vec![means(&samples)]);
    let (most, _) = error(&found, |c| WARMING.bias(c) + 0.02 * (c - 25.0).abs());
    assert!(found.long_lag_s.is_some() && found.lag_s() == 0.0 && most < 0.05, "{:?} {most}", found.following);
}

/// A hysteresis whose offset changes its sign within a fifth of the temperature span.
#[test]
fn a_slow_turn_of_a_hysteresis_is_found() {
    let both = Simulated { cools: true, ..WARMING };
    let mut samples = both.samples();
    let mut turned_c: f64 = 5.0;
    samples.iter_mut().for_each(|(rate, temp_c)| {
        turned_c = turned_c.clamp(*temp_c - 8.0, *temp_c + 8.0);
        *rate += 0.02 * (*temp_c - turned_c) / 8.0;
    });
    let found = curve(vec![means(&samples)]);
    let hysteresis = found.hysteresis.unwrap_or(0.0);
    assert!((hysteresis - 0.02).abs() < 0.004, "{hysteresis}");
}

#[test]
fn both_directions_show_a_hysteresis() {
    let with_play = Simulated { cools: true, play_c: 1.0, ..WARMING };
    let found = curve(vec![with_play.means()]);
    // half the difference is the slope of about 0.02 per °C times 1 °C
    let half = found.hysteresis.unwrap();
    assert!((half - 0.02).abs() < 0.005, "{half} {:?}", found.following);
    let (most, ratio) = error(&found, |c| with_play.bias(c));
    assert!(most < 0.01 && ratio < 3.5, "{most} {ratio}");
    let without = curve(vec![Simulated { cools: true, ..WARMING }.means()]);
    assert!(without.hysteresis.unwrap() < 0.002, "{:?}", without.hysteresis);
}

#[test]
fn several_starts_show_their_spread() {
    let start = |seed, offset| Simulated { seed, offset, ..WARMING }.means();
    let logs = vec![start(1, 0.03), start(2, -0.03), start(3, 0.02), start(4, -0.02)];
    let found = curve(logs);
    let spread = found.spread_of_starts.unwrap();
    assert!((0.01..0.08).contains(&spread), "{spread}");
    let (_, ratio) = error(&found, |c| WARMING.bias(c));
    assert!(ratio < 2.0, "{ratio}");
}

#[test]
fn jumps_and_glitches_are_taken_out() {
    let mut samples = WARMING.samples();
    samples[9_000..].iter_mut().for_each(|(rate, _)| *rate += 0.05);
    samples[4_000..4_010].iter_mut().for_each(|(rate, _)| *rate += 0.1);
    let found = curve(vec![means(&samples)]);
    assert_eq!(found.steps.len(), 1, "{:?}", found.steps);
    let step = found.steps[0];
    assert!((step.at_s - 900.0).abs() < 3.0 && (step.size - 0.05).abs() < 0.003, "{step:?}");
    let (most, _) = error(&found, |c| WARMING.bias(c));
    assert!(most < 0.003 && found.glitches <= 3, "{most} {}", found.glitches);
}

#[test]
fn motion_is_left_out_and_long_motion_is_refused() {
    let mut samples = WARMING.samples();
    let turn = |k: usize| 5.0 * libm::sin(k as f64 / 7.0);
    samples[6_000..6_600].iter_mut().enumerate().for_each(|(k, (rate, _))| *rate += turn(k));
    let moved = means(&samples);
    assert!((moved.moving_s()[0].0 - 600.0).abs() < 4.0 && (moved.moving_s()[0].1 - 660.0).abs() < 4.0);
    let (most, _) = error(&curve(vec![moved]), |c| WARMING.bias(c));
    assert!(most < 0.002, "{most}");
    samples[6_000..13_000].iter_mut().enumerate().for_each(|(k, (rate, _))| *rate += turn(k));
    let moved = [means(&samples)];
    assert!(matches!(check([&moved[..]].into_iter()), Err(CurveRefusal::Moves { .. })));
}

#[test]
fn a_coarse_thermometer_is_taken_as_intervals() {
    let coarse = Simulated { step_c: 1.0, ..WARMING };
    let log = coarse.means();
    assert_eq!(log.thermometer().coarse_step_c, Some(1.0));
    let found = curve(vec![log]);
    let (most, _) = error(&found, |c| coarse.bias(c));
    assert!(most < 0.004, "{most}");
}

#[test]
fn a_thermometer_that_sticks_is_left_out() {
    let mut samples = WARMING.samples();
    let stuck_c = samples[3_000].1;
    samples[3_000..5_000].iter_mut().for_each(|(_, temp_c)| *temp_c = stuck_c);
    let log = means(&samples);
    assert!((log.thermometer().stuck_s - 200.0).abs() < 5.0, "{:?}", log.thermometer());
    let (most, _) = error(&curve(vec![log]), |c| WARMING.bias(c));
    assert!(most < 0.002, "{most}");
}

#[test]
fn a_temperature_that_the_bias_does_not_follow_gives_a_warning() {
    let mut samples = Simulated { bias: [0.5, 0.0, 0.0, 0.0], ..WARMING }.samples();
    let walk = |k: usize| 0.01 * libm::sin(k as f64 / 300.0);
    samples.iter_mut().enumerate().for_each(|(k, (rate, _))| *rate += walk(k));
    let log = means(&samples);
    let warnings = curve(vec![log.clone()]).warnings(&[log], "°/s");
    assert!(warnings.contains(&CurveWarning::Unrelated), "{warnings:?}");
}

#[test]
fn a_small_span_is_refused() {
    let samples: Vec<(f64, f64)> = WARMING.samples()[..600].to_vec();
    let log = [means(&samples)];
    assert!(matches!(check([&log[..]].into_iter()), Err(CurveRefusal::SmallSpan { .. })));
    assert!(matches!(AxisRecord::new(vec![means(&samples[..200])]), Err(ThermalError::TooFew { .. })));
}

#[test]
fn a_cubic_holds_the_curve_of_a_cubic_bias() {
    let found = curve(vec![WARMING.means()]);
    let cubic = found.cubic(25.0);
    for (k, (term, truth)) in cubic.terms.iter().zip(WARMING.bias).enumerate() {
        let truth = truth / libm::pow(20.0, k as f64);
        assert!((term - truth).abs() < 0.02 * truth.abs() + 1e-6, "{k}: {term} {truth}");
    }
    assert!(cubic.left < 0.0005, "{}", cubic.left);
    let u = libm::sqrt(cubic.covariance[0][0]);
    assert!((u / found.u_at(25.0) - 1.0).abs() < 0.3, "{u} {}", found.u_at(25.0));
}
