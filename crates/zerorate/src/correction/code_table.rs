//! Look-up in the table of F-52 for a processor without division and floating point.

use super::formula::{Correction, TableError};
use crate::part::Scale;

/// The table of F-52, (TEMP − T3) × BTC in µ°/s, with a look-up by temperature code that needs no allocation,
/// division or floating point.
///
/// Row r, counted from 0, is for TEMP − T3 = (R − r) · step with 2R + 1 rows. The nearest row is r = ⌊R + ½ − (temp −
/// T3) / step⌋ with temperatures and the step in codes. T3 may lie between two codes, and is not rounded. The
/// reciprocal of the step has 32 fraction bits. So if the distances of two rows differ by less than 2⁻³² · |temp − T3|
/// steps, either row may be found.
///
/// ```
/// use zerorate::{Axis, CodeTable, Correction};
/// let correction = Correction::line(0.0, -0.04, 25.0);
/// let mut rows = [0; 13];
/// correction.fill_table(0.02, 0.12, &mut rows)?;
/// let table = CodeTable::new(&rows, 0.02, 25.0, &Axis::ADIS16130.temp);
/// assert_eq!(table.look_up_udps(8_388_608), Some(0));
/// assert_eq!(table.look_up_udps(8_388_608 + 563), Some(-1600)); // 563 / 14 093 °C are 0.04 °C
/// assert_eq!(table.look_up_udps(0), None); // the table knows nothing of so low a temperature
/// assert_eq!(table.look_up_held_udps(0), 4800);
/// # Ok::<(), zerorate::TableError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeTable<'a> {
    rows_udps: &'a [i32],
    index: RowIndex,
}

impl<'a> CodeTable<'a> {
    /// Wraps rows from [`Correction::fill_table`], with the step and the T3 of their table, °C, and the scale of the
    /// temperature.
    #[must_use]
    pub fn new(rows_udps: &'a [i32], step_c: f64, t3_c: f64, temp: &Scale) -> Self {
        Self { rows_udps, index: RowIndex::new(rows_udps.len(), step_c, t3_c, temp) }
    }

    /// The row nearest to the temperature of a 24-bit code, µ°/s, to be added to RATE + PBC. `None` if the temperature
    /// lies more than half a step beyond the first or the last row.
    #[inline]
    #[must_use]
    pub fn look_up_udps(&self, temp_code: u32) -> Option<i32> {
        let row = usize::try_from(self.index.row(temp_code)).ok()?;
        self.rows_udps.get(row).copied()
    }

    /// Returns the nearest row, µ°/s. For a temperature beyond the table this is the first or the last row, which for
    /// a line is wrong by BTC times the distance to that row. A table without rows gives 0.
    #[inline]
    #[must_use]
    pub fn look_up_held_udps(&self, temp_code: u32) -> i32 {
        let end = if self.index.row(temp_code) < 0 { self.rows_udps.first() } else { self.rows_udps.last() };
        self.look_up_udps(temp_code).or(end.copied()).unwrap_or(0)
    }
}

/// Finds the row of a temperature code: `row = (middle_q + (t3_code − temp) · rows_per_code_q) >> 32`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowIndex {
    /// Row at which `t3_code` lies, with its fraction, plus a half, times 2³².
    pub middle_q: i64,
    /// Rows per temperature code, times 2³².
    pub rows_per_code_q: i64,
    /// The temperature code nearest to T3.
    pub t3_code: i32,
}

impl RowIndex {
    /// Fraction bits of `middle_q` and `rows_per_code_q`.
    pub const Q: u32 = 32;

    /// Makes the index for a table of `rows` rows in steps of `step_c` °C around `t3_c` °C. A step below 10⁻⁶ °C
    /// counts as 10⁻⁶ °C.
    #[must_use]
    pub fn new(rows: usize, step_c: f64, t3_c: f64, temp: &Scale) -> Self {
        let one = (1i64 << Self::Q) as f64;
        let step_lsb = step_c.max(1e-6) * temp.lsb_per_unit;
        let middle = rows.saturating_sub(1) as u32 / 2;
        let t3_code = temp.nearest_code(t3_c).clamp(i32::MIN.into(), i32::MAX.into()) as i32;
        // the middle row lies at T3, up to half a code away from `t3_code`
        let rounded_off = (temp.code(t3_c) - f64::from(t3_code)).clamp(-0.5, 0.5);
        let off_q = libm::round(rounded_off * one / step_lsb) as i64;
        Self {
            middle_q: (i64::from(middle) << Self::Q) + (1 << (Self::Q - 1)) + off_q,
            rows_per_code_q: libm::round(one / step_lsb) as i64,
            t3_code,
        }
    }

    /// Returns the row of a 24-bit temperature code. It is negative for a code above the table, and beyond the
    /// last row for a code below it.
    #[inline]
    #[must_use]
    pub const fn row(&self, temp_code: u32) -> i64 {
        let below_t3 = self.t3_code - (temp_code & 0x00FF_FFFF) as i32;
        (self.middle_q + below_t3 as i64 * self.rows_per_code_q) >> Self::Q
    }
}

impl Correction {
    /// Lays out the table of F-52 in millionths of a °/s, rounded to nearest, from +`span_c` down to −`span_c`. It
    /// fills the first rows of `rows_udps` and returns their number. The other rows stay as they are.
    ///
    /// # Errors
    /// Returns the errors of [`Correction::table`], or an error if the table does not fit or exceeds ±2147 °/s.
    pub fn fill_table(&self, step_c: f64, span_c: f64, rows_udps: &mut [i32]) -> Result<usize, TableError> {
        let rows = self.rows(step_c, span_c)?;
        let needed = rows.len();
        let room = rows_udps.len();
        let table = rows_udps.get_mut(..needed).ok_or(TableError::NoRoom { needed, room })?;
        for (slot, row) in table.iter_mut().zip(rows) {
            let udps = libm::round(row.correction_dps * 1e6);
            // a NaN fails this test too
            if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&udps) {
                return Err(TableError::TooSteep { correction_dps: row.correction_dps });
            }
            *slot = udps as i32;
        }
        Ok(needed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEMP: Scale = crate::part::Axis::ADIS16130.temp;

    /// All thirteen rows of F-52, in µ°/s, for a temperature coefficient of the bias of +0.04 °/s/°C.
    #[test]
    fn the_table_of_f52() {
        let mut rows = [7; 15];
        let correction = Correction::line(1.0, -0.04, 25.0);
        assert_eq!(correction.fill_table(0.02, 0.12, &mut rows), Ok(13));
        let published = [-4800, -4000, -3200, -2400, -1600, -800, 0, 800, 1600, 2400, 3200, 4000, 4800];
        assert_eq!((&rows[..13], &rows[13..]), (&published[..], &[7, 7][..]));
    }

    #[test]
    fn a_value_beyond_its_integer_is_refused() {
        let steep = Correction::line(0.0, 1e6, 25.0);
        assert_eq!(steep.fill_table(0.02, 0.12, &mut [0; 12]), Err(TableError::NoRoom { needed: 13, room: 12 }));
        assert!(matches!(steep.fill_table(0.02, 0.12, &mut [0; 13]), Err(TableError::TooSteep { .. })));
    }

    /// T3 in the test of the row search, in 10⁻⁴ °C.
    const T3: i128 = 315_123;

    /// Distance of row `row` from the place of a code in the table, in 2⁻⁴⁰ rows, by exact rational arithmetic.
    /// `step_uc` is in 10⁻⁶ °C. The sums are in units of 1/(14 093 · 10⁶) °C.
    fn distance(row: usize, rows: usize, step_uc: i128, temp: u32) -> i128 {
        let step = step_uc * 14_093;
        let from_middle = row as i128 - (rows as i128 - 1) / 2;
        let place = (T3 - 250_000) * 14_093 * 100 - (i128::from(temp) - 8_388_608) * 1_000_000;
        ((from_middle * step - place).abs() << 40) / step
    }

    /// Looks up every seventh code of the range and every code near T3, with the step of AN-1042 (0.02 °C) and others.
    #[test]
    fn codes_find_the_nearest_row() {
        for (step_uc, half) in [(20_000, 100), (20_000, 6), (333_333, 150), (1, 3), (1_000_000, 60)] {
            let rows = 2 * half + 1;
            let index = RowIndex::new(rows, step_uc as f64 * 1e-6, T3 as f64 * 1e-4, &TEMP);
            for temp in (0..1 << 24).step_by(7).chain(8_300_000..8_600_000) {
                let row = index.row(temp).clamp(0, rows as i64 - 1) as usize;
                let of = |row| distance(row, rows, step_uc, temp);
                let best = of(row.saturating_sub(1)).min(of((row + 1).min(rows - 1)));
                let slack = (i128::from((index.t3_code - temp as i32).abs()) + 2) << 8;
                assert!(of(row) <= best + slack, "{step_uc} µ°C, code {temp}");
            }
        }
    }

    /// T3 lies half-way between two coarse codes. With a BTC of 0.1 °/s/°C, a T3 rounded to a code would shift the
    /// rows by 0.007 °/s.
    #[test]
    fn t3_between_two_codes_shifts_no_row() {
        let temp = Scale { lsb_per_unit: 7.14, zero_code: 2048, zero_value: 25.0, width_bits: 12, signed: false };
        let t3_c = 25.0 + 40.5 / 7.14;
        let mut rows = [0; 901];
        Correction::line(0.0, 0.1, t3_c).fill_table(0.02, 9.0, &mut rows).unwrap();
        let table = CodeTable::new(&rows, 0.02, t3_c, &temp);
        let off_dps = |code: i64| {
            let found = f64::from(table.look_up_udps(code as u32).unwrap()) * 1e-6;
            found - 0.1 * (temp.value(code - temp.zero_code) - t3_c)
        };
        let all: alloc::vec::Vec<f64> = (2088 - 60..2089 + 60).map(off_dps).collect();
        assert!(
            all.iter().all(|off_dps| off_dps.abs() <= 0.01 * 0.1 + 1e-6),
            "half a step is worth 0.001 °/s: {all:?}"
        );
        assert!((all.iter().sum::<f64>() / all.len() as f64).abs() < 1e-4, "{all:?}");
    }

    /// The table ends half a step beyond its first and its last row. Every code around both ends is looked up.
    #[test]
    fn a_temperature_beyond_the_table_gives_none_or_the_end_row() {
        let correction = Correction::line(0.0, -0.04, 25.0);
        let mut rows = [0; 13];
        correction.fill_table(0.02, 0.12, &mut rows).unwrap();
        let table = CodeTable::new(&rows, 0.02, 25.0, &TEMP);
        for code in 8_386_000..8_391_000 {
            let delta_c = f64::from(code as i32 - 8_388_608) / 14_093.0;
            assert_eq!(table.look_up_udps(code).is_some(), delta_c.abs() < 0.13, "{code}");
            let held = table.look_up_held_udps(code);
            assert_eq!(held, table.look_up_udps(code).unwrap_or(if delta_c > 0.0 { -4800 } else { 4800 }), "{code}");
        }
        for code in [0, 0x00FF_FFFF] {
            assert_eq!(table.look_up_udps(code), None);
            assert_eq!(CodeTable::new(&[], 0.02, 25.0, &TEMP).look_up_udps(code), None);
            assert_eq!(CodeTable::new(&[], 0.02, 25.0, &TEMP).look_up_held_udps(code), 0);
        }
    }

    #[test]
    fn codes_of_temperatures() {
        assert_eq!(
            [25.0, 26.0, -1e9, f64::INFINITY].map(|temp_c| TEMP.nearest_code(temp_c)),
            [8_388_608, 8_402_701, 0, 16_777_215]
        );
    }
}
