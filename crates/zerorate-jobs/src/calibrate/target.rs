//! `--target-dph`: when a recording has told enough, and how long that still takes.

use zerorate::{Method, PartProcedure, Plan, Reached};

/// The target is checked after multiples of this time of the recording, s.
const EVERY_S: f64 = 60.0;

/// When the twin is asked for its truth, ns after the first sample: where the correction may hold from.
pub fn marks_ns(plan: &Plan) -> impl Iterator<Item = u64> + use<> {
    let total_ns = (plan.total_s() * 1e9).round() as u64;
    let end_ns = if plan.method == Method::An1042 { plan.offset_ends_ns() } else { total_ns };
    let every_ns = (EVERY_S * 1e9) as u64;
    let minutes = if plan.target_dps.is_some() { total_ns.saturating_sub(1) / every_ns } else { 0 };
    (1..=minutes).map(move |minute| minute * every_ns).chain([end_ns])
}

/// Looks at a recording at whole minutes, more seldom as it gets longer.
#[derive(Debug, Default)]
pub struct Target {
    looked_s: f64,
    reached: Option<Reached>,
    target_dps: f64,
}

impl Target {
    /// Whether the next check is due: at a whole minute, at which the twin states its truth.
    #[inline]
    pub fn is_due(&self, procedure: &PartProcedure) -> bool {
        procedure.progress().elapsed_s >= whole_minutes(Reached::next_look_s(self.looked_s))
    }

    /// Looks: whether the target is reached, and the temperature settled.
    pub fn is_reached(&mut self, procedure: &PartProcedure) -> bool {
        self.looked_s = whole_minutes(procedure.progress().elapsed_s);
        self.target_dps = procedure.plan().target_dps.unwrap_or(0.0);
        self.reached = procedure.reached().and_then(Result::ok);
        self.reached.is_some_and(|reached| reached.settled && reached.u_dps <= self.target_dps)
    }

    /// The state of the target at the last check.
    pub fn reached(&self) -> Option<Reached> {
        self.reached
    }
}

/// The last whole minute, s.
fn whole_minutes(time_s: f64) -> f64 {
    (time_s / EVERY_S).floor() * EVERY_S
}
