//! A correction applied to a stream of readings.

use super::formula::Correction;
use super::validity::Validity;
use crate::notice::Warning;

/// The corrections to apply, one for each axis: in an array on a microcontroller, in a `Vec` elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectorConfig<C = [Correction; 1]> {
    /// The correction of each axis.
    pub corrections: C,
    /// The temperatures at which the corrections hold. `None` if they are not known.
    pub validity: Option<Validity>,
}

/// Applies a correction to each axis of a part. A rate without a temperature takes the last temperature.
///
/// ```
/// use zerorate::{Correction, Corrector, CorrectorConfig, Validity};
/// let correction = Correction::line(-0.25, -0.04, 31.5);
/// let validity = Some(Validity { temp_min_c: 25.0, temp_max_c: 33.0, margin_c: 0.5 });
/// let mut corrector = Corrector::new(CorrectorConfig { corrections: [correction], validity });
/// assert_eq!(corrector.take(Some(0.25), None).rate_dps, None); // no temperature yet
/// assert_eq!(corrector.take(Some(0.25), Some(31.5)).rate_dps, Some(0.0));
/// assert_eq!(corrector.take(Some(1.25), None).rate_dps, Some(1.0));
/// assert!(corrector.take(Some(0.25), Some(60.0)).extrapolated);
///
/// // two axes, one temperature
/// let other = Correction { pbc_dps: 1.0, ..correction };
/// let mut corrector = Corrector::new(CorrectorConfig { corrections: [correction, other], validity });
/// corrector.read(Some(31.5));
/// assert_eq!([0, 1].map(|axis| corrector.correct(axis, Some(0.25))), [Some(0.0), Some(1.25)]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Corrector<C = [Correction; 1]> {
    config: CorrectorConfig<C>,
    temp_c: Option<f64>,
    range_c: Option<(f64, f64)>,
}

/// A reading of one axis, corrected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrected {
    /// Rate corrected by F-50, °/s. `None` without a valid rate, and before the first temperature.
    pub rate_dps: Option<f64>,
    /// The temperature that was used, °C. `None` before the first temperature.
    pub temp_c: Option<f64>,
    /// Whether the temperature lies outside the span where the correction holds. False if either is not known.
    pub extrapolated: bool,
}

impl<C: AsRef<[Correction]>> Corrector<C> {
    /// Makes a corrector that has not seen a reading.
    #[must_use]
    pub fn new(config: CorrectorConfig<C>) -> Self {
        Self { config, temp_c: None, range_c: None }
    }

    /// Number of axes that have a correction.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.config.corrections.as_ref().len()
    }

    /// Takes in the temperature, °C, for the rates that come next. `None` keeps the last temperature.
    #[inline]
    pub fn read(&mut self, read_c: Option<f64>) {
        if let Some(read_c) = read_c {
            let (low, high) = self.range_c.unwrap_or((read_c, read_c));
            (self.temp_c, self.range_c) = (Some(read_c), Some((low.min(read_c), high.max(read_c))));
        }
    }

    /// Corrects a rate of an axis, °/s, or a mean of rates, by F-50. `None` without a rate, before the first
    /// temperature, and for an axis that has no correction.
    #[inline]
    #[must_use]
    pub fn correct(&self, axis: usize, rate_dps: Option<f64>) -> Option<f64> {
        Some(self.config.corrections.as_ref().get(axis)?.apply(rate_dps?, self.temp_c?))
    }

    /// Takes in and corrects a reading of a part with one axis: a rate in °/s, or a mean of rates, with the
    /// temperature in °C that was read with it.
    #[inline]
    pub fn take(&mut self, rate_dps: Option<f64>, read_c: Option<f64>) -> Corrected {
        self.read(read_c);
        Corrected { rate_dps: self.correct(0, rate_dps), temp_c: self.temp_c, extrapolated: self.is_extrapolated() }
    }

    /// The last temperature that was read, °C. Corrections use it.
    #[must_use]
    pub fn temp_c(&self) -> Option<f64> {
        self.temp_c
    }

    /// Whether the last temperature lies outside the span where the corrections hold. False if either is not known.
    #[must_use]
    pub fn is_extrapolated(&self) -> bool {
        let outside = |(validity, temp_c): (Validity, f64)| !validity.covers(temp_c);
        self.config.validity.zip(self.temp_c).is_some_and(outside)
    }

    /// Lowest and highest temperature that was read, °C. `None` before the first temperature.
    #[must_use]
    pub fn range_c(&self) -> Option<(f64, f64)> {
        self.range_c
    }

    /// Returns a warning if a temperature left the span where the corrections hold.
    #[must_use]
    pub fn warning(&self) -> Option<Warning> {
        let (low_c, high_c) = self.range_c?;
        self.config.validity?.warning(low_c, high_c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_temperature_outside_the_span_is_flagged_and_warned_of_even_after_it_came_back() {
        let validity = Some(Validity { temp_min_c: 20.0, temp_max_c: 30.0, margin_c: 1.0 });
        let corrections = [Correction::line(1.0, 0.0, 25.0)];
        let mut corrector = Corrector::new(CorrectorConfig { corrections, validity });
        assert_eq!((corrector.correct(0, Some(2.0)), corrector.warning()), (None, None), "no temperature yet");
        assert_eq!(corrector.range_c(), None);
        for (read_c, extrapolated) in [(19.5, false), (18.5, true), (25.0, false)] {
            let corrected = corrector.take(Some(2.0), Some(read_c));
            assert_eq!(corrected, Corrected { rate_dps: Some(3.0), temp_c: Some(read_c), extrapolated });
        }
        assert_eq!(corrector.range_c(), Some((18.5, 25.0)));
        let (low_c, high_c, temp_min_c, temp_max_c) = (18.5, 25.0, 20.0, 30.0);
        assert_eq!(corrector.warning(), Some(Warning::Extrapolated { low_c, high_c, temp_min_c, temp_max_c }));
    }
}
