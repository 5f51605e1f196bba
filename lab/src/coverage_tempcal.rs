//! `cargo xtask coverage-tempcal`: fits the bias over temperature to simulated logs, and compares it with the truth.

use crate::methods::least_squares::polynomial;
use crate::residuals::rms;
use crate::seeds::{self, for_each_seed};
use anyhow::{Context, anyhow};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use std::ops::RangeInclusive;
use std::time::Instant;
use zerorate::temperature::curve::{AxisRecord, LagLikelihood, LogCurve, LogMeans, MeansBuilder};

#[derive(clap::Args)]
pub struct CoverageTempcalArgs {
    /// Logs of each kind, by their seeds, both ends included
    #[arg(long, default_value = "1..30", value_parser = seeds::parse, value_name = "A..B")]
    seeds: RangeInclusive<u64>,
    /// Only the kinds of logs whose name holds this text
    #[arg(long, default_value = "", hide_default_value = true)]
    only: String,
}

const RATE_HZ: f64 = 50.0;
const AXES: usize = 3;
/// Standard deviations of the true bias's coefficients in powers of (T − 25 °C)/20 °C, °/s.
const TERMS_DPS: [f64; 4] = [1.0, 0.4, 0.08, 0.03];
/// Standard deviation of the coefficients of order 4 and 5, °/s, in logs with `is_hard`.
const HARD_DPS: f64 = 0.02;
const N: f64 = 0.003 / std::f64::consts::SQRT_2;
const K: f64 = 1e-4;
/// Gauss–Markov processes that approximate flicker: standard deviation of each, °/s, and correlation times, s.
const FLICKER_DPS: f64 = 0.0006;
const FLICKER_S: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
const LSB_PER_DPS: f64 = 131.0;

/// The properties that all simulated logs of one kind share.
struct Kind {
    name: &'static str,
    is_hard: bool,
    /// Lag of the bias behind the temperature, s. With `draws_lag`, each log has a random lag from 0 to this value.
    lag_s: f64,
    draws_lag: bool,
    /// Largest half width of the backlash, °C. Each log has a random half width from 0 to this value.
    play_c: f64,
    cools: bool,
    /// Longest time from switch-on to the start of the log, s. Each log has a random time from 0 to this value.
    begins_s: f64,
    /// Noise of a reading of the thermometer, and step of its readings (`step_c`), °C.
    noise_c: f64,
    step_c: f64,
    /// Standard deviation, °C, and correlation time, s, of a draught that the thermometer feels.
    draught: (f64, f64),
    /// Whether the sensor feels the draught too.
    is_felt: bool,
    /// Lag of the thermometer behind the sensor, s.
    late_s: f64,
    /// Change of the slope of the bias at 25 °C, °/s/°C.
    kink_dps_per_c: f64,
}

const AT_ONCE: Kind = Kind {
    name: "cubic, no lag",
    is_hard: false,
    lag_s: 0.0,
    draws_lag: false,
    play_c: 0.0,
    cools: false,
    begins_s: 0.0,
    noise_c: 0.02,
    step_c: 1.0 / 340.0,
    draught: (0.0, 10.0),
    is_felt: false,
    late_s: 0.0,
    kink_dps_per_c: 0.0,
};
const DRAWN: Kind = Kind { name: "cubic, lag of 0 to 150 s", lag_s: 150.0, draws_lag: true, ..AT_ONCE };
const KINDS: [Kind; 14] = [
    AT_ONCE,
    Kind { name: "order 5, no lag", is_hard: true, ..AT_ONCE },
    Kind { name: "cubic, lag of 60 s", lag_s: 60.0, ..AT_ONCE },
    DRAWN,
    Kind { name: "the same with play of 0 to 2 °C, warming and cooling", play_c: 2.0, cools: true, ..DRAWN },
    Kind { name: "cubic, no lag, begins up to 400 s after switch-on", begins_s: 400.0, ..AT_ONCE },
    Kind { name: "cubic, lag of 0 to 150 s, begins up to 400 s after switch-on", begins_s: 400.0, ..DRAWN },
    Kind { name: "cubic, no lag, thermometer with noise of 0.5 °C", noise_c: 0.5, ..AT_ONCE },
    Kind { name: "cubic, no lag, thermometer in a draught of 0.3 °C for 10 s", draught: (0.3, 10.0), ..AT_ONCE },
    Kind { name: "cubic, no lag, thermometer in a draught of 1 °C for 60 s", draught: (1.0, 60.0), ..AT_ONCE },
    Kind {
        name: "cubic, lag of 120 s, both in a draught of 0.3 °C for 10 s",
        draught: (0.3, 10.0),
        is_felt: true,
        lag_s: 120.0,
        ..AT_ONCE
    },
    Kind { name: "cubic, no lag, thermometer with steps of 0.5 °C", step_c: 0.5, ..AT_ONCE },
    Kind { name: "cubic, no lag, thermometer 20 s late", late_s: 20.0, ..AT_ONCE },
    Kind { name: "cubic with a kink of 0.01 °/s/°C, no lag", kink_dps_per_c: 0.01, ..AT_ONCE },
];

/// Errors of one axis: rms without the mean error, °/s, and single errors as multiples of the stated uncertainty.
struct AxisErrors {
    cubic: f64,
    quintic: f64,
    curve: f64,
    ratios: Vec<f64>,
    /// The errors as multiples of the uncertainty for a sensor that was on before the log began: the larger of `u_at`
    /// and, if stated, `u_if_on_before`.
    ratios_on: Vec<f64>,
    elapsed_s: f64,
}

/// Temperatures at which curves are compared, °C: from one degree above the log's first reading to 43 °C.
fn temps_c(log: &Log) -> impl Iterator<Item = f64> + Clone + use<> {
    let low_c = log.temps_c[0] + 1.0;
    (0..60).map(move |k| low_c + (43.0 - low_c) * f64::from(k) / 59.0)
}

/// Prints the table of docs/reference/temperature.md.
pub fn run(args: &CoverageTempcalArgs) -> anyhow::Result<()> {
    println!(
        "| log | order 3 | order 5 | curve | to order 3 | to order 5 | inside 95 % | or if on before | rms(error/u) | \
         s per log |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for kind in KINDS.iter().filter(|kind| kind.name.contains(&args.only)) {
        let logs = for_each_seed(args.seeds.clone(), |seed| errors(kind, seed))?;
        let axes: Vec<&AxisErrors> = logs.iter().flatten().collect();
        let of = |error: fn(&AxisErrors) -> f64| rms(axes.iter().map(|axis| error(axis)));
        let [cubic, quintic, curve] = [of(|axis| axis.cubic), of(|axis| axis.quintic), of(|axis| axis.curve)];
        let ratios = || axes.iter().flat_map(|axis| &axis.ratios);
        let ratios_on = || axes.iter().flat_map(|axis| &axis.ratios_on);
        let [inside, inside_on] = [inside(ratios()), inside(ratios_on())];
        let elapsed_s = axes.iter().map(|axis| axis.elapsed_s).sum::<f64>() / logs.len() as f64;
        println!(
            "| {} | {cubic:.5} | {quintic:.5} | {curve:.5} | {:.2} | {:.2} | {:.1} % | {:.1} % | {:.2} | \
             {elapsed_s:.2} |",
            kind.name,
            curve / cubic,
            curve / quintic,
            100.0 * inside,
            100.0 * inside_on,
            rms(ratios().copied())
        );
    }
    Ok(())
}

/// Share of the errors that are inside their 95 % intervals.
fn inside<'a>(ratios: impl Iterator<Item = &'a f64> + Clone) -> f64 {
    ratios.clone().filter(|ratio| ratio.abs() < 1.96).count() as f64 / ratios.count() as f64
}

/// A log: measured temperatures, rates of each axis, °/s, and coefficients of the true bias ([`TERMS_DPS`]).
struct Log {
    temps_c: Vec<f64>,
    rates_dps: [Vec<f64>; AXES],
    terms_dps: [[f64; 6]; AXES],
}

impl Kind {
    fn bias_dps(&self, terms: &[f64; 6], temp_c: f64) -> f64 {
        let d = (temp_c - 25.0) / 20.0;
        let kink = self.kink_dps_per_c * (temp_c - 25.0).max(0.0);
        terms.iter().rev().fold(0.0, |sum, term| sum * d + term) + kink
    }
}

/// The temperature of the sensor, °C: 45 minutes of warming, then 45 minutes of cooling, with a ripple of 0.3 °C.
fn course_c(at_s: f64) -> f64 {
    let warm = |at_s: f64| 5.0 + 40.0 * (1.0 - (-at_s / 800.0).exp());
    let turn_s = 2700.0;
    let course =
        if at_s < turn_s { warm(at_s) } else { 5.0 + (warm(turn_s) - 5.0) * (-(at_s - turn_s) / 900.0).exp() };
    course + 0.3 * (at_s / 200.0).sin()
}

fn simulated(kind: &Kind, seed: u64) -> Log {
    let mut random = SmallRng::seed_from_u64(seed);
    let mut normal = |deviation: f64| deviation * random.sample::<f64, _>(StandardNormal);
    let count = (RATE_HZ * if kind.cools { 5400.0 } else { 2700.0 }) as usize;
    let hard = if kind.is_hard { HARD_DPS } else { 0.0 };
    let sizes = [TERMS_DPS[0], TERMS_DPS[1], TERMS_DPS[2], TERMS_DPS[3], hard, hard];
    let terms_dps: [[f64; 6]; AXES] = std::array::from_fn(|_| sizes.map(&mut normal));
    let mut shares = SmallRng::seed_from_u64(!seed);
    let mut share = || shares.random::<f64>();
    let lag_s = kind.lag_s * if kind.draws_lag { share() } else { 1.0 };
    let play_c = kind.play_c * share();
    let decay = if lag_s > 0.0 { (-1.0 / RATE_HZ / lag_s).exp() } else { 0.0 };
    let (mut late_c, mut held_c, mut read_c) = (course_c(0.0), course_c(0.0), course_c(0.0));
    let of_thermometer = if kind.late_s > 0.0 { (-1.0 / RATE_HZ / kind.late_s).exp() } else { 0.0 };
    let mut of_air = SmallRng::seed_from_u64(seed ^ 0xA1);
    let mut draught = |deviation: f64| deviation * of_air.sample::<f64, _>(StandardNormal);
    let mut draught_c = 0.0;
    let (mut walks, mut flickers) = ([0.0; AXES], [[0.0; FLICKER_S.len()]; AXES]);
    flickers.iter_mut().flatten().for_each(|state| *state = normal(FLICKER_DPS));
    let mut log = Log { temps_c: Vec::new(), rates_dps: Default::default(), terms_dps };
    for k in 0..count {
        let kept = (-1.0 / (RATE_HZ * kind.draught.1)).exp();
        draught_c = kept * draught_c + draught((1.0 - kept * kept).sqrt() * kind.draught.0);
        let of_both_c = if kind.is_felt { draught_c } else { 0.0 };
        let temp_c = course_c(k as f64 / RATE_HZ) + of_both_c;
        late_c = temp_c + (late_c - temp_c) * decay;
        held_c = f64::clamp(held_c, late_c - play_c, late_c + play_c);
        read_c = temp_c + (read_c - temp_c) * of_thermometer;
        let read_c = read_c + draught_c - of_both_c;
        log.temps_c.push(((read_c + normal(kind.noise_c)) / kind.step_c).round() * kind.step_c);
        for axis in 0..AXES {
            walks[axis] += normal(K / RATE_HZ.sqrt());
            for (state, tau_s) in flickers[axis].iter_mut().zip(FLICKER_S) {
                let kept = (-1.0 / (RATE_HZ * tau_s)).exp();
                *state = kept * *state + normal(FLICKER_DPS * (1.0 - kept * kept).sqrt());
            }
            let noise = normal(N * (RATE_HZ / 2.0).sqrt()) + walks[axis] + flickers[axis].iter().sum::<f64>();
            let rate = kind.bias_dps(&log.terms_dps[axis], held_c) + noise;
            log.rates_dps[axis].push((rate * LSB_PER_DPS).round() / LSB_PER_DPS);
        }
    }
    let begins = (RATE_HZ * kind.begins_s * share()) as usize;
    log.temps_c.drain(..begins);
    log.rates_dps.iter_mut().for_each(|rates_dps| drop(rates_dps.drain(..begins)));
    log
}

fn errors(kind: &Kind, seed: u64) -> anyhow::Result<Vec<AxisErrors>> {
    let log = simulated(kind, seed);
    let start = Instant::now();
    let records = log.rates_dps.iter().map(|rates_dps| AxisRecord::new(vec![means(&log.temps_c, rates_dps)]));
    let failed = |error| anyhow!("{error:?}");
    let records = records.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    let curve = |index: usize| {
        let others: Vec<&LagLikelihood> =
            records.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, other)| other.lag()).collect();
        records[index].curve(&others)
    };
    let curves = (0..AXES).map(curve).collect::<Result<Vec<LogCurve>, _>>().map_err(failed)?;
    let elapsed_s = start.elapsed().as_secs_f64() / AXES as f64;
    let of_axis = |(axis, curve): (usize, &LogCurve)| {
        let truth = |temp_c: f64| kind.bias_dps(&log.terms_dps[axis], temp_c);
        let points = points(&log.temps_c, &log.rates_dps[axis]);
        let error = |order: usize| {
            let terms = polynomial(&points, order, |temp_c| (temp_c - 25.0) / 20.0)?;
            let terms: Vec<f64> = terms.iter().enumerate().map(|(k, term)| term / 20_f64.powi(k as i32)).collect();
            let at = |temp_c: f64| terms.iter().rev().fold(0.0, |sum, term| sum * (temp_c - 25.0) + term);
            Some(without_mean(temps_c(&log).map(|temp_c| at(temp_c) - truth(temp_c))))
        };
        let off = |temp_c: f64| curve.at(temp_c) - truth(temp_c);
        let u_on = |temp_c: f64| curve.u_if_on_before.unwrap_or(0.0).max(curve.u_at(temp_c));
        Ok(AxisErrors {
            cubic: error(3).context("no polynomial")?,
            quintic: error(5).context("no polynomial")?,
            curve: without_mean(temps_c(&log).map(off)),
            ratios: temps_c(&log).step_by(6).map(|temp_c| off(temp_c) / curve.u_at(temp_c)).collect(),
            ratios_on: temps_c(&log).step_by(6).map(|temp_c| off(temp_c) / u_on(temp_c)).collect(),
            elapsed_s,
        })
    };
    curves.iter().enumerate().map(of_axis).collect()
}

fn means(temps_c: &[f64], rates_dps: &[f64]) -> LogMeans {
    let mut means = MeansBuilder::new(rates_dps.len(), RATE_HZ);
    rates_dps.iter().zip(temps_c).for_each(|(rate_dps, temp_c)| means.push(*rate_dps, *temp_c));
    means.finish()
}

/// Means over 2 s of temperature and rate, as in ArduPilot's script.
fn points(temps_c: &[f64], rates_dps: &[f64]) -> Vec<(f64, f64)> {
    let per = (2.0 * RATE_HZ) as usize;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    temps_c
        .chunks_exact(per)
        .zip(rates_dps.chunks_exact(per))
        .map(|(temps, rates)| (mean(temps), mean(rates)))
        .collect()
}

fn without_mean(errors: impl Iterator<Item = f64> + Clone) -> f64 {
    let (sum, count) = errors.clone().fold((0.0, 0.0), |(sum, count), error| (sum + error, count + 1.0));
    rms(errors.map(|error| error - sum / count))
}
