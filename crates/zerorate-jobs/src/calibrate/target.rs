//! `--target-dph`: checks whether a recording has reached the target uncertainty.

use zerorate::{Method, PartProcedure, Plan, Reached};

/// The target is checked at multiples of this time, s.
const EVERY_S: f64 = 60.0;

/// Times after the first sample at which the twin reports its true state, ns: the possible ends of the measurement.
pub fn marks_ns(plan: &Plan) -> impl Iterator<Item = u64> + use<> {
    let total_ns = (plan.total_s() * 1e9).round() as u64;
    let end_ns = if plan.method == Method::An1042 { plan.offset_ends_ns() } else { total_ns };
    let every_ns = (EVERY_S * 1e9) as u64;
    let minutes = if plan.target_dps.is_some() { total_ns.saturating_sub(1) / every_ns } else { 0 };
    (1..=minutes).map(move |minute| minute * every_ns).chain([end_ns])
}

/// Checks a recording against its target at whole minutes, less often as the recording gets longer.
#[derive(Debug, Default)]
pub struct Target {
    looked_s: f64,
    reached: Option<Reached>,
}

impl Target {
    /// Checks are at whole minutes, where the twin reports its true state.
    #[inline]
    pub fn is_due(&self, procedure: &PartProcedure) -> bool {
        procedure.progress().elapsed_s >= whole_minutes(Reached::next_look_s(self.looked_s))
    }

    pub fn is_reached(&mut self, procedure: &PartProcedure) -> bool {
        self.looked_s = whole_minutes(procedure.progress().elapsed_s);
        self.reached = procedure.reached().and_then(Result::ok);
        let target_dps = procedure.plan().target_dps.unwrap_or(0.0);
        self.reached.is_some_and(|reached| reached.settled && reached.u_dps <= target_dps)
    }

    /// The result of the last check; `None` before it, or if the samples up to then would be refused.
    pub fn reached(&self) -> Option<Reached> {
        self.reached
    }
}

fn whole_minutes(time_s: f64) -> f64 {
    (time_s / EVERY_S).floor() * EVERY_S
}
