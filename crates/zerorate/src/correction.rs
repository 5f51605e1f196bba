//! The bias correction of F-50, RBC = RATE + PBC + (TEMP − T3) × BTC, in f64 and in f32, and its table (F-52).

use crate::notice::Warning;
use alloc::vec::Vec;
use core::fmt;

/// The three numbers of F-50. Both coefficients are *added*: each is minus the bias that it removes.
///
/// ```
/// let correction = zerorate::Correction { pbc_dps: -0.25, btc_dps_per_c: -0.04, t3_c: 31.5 };
/// // two degrees above T3 the part reads 0.25 + 2 × 0.04 °/s at rest
/// assert!(correction.apply(0.33, 33.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "file", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Correction {
    /// Precision bias correction PBC, °/s: minus the mean rate at rest at T3.
    pub pbc_dps: f64,
    /// Bias temperature correction BTC, °/s/°C: minus the bias temperature coefficient.
    pub btc_dps_per_c: f64,
    /// Reference temperature T3, °C, as the part's own sensor reads it.
    pub t3_c: f64,
}

impl Correction {
    /// F-50 in physical units: the corrected rate in °/s of a rate in °/s taken at a temperature in °C.
    #[must_use]
    pub fn apply(&self, rate_dps: f64, temp_c: f64) -> f64 {
        rate_dps + self.pbc_dps + (temp_c - self.t3_c) * self.btc_dps_per_c
    }

    /// The same in single precision, for a processor with a small floating point unit.
    #[must_use]
    pub fn to_f32(&self) -> CorrectionF32 {
        CorrectionF32 {
            pbc_dps: self.pbc_dps as f32,
            btc_dps_per_c: self.btc_dps_per_c as f32,
            t3_c: self.t3_c as f32,
        }
    }

    /// The look-up table of F-52: (TEMP − T3) × BTC, without PBC, from +`span_c` down to −`span_c` in steps of
    /// `step_c`.
    ///
    /// # Errors
    /// A step or span that is not positive, a span that is no whole number of steps, or more than 100 001 rows.
    pub fn table(&self, step_c: f64, span_c: f64) -> Result<Vec<TableRow>, TableError> {
        Ok(self.rows(step_c, span_c)?.collect())
    }

    /// The rows of [`Correction::table`], one by one.
    pub(crate) fn rows(
        &self,
        step_c: f64,
        span_c: f64,
    ) -> Result<impl ExactSizeIterator<Item = TableRow> + use<>, TableError> {
        let steps = steps_in_span(step_c, span_c)?;
        let btc_dps_per_c = self.btc_dps_per_c;
        Ok((0..2 * steps + 1).map(move |row| {
            let delta_c = f64::from(steps - row) * step_c;
            TableRow { delta_c, correction_dps: delta_c * btc_dps_per_c }
        }))
    }
}

/// Where a correction holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Validity {
    /// Lowest temperature seen while measuring, °C.
    pub temp_min_c: f64,
    /// Highest temperature seen while measuring, °C.
    pub temp_max_c: f64,
    /// How far a temperature may leave the span unremarked, °C.
    pub margin_c: f64,
}

impl Validity {
    /// The margin where nothing else is known, °C: what ten times the noise of a single reading is for the ADIS16130
    /// (M-05).
    pub const MARGIN_C: f64 = 0.5;

    /// Whether the correction holds at a temperature; elsewhere it is an extrapolation.
    #[must_use]
    pub fn covers(&self, temp_c: f64) -> bool {
        (self.temp_min_c - self.margin_c..=self.temp_max_c + self.margin_c).contains(&temp_c)
    }

    /// What to say where temperatures from `low_c` to `high_c` leave the span.
    #[must_use]
    pub fn warning(&self, low_c: f64, high_c: f64) -> Option<Warning> {
        let Self { temp_min_c, temp_max_c, .. } = *self;
        let inside = self.covers(low_c) && self.covers(high_c);
        (!inside).then_some(Warning::Extrapolated { low_c, high_c, temp_min_c, temp_max_c })
    }
}

fn steps_in_span(step_c: f64, span_c: f64) -> Result<i32, TableError> {
    if !(step_c > 0.0 && span_c > 0.0 && step_c.is_finite() && span_c.is_finite()) {
        return Err(TableError::NotPositive { step_c, span_c });
    }
    let steps = libm::round(span_c / step_c);
    if steps > 50_000.0 {
        return Err(TableError::TooLong { step_c, span_c });
    }
    if steps < 1.0 || (span_c / step_c - steps).abs() > 1e-6 {
        return Err(TableError::Ragged { step_c, span_c });
    }
    Ok(steps as i32)
}

/// [`Correction`] in f32. Its error against f64 stays below 4e-5 °/s over the whole range, one code of the rate
/// channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectionF32 {
    /// PBC, °/s.
    pub pbc_dps: f32,
    /// BTC, °/s/°C.
    pub btc_dps_per_c: f32,
    /// T3, °C.
    pub t3_c: f32,
}

impl CorrectionF32 {
    /// F-50: rate in °/s, temperature in °C, corrected rate in °/s.
    #[must_use]
    pub fn apply(&self, rate_dps: f32, temp_c: f32) -> f32 {
        rate_dps + self.pbc_dps + (temp_c - self.t3_c) * self.btc_dps_per_c
    }
}

/// A row of the look-up table of F-52.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableRow {
    /// TEMP − T3, °C.
    pub delta_c: f64,
    /// (TEMP − T3) × BTC, °/s, to be added to RATE + PBC.
    pub correction_dps: f64,
}

/// A table that cannot be laid out as asked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are the numbers as asked, with their units, and rows")]
pub enum TableError {
    /// Step and span must both be above zero.
    NotPositive { step_c: f64, span_c: f64 },
    /// The span is no whole number of steps.
    Ragged { step_c: f64, span_c: f64 },
    /// More than 100 001 rows.
    TooLong { step_c: f64, span_c: f64 },
    /// More rows than the place for them holds.
    NoRoom { needed: usize, room: usize },
    /// A row that does not fit 32 bits in millionths of a °/s.
    TooSteep { correction_dps: f64 },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive { step_c, span_c } => {
                write!(f, "step {step_c} °C and span {span_c} °C must both be above zero")
            }
            Self::Ragged { step_c, span_c } => {
                write!(f, "the span of {span_c} °C is no whole number of steps of {step_c} °C; choose a multiple")
            }
            Self::TooLong { step_c, span_c } => {
                write!(
                    f,
                    "a table over ±{span_c} °C in steps of {step_c} °C has more than 100001 rows; choose a larger step"
                )
            }
            Self::NoRoom { needed, room } => {
                write!(
                    f,
                    "the table has {needed} rows and there is room for {room}; choose a smaller span or a larger step"
                )
            }
            Self::TooSteep { correction_dps } => {
                write!(f, "a row of {correction_dps} °/s does not fit 32 bits in millionths; choose a smaller span")
            }
        }
    }
}

impl core::error::Error for TableError {}

#[cfg(test)]
mod tests {
    use super::*;

    const TYPICAL: Correction = Correction { pbc_dps: -0.2537, btc_dps_per_c: -0.04, t3_c: 31.5123 };

    /// F-52, all thirteen rows, for a bias coefficient of +0.04 °/s/°C.
    #[test]
    fn table_of_the_note() {
        let rows = Correction { pbc_dps: 1.0, btc_dps_per_c: -0.04, t3_c: 25.0 }.table(0.02, 0.12).unwrap();
        let published = [
            -0.0048, -0.0040, -0.0032, -0.0024, -0.0016, -0.0008, 0.0, 0.0008, 0.0016, 0.0024, 0.0032, 0.0040, 0.0048,
        ];
        assert_eq!(rows.len(), published.len());
        for (k, (row, correction_dps)) in rows.iter().zip(published).enumerate() {
            assert!((row.delta_c - (0.12 - 0.02 * k as f64)).abs() < 1e-12);
            assert!((row.correction_dps - correction_dps).abs() < 1e-15, "{row:?}");
        }
    }

    #[test]
    fn table_refuses_what_it_cannot_lay_out() {
        assert!(matches!(TYPICAL.table(0.0, 1.0), Err(TableError::NotPositive { .. })));
        assert!(matches!(TYPICAL.table(f64::NAN, 1.0), Err(TableError::NotPositive { .. })));
        assert!(matches!(TYPICAL.table(0.02, 0.13), Err(TableError::Ragged { .. })));
        assert!(matches!(TYPICAL.table(0.02, 0.005), Err(TableError::Ragged { .. })));
        assert!(matches!(TYPICAL.table(1e-6, 1.0), Err(TableError::TooLong { .. })));
    }

    /// Codes spread over the whole range by a multiplicative sequence.
    fn codes() -> impl Iterator<Item = (u32, u32)> {
        (0..100_000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 8, i.wrapping_mul(2_246_822_519) >> 8))
    }

    #[test]
    fn single_precision_stays_within_a_code() {
        let single = TYPICAL.to_f32();
        for (rate, temp) in codes() {
            let rate_dps = (f64::from(rate) - 8_388_608.0) / 23_488.0;
            let temp_c = ((f64::from(temp) - 8_388_608.0) / 14_093.0 + 25.0).clamp(-40.0, 105.0);
            let error = f64::from(single.apply(rate_dps as f32, temp_c as f32)) - TYPICAL.apply(rate_dps, temp_c);
            assert!(error.abs() < 1.0 / 23_488.0, "{error}");
        }
    }
}
