//! The methods without a chamber: the procedure of AN-1042, a warm-up, and a temperature cycle.

use super::{GuidedAxis, GuidedMethod, GuidedResult, Measurement, label};
use crate::message::{CalibrateCommand, Forecast, MethodName, Running, Step};
use zerorate::calibration::Origin;
use zerorate::health::resonance;
use zerorate::{
    Action, AxisRefusal, Calibration, Event, Method, Outcome, Part, PartProcedure, Plan, Reached, Scan, State, Wording,
};

/// A recording can be finished after this time since its start, s of the part's time.
const FINISH_FROM_S: f64 = 60.0;

#[derive(Debug)]
pub struct Hour {
    procedure: PartProcedure,
    pending_refusals: Vec<String>,
    /// The result that a recording ending at `reached_s` would have, or the reason why it would be refused.
    reached: Option<Result<Reached, String>>,
    reached_s: f64,
}

impl Hour {
    pub fn new(command: &CalibrateCommand, part: &Part, earth_dps: Option<f64>) -> Result<Self, String> {
        let plan = plan(command, earth_dps);
        let procedure = PartProcedure::new(part, plan).map_err(|error| error.with(label).to_string())?;
        Ok(Self { procedure, pending_refusals: Vec::new(), reached: None, reached_s: 0.0 })
    }

    fn handle(&mut self, event: Event<'_, Scan>) -> Result<(), String> {
        self.procedure.handle(event).map_err(|refusal| worded(&refusal))
    }

    fn advice(&self, state: State, temps_c: Option<[f64; 4]>) -> String {
        let warmed_c = temps_c.map_or(0.0, |[first, now, ..]| now - first);
        match (state, self.procedure.plan().method) {
            (State::Start, _) => "Do not move the sensor: it is being initialised.".to_owned(),
            (State::Recording, Method::Cycle) => {
                "Heat the sensor, then let it cool, over the temperatures of its later use. Do not move it.".to_owned()
            }
            (State::WarmUp | State::Recording, _) => format!(
                "Leave the sensor alone while it warms itself; it is {warmed_c:+.2} °C from its start. Avoid \
                 draughts, touch, and switching loads on its supply."
            ),
            (State::Settle, _) => "Leave the sensor alone until its temperature has settled.".to_owned(),
            _ => "Do not touch the table: the rate at rest is being averaged.".to_owned(),
        }
    }
}

impl GuidedMethod for Hour {
    fn begin(&mut self, t_ns: u64) -> Result<(), String> {
        self.handle(Event::Initialised { t_ns })
    }

    fn take(&mut self, scan: &Scan) -> Result<bool, String> {
        self.handle(Event::Reading(scan))?;
        Ok(self.procedure.next() == Action::Done)
    }

    fn end_recording(&mut self) -> Result<bool, String> {
        self.procedure.end_recording().map_err(|refusal| worded(&refusal))
    }

    fn look(&mut self) {
        let elapsed_s = self.procedure.progress().elapsed_s;
        if elapsed_s >= Reached::next_look_s(self.reached_s) {
            self.reached_s = elapsed_s;
            let reached = self.procedure.reached();
            self.reached = reached.map(|reached| reached.map_err(|refusal| worded(&refusal)));
        }
        let mut refusals: Vec<String> = self.procedure.pending_refusals().map(|refusal| worded(&refusal)).collect();
        if let Some(Err(refused)) = self.reached.as_ref().filter(|_| refusals.is_empty()) {
            refusals.push(refused.clone());
        }
        self.pending_refusals = refusals;
    }

    fn running(&self, method: MethodName, temps_c: Option<[f64; 4]>) -> Running {
        let progress = self.procedure.progress();
        let step = |(state, from_s, to_s): (State, f64, f64)| Step { name: state.to_string(), from_s, to_s };
        let reached = self.reached.as_ref().and_then(|reached| reached.as_ref().ok());
        // a cycle has no natural end: the user decides how long it lasts
        let has_settled = |reached: &Reached| reached.settled || self.procedure.plan().method == Method::Cycle;
        Running {
            method,
            steps: self.procedure.plan().steps().map(step).collect(),
            elapsed_s: progress.elapsed_s,
            left_s: (progress.total_s - progress.elapsed_s).max(0.0),
            advice: self.advice(progress.state, temps_c),
            pending_refusals: self.pending_refusals.clone(),
            temps_c,
            forecast: reached.map(|&Reached { u_pbc_dps, u_btc_dps_per_c, .. }| Forecast {
                at_s: self.reached_s,
                u_pbc_dps,
                u_btc_dps_per_c,
            }),
            can_finish: progress.state == State::Recording && progress.elapsed_s > FINISH_FROM_S,
            is_enough: self.pending_refusals.is_empty() && reached.is_some_and(has_settled),
        }
    }

    fn finish(self: Box<Self>, source: &Measurement<'_>, origin: Origin) -> Result<GuidedResult, String> {
        let (plan, part) = (*self.procedure.plan(), self.procedure.part().clone());
        let mut outcomes = self.procedure.finish().map_err(|refusal| worded(&refusal))?;
        let average_s = plan.average_s.min(plan.offset_s);
        let (rate_hz, edges) = (source.tally.sampling_hz(), source.info.edges_per_reading());
        let tone = part.axes.first().and_then(|first| resonance::warning(&first.axis, rate_hz, edges, average_s));
        let of_all = tone.into_iter().chain(source.info.twin_at_rest(plan.earth_dps));
        outcomes.iter_mut().for_each(|outcome| outcome.warnings.extend(of_all.clone()));
        let found = |outcome: &Outcome| GuidedAxis {
            correction: outcome.correction,
            u_pbc_dps: outcome.uncertainty.u_pbc_dps,
            u_btc_dps_per_c: outcome.uncertainty.u_btc_dps_per_c,
            span_c: (outcome.temp_min_c, outcome.temp_max_c),
        };
        Ok(GuidedResult {
            calibration: Calibration::new(&part, &outcomes, origin),
            axes: outcomes.iter().map(found).collect(),
            warnings: super::worded(outcomes.iter().flat_map(|outcome| &outcome.warnings)),
        })
    }
}

fn plan(command: &CalibrateCommand, earth_dps: Option<f64>) -> Plan {
    let default = Plan::default();
    Plan {
        method: match command.method {
            MethodName::Warmup => Method::Warmup,
            MethodName::Cycle => Method::Cycle,
            MethodName::An1042 | MethodName::Chamber => Method::An1042,
        },
        average_s: command.average_s.unwrap_or(default.average_s),
        warmup_s: command.warmup_s.unwrap_or(default.warmup_s),
        settle_s: command.settle_s.unwrap_or(default.settle_s),
        offset_s: command.offset_s.unwrap_or(default.offset_s),
        earth_dps,
        ..default
    }
}

fn worded(refusal: &AxisRefusal) -> String {
    refusal.with(label).to_string()
}
