//! `cargo xtask coverage-allan`: fits noise models to simulated records at rest, and compares them with the truth.

mod judge;
mod scenario;
mod simulate;

use crate::seeds::for_each_seed;
use anyhow::ensure;
use judge::{Error, judge, scatter, share};
use rand::SeedableRng;
use rand::rngs::SmallRng;
use rustfft::{Fft, FftPlanner};
use scenario::{Bounds, Scenario, scenarios};
use simulate::{RATE_HZ, SYNTHESIS, record};
use std::sync::Arc;
use std::time::Instant;
use zerorate_allan::{
    AllanWarning, Coefficient, Deviation, Estimate, FitOptions, Input, Stat, Term, deviations, fit, octaves,
};

#[derive(clap::Args)]
pub struct CoverageAllanArgs {
    /// Records of each scenario
    #[arg(long, default_value_t = 1000)]
    runs: u64,
    /// First seed of the random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only the scenarios whose name contains this
    #[arg(long, default_value = "", value_name = "TEXT")]
    only: String,
}

struct Run {
    curve: Vec<Deviation>,
    /// The fitted N, B and K, with ° and s as units.
    fitted: [Coefficient; 3],
    /// The fitted σ, °/s, and T, s, of each Gauss–Markov term.
    markovs: Vec<(Estimate, Estimate)>,
    has_drift: bool,
    steps: usize,
    is_rejected: bool,
    warnings: Vec<&'static str>,
    fit_s: f64,
}

/// Warnings that a coefficient may be wrong. Warnings about something that was found and removed are not included.
const TELLING: [&str; 9] = [
    "many-glitches",
    "many-steps",
    "warm-up",
    "drift",
    "unsteady",
    "memory-or-flicker",
    "memory-or-filter",
    "drift-or-walk",
    "model-rejected",
];
/// Distance from the truth at which a coefficient is wrong, in half widths of its interval.
const WRONG: f64 = 3.0;

impl Run {
    /// True if a coefficient is identified but wrong, and no warning says that it may be wrong.
    fn is_silently_wrong(&self, truth: &[f64; 3]) -> bool {
        let is_wrong = |(c, truth): (&Coefficient, &f64)| {
            let half = if *truth > c.value { c.hi - c.value } else { c.value - c.lo };
            c.identified && (truth - c.value).abs() > WRONG * half
        };
        let silent = !self.warnings.iter().any(|code| TELLING.contains(code));
        silent && self.fitted.iter().zip(truth).any(is_wrong)
    }
}

pub fn run(args: &CoverageAllanArgs) -> anyhow::Result<()> {
    let mut missed = Vec::new();
    for scenario in scenarios().iter().filter(|scenario| scenario.name.contains(&args.only)) {
        let runs = simulate(args, scenario)?;
        println!("{}: {} records of {} s, seed {}", scenario.name, runs.len(), scenario.length_s, args.seed);
        missed.extend(report(scenario, &runs).into_iter().map(|miss| format!("{}: {miss}", scenario.name)));
    }
    missed.iter().for_each(|miss| println!("MISSED {miss}"));
    ensure!(missed.is_empty(), "{} of the bounds do not hold", missed.len());
    Ok(())
}

/// Prints the results, and returns those that are outside their bounds.
fn report(scenario: &Scenario, runs: &[Run]) -> Vec<String> {
    let mut missed = Vec::new();
    println!("  Allan variance over the model's, mean of all records: {}", mean_over_model(scenario, runs));
    let truth = scenario.truth(RATE_HZ);
    let believed: Vec<&Run> = runs.iter().filter(|run| !run.is_rejected).collect();
    for (which, name) in ["N", "B", "K"].into_iter().enumerate().filter(|_| !believed.is_empty()) {
        let column: Vec<Coefficient> = believed.iter().map(|run| run.fitted[which]).collect();
        let judged = judge(&column, truth[which]);
        println!("  {name} {judged}");
        missed.extend(judged.misses(scenario, which).map(|miss| format!("{name}: {miss}")));
    }
    missed.extend(terms(scenario, runs));
    let silent = runs.iter().filter(|run| run.is_silently_wrong(&truth)).count();
    let rejected = share(runs, |run| run.is_rejected);
    println!("  rejected {rejected:.1} %, silently wrong {silent} of {}", runs.len());
    if silent > 0 {
        missed.push(format!("{silent} silently wrong"));
    }
    let fit_s = runs.iter().map(|run| run.fit_s).sum::<f64>() / runs.len() as f64;
    println!("  a fit takes {:.1} ms", 1e3 * fit_s);
    println!("  warnings, % of records: {}", warnings(runs));
    missed
}

/// Prints the results about the terms other than N, B and K, and returns those that are outside their bounds.
fn terms(scenario: &Scenario, runs: &[Run]) -> Vec<String> {
    let (found, drift) = (share(runs, |run| !run.markovs.is_empty()), share(runs, |run| run.has_drift));
    let steps = share(runs, |run| run.steps > 0);
    println!("  with a Gauss–Markov term {found:.1} %, a drift {drift:.1} %, a step {steps:.1} %");
    let Bounds { steps: allowed, false_terms, found: least, .. } = scenario.bounds;
    let mut missed = Vec::new();
    let beyond = |share: f64, (least, most): (f64, f64)| {
        share < least - scatter(least, runs.len()) || share > most + scatter(most, runs.len())
    };
    if beyond(steps, allowed) {
        missed.push(format!("a step in {steps:.1} %, not {} to {} %", allowed.0, allowed.1));
    }
    let Some(truth) = scenario.gauss_markov else {
        if beyond(found, (0.0, false_terms)) {
            missed.push(format!("Gauss–Markov in {found:.1} %"));
        }
        return missed;
    };
    let single: Vec<&(Estimate, Estimate)> =
        runs.iter().filter_map(|run| if let [one] = &run.markovs[..] { Some(one) } else { None }).collect();
    let sigma: Vec<Estimate> = single.iter().map(|(sigma, _)| *sigma).collect();
    let tau_s: Vec<Estimate> = single.iter().map(|(_, tau_s)| *tau_s).collect();
    for (name, column, truth) in [("σ", sigma, truth.0), ("T", tau_s, truth.1)] {
        let error = Error::of(&column.iter().map(|estimate| estimate.value).collect::<Vec<_>>(), truth);
        let inside = share(&column, |estimate| estimate.lo <= truth && truth <= estimate.hi);
        println!("  {name} {error}; interval holds in {inside:.1} %");
    }
    if beyond(found, (least, 100.0)) {
        missed.push(format!("Gauss–Markov found in {found:.1} % only"));
    }
    missed
}

fn simulate(args: &CoverageAllanArgs, scenario: &Scenario) -> anyhow::Result<Vec<Run>> {
    let fft = FftPlanner::new().plan_fft_forward(SYNTHESIS);
    for_each_seed(0..args.runs, |index| {
        let mut rng = SmallRng::seed_from_u64(args.seed.wrapping_mul(1_000_003).wrapping_add(index));
        one(scenario, &fft, &mut rng)
    })
}

fn one(scenario: &Scenario, fft: &Arc<dyn Fft<f64>>, rng: &mut SmallRng) -> anyhow::Result<Run> {
    let rate = record(scenario, fft, rng);
    let points = deviations(&Input::Rate(&rate), RATE_HZ, Stat::Oadev, &octaves(rate.len()));
    let curve: Vec<Deviation> = points.into_iter().flatten().collect();
    let start = Instant::now();
    let fit = fit(&Input::Rate(&rate), RATE_HZ, &FitOptions::default())?;
    let fit_s = start.elapsed().as_secs_f64();
    let markov = |term: &Term| match term {
        Term::GaussMarkov { sigma, tau_s } => Some((*sigma, *tau_s)),
        _ => None,
    };
    Ok(Run {
        curve,
        fitted: [fit.n, fit.b, fit.k],
        markovs: fit.terms.iter().filter_map(markov).collect(),
        has_drift: fit.r.is_some() || fit.terms.iter().any(|term| matches!(term, Term::WarmUp { .. })),
        steps: fit.cleaned.steps.len(),
        is_rejected: fit.is_rejected,
        warnings: fit.warnings.iter().map(AllanWarning::code).collect(),
        fit_s,
    })
}

/// The ratio of the mean Allan variance to the model's, for each octave. It is 1 if the simulation follows the model.
fn mean_over_model(scenario: &Scenario, runs: &[Run]) -> String {
    let octaves = runs.iter().map(|run| run.curve.len()).min().unwrap_or(0);
    let ratio = |i: usize| {
        let tau_s = runs[0].curve[i].m as f64 / RATE_HZ;
        let mean = runs.iter().map(|run| run.curve[i].dev.powi(2)).sum::<f64>() / runs.len() as f64;
        format!("{:.3}", mean / scenario.allan_variance(tau_s))
    };
    (0..octaves).map(ratio).collect::<Vec<_>>().join(" ")
}

fn warnings(runs: &[Run]) -> String {
    let mut counts = std::collections::BTreeMap::new();
    for run in runs {
        let mut codes = run.warnings.clone();
        codes.dedup();
        codes.into_iter().for_each(|code| *counts.entry(code).or_insert(0) += 1);
    }
    let share = |(code, count): (&str, i32)| format!("{code} {:.1}", 100.0 * f64::from(count) / runs.len() as f64);
    counts.into_iter().map(share).collect::<Vec<_>>().join(", ")
}
