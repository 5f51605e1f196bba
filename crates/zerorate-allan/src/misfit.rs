//! The frequency band and the likely cause of a misfit of a noise model.

use crate::text::significant;
use core::fmt;

/// A frequency band in which the record disagrees with its noise model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Lower end of the band, Hz.
    pub from_hz: f64,
    /// Upper end of the band, Hz.
    pub to_hz: f64,
    /// Measured power over modelled power in the band.
    pub ratio: f64,
    /// The likely cause.
    pub cause: Cause,
}

/// The likely cause of a misfit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The power in the band changes during the record.
    Motion,
    /// The power is steady, and above the model in a narrow band.
    Resonance,
    /// The power is steady, and above the model up to the end of the spectrum, where a steep filter left little power.
    Filter,
    /// Most samples repeat the one before.
    CoarseCodes,
    /// The record shows none of the other causes.
    Unknown,
}

impl fmt::Display for Misfit {
    /// States the band and the remedy.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from_hz, to_hz, ratio, cause } = *self;
        let what = match cause {
            Cause::Motion => "motion: record at rest",
            Cause::Resonance => "resonance: end the model below",
            Cause::Filter => "a steep filter: end the model below",
            Cause::CoarseCodes => "coarse codes: read finer steps",
            Cause::Unknown => "look at the plot",
        };
        let [from_hz, to_hz] = [from_hz, to_hz].map(|hz| significant(hz, 3));
        let places = if ratio < 10.0 { 2 } else { 0 };
        write!(f, "{ratio:.places$} times the power in {from_hz}–{to_hz} Hz; {what}")
    }
}
