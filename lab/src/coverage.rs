//! `cargo xtask coverage`: calibrates many simulated units and compares results and uncertainties with the truth.

use crate::residuals::rms;
use crate::seeds::{self, for_each_seed};
use crate::trial::{self, EstimateError, FAULTS, Fault, Rig, Unit, judge};
use adis16130::Sample;
use adis16130_twin::Spec;
use anyhow::{Context, ensure};
use std::ops::RangeInclusive;
use zerorate::{Axis, Correction, Plan, Reading, Refusal, Uncertainty};

/// Time for which the part is off before its second warm-up, s.
const OFF_S: u64 = 3600;

#[derive(clap::Args)]
pub struct CoverageArgs {
    /// Units, by their seeds, both ends included
    #[arg(long, default_value = "1..200", value_parser = seeds::parse, value_name = "A..B")]
    seeds: RangeInclusive<u64>,
    /// Only the disturbed units: how often a wrong result is reported
    #[arg(long)]
    disturbed_units: bool,
}

pub fn run(args: &CoverageArgs) -> anyhow::Result<()> {
    if args.disturbed_units {
        println!("| what happens | inside | warned | refused | wrong and silent | the worst of these |");
        println!("|---|---|---|---|---|---|");
        return FAULTS.iter().try_for_each(|fault| report_fault(args, fault));
    }
    let units = for_each_seed(args.seeds.clone(), linear_unit)?;
    println!("{} linear units (curvature=0,hysteresis=0, --assume-linear), seeds {:?}:", units.len(), args.seeds);
    report_intervals("PBC", "°/s", units.iter().map(|unit| unit.pbc));
    report_intervals("BTC", "°/s/°C", units.iter().map(|unit| unit.btc));
    let all = for_each_seed(args.seeds.clone(), default_unit)?;
    let units: Vec<DefaultUnit> = all.iter().flatten().copied().collect();
    println!("{} default units, {} refused, seeds {:?}:", units.len(), all.len() - units.len(), args.seeds);
    report_intervals("PBC", "°/s", units.iter().map(|unit| unit.judged.pbc));
    report_intervals("BTC", "°/s/°C", units.iter().map(|unit| unit.judged.btc));
    let raw = rms(units.iter().map(|unit| unit.raw_change_dps));
    let corrected = rms(units.iter().map(|unit| unit.corrected_change_dps));
    println!(
        "  second warm-up after an hour off, change from its first 10 s to its last 150 s, rms: {raw:.4} °/s raw, \
         {corrected:.4} °/s corrected: {:.1}-fold less",
        raw / corrected
    );
    Ok(())
}

#[derive(Clone, Copy)]
struct DefaultUnit {
    judged: Unit,
    raw_change_dps: f64,
    corrected_change_dps: f64,
}

/// Prints a row of the table in `docs/reference/accuracy.md`.
fn report_fault(args: &CoverageArgs, fault: &Fault) -> anyhow::Result<()> {
    let ended = for_each_seed(args.seeds.clone(), |seed| Rig::new((fault.spec)(seed)).run(Plan::default()))?;
    let count = |is: fn(&trial::TrialEnd) -> bool| ended.iter().filter(|ended| is(ended)).count();
    let refused = count(|ended| matches!(ended, trial::TrialEnd::Refused));
    let (silent, wrong) = (count(trial::TrialEnd::is_silent), count(trial::TrialEnd::is_wrong_and_silent));
    let worst =
        ended.iter().filter(|ended| ended.is_wrong_and_silent()).map(trial::TrialEnd::worst).fold(0.0, f64::max);
    let warned = ended.len() - refused - silent;
    println!("| {} | {} | {warned} | {refused} | {wrong} | {worst:.1} u |", fault.name, silent - wrong);
    Ok(())
}

fn report_intervals(name: &str, unit: &str, results: impl Iterator<Item = EstimateError> + Clone) {
    let ratios = results.clone().map(|judged| judged.error / judged.u);
    let count = ratios.clone().count() as f64;
    let inside = ratios.clone().filter(|ratio| ratio.abs() <= Uncertainty::FACTOR).count() as f64;
    println!(
        "  {name}: {:.1} % inside the 95 % interval, rms(error/u) {:.3}, mean(error/u) {:+.3}; rms error {:.5} \
         {unit}, rms u {:.5} {unit}",
        100.0 * inside / count,
        rms(ratios.clone()),
        ratios.sum::<f64>() / count,
        rms(results.clone().map(|judged| judged.error)),
        rms(results.map(|judged| judged.u)),
    );
}

fn linear_unit(seed: u64) -> anyhow::Result<Unit> {
    let spec = Spec { curvature_dps_per_c2: 0.0, hysteresis_dps: 0.0, ..Spec::from_seed(seed) };
    let plan = Plan { assume_linear: true, ..Plan::default() };
    let (outcome, truth) = Rig::new(spec).calibrate(plan)?;
    Ok(judge(&outcome, &truth))
}

/// Calibrates a unit with default settings; `None` if the measurement was refused.
fn default_unit(seed: u64) -> anyhow::Result<Option<DefaultUnit>> {
    let mut rig = Rig::new(Spec::from_seed(seed));
    let (outcome, truth) = match rig.calibrate(Plan::default()) {
        Ok(measured) => measured,
        Err(error) => return error.downcast::<Refusal>().map(|_| None),
    };
    rig.twin.power_off();
    rig.twin.advance_ns(OFF_S * 1_000_000_000);
    rig.twin.power_on();
    let (raw_change_dps, corrected_change_dps) = warm_up(&mut rig, &outcome.correction)?;
    Ok(Some(DefaultUnit { judged: judge(&outcome, &truth), raw_change_dps, corrected_change_dps }))
}

/// The change of the mean rate during a second warm-up, raw and corrected, °/s: from the first 10 s after switching on
/// to the last 150 s of the duration of F-51.
fn warm_up(rig: &mut Rig, correction: &Correction) -> anyhow::Result<(f64, f64)> {
    let start_ns = rig.initialise()?;
    let (mut first, mut last) = (Vec::new(), Vec::new());
    loop {
        let sample = rig.read()?;
        match (sample.t_ns - start_ns) / 1_000_000_000 {
            0..10 => first.push(rates_dps(&sample, correction)?),
            3020..3170 => last.push(rates_dps(&sample, correction)?),
            3170.. => break,
            _ => {}
        }
    }
    ensure!(!first.is_empty() && !last.is_empty(), "no samples in the second warm-up");
    let mean = |rates: &[[f64; 2]], which: usize| rates.iter().map(|r| r[which]).sum::<f64>() / rates.len() as f64;
    let change = |which: usize| mean(&last, which) - mean(&first, which);
    Ok((change(0), change(1)))
}

/// The rate of a sample, raw and corrected.
fn rates_dps(sample: &Sample, correction: &Correction) -> anyhow::Result<[f64; 2]> {
    let (axis, reading) = (Axis::ADIS16130, Reading::from(sample));
    let temp = reading.temp.context("a sample without temperature")?;
    let rate_dps = axis.rate.value(reading.rate.into());
    Ok([rate_dps, correction.apply(rate_dps, axis.temp.value(temp.into()))])
}
