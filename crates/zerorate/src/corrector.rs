//! A correction applied to a stream of readings.

use crate::correction::{Correction, Validity};
use crate::notice::Warning;

/// What is applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectorConfig {
    /// PBC, BTC and T3.
    pub correction: Correction,
    /// Where they hold, if that is stated.
    pub validity: Option<Validity>,
}

/// Applies a correction: a reading without a temperature takes the last one that was read.
///
/// ```
/// use zerorate::{Correction, Corrector, CorrectorConfig, Validity};
/// let correction = Correction { pbc_dps: -0.25, btc_dps_per_c: -0.04, t3_c: 31.5 };
/// let validity = Some(Validity { temp_min_c: 25.0, temp_max_c: 33.0 });
/// let mut corrector = Corrector::new(CorrectorConfig { correction, validity });
/// assert_eq!(corrector.take(Some(0.25), None).rate_dps, None); // no temperature yet
/// assert_eq!(corrector.take(Some(0.25), Some(31.5)).rate_dps, Some(0.0));
/// assert_eq!(corrector.take(Some(1.25), None).rate_dps, Some(1.0));
/// assert!(corrector.take(Some(0.25), Some(60.0)).extrapolated);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Corrector {
    config: CorrectorConfig,
    temp_c: Option<f64>,
    range_c: Option<(f64, f64)>,
}

/// A reading, corrected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrected {
    /// F-50, °/s; none without a rate that is believed, and before the first temperature.
    pub rate_dps: Option<f64>,
    /// The temperature that was used, °C.
    pub temp_c: Option<f64>,
    /// It lies outside the span where the correction holds.
    pub extrapolated: bool,
}

impl Corrector {
    /// Before the first reading.
    #[must_use]
    pub fn new(config: CorrectorConfig) -> Self {
        Self { config, temp_c: None, range_c: None }
    }

    /// Corrects a rate in °/s, or a mean of rates, with the temperature in °C that was read with it.
    #[inline]
    pub fn take(&mut self, rate_dps: Option<f64>, read_c: Option<f64>) -> Corrected {
        if let Some(read_c) = read_c {
            let (low, high) = self.range_c.unwrap_or((read_c, read_c));
            (self.temp_c, self.range_c) = (Some(read_c), Some((low.min(read_c), high.max(read_c))));
        }
        let temp_c = self.temp_c;
        let apply = |(rate_dps, temp_c)| self.config.correction.apply(rate_dps, temp_c);
        let outside = |(validity, temp_c): (Validity, f64)| !validity.covers(temp_c);
        Corrected {
            rate_dps: rate_dps.zip(temp_c).map(apply),
            temp_c,
            extrapolated: self.config.validity.zip(temp_c).is_some_and(outside),
        }
    }

    /// Lowest and highest temperature that was read, °C.
    #[must_use]
    pub fn range_c(&self) -> Option<(f64, f64)> {
        self.range_c
    }

    /// What to say where a temperature left the span.
    #[must_use]
    pub fn warning(&self) -> Option<Warning> {
        let (low_c, high_c) = self.range_c?;
        self.config.validity?.warning(low_c, high_c)
    }
}
