//! Codes and texts of deviations of the rate. Warnings and refusals contain them.

use super::rows_with_remedies;
use crate::drift_checks::Deviation;
use crate::remedy::Remedy;
use core::fmt;
use zerorate_allan::Says;

rows_with_remedies!(match Deviation {
    Self::Step { at_s, size_dps, supply_mv } => Row {
        code: "step",
        text: format_args!("the rate stepped by {size_dps:+.4} °/s at {at_s:.0} s{}", AsSupply(supply_mv)),
        remedies: &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "allan", "imu"],
        seen: "The level of the rate jumped, and stayed.",
        matters: "A knock or a step of the supply looks like a change of the bias. The bias of an ADIS16130 follows \
            its supply by up to 0.0002 °/s per mV (F-01). A method that fits a curve takes the step out: the \
            correction is the one after the step, and its uncertainty allows for the rest. AN-1042 keeps it: the \
            brackets give the errors that it makes in PBC and BTC, and their uncertainties include them. If it cannot \
            be told from the temperature, or spoils BTC, the measurement is refused. In an Allan analysis it would \
            pass for a random walk.",
        remedy: "Use a linear supply, check that nothing moved, and measure again.",
    },
    Self::Curvature { dps_per_c2 } => Row {
        code: "curved",
        text: format_args!("the bias bends by {dps_per_c2:+.5} °/s/°C² over temperature"),
        remedies: &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "The rate bends over temperature.",
        matters: "A line through two temperatures is wrong between and beyond them. The brackets give the errors that \
            it makes in PBC and BTC, and their uncertainties include them. If BTC would be too uncertain, the \
            measurement is refused.",
        remedy: "Use a method that fits a curve, or a chamber. Check that nothing moved slowly, which looks the same.",
        command: "zerorate recalibrate unit.arrows --method warmup -o curve.toml",
    },
    Self::Lag { lag_s } => Row {
        code: "lagging",
        text: format_args!("the rate follows the temperature about {lag_s:.0} s late"),
        remedies: &[Remedy::WarmMoreSlowly, Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The rate follows the temperature sensor late, as if the sensing element were warmed later than the \
            sensor beside it.",
        matters: "While the temperature changes, the correction belongs to a temperature that the element does not \
            have yet. A fitted curve holds for a temperature at rest. With AN-1042 the brackets give the errors in \
            PBC and BTC, and their uncertainties include them.",
        remedy: "Warm and settle more slowly, or measure in a chamber. Check that nothing moved slowly, which looks \
            the same.",
    },
    Self::Hysteresis { width_c } => Row {
        code: "hysteresis",
        text: format_args!("the rate held still until the temperature had changed by about {width_c:.1} °C"),
        remedies: &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The bias differs between warming and cooling, or it held still until the temperature had changed by \
            some degrees. The latter is a hysteresis or a step at the start.",
        matters: "No curve over temperature corrects that. The correction is right for the direction in which it was \
            measured. With AN-1042 the brackets give the errors in PBC and BTC, and their uncertainties include them.",
        remedy: "Measure in both directions in a chamber, and take the width of the loop as the error that remains. \
            Check that nothing moved slowly, which looks the same.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Self::Sway { hz, size_dps } => Row {
        code: "swaying",
        text: format_args!("the part sways with its platform by ±{size_dps:.4} °/s once in {:.0} s", 1.0 / hz),
        remedies: &[Remedy::FixToStillPlatform],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The rate sways slowly to and fro.",
        matters: "The platform moves: a building, a long bench, a person. A method that fits a curve takes the sway \
            out, and its uncertainty allows for the rest. With AN-1042 the brackets give the errors in PBC and BTC, \
            and their uncertainties include them. If a result cannot bear the sway, the measurement is refused.",
        remedy: "Fix the part to something that stands still by itself: a stone, a wall, the floor of a cellar.",
    },
});

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

/// The step of the supply that would explain a step of the rate.
struct AsSupply(Option<f64>);

impl fmt::Display for AsSupply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |mv| write!(f, " (a supply step of at least {mv:.0} mV would do that)"))
    }
}

/// A deviation in a few words, for the one line of a warning.
pub(super) struct Brief(pub(super) Deviation);

impl fmt::Display for Brief {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Deviation::Step { at_s, size_dps, .. } => write!(f, "rate stepped {size_dps:+.4} °/s at {at_s:.0} s"),
            Deviation::Curvature { dps_per_c2 } => write!(f, "bias bends by {dps_per_c2:+.5} °/s/°C²"),
            Deviation::Lag { lag_s } => write!(f, "the rate lags by {lag_s:.0} s"),
            Deviation::Hysteresis { width_c } => write!(f, "rate held for {width_c:.1} °C"),
            Deviation::Sway { hz, size_dps } => write!(f, "sways ±{size_dps:.4} °/s in {:.0} s", 1.0 / hz),
        }
    }
}
