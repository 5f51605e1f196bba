//! The place and the cause of a misfit of a noise model.

use alloc::format;
use core::fmt;

/// The frequencies at which the record is off its model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// The lowest of them, Hz.
    pub from_hz: f64,
    /// The highest of them, Hz.
    pub to_hz: f64,
    /// Measured power over modelled power in that band.
    pub ratio: f64,
    /// The likely cause.
    pub cause: Cause,
}

/// The causes why a record is off its model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The power there comes and goes.
    Motion,
    /// The power there is steady, and more than the model's in a narrow band.
    Resonance,
    /// The same, up to the end of the spectrum: a steep filter left little power there.
    Filter,
    /// Most samples repeat the one before.
    CoarseCodes,
    /// None of these causes.
    Unknown,
}

impl fmt::Display for Misfit {
    /// Tells where the power is off, and what to do.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from_hz, to_hz, ratio, cause } = *self;
        let what = match cause {
            Cause::Motion => "motion: record at rest",
            Cause::Resonance => "resonance: end the model below",
            Cause::Filter => "a steep filter: end the model below",
            Cause::CoarseCodes => "coarse codes: read finer steps",
            Cause::Unknown => "look at the plot",
        };
        let [from_hz, to_hz] = [from_hz, to_hz].map(|hz| {
            // three digits
            let places = (2.0 - libm::floor(libm::log10(hz.max(1e-9)))).clamp(0.0, 9.0);
            format!("{hz:.*}", places as usize)
        });
        write!(f, "{ratio:.2} times the power in {from_hz}–{to_hz} Hz; {what}")
    }
}
