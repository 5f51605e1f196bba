//! Codes and texts of deviations of the rate. Warnings and refusals contain them.

use super::rows_with_remedies;
use crate::drift_checks::Deviation;
use crate::remedy::Remedy;
use core::fmt;

rows_with_remedies!(match Deviation {
    Self::Step { at_s, size_dps, supply_mv } => Row {
        code: "step",
        text: format_args!("the rate stepped by {size_dps:+.4} °/s at {at_s:.0} s{}", AsSupply(supply_mv)),
        remedies: &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
    },
    Self::Curvature { dps_per_c2 } => Row {
        code: "curved",
        text: format_args!("the bias bends by {dps_per_c2:+.5} °/s/°C² over temperature"),
        remedies: &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
    },
    Self::Lag { lag_s } => Row {
        code: "lagging",
        text: format_args!("the rate follows the temperature about {lag_s:.0} s late"),
        remedies: &[Remedy::WarmMoreSlowly, Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
    },
    Self::Hysteresis { width_c } => Row {
        code: "hysteresis",
        text: format_args!("the rate held still until the temperature had changed by about {width_c:.1} °C"),
        remedies: &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
    },
    Self::Sway { hz, size_dps } => Row {
        code: "swaying",
        text: format_args!("the part sways with its platform by ±{size_dps:.4} °/s once in {:.0} s", 1.0 / hz),
        remedies: &[Remedy::FixToStillPlatform],
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
