//! The bias correction of F-50, RBC = RATE + PBC + (TEMP − T3) × BTC, in f64 and in f32, and its table (F-52). All of
//! them also work with a quadratic and a cubic term.

use alloc::vec::Vec;
use core::fmt;

/// The coefficients of F-50, and two more for a bias that is a curve over temperature: RATE + PBC + d·BTC +
/// d²·BTC2 + d³·BTC3 with d = TEMP − T3. All coefficients are *added*: each is minus the bias that it removes.
///
/// ```
/// let correction = zerorate::Correction::line(-0.25, -0.04, 31.5);
/// // two degrees above T3 the part reads 0.25 + 2 × 0.04 °/s at rest
/// assert!(correction.apply(0.33, 33.5).abs() < 1e-15);
///
/// let curved = zerorate::Correction { btc2_dps_per_c2: 0.001, ..correction };
/// assert!((curved.apply(0.33, 33.5) - 2.0 * 2.0 * 0.001).abs() < 1e-15);
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
    /// Coefficient of (TEMP − T3)², °/s/°C². It is zero for the straight line of AN-1042 (F-50).
    #[cfg_attr(feature = "file", serde(default, skip_serializing_if = "is_zero"))]
    pub btc2_dps_per_c2: f64,
    /// Coefficient of (TEMP − T3)³, °/s/°C³. It is zero for the straight line of AN-1042 (F-50).
    #[cfg_attr(feature = "file", serde(default, skip_serializing_if = "is_zero"))]
    pub btc3_dps_per_c3: f64,
}

/// Whether a term is zero, so that a file leaves it out.
#[cfg(feature = "file")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Correction {
    /// The correction of F-50, without a quadratic and a cubic term.
    #[must_use]
    pub const fn line(pbc_dps: f64, btc_dps_per_c: f64, t3_c: f64) -> Self {
        Self { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2: 0.0, btc3_dps_per_c3: 0.0 }
    }

    /// The correction of a bias that is the sum of `terms[k]` · (T − T3)ᵏ, °/s.
    pub(crate) fn against(terms: [f64; 4], t3_c: f64) -> Self {
        let [pbc_dps, btc_dps_per_c, btc2_dps_per_c2, btc3_dps_per_c3] = terms.map(|term| 0.0 - term);
        Self { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 }
    }

    /// Whether the correction is a line as in F-50, without a quadratic and a cubic term.
    #[must_use]
    pub const fn is_line(&self) -> bool {
        self.btc2_dps_per_c2 == 0.0 && self.btc3_dps_per_c3 == 0.0
    }

    /// Returns the corrected rate, °/s, of a rate in °/s that was taken at a temperature in °C.
    #[inline]
    #[must_use]
    pub fn apply(&self, rate_dps: f64, temp_c: f64) -> f64 {
        rate_dps + self.pbc_dps + self.rise_dps(temp_c - self.t3_c)
    }

    /// Returns the correction that is added to a rate at a temperature in °C: minus the bias there, °/s.
    #[must_use]
    pub fn at(&self, temp_c: f64) -> f64 {
        self.pbc_dps + self.rise_dps(temp_c - self.t3_c)
    }

    /// The correction without PBC at TEMP − T3 = `delta_c`, °/s.
    #[inline]
    fn rise_dps(&self, delta_c: f64) -> f64 {
        delta_c * (self.btc_dps_per_c + delta_c * (self.btc2_dps_per_c2 + delta_c * self.btc3_dps_per_c3))
    }

    /// Slope of the correction at TEMP − T3 = `delta_c`, °/s/°C. For a line it is BTC everywhere.
    #[must_use]
    pub fn slope_dps_per_c(&self, delta_c: f64) -> f64 {
        self.btc_dps_per_c + delta_c * (2.0 * self.btc2_dps_per_c2 + delta_c * 3.0 * self.btc3_dps_per_c3)
    }

    /// Absolute value of the steepest slope within `reach_c` of T3, °/s/°C.
    #[must_use]
    pub fn steepest_dps_per_c(&self, reach_c: f64) -> f64 {
        // the slope is a parabola: steepest at an end or where it turns
        let turn_c = -self.btc2_dps_per_c2 / (3.0 * self.btc3_dps_per_c3);
        let turn_c = if turn_c.abs() <= reach_c { turn_c } else { reach_c };
        [-reach_c, reach_c, turn_c].iter().map(|delta_c| self.slope_dps_per_c(*delta_c).abs()).fold(0.0, f64::max)
    }

    /// Largest error of linear interpolation between the rows of a table in steps of `step_c` within `reach_c` of
    /// T3, °/s. It is step² / 8 times the largest second derivative, and zero for a line.
    #[must_use]
    pub fn bend_dps(&self, step_c: f64, reach_c: f64) -> f64 {
        let second = 2.0 * self.btc2_dps_per_c2.abs() + 6.0 * self.btc3_dps_per_c3.abs() * reach_c;
        step_c * step_c / 8.0 * second
    }

    /// Converts the correction to single precision, for a processor with a small floating point unit.
    #[must_use]
    pub fn to_f32(&self) -> CorrectionF32 {
        CorrectionF32 {
            pbc_dps: self.pbc_dps as f32,
            btc_dps_per_c: self.btc_dps_per_c as f32,
            t3_c: self.t3_c as f32,
            btc2_dps_per_c2: self.btc2_dps_per_c2 as f32,
            btc3_dps_per_c3: self.btc3_dps_per_c3 as f32,
        }
    }

    /// The look-up table of F-52 from `span_c` down to −`span_c` in steps of `step_c`. Its rows hold the correction
    /// without PBC, which is (TEMP − T3) × BTC for a line.
    ///
    /// # Errors
    /// Returns an error unless step and span are positive, and the span is a whole number of at most 50 000 steps.
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
        let correction = *self;
        Ok((0..2 * steps + 1).map(move |row| {
            let delta_c = f64::from(steps - row) * step_c;
            TableRow { delta_c, correction_dps: correction.rise_dps(delta_c) }
        }))
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

/// [`Correction`] in f32. Its difference from f64 stays below 4e-5 °/s over the whole range, which is less than one
/// code of the rate channel (1/23 488 °/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectionF32 {
    /// PBC, °/s.
    pub pbc_dps: f32,
    /// BTC, °/s/°C.
    pub btc_dps_per_c: f32,
    /// T3, °C.
    pub t3_c: f32,
    /// Coefficient of the quadratic term, °/s/°C². It is zero for the straight line of AN-1042 (F-50).
    pub btc2_dps_per_c2: f32,
    /// Coefficient of the cubic term, °/s/°C³. It is zero for the straight line of AN-1042 (F-50).
    pub btc3_dps_per_c3: f32,
}

impl CorrectionF32 {
    /// Corrects a rate in °/s at a temperature in °C, and returns °/s.
    #[inline]
    #[must_use]
    pub fn apply(&self, rate_dps: f32, temp_c: f32) -> f32 {
        let delta_c = temp_c - self.t3_c;
        let slope = self.btc_dps_per_c + delta_c * (self.btc2_dps_per_c2 + delta_c * self.btc3_dps_per_c3);
        rate_dps + self.pbc_dps + delta_c * slope
    }
}

/// A row of the look-up table of F-52.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableRow {
    /// TEMP − T3, °C.
    pub delta_c: f64,
    /// Correction that is added to RATE + PBC there, °/s: (TEMP − T3) × BTC for a line.
    pub correction_dps: f64,
}

/// The reason why a table cannot be laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are the numbers as asked, with their units, and rows")]
pub enum TableError {
    /// Step or span is not above zero, or not finite.
    NotPositive { step_c: f64, span_c: f64 },
    /// The span is not a whole number of steps.
    Ragged { step_c: f64, span_c: f64 },
    /// The table would have more than 100 001 rows.
    TooLong { step_c: f64, span_c: f64 },
    /// The table has more rows than the buffer.
    NoRoom { needed: usize, room: usize },
    /// A row does not fit into 32 bits in millionths of a °/s.
    TooSteep { correction_dps: f64 },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive { step_c, span_c } => {
                write!(f, "step {step_c} °C and span {span_c} °C must both be above zero")
            }
            Self::Ragged { step_c, span_c } => {
                write!(f, "the span of {span_c} °C is not a whole number of steps of {step_c} °C; choose a multiple")
            }
            Self::TooLong { step_c, span_c } => write!(
                f,
                "a table over ±{span_c} °C in steps of {step_c} °C has more than 100001 rows; choose a larger step"
            ),
            Self::NoRoom { needed, room } => write!(
                f,
                "the table has {needed} rows, and there is room for {room}; choose a smaller span or a larger step"
            ),
            Self::TooSteep { correction_dps } => {
                write!(f, "a row of {correction_dps} °/s does not fit 32 bits in millionths; choose a smaller span")
            }
        }
    }
}

impl core::error::Error for TableError {}

#[cfg(test)]
mod tests {
    use super::super::integer::tests::words;
    use super::*;

    const TYPICAL: Correction = Correction::line(-0.2537, -0.04, 31.5123);

    #[test]
    fn table_refuses_what_it_cannot_lay_out() {
        assert!(matches!(TYPICAL.table(0.0, 1.0), Err(TableError::NotPositive { .. })));
        assert!(matches!(TYPICAL.table(f64::NAN, 1.0), Err(TableError::NotPositive { .. })));
        assert!(matches!(TYPICAL.table(0.02, 0.13), Err(TableError::Ragged { .. })));
        assert!(matches!(TYPICAL.table(0.02, 0.005), Err(TableError::Ragged { .. })));
        assert!(matches!(TYPICAL.table(1e-6, 1.0), Err(TableError::TooLong { .. })));
    }

    const CURVED: Correction = Correction { btc2_dps_per_c2: 0.0007, btc3_dps_per_c3: -2e-5, ..TYPICAL };

    #[test]
    fn a_curve_adds_its_terms() {
        for temp_c in (-400..850).map(|tenth| f64::from(tenth) / 10.0) {
            let d = temp_c - 31.5123;
            let expected = -0.2537 - 0.04 * d + 0.0007 * d.powi(2) - 2e-5 * d.powi(3);
            assert!((CURVED.at(temp_c) - expected).abs() < 1e-12, "{temp_c}");
            assert!((CURVED.apply(1.5, temp_c) - 1.5 - expected).abs() < 1e-12, "{temp_c}");
            assert!((f64::from(CURVED.to_f32().apply(0.0, temp_c as f32)) - expected).abs() < 4e-5, "{temp_c}");
            let row = CURVED.table(d.abs().max(0.1), d.abs().max(0.1)).unwrap()[usize::from(d < 0.0) * 2];
            assert!(d.abs() < 0.1 || (row.correction_dps - (expected + 0.2537)).abs() < 1e-12, "{temp_c}: {row:?}");
        }
    }

    /// The terms of curves, which are zero for a line, do not change a bit of its results.
    #[test]
    fn a_line_follows_f50_bit_for_bit() {
        let single = TYPICAL.to_f32();
        for (rate, temp) in words(100_000).map(|(rate, temp)| (rate >> 8, temp >> 8)) {
            let rate_dps = (f64::from(rate) - 8_388_608.0) / 23_488.0;
            let temp_c = (f64::from(temp) - 8_388_608.0) / 14_093.0 + 25.0;
            let expected = rate_dps + TYPICAL.pbc_dps + (temp_c - TYPICAL.t3_c) * TYPICAL.btc_dps_per_c;
            assert_eq!(TYPICAL.apply(rate_dps, temp_c).to_bits(), expected.to_bits());
            let (rate_dps, temp_c) = (rate_dps as f32, temp_c as f32);
            let expected = rate_dps + single.pbc_dps + (temp_c - single.t3_c) * single.btc_dps_per_c;
            assert_eq!(single.apply(rate_dps, temp_c).to_bits(), expected.to_bits());
        }
    }

    /// Compares the stated steepest slope, and the stated error of linear interpolation between rows, with a fine
    /// search.
    #[test]
    fn the_error_of_a_table_is_bounded() {
        let (step_c, reach_c) = (0.5, 20.0);
        let parabola = Correction { btc2_dps_per_c2: 0.0007, ..TYPICAL };
        for correction in [TYPICAL, parabola, CURVED, Correction { btc2_dps_per_c2: 0.0, ..CURVED }] {
            let (mut steepest, mut bend) = (0.0_f64, 0.0_f64);
            for k in -400_i32..400 {
                let at = |offset: f64| correction.rise_dps((f64::from(k) + offset) * 0.05);
                steepest = steepest.max((at(1.0) - at(0.0)).abs() / 0.05);
                let low = f64::from(k.div_euclid(10)) * step_c;
                let share = (f64::from(k) * 0.05 - low) / step_c;
                let (from, to) = (correction.rise_dps(low), correction.rise_dps(low + step_c));
                bend = bend.max((from + share * (to - from) - at(0.0)).abs());
            }
            let stated = correction.steepest_dps_per_c(reach_c);
            assert!(stated >= steepest - 1e-12 && stated <= 1.01 * steepest, "{correction:?}: {stated} {steepest}");
            let stated = correction.bend_dps(step_c, reach_c);
            assert!(stated >= bend - 1e-12 && stated <= 1.1 * bend + 1e-12, "{correction:?}: {stated} {bend}");
        }
    }

    #[test]
    fn single_precision_stays_within_a_code() {
        let single = TYPICAL.to_f32();
        for (rate, temp) in words(100_000).map(|(rate, temp)| (rate >> 8, temp >> 8)) {
            let rate_dps = (f64::from(rate) - 8_388_608.0) / 23_488.0;
            let temp_c = ((f64::from(temp) - 8_388_608.0) / 14_093.0 + 25.0).clamp(-40.0, 105.0);
            let error = f64::from(single.apply(rate_dps as f32, temp_c as f32)) - TYPICAL.apply(rate_dps, temp_c);
            assert!(error.abs() < 1.0 / 23_488.0, "{error}");
        }
    }
}
