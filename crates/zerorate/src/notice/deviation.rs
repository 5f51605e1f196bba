//! Deviations of the rate, with their codes and texts. Warnings and refusals contain them.

use super::{Remedy, rows_with_remedies};
use core::fmt;

/// A deviation of the rate from a line over temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deviation {
    /// The level changed, because of the supply or because the platform turned.
    Step {
        /// Time from the start of the measurement, s.
        at_s: f64,
        /// The level after the step less the level before it, °/s.
        size_dps: f64,
        /// Smallest step of the supply with this effect, mV. `None` if the sensitivity is not known.
        supply_mv: Option<f64>,
    },
    /// The bias bends over temperature.
    Curvature {
        /// Quadratic coefficient, °/s/°C².
        dps_per_c2: f64,
    },
    /// The bias lags behind the temperature sensor.
    Lag {
        /// Time constant, s.
        lag_s: f64,
    },
    /// The bias stays constant until the temperature has changed by `width_c` from the start, and then follows that
    /// far behind.
    Hysteresis {
        /// Half width of the play, °C: after a reversal, twice this change has no effect on the bias.
        width_c: f64,
    },
    /// The base oscillates, and the sensor with it.
    BaseMotion {
        /// Frequency, Hz.
        hz: f64,
        /// Peak rate, °/s.
        size_dps: f64,
    },
}

/// A deviation, and the error that it puts into the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The deviation, with its size.
    pub deviation: Deviation,
    /// Error of PBC, °/s.
    pub pbc_dps: f64,
    /// Error of BTC, °/s/°C.
    pub btc_dps_per_c: f64,
}

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
    Self::BaseMotion { hz, size_dps } => Row {
        code: "swaying",
        text: format_args!("the base moves by ±{size_dps:.4} °/s once in {:.0} s", 1.0 / hz),
        remedies: &[Remedy::FixToStillPlatform],
    },
});

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

/// Writes the step of the supply that would explain a step of the rate.
struct AsSupply(Option<f64>);

impl fmt::Display for AsSupply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |mv| write!(f, " (a supply step of at least {mv:.0} mV would do that)"))
    }
}

/// A deviation in a few words, for a warning of one line.
pub(super) struct Brief(pub(super) Deviation);

impl fmt::Display for Brief {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Deviation::Step { at_s, size_dps, .. } => write!(f, "rate stepped {size_dps:+.4} °/s at {at_s:.0} s"),
            Deviation::Curvature { dps_per_c2 } => write!(f, "bias bends by {dps_per_c2:+.5} °/s/°C²"),
            Deviation::Lag { lag_s } => write!(f, "the rate lags by {lag_s:.0} s"),
            Deviation::Hysteresis { width_c } => write!(f, "rate held for {width_c:.1} °C"),
            Deviation::BaseMotion { hz, size_dps } => write!(f, "moves ±{size_dps:.4} °/s in {:.0} s", 1.0 / hz),
        }
    }
}
