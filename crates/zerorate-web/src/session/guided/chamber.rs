//! A calibration in a chamber that a person sets by hand, step by step.

use super::{GuidedAxis, GuidedMethod, GuidedResult, Measurement};
use crate::message::{CalibrateCommand, MethodName, Running, Step};
use zerorate::calibration::{ChamberRun, Origin};
use zerorate::chamber::{
    ChamberAction, ChamberOutcome, ChamberPlan, ChamberProcedure, ChamberRefusal, SHIPPED, StepEnd,
};
use zerorate::{Calibration, Part, Plan, Scan, Warning};
use zerorate_view::{Seconds, SessionWarning, report};

/// The plan that is used if none is named.
const DEFAULT: &str = "two-point";
/// Highest polynomial order of the curve.
const MAX_ORDER: usize = 3;

#[derive(Debug)]
pub struct ByHand {
    procedure: ChamberProcedure,
    /// End times of the finished steps, s since the start of the calibration.
    ends_s: Vec<f64>,
    max_lost: f64,
    earth_dps: Option<f64>,
}

impl ByHand {
    pub fn new(command: &CalibrateCommand, part: &Part, earth_dps: Option<f64>) -> Result<Self, String> {
        let named = command.plan.as_deref().map(str::trim).filter(|plan| !plan.is_empty()).unwrap_or(DEFAULT);
        let max_lost = Plan::default().max_lost;
        let plan = ChamberPlan::parse(text_of(named)?).map_err(|error| error.to_string())?;
        plan.spares(part).map_err(|error| error.to_string())?;
        let procedure = ChamberProcedure::new(part, plan, max_lost).map_err(|error| error.to_string())?;
        Ok(Self { procedure, ends_s: Vec::new(), max_lost, earth_dps })
    }

    /// The end of a step that starts at `from_s`, s. A finished step has its real end. Any other step ends after its
    /// minimum duration, and the running step not before now.
    fn end_s(&self, step: usize, from_s: f64) -> f64 {
        let (plan, part) = (self.procedure.plan(), self.procedure.part());
        let least_s = plan.least_s(step, part) - plan.least_s(step + 1, part);
        match self.ends_s.get(step) {
            Some(end_s) => *end_s,
            None if step == self.ends_s.len() => (from_s + least_s).max(self.procedure.progress().elapsed_s),
            None => from_s + least_s,
        }
    }

    fn advice(&self) -> String {
        let progress = self.procedure.progress();
        let Some(step) = self.procedure.plan().steps.get(progress.step) else {
            return "Set the chamber back, or switch it off.".to_owned();
        };
        let how = step.c_per_min.map_or(String::new(), |c_per_min| format!(", at {c_per_min} °C a minute"));
        let then = match step.end {
            StepEnd::Hold(hold_s) => format!("leave it there for {}", Seconds(hold_s)),
            StepEnd::Average(_) => "leave it there until the sensor has settled and was averaged".to_owned(),
        };
        let at = progress.temp_c.map_or(String::new(), |temp_c| format!(" The sensor is at {temp_c:.1} °C."));
        format!(
            "Step {} of {}: set the chamber to {:.1} °C{how}, and {then}. Now: {}.{at}",
            progress.step + 1,
            progress.steps,
            step.to_c,
            progress.state
        )
    }
}

/// The text of a plan, given by its name or directly.
fn text_of(named: &str) -> Result<&str, String> {
    let shipped = SHIPPED.iter().find(|(name, _)| *name == named).map(|(_, text)| *text);
    let names = SHIPPED.map(|(name, _)| name).join(" and ");
    shipped
        .or(Some(named).filter(|text| text.contains('=')))
        .ok_or_else(|| format!("unknown plan {named:?}: take one of {names}, or give the text of a plan"))
}

impl GuidedMethod for ByHand {
    fn begin(&mut self, t_ns: u64) -> Result<(), String> {
        self.procedure.begin(t_ns);
        Ok(())
    }

    fn take(&mut self, scan: &Scan) -> Result<bool, String> {
        self.procedure.take(scan).map_err(|refusal| refusal.to_string())?;
        while self.ends_s.len() < self.procedure.steps_done() {
            self.ends_s.push(self.procedure.progress().elapsed_s);
        }
        Ok(self.procedure.next() == ChamberAction::Done)
    }

    fn running(&self, method: MethodName, temps_c: Option<[f64; 4]>) -> Running {
        let elapsed_s = self.procedure.progress().elapsed_s;
        let mut at_s = 0.0;
        let step = |(index, to_c): (usize, f64)| {
            let from_s = at_s;
            at_s = self.end_s(index, from_s);
            Step { name: format!("to {to_c:.1} °C"), from_s, to_s: at_s }
        };
        let steps: Vec<Step> =
            self.procedure.plan().steps.iter().map(|step| step.to_c).enumerate().map(step).collect();
        Running {
            method,
            steps,
            elapsed_s,
            left_s: (at_s - elapsed_s).max(0.0),
            advice: self.advice(),
            pending_refusals: Vec::new(),
            temps_c,
            forecast: None,
            can_finish: false,
            is_enough: false,
        }
    }

    fn finish(self: Box<Self>, source: &Measurement<'_>, origin: Origin) -> Result<GuidedResult, String> {
        let worded = |refusal: ChamberRefusal| refusal.to_string();
        let (part, earth_dps) = (self.procedure.part().clone(), self.earth_dps);
        let record = self.procedure.finish().map_err(worded)?;
        let outcomes = record.outcomes(&part, earth_dps, MAX_ORDER).map_err(worded)?;
        let at_rest = source.info.twin_at_rest(earth_dps);
        let warnings: Vec<Warning> = record.warnings(earth_dps).chain(at_rest).collect();
        let run = ChamberRun { tally: source.tally, max_lost: self.max_lost, earth_dps, warnings: &warnings };
        let span_c = record.span_c().unwrap_or_default();
        let found = |outcome: &ChamberOutcome| GuidedAxis {
            correction: outcome.curve.correction,
            u_pbc_dps: outcome.curve.covariance[0][0].sqrt(),
            u_btc_dps_per_c: outcome.curve.u_btc_dps_per_c(),
            span_c,
        };
        let axes = || outcomes.iter().zip(part.axes.iter());
        let of_axes: Vec<Warning> = axes().flat_map(|(outcome, axis)| outcome.warnings(&axis.axis)).collect();
        let loops = axes()
            .filter_map(|(outcome, axis)| report::wide_loop(outcome, &axis.name))
            .map(|text| SessionWarning::WideLoop(text).into());
        Ok(GuidedResult {
            calibration: Calibration::of_chamber(&part, &record, &outcomes, &run, origin),
            axes: outcomes.iter().map(found).collect(),
            warnings: super::worded(warnings.iter().chain(&of_axes)).into_iter().chain(loops).collect(),
        })
    }
}
