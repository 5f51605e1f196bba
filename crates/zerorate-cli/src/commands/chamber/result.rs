//! What a measurement in a chamber came to: the calibration, for scripts (JSON), for people (text), as a page.

use super::drive::Driven;
use super::plan::PlanFile;
use super::{ChamberArgs, Files};
use crate::commands::allan::picture;
use crate::exit::Refused;
use crate::output::{print_json, print_lines, warn};
use crate::wording::coded;
use adis16130_twin::Truth;
use anyhow::Result;
use serde::Serialize;
use std::path::Path;
use zerorate::calibration::ChamberRun;
use zerorate::chamber::{Branches, ChamberOutcome, Record};
use zerorate::{Calibration, Correction, Part, Uncertainty, Warning};
use zerorate_jobs::JobWarning;
use zerorate_jobs::acquisition::aliasing;
use zerorate_jobs::calibrate::{CurvePoint, POINTS, Undelivered};
use zerorate_view::duration::Seconds;
use zerorate_view::report::{ChamberPage, Fact, chamber_page, over_temperature, wide_loop};

/// The JSON object of `chamber --json`; the names are a contract.
#[derive(Serialize)]
struct Report {
    /// Of a part with one axis; else it stands in `axes`.
    #[serde(flatten)]
    only: Option<AxisReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    axes: Vec<AxisReport>,
    method: &'static str,
    plan: String,
    device: Option<String>,
    coverage: f64,
    coverage_factor: f64,
    samples: u64,
    lost_samples: u64,
    impossible_readings: u64,
    duration_s: f64,
    temp_min_c: f64,
    temp_max_c: f64,
    /// Share of the time in which the part was not at rest, and which is in no result.
    restless: f64,
    calibration_id: String,
    capture_sha256: Option<String>,
    warnings: Vec<String>,
}

/// What was found of an axis.
#[derive(Serialize)]
struct AxisReport {
    name: String,
    pbc_dps: f64,
    btc_dps_per_c: f64,
    btc2_dps_per_c2: f64,
    btc3_dps_per_c3: f64,
    t3_c: f64,
    u_pbc_dps: f64,
    u_btc_dps_per_c: f64,
    u_btc2_dps_per_c2: f64,
    u_btc3_dps_per_c3: f64,
    order: usize,
    order_weights: Vec<f64>,
    lag_s: f64,
    play_c: f64,
    bias_instability_dps: f64,
    rate_random_walk_dps_per_rt_s: f64,
    /// The correction at the end, evenly over the temperatures seen.
    curve: Vec<CurvePoint>,
    points: Vec<Point>,
    #[serde(rename = "loop")]
    branches: Option<Loop>,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<TruthReport>,
}

/// A soak point.
#[derive(Serialize)]
struct Point {
    step: usize,
    set_c: f64,
    start_s: f64,
    end_s: f64,
    temp_c: f64,
    rate_dps: f64,
    residual_dps: f64,
    drift_c_per_min: f64,
    settled: bool,
}

/// How far warming and cooling lie apart.
#[derive(Serialize)]
struct Loop {
    half_width_dps: f64,
    u_dps: f64,
    temp_min_c: f64,
    temp_max_c: f64,
}

/// What the twin knows at the end.
#[derive(Serialize)]
struct TruthReport {
    pbc_dps: f64,
    btc_dps_per_c: f64,
    curve: Vec<CurvePoint>,
}

/// Finds the curve, and hands everything out that was asked for.
pub fn deliver(args: &ChamberArgs, plan: &PlanFile, driven: Driven, files: Files) -> Result<()> {
    let Driven { procedure, acquisition, mut kept, capture_sha256, truths, log_failed, is_resumed } = driven;
    let (part, tally) = (procedure.part().clone(), *procedure.tally());
    let refused = |refusal: zerorate::chamber::ChamberRefusal| Refused::new(refusal.code(), refusal.to_string());
    let record = procedure.finish().map_err(refused)?;
    let outcomes = record.outcomes(&part, args.earth_dps, args.max_order.into()).map_err(refused)?;
    let info = acquisition.info(args.serial.as_deref(), args.supply_note.as_deref());
    let aliased = part.axes.first().and_then(|axis| aliasing(&axis.axis, &tally));
    let warnings: Vec<Warning> = record.warnings(args.earth_dps).chain(aliased).collect();
    let run = ChamberRun { tally: &tally, max_lost: args.max_lost, earth_dps: args.earth_dps, warnings: &warnings };
    // what was measured before an interruption is in no recording of this run
    let capture_sha256 = if is_resumed { String::new() } else { capture_sha256 };
    let calibration = Calibration::of_chamber(&part, &record, &outcomes, &run, info.origin(capture_sha256));
    let mut said: Vec<String> = warnings
        .iter()
        .copied()
        .map(JobWarning::from)
        .chain(acquisition.disbelief())
        .map(|one| coded(one).to_string())
        .collect();
    said.extend(resumed(is_resumed));
    said.extend(outcomes.iter().zip(part.axes.iter()).flat_map(|(outcome, axis)| of_axis(outcome, &axis.name, &part)));
    said.extend(outcomes.iter().zip(part.axes.iter()).filter_map(|(outcome, axis)| wide_loop(outcome, &axis.name)));
    let report = Report::new(plan, &calibration, &record, &outcomes, &truths, said);
    let kept_all = files.fill(&report, &calibration, &record, &outcomes);
    match log_failed.map_or(kept_all, Err) {
        Ok(()) => kept.forget(),
        Err(why) => {
            let wanted: Vec<_> = args.output.iter().cloned().collect();
            return Err(Undelivered::rescue(why, &wanted, &calibration).error(""));
        }
    }
    if args.json {
        return print_json(&report);
    }
    warn(&report.warnings);
    print_lines(&report.text(args.output.as_deref()))
}

fn resumed(is_resumed: bool) -> Option<String> {
    is_resumed.then(|| {
        "resumed: the measurement was interrupted; a part that was switched off in between may have another bias \
         since, which shows as noise and is no part of the uncertainty. No one recording gives this result again"
            .to_owned()
    })
}

/// The warnings of an axis, which is named where there are several.
fn of_axis(outcome: &ChamberOutcome, name: &str, part: &Part) -> Vec<String> {
    let named = |warning: Warning| match part.axes.len() {
        1 => coded(warning).to_string(),
        _ => format!("axis {name}: {}", coded(warning)),
    };
    outcome.warnings().map(named).collect()
}

impl Files {
    fn fill(
        self,
        report: &Report,
        calibration: &Calibration,
        record: &Record,
        outcomes: &[ChamberOutcome],
    ) -> Result<()> {
        if let Some(file) = self.report {
            match self.report_kind {
                Some(kind) => picture::write(kind, file, &outcomes.first().map_or(String::new(), over_temperature))?,
                None => file.fill(report.page(calibration, record, outcomes)?.as_bytes())?,
            }
        }
        Ok(self.calibration.map_or(Ok(()), |file| file.fill(calibration.to_toml().as_bytes()))?)
    }
}

impl Report {
    fn new(
        plan: &PlanFile,
        calibration: &Calibration,
        record: &Record,
        outcomes: &[ChamberOutcome],
        truths: &[Truth],
        warnings: Vec<String>,
    ) -> Self {
        let (temp_min_c, temp_max_c) = record.span_c().unwrap_or_default();
        let axis = |(index, outcome): (usize, &ChamberOutcome)| {
            let name = calibration.axes.get(index).map_or(String::new(), |axis| axis.name.clone());
            AxisReport::new(name, index, record, outcome, truths.get(index))
        };
        let mut axes: Vec<AxisReport> = outcomes.iter().enumerate().map(axis).collect();
        let only = if axes.len() == 1 { axes.pop() } else { None };
        Self {
            only,
            axes,
            method: "chamber",
            plan: plan.name.clone(),
            device: calibration.device.clone(),
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            samples: record.samples,
            lost_samples: record.lost,
            impossible_readings: record.impossible,
            duration_s: calibration.run.map_or(0.0, |run| run.duration_s),
            temp_min_c,
            temp_max_c,
            restless: record.restless(),
            calibration_id: calibration.id(),
            capture_sha256: calibration.capture_sha256.clone(),
            warnings,
        }
    }

    fn all(&self) -> impl Iterator<Item = &AxisReport> {
        self.only.iter().chain(&self.axes)
    }

    fn text(&self, file: Option<&Path>) -> String {
        let mut text = format!(
            "Calibration {} of {}, {}\n{} samples in {}, {} lost, part between {:.1} and {:.1} °C\n",
            self.calibration_id,
            self.device.as_deref().unwrap_or_default(),
            self.plan,
            self.samples,
            Seconds(self.duration_s.round()),
            self.lost_samples,
            self.temp_min_c,
            self.temp_max_c,
        );
        for axis in self.all() {
            text += &axis.text(self.axes.len() > 1);
        }
        text += "± is the 95 % interval; outside these temperatures the correction is an extrapolation\n";
        match file.map(Path::display) {
            Some(file) => text + &format!("\nWritten to {file}. Next: zerorate report {file} -o report.html\n"),
            None => text + "\nNothing was written: give -o unit.toml to keep the calibration.\n",
        }
    }

    fn page(&self, calibration: &Calibration, record: &Record, outcomes: &[ChamberOutcome]) -> Result<String> {
        let title = format!("{} in a chamber: {}", calibration.part, self.plan);
        let facts = self.all().map(AxisReport::facts).collect();
        chamber_page(ChamberPage { title: &title, calibration, record, outcomes, warnings: &self.warnings, facts })
    }
}

impl AxisReport {
    fn new(name: String, index: usize, record: &Record, outcome: &ChamberOutcome, truth: Option<&Truth>) -> Self {
        let curve = &outcome.curve;
        let Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = curve.correction;
        let (low_c, high_c) = record.span_c().unwrap_or_default();
        let temps = || CurvePoint::temps_c(low_c, high_c);
        let point = |temp_c| {
            let correction_dps = curve.correction.at(temp_c);
            CurvePoint { temp_c, correction_dps, u_dps: Some(curve.u_dps(temp_c)) }
        };
        let u = |term: usize| curve.covariance[term][term].max(0.0).sqrt();
        let truth = truth.map(|truth| TruthReport {
            pbc_dps: truth.pbc_dps(t3_c),
            btc_dps_per_c: truth.btc_dps_per_c(t3_c),
            curve: temps()
                .map(|temp_c| CurvePoint { temp_c, correction_dps: truth.pbc_dps(temp_c), u_dps: None })
                .collect(),
        });
        Self {
            name,
            pbc_dps,
            btc_dps_per_c,
            btc2_dps_per_c2,
            btc3_dps_per_c3,
            t3_c,
            u_pbc_dps: curve.u_dps(t3_c),
            u_btc_dps_per_c: u(1),
            u_btc2_dps_per_c2: u(2),
            u_btc3_dps_per_c3: u(3),
            order: curve.order,
            order_weights: curve.order_weights.to_vec(),
            lag_s: curve.following.lag_s,
            play_c: curve.following.play_c,
            bias_instability_dps: curve.noise.bias_instability_dps,
            rate_random_walk_dps_per_rt_s: curve.noise.rate_random_walk_dps_per_rt_s,
            curve: temps().map(point).collect(),
            points: points(index, record, outcome),
            branches: outcome.branches.map(Loop::from),
            truth,
        }
    }

    /// Uncertainty of the curve, rms over the temperatures seen, °/h at 95 %.
    fn u_dph(&self) -> f64 {
        let squares: f64 = self.curve.iter().filter_map(|point| point.u_dps).map(|u_dps| u_dps * u_dps).sum();
        3600.0 * Uncertainty::FACTOR * (squares / f64::from(POINTS)).sqrt()
    }

    /// How far the curve is from the twin's, rms over the temperatures seen, °/h.
    fn off_dph(&self) -> Option<f64> {
        let truth = &self.truth.as_ref()?.curve;
        let off = self.curve.iter().zip(truth).map(|(one, other)| one.correction_dps - other.correction_dps);
        Some(3600.0 * (off.map(|off| off * off).sum::<f64>() / f64::from(POINTS)).sqrt())
    }

    fn facts(&self) -> Vec<Fact> {
        let factor = Uncertainty::FACTOR;
        let mut facts = vec![
            Fact::new(
                "PBC",
                format!("{:+.5} ± {:.5} °/s at T3 = {:.3} °C", self.pbc_dps, factor * self.u_pbc_dps, self.t3_c),
            ),
            Fact::new("BTC", format!("{:+.6} ± {:.6} °/s/°C", self.btc_dps_per_c, factor * self.u_btc_dps_per_c)),
        ];
        if self.order > 1 {
            facts.push(Fact::new(
                "BTC2",
                format!("{:+.3e} ± {:.1e} °/s/°C²", self.btc2_dps_per_c2, factor * self.u_btc2_dps_per_c2),
            ));
        }
        if self.order > 2 {
            facts.push(Fact::new(
                "BTC3",
                format!("{:+.3e} ± {:.1e} °/s/°C³", self.btc3_dps_per_c3, factor * self.u_btc3_dps_per_c3),
            ));
        }
        let weight = 100.0 * self.order_weights.get(self.order).copied().unwrap_or_default();
        facts.push(Fact::new("order", format!("{} (probability {weight:.0} %)", self.order)));
        facts.push(Fact::new("known to", format!("±{:.1} °/h, rms over the temperatures seen", self.u_dph())));
        facts.push(Fact::new("lag", format!("{:.0} s", self.lag_s)));
        let apart = self.branches.as_ref().map_or_else(
            || "not seen: no temperature was passed in both directions".to_owned(),
            |one| {
                let (half_dps, u_dps) = (one.half_width_dps, factor * one.u_dps);
                format!(
                    "{half_dps:+.5} ± {u_dps:.5} °/s, half of cooling less warming, {:.0} to {:.0} °C",
                    one.temp_min_c, one.temp_max_c
                )
            },
        );
        facts.push(Fact::new("loop", apart));
        facts.extend(self.off_dph().map(|off_dph| Fact::new("twin's truth", format!("{off_dph:.1} °/h off, rms"))));
        facts
    }

    fn text(&self, named: bool) -> String {
        let mut text = if named { format!("\naxis {}\n", self.name) } else { "\n".to_owned() };
        for Fact { name, value } in self.facts() {
            text += &format!("  {name:12} {value}\n");
        }
        text += "\n  step   set, °C  part, °C    rate, °/s  corrected, °/s  drift, °C/min\n";
        for point in &self.points {
            let settled = if point.settled { "" } else { "  not settled" };
            text += &format!(
                "  {:4} {:9.1} {:9.3} {:+12.5} {:+15.5} {:+14.4}{settled}\n",
                point.step, point.set_c, point.temp_c, point.rate_dps, point.residual_dps, point.drift_c_per_min
            );
        }
        text + "\n"
    }
}

fn points(axis: usize, record: &Record, outcome: &ChamberOutcome) -> Vec<Point> {
    let point = |(soak, residual_dps): (&zerorate::chamber::Soak, &f64)| Point {
        step: soak.step + 1,
        set_c: soak.set_c,
        start_s: soak.start_s,
        end_s: soak.end_s,
        temp_c: soak.temp_c,
        rate_dps: soak.rates_dps.get(axis).copied().unwrap_or(f64::NAN),
        residual_dps: *residual_dps,
        drift_c_per_min: soak.drift_c_per_min,
        settled: soak.settled,
    };
    record.soaks.iter().zip(&outcome.soak_residuals_dps).map(point).collect()
}

impl From<Branches> for Loop {
    fn from(branches: Branches) -> Self {
        let Branches { half_width_dps, u_dps, span_c: (temp_min_c, temp_max_c) } = branches;
        Self { half_width_dps, u_dps, temp_min_c, temp_max_c }
    }
}
