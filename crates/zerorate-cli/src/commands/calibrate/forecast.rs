//! `--target-dph`: forecasts how long the recording will take.

use zerorate::{Part, Plan};
use zerorate_view::duration::Seconds;

/// The forecast is rounded up to a multiple of this time, s, since the target is checked once a minute at most.
const MINUTE_S: f64 = 60.0;

/// Formats the forecast, one line per axis; empty without a target.
pub fn lines(part: &Part, plan: &Plan) -> Vec<String> {
    let Some(target_dps) = plan.target_dps else { return Vec::new() };
    let target_dph = 3600.0 * target_dps;
    let of_axis = |axis: &zerorate::NamedAxis| {
        let Some(forecast) = axis.axis.forecast(target_dps, plan.total_s()) else {
            return format!(
                "{}: no typical noise of this part is known, so the time to {target_dph:.1} °/h is forecast while it \
                 warms",
                axis.name
            );
        };
        let (u_dph, after) = (3600.0 * forecast.u_dps, Seconds((forecast.after_s / MINUTE_S).ceil() * MINUTE_S));
        match u_dph <= target_dph {
            true => format!("{}: a typical part reaches {target_dph:.1} °/h after about {after}", axis.name),
            false => format!(
                "{}: a typical part does not reach {target_dph:.1} °/h: flicker and random walk leave about \
                 {u_dph:.1} °/h, so the recording will take its whole time",
                axis.name
            ),
        }
    };
    part.axes.iter().map(of_axis).collect()
}
