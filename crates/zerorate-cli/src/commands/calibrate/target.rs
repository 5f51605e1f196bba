//! `--target-dph`: when a recording has told enough, and how long that still takes.

use crate::wording::flag;
use zerorate::{Method, Part, PartProcedure, Plan, Reached, Setting};
use zerorate_view::duration::Seconds;

/// The target is looked at once in so many s of the recording.
const EVERY_S: f64 = 60.0;

/// When the twin is asked for its truth, ns after the first sample: where the correction may hold from.
pub fn marks_ns(plan: &Plan) -> impl Iterator<Item = u64> + use<> {
    let total_ns = (plan.total_s() * 1e9).round() as u64;
    let end_ns = if plan.method == Method::An1042 { plan.offset_ends_ns() } else { total_ns };
    let every_ns = (EVERY_S * 1e9) as u64;
    let minutes = if plan.target_dps.is_some() { total_ns.saturating_sub(1) / every_ns } else { 0 };
    (1..=minutes).map(move |minute| minute * every_ns).chain([end_ns])
}

/// What can be said beforehand.
pub fn forecasts(part: &Part, plan: &Plan) -> Vec<String> {
    let Some(target_dps) = plan.target_dps else { return Vec::new() };
    let target_dph = 3600.0 * target_dps;
    let of_axis = |axis: &zerorate::NamedAxis| {
        let Some(forecast) = axis.axis.forecast(target_dps, plan.total_s()) else {
            return format!(
                "{}: how long {target_dph:.1} °/h will take is said while the part warms, since nothing typical is \
                 known of it",
                axis.name
            );
        };
        let (u_dph, after) = (3600.0 * forecast.u_dps, Seconds((forecast.after_s / EVERY_S).ceil() * EVERY_S));
        match u_dph <= target_dph {
            true => format!("{}: a typical part reaches {target_dph:.1} °/h after about {after}", axis.name),
            false => format!(
                "{}: a typical part does not reach {target_dph:.1} °/h, since flicker and random walk leave about \
                 {u_dph:.1} °/h: the recording will take its whole time",
                axis.name
            ),
        }
    };
    part.axes.iter().map(of_axis).collect()
}

/// Looks at a recording once a minute.
#[derive(Debug, Default)]
pub struct Target {
    looked_s: f64,
    reached: Option<Reached>,
    target_dps: f64,
}

impl Target {
    /// Whether a minute has passed since the last look. The looks are at whole minutes, where the twin says its truth.
    #[inline]
    pub fn is_due(&self, procedure: &PartProcedure) -> bool {
        procedure.progress().elapsed_s >= self.looked_s + EVERY_S
    }

    /// Looks: whether the target is reached, and the temperature settled.
    pub fn is_reached(&mut self, procedure: &PartProcedure) -> bool {
        self.looked_s = (procedure.progress().elapsed_s / EVERY_S).floor() * EVERY_S;
        self.target_dps = procedure.plan().target_dps.unwrap_or(0.0);
        self.reached = procedure.reached();
        self.reached.is_some_and(|reached| reached.settled && reached.u_dps <= self.target_dps)
    }

    /// How far it is, in words.
    pub fn left(&self) -> Option<String> {
        let Reached { u_dps, left_s, .. } = self.reached?;
        let settles = if left_s > 0.0 { format!(", settles in {}", Seconds(left_s.round())) } else { String::new() };
        Some(format!("{:.1} °/h ({}){settles}", 3600.0 * u_dps, flag(Setting::Target)))
    }
}
