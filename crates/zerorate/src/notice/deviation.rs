//! What a rate that deviates is called. Warnings and refusals contain its text.

use super::rows_with_remedies;
use crate::drift_checks::Deviation;
use crate::remedy::Remedy;
use alloc::format;
use core::fmt;
use zerorate_allan::Says;

rows_with_remedies!(match Deviation {
    Self::Step { at_s, size_dps, supply_mv } => Row {
        code: "step",
        text: format_args!(
            "the rate stepped by {size_dps:+.4} °/s at {at_s:.0} s{}",
            supply_mv.map(|mv| format!(": as a supply step that would be at least {mv:.0} mV")).unwrap_or_default()
        ),
        remedies: &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "allan", "imu"],
        seen: "The level of the rate jumped, and stayed.",
        matters: "A knock or a step of the supply looks like a change of the bias. It is taken out or widens the \
            uncertainty; where it cannot be told from the temperature, or spoils BTC, the measurement is refused. In \
            an Allan analysis a random walk would be seen in its place.",
        remedy: "Use a linear supply, check that nothing moved, and measure again.",
    },
    Self::Curvature { dps_per_c2 } => Row {
        code: "curved",
        text: format_args!("the rate bends over temperature, by {dps_per_c2:+.5} °/s/°C²: a curved bias"),
        remedies: &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "The rate bends over temperature.",
        matters: "A line through two temperatures is wrong between and beyond them. The size is in the uncertainties; \
            where BTC would be too uncertain, it is refused.",
        remedy: "Use a method that bends, or a chamber. Slow motion of the table looks the same: check that.",
        command: "zerorate recalibrate unit.arrows --method warmup -o curve.toml",
    },
    Self::Lag { lag_s } => Row {
        code: "lagging",
        text: format_args!(
            "the rate follows the temperature late, as if the sensing element lagged by about {lag_s:.0} s"
        ),
        remedies: &[Remedy::WarmMoreSlowly, Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The rate follows the temperature sensor late, as if the sensing element were warmed later than the \
            sensor beside it.",
        matters: "While the temperature changes, the correction is that of a temperature which the element does not \
            have yet.",
        remedy: "Warm and settle more slowly, or measure in a chamber. Slow motion looks the same.",
    },
    Self::Hysteresis { width_c } => Row {
        code: "hysteresis",
        text: format_args!(
            "the rate held still until the temperature had changed by about {width_c:.1} °C: a hysteresis, or a step \
             at the start"
        ),
        remedies: &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The bias on the way up is not that on the way down; or it held still until the temperature had changed \
            by some degrees.",
        matters: "No curve over temperature corrects that: the correction is right for the way on which it was \
            measured.",
        remedy: "Measure both ways in a chamber, and take the loop as what is left.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Self::Sway { hz, size_dps } => Row {
        code: "swaying",
        text: format_args!("the rate sways by ±{size_dps:.4} °/s once in {:.0} s: the platform moves", 1.0 / hz),
        remedies: &[Remedy::FixToStillPlatform],
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "The rate sways slowly to and fro.",
        matters: "The platform moves: a building, a long bench, a person. What it adds to the averages is in the \
            uncertainty, or more than a result can bear.",
        remedy: "Fix the part to something that stands still by itself: a stone, a wall, the floor of a cellar.",
    },
});

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}
