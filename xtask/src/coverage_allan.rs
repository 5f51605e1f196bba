//! `cargo xtask coverage-allan`: simulates records at rest and holds the fitted noise coefficients against their
//! truth.

use anyhow::{anyhow, ensure};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rustfft::{Fft, FftPlanner, num_complex::Complex64};
use std::f64::consts::{LN_2, PI};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use zerorate::allan::{Coefficient, Deviation, Input, Stat, deviations, fit_curve, octaves};
use zerorate::noise::FLICKER_CUTOFF_HZ;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Records of each scenario
    #[arg(long, default_value_t = 1000)]
    runs: u64,
    /// First seed of the random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Records at once
    #[arg(long, default_value_t = std::thread::available_parallelism().map_or(1, usize::from))]
    threads: usize,
    /// Only the scenarios whose name contains this
    #[arg(long, default_value = "", value_name = "TEXT")]
    only: String,
}

/// Floor of the Allan deviation per B: √(2 ln 2/π).
const FLOOR_PER_B: f64 = 0.664_282_470_267_960_1;
/// The slow flicker is made at this rate, and interpolated; the fast one at the record's rate.
const SLOW_RATE_HZ: f64 = 10.0;
/// Where slow and fast flicker meet.
const SPLIT_HZ: f64 = 0.5;
/// Points of each synthesis: the slow one repeats after 52 429 s.
const SYNTHESIS: usize = 1 << 19;
/// Rate of every record, Hz.
const RATE_HZ: f64 = 100.0;

/// A record to simulate, and the truth about it: ° and s.
struct Scenario {
    name: &'static str,
    length_s: f64,
    n: f64,
    b: f64,
    k: f64,
    q: f64,
    /// Time constant of a first-order low-pass on the white noise, s.
    low_pass_s: f64,
    /// Amplitude, °/s, and frequency, Hz, of a disturbance.
    sine: (f64, f64),
    bounds: Bounds,
}

/// What must hold, %.
struct Bounds {
    coverage: (f64, f64),
    /// Of N, B and K.
    rms: [f64; 3],
    /// Share of records with N and B identified.
    identified: [f64; 2],
}

/// The hour that the project's goals are stated for, and others.
fn scenarios() -> [Scenario; 10] {
    // Half of the coefficients that are zero have one-sided intervals: they hold in 97.5 %, and in a few runs more.
    const OTHER: Bounds = Bounds { coverage: (90.0, 100.0), rms: [f64::INFINITY; 3], identified: [0.0; 2] };
    // The model does not hold: what counts is the warning.
    const NO_BOUNDS: Bounds = Bounds { coverage: (0.0, 100.0), ..OTHER };
    let floor = |deg_per_h: f64| deg_per_h / 3600.0 / FLOOR_PER_B;
    let arw = |deg_per_rt_h: f64| deg_per_rt_h / 60.0;
    let hour = Scenario {
        name: "hour",
        length_s: 3600.0,
        n: arw(0.56),
        b: floor(6.25),
        k: 2e-4,
        q: 0.0,
        low_pass_s: 0.0,
        sine: (0.0, 0.0),
        bounds: OTHER,
    };
    let goal = Bounds { coverage: (93.0, 97.0), rms: [0.13, 10.5, 40.0], identified: [99.0, 95.0] };
    [
        Scenario { bounds: goal, ..hour },
        Scenario { name: "no flicker", b: 0.0, bounds: OTHER, ..hour },
        Scenario { name: "no random walk", k: 0.0, bounds: OTHER, ..hour },
        Scenario { name: "white alone", b: 0.0, k: 0.0, bounds: OTHER, ..hour },
        Scenario { name: "noisy MEMS", n: arw(3.0), b: floor(20.0), k: 1e-3, bounds: OTHER, ..hour },
        Scenario { name: "10 minutes", length_s: 600.0, bounds: OTHER, ..hour },
        Scenario { name: "long", length_s: 21_600.0, bounds: OTHER, ..hour },
        Scenario { name: "quantised", q: 2e-4, bounds: OTHER, ..hour },
        Scenario { name: "behind a low-pass", low_pass_s: 0.03, bounds: OTHER, ..hour },
        Scenario { name: "with a sine", sine: (0.02, 0.5), bounds: NO_BOUNDS, ..hour },
    ]
}

impl Scenario {
    /// σ²(τ), written out from IEEE Std 952-1997 C.1.
    fn allan_variance(&self, tau_s: f64) -> f64 {
        3.0 * (self.q / tau_s).powi(2)
            + self.n.powi(2) / tau_s
            + 2.0 * LN_2 / PI * self.b.powi(2)
            + self.k.powi(2) * tau_s / 3.0
    }
}

struct Run {
    curve: Vec<Deviation>,
    /// N, B, K.
    fitted: [Coefficient; 3],
    warnings: Vec<&'static str>,
    fit_s: f64,
}

/// Runs every scenario and fails where one is out of its bounds.
pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut missed = Vec::new();
    for scenario in scenarios().iter().filter(|scenario| scenario.name.contains(&args.only)) {
        let runs = simulate(args, scenario)?;
        println!("{}: {} records of {} s, seed {}", scenario.name, runs.len(), scenario.length_s, args.seed);
        println!("  Allan variance over the model's, mean of all records: {}", mean_over_model(scenario, &runs));
        let truth = [scenario.n, scenario.b, scenario.k];
        for (which, name) in ["N", "B", "K"].into_iter().enumerate() {
            let column: Vec<Coefficient> = runs.iter().map(|run| run.fitted[which]).collect();
            let judged = judge(&column, truth[which]);
            println!("  {name} {judged}");
            missed.extend(judged.misses(scenario, which).map(|miss| format!("{} {name}: {miss}", scenario.name)));
        }
        for (which, column) in independent_weights(&runs).iter().enumerate() {
            let error = Error::of(column, truth[which]);
            println!("  {} by least squares with independent weights: {error}", ["N", "B", "K"][which]);
        }
        let fit_s = runs.iter().map(|run| run.fit_s).sum::<f64>() / runs.len() as f64;
        println!("  a fit takes {:.1} ms", 1e3 * fit_s);
        println!("  warnings, % of records: {}", warnings(&runs));
    }
    missed.iter().for_each(|miss| println!("MISSED {miss}"));
    ensure!(missed.is_empty(), "{} of the bounds do not hold", missed.len());
    Ok(())
}

fn simulate(args: &Args, scenario: &Scenario) -> anyhow::Result<Vec<Run>> {
    let next = AtomicU64::new(0);
    let fft = FftPlanner::new().plan_fft_forward(SYNTHESIS);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= args.runs {
                return Ok(done);
            }
            let mut rng = SmallRng::seed_from_u64(args.seed.wrapping_mul(1_000_003).wrapping_add(index));
            done.push((index, one(scenario, &fft, &mut rng)?));
        }
    };
    let mut runs: Vec<(u64, Run)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..args.threads.max(1)).map(|_| scope.spawn(worker)).collect();
        let done = workers.into_iter().map(|worker| worker.join().map_err(|_| anyhow!("a worker panicked"))?);
        done.collect::<anyhow::Result<Vec<_>>>().map(|all| all.into_iter().flatten().collect())
    })?;
    runs.sort_by_key(|(index, _)| *index);
    Ok(runs.into_iter().map(|(_, run)| run).collect())
}

fn one(scenario: &Scenario, fft: &Arc<dyn Fft<f64>>, rng: &mut SmallRng) -> anyhow::Result<Run> {
    let rate = record(scenario, fft, rng);
    let points = deviations(&Input::Rate(&rate), RATE_HZ, Stat::Oadev, &octaves(rate.len()));
    let curve: Vec<Deviation> = points.into_iter().flatten().collect();
    let start = Instant::now();
    let fit = fit_curve(&curve, RATE_HZ, rate.len() as u64)?;
    let fit_s = start.elapsed().as_secs_f64();
    let warnings = fit.warnings.iter().map(|warning| warning.code()).collect();
    Ok(Run { curve, fitted: [fit.n, fit.b, fit.k], warnings, fit_s })
}

fn record(scenario: &Scenario, fft: &Arc<dyn Fft<f64>>, rng: &mut SmallRng) -> Vec<f64> {
    let len = (scenario.length_s * RATE_HZ) as usize;
    let mut normal = |sd: f64| sd * rng.sample::<f64, _>(StandardNormal);
    let mut rate: Vec<f64> = (0..len).map(|_| normal(scenario.n * RATE_HZ.sqrt())).collect();
    if scenario.low_pass_s > 0.0 {
        let keep = (-1.0 / (RATE_HZ * scenario.low_pass_s)).exp();
        let mut before = 0.0;
        for rate in &mut rate {
            before = keep * before + (1.0 - keep) * *rate;
            *rate = before;
        }
    }
    if scenario.k > 0.0 {
        let mut walk = 0.0;
        for rate in &mut rate {
            walk += normal(scenario.k / RATE_HZ.sqrt());
            *rate += walk;
        }
    }
    if scenario.q > 0.0 {
        let mut before = normal(scenario.q);
        for rate in &mut rate {
            let angle = normal(scenario.q);
            *rate += (angle - before) * RATE_HZ;
            before = angle;
        }
    }
    let (amplitude, frequency_hz) = scenario.sine;
    for (i, rate) in rate.iter_mut().enumerate() {
        *rate += amplitude * (2.0 * PI * frequency_hz * i as f64 / RATE_HZ).sin();
    }
    if scenario.b > 0.0 {
        add_flicker(&mut rate, scenario.b, fft, rng);
    }
    rate
}

fn add_flicker(rate: &mut [f64], b: f64, fft: &Arc<dyn Fft<f64>>, rng: &mut SmallRng) {
    let slow = flicker(b, SLOW_RATE_HZ, FLICKER_CUTOFF_HZ..SPLIT_HZ, fft, rng);
    let fast = flicker(b, RATE_HZ, SPLIT_HZ..RATE_HZ, fft, rng);
    for (i, rate) in rate.iter_mut().enumerate() {
        let at = i as f64 * SLOW_RATE_HZ / RATE_HZ;
        let (whole, part) = (at as usize, at.fract());
        // A record longer than the fast synthesis gets it again: nothing that fast spans a repetition.
        *rate += slow[whole] * (1.0 - part) + slow[whole + 1] * part + fast[i % SYNTHESIS];
    }
}

/// Spectral synthesis: a one-sided density of B²/(πf) gives a line at f the variance B²/(πf)·df.
fn flicker(
    b: f64,
    rate_hz: f64,
    band_hz: std::ops::Range<f64>,
    fft: &Arc<dyn Fft<f64>>,
    rng: &mut SmallRng,
) -> Vec<f64> {
    let df = rate_hz / SYNTHESIS as f64;
    let mut lines = vec![Complex64::default(); SYNTHESIS];
    for (k, line) in lines.iter_mut().enumerate().take(SYNTHESIS / 2) {
        let f = k as f64 * df;
        if band_hz.contains(&f) {
            let sd = (b * b / (PI * f) * df).sqrt();
            *line = Complex64::new(rng.sample(StandardNormal), rng.sample(StandardNormal)) * sd;
        }
    }
    fft.process(&mut lines);
    lines.into_iter().map(|line| line.re).collect()
}

/// Relative to the truth, %, or as it is where the truth is zero.
struct Error {
    truth: f64,
    rms: f64,
    mean: f64,
}

impl Error {
    fn of(values: &[f64], truth: f64) -> Self {
        let errors = || values.iter().map(|value| if truth > 0.0 { 100.0 * (value / truth - 1.0) } else { *value });
        let n = values.len() as f64;
        let rms = (errors().map(|error| error * error).sum::<f64>() / n).sqrt();
        Self { truth, rms, mean: errors().sum::<f64>() / n }
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { truth, rms, mean } = self;
        match *truth > 0.0 {
            true => write!(f, "truth {truth:.3e}, rms error {rms:.3} %, mean {mean:+.3} %"),
            false => write!(f, "truth 0, rms {rms:.2e}, mean {mean:.2e}"),
        }
    }
}

/// What the records say about one coefficient; shares in %.
struct Judged {
    error: Error,
    inside: f64,
    above: f64,
    below: f64,
    identified: f64,
}

fn judge(column: &[Coefficient], truth: f64) -> Judged {
    let share = |holds: &dyn Fn(&Coefficient) -> bool| {
        100.0 * column.iter().filter(|c| holds(c)).count() as f64 / column.len() as f64
    };
    Judged {
        error: Error::of(&column.iter().map(|c| c.value).collect::<Vec<_>>(), truth),
        inside: share(&|c| c.lo <= truth && truth <= c.hi),
        above: share(&|c| c.lo > truth),
        below: share(&|c| c.hi < truth),
        identified: share(&|c| c.identified),
    }
}

impl std::fmt::Display for Judged {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { error, inside, above, below, identified } = self;
        write!(
            f,
            "{error}; interval holds in {inside:.1} % (too high {above:.1}, too low {below:.1}), identified \
             {identified:.1} %"
        )
    }
}

impl Judged {
    fn misses<'a>(&'a self, scenario: &'a Scenario, which: usize) -> impl Iterator<Item = String> + 'a {
        let Bounds { coverage, rms, identified } = &scenario.bounds;
        let covers = self.inside >= coverage.0 && self.inside <= coverage.1;
        let seen = identified.get(which).is_none_or(|least| self.identified >= *least);
        [
            (!covers, format!("interval holds in {:.1} %, not {} to {} %", self.inside, coverage.0, coverage.1)),
            (
                self.error.truth > 0.0 && self.error.rms > rms[which],
                format!("rms error {:.3} % above {} %", self.error.rms, rms[which]),
            ),
            (!seen, format!("identified in {:.1} % only", self.identified)),
        ]
        .into_iter()
        .filter_map(|(missed, text)| missed.then_some(text))
    }
}

/// One number for each octave: does the simulation do what the model says?
fn mean_over_model(scenario: &Scenario, runs: &[Run]) -> String {
    let octaves = runs.first().map_or(0, |run| run.curve.len());
    let ratio = |i: usize| {
        let tau_s = runs[0].curve[i].m as f64 / RATE_HZ;
        let mean = runs.iter().map(|run| run.curve[i].dev.powi(2)).sum::<f64>() / runs.len() as f64;
        format!("{:.3}", mean / scenario.allan_variance(tau_s))
    };
    (0..octaves).map(ratio).collect::<Vec<_>>().join(" ")
}

/// What the fit is compared with: non-negative least squares for N, B and K with each point's true variance (that of
/// all records here) as its weight, as weighting by degrees of freedom aims at, and no covariance between points.
fn independent_weights(runs: &[Run]) -> [Vec<f64>; 3] {
    let octaves = runs.first().map_or(0, |run| run.curve.len());
    let count = runs.len() as f64;
    let points: Vec<([f64; 3], f64)> = (0..octaves)
        .map(|i| {
            let tau_s = runs[0].curve[i].m as f64 / RATE_HZ;
            let squares = || runs.iter().map(|run| run.curve[i].dev.powi(2));
            let mean = squares().sum::<f64>() / count;
            let variance = squares().map(|square| (square - mean).powi(2)).sum::<f64>() / count;
            ([1.0 / tau_s, 2.0 * LN_2 / PI, tau_s / 3.0], 1.0 / variance)
        })
        .collect();
    let fits: Vec<[f64; 3]> = runs.iter().map(|run| non_negative(&points, &run.curve)).collect();
    std::array::from_fn(|which| fits.iter().map(|fit| fit[which].sqrt()).collect())
}

/// The best of the seven subsets that have no negative coefficient.
fn non_negative(points: &[([f64; 3], f64)], curve: &[Deviation]) -> [f64; 3] {
    let sum = |term: &dyn Fn(usize) -> f64| (0..points.len()).map(term).sum::<f64>();
    let right: [f64; 3] = std::array::from_fn(|a| sum(&|i| points[i].1 * points[i].0[a] * curve[i].dev.powi(2)));
    let normal: [[f64; 3]; 3] =
        std::array::from_fn(|a| std::array::from_fn(|b| sum(&|i| points[i].1 * points[i].0[a] * points[i].0[b])));
    let solved = (1u8..8).map(|set| solve(normal, right, set)).filter(|found| found.iter().all(|&c| c >= 0.0));
    let gain = |found: &[f64; 3]| found.iter().zip(right).map(|(c, r)| c * r).sum::<f64>();
    solved.max_by(|a, b| gain(a).total_cmp(&gain(b))).unwrap_or_default()
}

/// Gauss and Jordan, for the coefficients whose bit is set.
fn solve(mut normal: [[f64; 3]; 3], mut right: [f64; 3], set: u8) -> [f64; 3] {
    let rows: Vec<usize> = (0..3).filter(|row| set >> row & 1 == 1).collect();
    for &pivot in &rows {
        for &row in rows.iter().filter(|&&row| row != pivot) {
            let factor = normal[row][pivot] / normal[pivot][pivot];
            rows.iter().for_each(|&column| normal[row][column] -= factor * normal[pivot][column]);
            right[row] -= factor * right[pivot];
        }
    }
    std::array::from_fn(|row| if rows.contains(&row) { right[row] / normal[row][row] } else { 0.0 })
}

fn warnings(runs: &[Run]) -> String {
    let mut counts = std::collections::BTreeMap::new();
    runs.iter().flat_map(|run| &run.warnings).for_each(|code| *counts.entry(*code).or_insert(0) += 1);
    let share = |(code, count): (&str, i32)| format!("{code} {:.1}", 100.0 * f64::from(count) / runs.len() as f64);
    counts.into_iter().map(share).collect::<Vec<_>>().join(", ")
}
