//! The bias correction of F-50 on codes, in integers.

use super::formula::Correction;
use crate::part::{Axis, Scale};
use core::fmt;

/// The format of an integer correction. It follows from the scales of rate and temperature alone.
///
/// The coefficients have q = min(30, w_t + 6, 61 − w_r) fraction bits, with w_r bits of a rate code and w_t of a
/// temperature code. For rates of up to 31 bits and temperatures of up to 24, the rounded slope is off by at most 2⁻⁷
/// rate codes over the whole scale. No sum overflows 64 bits: rate · 2^q, offset and (TEMP − T3) · slope stay below
/// 2⁶¹ each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegerForm {
    /// Fraction bits of offset and slope.
    pub q: u32,
    /// First and last code of the rate.
    pub rate_codes: (i64, i64),
    /// First and last code of the temperature.
    pub temp_codes: (i64, i64),
}

impl IntegerForm {
    /// The form for the 24-bit codes of the ADIS16130.
    pub const ADIS16130: Self = Self::new(&Axis::ADIS16130.rate, &Axis::ADIS16130.temp);

    /// The form for codes on these scales, of up to 32 bits each.
    #[must_use]
    pub const fn new(rate: &Scale, temp: &Scale) -> Self {
        let (by_temp, by_rate) = (temp.width_bits as u32 + 6, 61_u32.saturating_sub(rate.width_bits as u32));
        let least = if by_temp < by_rate { by_temp } else { by_rate };
        let q = if least < IntegerCorrection::Q { least } else { IntegerCorrection::Q };
        Self { q, rate_codes: rate.codes(), temp_codes: temp.codes() }
    }

    /// The largest slope times 2^q. It has at most 31 bits. Its product with any temperature difference has at most
    /// 61 bits.
    fn slope_max(&self) -> f64 {
        let (first, last) = self.temp_codes;
        let most = libm::exp2(61.0) / ((last - first) as f64 + 1.0);
        most.min(i32::MAX.into())
    }
}

/// F-50 on codes, without division or floating point, clamped to the possible codes:
/// `corrected = (rate · 2^q + offset_q + (temp − t3_code) · slope_q + 2^(q−1)) >> q`.
///
/// The result is rounded to nearest. For rates of up to 31 bits and temperatures of up to 24, it differs from F-50 in
/// f64 by at most 0.51 codes (0.51/23 488 °/s for the ADIS16130, F-40). For temperatures of w > 24 bits it differs by
/// at most ½ + 2^(w − q − 1) codes. Multiply a 16-bit code of the ADIS16130 by 256 first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegerCorrection {
    /// PBC in rate codes times 2^q.
    pub offset_q: i64,
    /// BTC in rate codes per temperature code, times 2^q.
    pub slope_q: i32,
    /// T3 as a temperature code.
    pub t3_code: i32,
}

impl IntegerCorrection {
    /// Fraction bits of `offset_q` and `slope_q` for the ADIS16130, which is also the maximum ([`IntegerForm`]).
    pub const Q: u32 = 30;

    /// Corrects a 24-bit rate code of the ADIS16130 with the temperature code taken with it.
    #[inline]
    #[must_use]
    pub const fn apply(&self, rate_code: u32, temp_code: u32) -> u32 {
        let (rate, temp) = ((rate_code & 0x00FF_FFFF) as i64, (temp_code & 0x00FF_FFFF) as i64);
        self.apply_as(&IntegerForm::ADIS16130, rate, temp) as u32
    }

    /// Corrects a rate code with the temperature code taken with it. `form` must be the form for which the
    /// correction was made. An impossible code counts as the nearest possible one.
    ///
    /// ```
    /// use zerorate::{Axis, Correction, IntegerForm, Scale};
    /// // two's complement of 16 bits in 1/20 °/s, and of 12 bits in 1/8 °C from 25 °C
    /// let rate = Scale { lsb_per_unit: 20.0, zero_code: 0, width_bits: 16, signed: true, ..Axis::ADIS16130.rate };
    /// let temp = Scale { lsb_per_unit: 8.0, zero_code: 0, width_bits: 12, signed: true, ..Axis::ADIS16130.temp };
    /// let integer = Correction::line(-1.0, 0.5, 25.0).to_integer(&rate, &temp)?;
    /// assert_eq!(integer.apply_as(&IntegerForm::new(&rate, &temp), 0, 16), -20 + 20); // 2 °C above T3
    /// # Ok::<(), zerorate::IntegerError>(())
    /// ```
    #[inline]
    #[must_use]
    pub const fn apply_as(&self, form: &IntegerForm, rate: i64, temp: i64) -> i64 {
        let (rate, temp) = (held(rate, form.rate_codes), held(temp, form.temp_codes));
        let bias = self.offset_q + (temp - self.t3_code as i64) * self.slope_q as i64;
        held(rate + ((bias + (1 << (form.q - 1))) >> form.q), form.rate_codes)
    }
}

/// Returns the possible code that is nearest to a code.
#[inline]
pub(crate) const fn held(code: i64, (first, last): (i64, i64)) -> i64 {
    if code < first {
        first
    } else if code > last {
        last
    } else {
        code
    }
}

impl Correction {
    /// Converts the correction to the codes of an axis, see [`IntegerCorrection`] and [`IntegerForm`].
    ///
    /// # Errors
    /// Returns an error if the correction is a curve, or a coefficient does not fit. These fit: |BTC| up to
    /// [`IntegerError::largest_btc_dps_per_c`] (1.2 °/s/°C for the ADIS16130), PBC within the span of the rate's
    /// codes, and T3 within the temperature's codes and 32 bits.
    pub fn to_integer(&self, rate: &Scale, temp: &Scale) -> Result<IntegerCorrection, IntegerError> {
        let form = IntegerForm::new(rate, temp);
        let per_lsb = rate.lsb_per_unit / temp.lsb_per_unit;
        let error = |coefficient| IntegerError {
            coefficient,
            largest_btc_dps_per_c: form.slope_max() / f64::from(1_u32 << form.q) / per_lsb,
            rate_bits: rate.width_bits,
            temp_bits: temp.width_bits,
        };
        let within = |name, value: f64, low: f64, high: f64| {
            let rounded = libm::round(value);
            // a NaN fails this test too
            if (low..=high).contains(&rounded) { Ok(rounded) } else { Err(error(name)) }
        };
        let one = f64::from(1_u32 << form.q);
        for (name, term) in [("btc2_dps_per_c2", self.btc2_dps_per_c2), ("btc3_dps_per_c3", self.btc3_dps_per_c3)] {
            if term != 0.0 {
                return Err(error(name));
            }
        }
        let (t3_exact, (first, last)) = (temp.code(self.t3_c), form.temp_codes);
        let last = last.min(i32::MAX.into());
        let t3_code = within("t3_c", t3_exact, first as f64, last as f64)?;
        let slope = within("btc_dps_per_c", self.btc_dps_per_c * per_lsb * one, -form.slope_max(), form.slope_max())?;
        let pbc_lsb = self.pbc_dps * rate.lsb_per_unit;
        // T3 rounds to a code. The rounding error times BTC belongs to the offset.
        let offset = (pbc_lsb + (t3_code - t3_exact) * self.btc_dps_per_c * per_lsb) * one;
        let offset = within("pbc_dps", offset, -rate.span() * one, rate.span() * one)?;
        Ok(IntegerCorrection { offset_q: offset as i64, slope_q: slope as i32, t3_code: t3_code as i32 })
    }
}

/// A coefficient that does not fit the integer arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegerError {
    /// Name of the coefficient in the calibration.
    pub coefficient: &'static str,
    /// The largest |BTC| that fits these scales, °/s/°C.
    pub largest_btc_dps_per_c: f64,
    /// Bits of a rate code.
    pub rate_bits: u8,
    /// Bits of a temperature code.
    pub temp_bits: u8,
}

impl fmt::Display for IntegerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { coefficient, largest_btc_dps_per_c: largest, rate_bits, temp_bits } = *self;
        if coefficient.starts_with("btc2") || coefficient.starts_with("btc3") {
            return write!(f, "{coefficient} belongs to a curve, and this integer correction is a line");
        }
        // three digits, the last rounded down
        let digit = libm::exp10(libm::floor(libm::log10(largest)) - 2.0);
        let digits = libm::round(2.0 - libm::log10(digit * 100.0)).max(0.0) as usize;
        write!(
            f,
            "{coefficient} does not fit the integer correction, so check the calibration. Limits: |BTC| up to \
             {:.digits$} °/s/°C, PBC within the {rate_bits}-bit codes of the rate, T3 within the {temp_bits}-bit \
             codes of the temperature",
            libm::floor(largest / digit) * digit
        )
    }
}

impl core::error::Error for IntegerError {}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use alloc::string::ToString;

    const ZERO_CODE: u32 = 8_388_608;

    const TYPICAL: Correction = Correction::line(-0.2537, -0.04, 31.5123);
    pub const RATE: Scale = Axis::ADIS16130.rate;
    pub const TEMP: Scale = Axis::ADIS16130.temp;

    fn adis16130(correction: Correction) -> Result<IntegerCorrection, IntegerError> {
        correction.to_integer(&RATE, &TEMP)
    }

    /// Words spread over 32 bits by a multiplicative sequence.
    pub fn words(count: u32) -> impl Iterator<Item = (u32, u32)> {
        (0..count).map(|i| (i.wrapping_mul(2_654_435_761), i.wrapping_mul(2_246_822_519)))
    }

    fn exact_code(correction: &Correction, rate: u32, temp: u32) -> f64 {
        let rate_dps = (f64::from(rate) - 8_388_608.0) / 23_488.0;
        let temp_c = (f64::from(temp) - 8_388_608.0) / 14_093.0 + 25.0;
        (correction.apply(rate_dps, temp_c) * 23_488.0 + 8_388_608.0).clamp(0.0, 16_777_215.0)
    }

    #[test]
    fn integers_round_to_nearest_over_the_whole_range() {
        for btc_dps_per_c in [-0.04, 0.0123, 1.1, -1.1] {
            let correction = Correction { btc_dps_per_c, ..TYPICAL };
            let integer = adis16130(correction).unwrap();
            for (rate, temp) in words(100_000).map(|(rate, temp)| (rate >> 8, temp >> 8)) {
                let error = f64::from(integer.apply(rate, temp)) - exact_code(&correction, rate, temp);
                assert!(error.abs() < 0.51, "{rate} at {temp}: {error}");
            }
        }
    }

    #[test]
    fn corrected_codes_saturate() {
        let up = adis16130(Correction::line(10.0, 0.0, 25.0)).unwrap();
        assert_eq!(up.apply(0x00FF_FFFF, ZERO_CODE), 0x00FF_FFFF);
        let down = adis16130(Correction::line(-10.0, 0.0, 25.0)).unwrap();
        assert_eq!(down.apply(3, ZERO_CODE), 0);
        assert_eq!(down.apply(ZERO_CODE, ZERO_CODE), ZERO_CODE - 234_880);
    }

    #[test]
    fn coefficients_that_do_not_fit_are_named() {
        let named = |correction: Correction| adis16130(correction).unwrap_err().coefficient;
        assert_eq!(named(Correction { btc_dps_per_c: 1.3, ..TYPICAL }), "btc_dps_per_c");
        assert_eq!(named(Correction { pbc_dps: 1e4, ..TYPICAL }), "pbc_dps");
        assert_eq!(named(Correction { t3_c: f64::NAN, ..TYPICAL }), "t3_c");
        assert_eq!(named(Correction { btc2_dps_per_c2: 1e-9, ..TYPICAL }), "btc2_dps_per_c2");
        assert_eq!(named(Correction { btc3_dps_per_c3: f64::NAN, ..TYPICAL }), "btc3_dps_per_c3");
    }

    pub fn signed(width_bits: u8, lsb_per_unit: f64, zero_value: f64) -> Scale {
        Scale { lsb_per_unit, zero_code: 0, zero_value, width_bits, signed: true }
    }

    fn scales() -> [(Scale, Scale); 7] {
        [
            (signed(16, 20.0, 0.0), signed(12, 7.14, 25.0)),
            (signed(14, 12.5, 0.0), signed(12, 7.14, 25.0)),
            (RATE, TEMP),
            (RATE, signed(12, 8.0, 25.0)),
            (signed(32, 1e6, 0.0), signed(16, 256.0, 0.0)),
            (signed(32, 1e6, 0.0), Scale { zero_code: 1 << 30, signed: false, ..signed(32, 1e7, 25.0) }),
            (signed(8, 1.0, 0.0), signed(1, 0.1, 25.0)),
        ]
    }

    /// The exact corrected code, times 2⁶⁰, for coefficients that are whole multiples of 2⁻⁴⁰ codes.
    fn exact(offset: i128, slope: i128, t3: i64, rate: i64, temp: i64) -> i128 {
        (i128::from(rate) << 60) + (offset << 20) + i128::from(temp - t3) * (slope << 20)
    }

    /// Compares with exact arithmetic on scales of several widths and codings. The coefficients have 40 fraction bits,
    /// so f64 carries them without an error.
    #[test]
    fn the_correction_is_exact_on_any_scale() {
        for (rate_scale, temp_scale) in scales() {
            let form = IntegerForm::new(&rate_scale, &temp_scale);
            let (first, last) = form.temp_codes;
            let t3 = temp_scale.zero_code.clamp(first, last.min(i32::MAX.into()));
            let tolerance = 0.5 + libm::exp2(f64::from(temp_scale.width_bits) - f64::from(form.q) - 1.0) + 1e-3;
            for (offset, slope) in
                [(123_456_789_012_345_i128, 7_654_321_987_i128), (-98_765_432_109, -543_210_987), (0, 0)]
            {
                // keep the offset within the scale, and the slope within the largest slope
                let offset = offset % (1 << (40 + rate_scale.width_bits - 1));
                let slope = slope % ((form.slope_max() * libm::exp2(40.0 - f64::from(form.q))) as i128);
                let correction = Correction::line(
                    offset as f64 * libm::exp2(-40.0) / rate_scale.lsb_per_unit,
                    slope as f64 * libm::exp2(-40.0) * temp_scale.lsb_per_unit / rate_scale.lsb_per_unit,
                    temp_scale.value(t3 - temp_scale.zero_code),
                );
                let integer = correction.to_integer(&rate_scale, &temp_scale).unwrap();
                for (rate, temp) in words(100_000) {
                    let of = |word: u32, scale: &Scale| scale.codes().0 + i64::from(word >> (32 - scale.width_bits));
                    let (rate, temp) = (of(rate, &rate_scale), of(temp, &temp_scale));
                    let code = integer.apply_as(&form, rate, temp);
                    let (low, high) = form.rate_codes;
                    let wanted =
                        exact(offset, slope, t3, rate, temp).clamp(i128::from(low) << 60, i128::from(high) << 60);
                    let error = ((i128::from(code) << 60) - wanted) as f64 * libm::exp2(-60.0);
                    assert!(error.abs() <= tolerance, "{rate_scale:?} {temp_scale:?}: {rate} at {temp}: {error}");
                }
            }
        }
    }

    #[test]
    fn the_largest_coefficients_overflow_nothing() {
        for (rate, temp) in scales() {
            let form = IntegerForm::new(&rate, &temp);
            for sign in [-1.0, 1.0] {
                let largest = IntegerCorrection {
                    offset_q: (sign * rate.span()) as i64 * (1 << form.q),
                    slope_q: (sign * form.slope_max()) as i32,
                    t3_code: if sign > 0.0 {
                        form.temp_codes.0 as i32
                    } else {
                        form.temp_codes.1.min(i32::MAX.into()) as i32
                    },
                };
                for (rate, temp) in [(i64::MIN, i64::MAX), (i64::MAX, i64::MIN), (0, 0), (i64::MAX, i64::MAX)] {
                    let code = largest.apply_as(&form, rate, temp);
                    assert!((form.rate_codes.0..=form.rate_codes.1).contains(&code));
                }
            }
        }
    }

    #[test]
    fn the_limit_follows_from_the_scales() {
        for (rate, temp) in scales() {
            let steep = Correction::line(0.0, f64::INFINITY, temp.zero_value);
            let error = steep.to_integer(&rate, &temp).unwrap_err();
            let at = |factor| Correction { btc_dps_per_c: factor * error.largest_btc_dps_per_c, ..steep };
            assert!(at(0.9999).to_integer(&rate, &temp).is_ok(), "{error}");
            assert_eq!(at(1.0001).to_integer(&rate, &temp).unwrap_err().coefficient, "btc_dps_per_c");
            let stated = error.to_string();
            let number = stated.split("up to ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
            let number: f64 = number.parse().unwrap();
            assert!(number <= error.largest_btc_dps_per_c && number > 0.98 * error.largest_btc_dps_per_c, "{stated}");
        }
        let text = adis16130(Correction { btc_dps_per_c: 1.3, ..TYPICAL }).unwrap_err().to_string();
        assert!(text.contains("|BTC| up to 1.20 °/s/°C, PBC within the 24-bit codes"), "{text}");
    }
}
