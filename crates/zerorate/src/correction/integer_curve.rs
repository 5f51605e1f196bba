//! A correction of order 3 on codes, in integers. For a line, the module `integer` needs fewer instructions.

use super::formula::Correction;
use super::integer::held;
use crate::part::{Axis, Scale};
use core::fmt;

/// The format of an [`IntegerCurve`]. It follows from the scales of rate and temperature alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurveForm {
    /// Left shift that scales the distance from T3, in codes, to the full range of a signed number of 32 bits.
    pub temp_shift: u32,
    /// First and last code of the rate.
    pub rate_codes: (i64, i64),
    /// First and last code of the temperature.
    pub temp_codes: (i64, i64),
}

impl CurveForm {
    /// The form for the ADIS16130, which reaches 148.8 °C to either side of T3.
    pub const ADIS16130: Self = Self::new(&Axis::ADIS16130.rate, &Axis::ADIS16130.temp);

    /// Least distance from T3 that the form covers to either side, °C. [`new`](Self::new) rounds this distance up to a
    /// power of two in codes. With T3 at 25 °C, it is at least −103 … 153 °C. Temperatures beyond it are clamped.
    pub const REACH_C: f64 = 128.0;

    /// The form for codes on these scales, of up to 32 bits each.
    #[must_use]
    pub const fn new(rate: &Scale, temp: &Scale) -> Self {
        let mut temp_shift = 31;
        while temp_shift > 0 && ((1_i64 << (31 - temp_shift)) as f64) < Self::REACH_C * temp.lsb_per_unit {
            temp_shift -= 1;
        }
        Self { temp_shift, rate_codes: rate.codes(), temp_codes: temp.codes() }
    }

    /// Returns the lowest and highest distance from T3, in codes. Temperatures farther out are clamped to these.
    #[must_use]
    pub const fn reach(&self) -> (i64, i64) {
        let codes = 1_i64 << (31 - self.temp_shift);
        (-codes, codes - 1)
    }
}

/// A correction of order 3 on codes, without division or floating point, by Horner's rule on 32 bits with products of
/// 64 bits. Let x = (temp − t3_code) · 2^temp_shift. Then `sum = t0 + ⌊x·(t1 + ⌊x·(t2 + ⌊x·t3 / 2³²⌋) / 2³²⌋) / 2³²⌋`
/// and `corrected = rate + (sum + 2^(f−1)) >> f`, clamped to the possible codes.
///
/// The number of fraction bits, f, follows from the largest term and lies between 1 and 16. Let u = 2⁻ᶠ codes. A term
/// is rounded by ±½ u. Each of the three products loses up to 1 u by its floor, and an earlier loss counts at most
/// half, because |x| ≤ 2³¹. So the sum is off by at most ½ + (1 + ½ (½ + 1 + ½ (½ + 1 + ¼))) = 2.69 u. The code is off
/// by **½ + 2.69 · 2⁻ᶠ codes** (0.51 for f = 8, and 1.85 at worst) from the curve in f64 within [`CurveForm::REACH_C`]
/// of T3. Beyond [`CurveForm::reach`], the temperature is clamped.
///
/// ```
/// use zerorate::{Axis, Correction};
/// let Axis { rate, temp, .. } = Axis::ADIS16130;
/// let correction = Correction { btc2_dps_per_c2: 0.001, ..Correction::line(-0.25, -0.04, 25.0) };
/// let curve = correction.to_integer_curve(&rate, &temp)?;
/// // ten degrees above T3: −0.25 − 0.4 + 0.1 °/s are −12 918.4 codes
/// assert_eq!(curve.apply(8_388_608, 8_388_608 + 140_930), 8_388_608 - 12_918);
/// # Ok::<(), zerorate::CurveError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegerCurve {
    /// The correction at T3, and the terms of order 1, 2 and 3 over x / 2³², in rate codes times 2^f.
    pub terms: [i32; 4],
    /// T3 as a temperature code.
    pub t3_code: i32,
    /// Fraction bits f of the terms.
    pub fraction: u32,
}

impl IntegerCurve {
    /// Fewest and most fraction bits.
    pub const FRACTION: (u32, u32) = (1, 16);

    /// Largest difference from the curve in f64 within [`CurveForm::REACH_C`] of T3, rate codes: ½ + 2.69 · 2⁻ᶠ.
    #[must_use]
    pub fn bound_codes(&self) -> f64 {
        0.5 + 2.69 * libm::exp2(-f64::from(self.fraction))
    }

    /// Corrects a 24-bit rate code of the ADIS16130 with the temperature code taken with it.
    #[inline]
    #[must_use]
    pub const fn apply(&self, rate_code: u32, temp_code: u32) -> u32 {
        let (rate, temp) = ((rate_code & 0x00FF_FFFF) as i64, (temp_code & 0x00FF_FFFF) as i64);
        self.apply_as(&CurveForm::ADIS16130, rate, temp) as u32
    }

    /// Corrects a rate code with the temperature code taken with it. `form` must be the form for which the
    /// correction was made. An impossible code counts as the nearest possible one.
    #[inline]
    #[must_use]
    pub const fn apply_as(&self, form: &CurveForm, rate: i64, temp: i64) -> i64 {
        let (rate, temp) = (held(rate, form.rate_codes), held(temp, form.temp_codes));
        let from_t3 = held(temp - self.t3_code as i64, form.reach());
        let x = (from_t3 as i32) << form.temp_shift;
        let [t0, t1, t2, t3] = self.terms;
        let sum = t0 + high(x, t1 + high(x, t2 + high(x, t3)));
        let added = (sum + (1 << (self.fraction - 1))) >> self.fraction;
        held(rate + added as i64, form.rate_codes)
    }
}

/// The high half of a product: ⌊a·b / 2³²⌋, one instruction on a Cortex-M4.
#[inline]
const fn high(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

impl Correction {
    /// Converts the correction to the codes of an axis, see [`IntegerCurve`]. It accepts a line too, but
    /// [`Correction::to_integer`] needs fewer instructions for it.
    ///
    /// # Errors
    /// Returns an error if the terms come to more than 2²⁹ codes within the reach (22 857 °/s for the ADIS16130), T3
    /// is outside the codes of the temperature, or the temperature has more than 2²⁴ codes in 1 °C.
    pub fn to_integer_curve(&self, rate: &Scale, temp: &Scale) -> Result<IntegerCurve, CurveError> {
        let form = CurveForm::new(rate, temp);
        let (first, last) = form.temp_codes;
        let t3_exact = temp.code(self.t3_c);
        let t3_code = libm::round(t3_exact);
        let reach_c = form.reach().1 as f64 / temp.lsb_per_unit;
        let error = |coefficient, codes| CurveError { coefficient, codes, reach_c };
        // a NaN fails this test too
        let known = (first as f64..=(last.min(i32::MAX.into())) as f64).contains(&t3_code);
        if !known || reach_c < CurveForm::REACH_C - 1.0 {
            return Err(error("t3_c", t3_exact));
        }
        // T3 rounds to a code, so shift the origin of the curve to the temperature of that code
        let shift_c = (t3_code - t3_exact) / temp.lsb_per_unit;
        let about = [
            self.at(self.t3_c + shift_c),
            self.slope_dps_per_c(shift_c),
            self.btc2_dps_per_c2 + 3.0 * self.btc3_dps_per_c3 * shift_c,
            self.btc3_dps_per_c3,
        ];
        // x / 2³² is a distance in units of 2^(32 − temp_shift) codes
        let unit_c = libm::exp2(32.0 - f64::from(form.temp_shift)) / temp.lsb_per_unit;
        let mut terms = about.map(|term| term * rate.lsb_per_unit);
        let mut power = 1.0;
        for term in &mut terms {
            *term *= power;
            power *= unit_c;
        }
        let (coefficient, codes) = largest(&terms);
        let (least, most) = IntegerCurve::FRACTION;
        let mut bits = (least..=most).rev();
        let fits = |bits: &u32| codes * libm::exp2(f64::from(*bits)) <= libm::exp2(30.0);
        let fraction = bits.find(fits).ok_or_else(|| error(coefficient, codes))?;
        let terms = terms.map(|term| libm::round(term * libm::exp2(f64::from(fraction))) as i32);
        Ok(IntegerCurve { terms, t3_code: t3_code as i32, fraction })
    }
}

/// Largest sum of Horner's rule with |x / 2³²| ≤ ½, in codes, and the term that contributes most.
fn largest(terms: &[f64; 4]) -> (&'static str, f64) {
    let (mut sum, mut most) = (0.0, 0.0_f64);
    for term in terms.iter().rev() {
        sum = term.abs() + sum / 2.0;
        // a NaN is kept, so no number of fraction bits fits
        most = if most >= sum { most } else { sum };
    }
    let names = ["pbc_dps", "btc_dps_per_c", "btc2_dps_per_c2", "btc3_dps_per_c3"];
    let shares = terms.iter().zip([1.0, 0.5, 0.25, 0.125]).map(|(term, share)| term.abs() * share);
    let named = names.into_iter().zip(shares).max_by(|(_, a), (_, b)| a.total_cmp(b));
    (named.map_or("pbc_dps", |(name, _)| name), most)
}

/// A curve that does not fit the integer arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveError {
    /// Name in the calibration of the largest term, or of T3.
    pub coefficient: &'static str,
    /// Size of the terms within the reach, rate codes. For T3 it is the code of T3.
    pub codes: f64,
    /// Largest distance from T3 that the form covers, °C.
    pub reach_c: f64,
}

impl fmt::Display for CurveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { coefficient, codes, reach_c } = *self;
        match coefficient {
            "t3_c" => write!(
                f,
                "t3_c (code {codes:.0}) does not fit the integer correction of a curve, so check the calibration. T3 \
                 must be a code of the temperature, and {} °C must be at most 2^31 codes",
                CurveForm::REACH_C
            ),
            _ => write!(
                f,
                "{coefficient} does not fit the integer correction of a curve: it reaches {codes:.2e} rate codes \
                 within ±{reach_c:.0} °C of T3, and up to 5.4e8 fit. Check the calibration, or take the table or \
                 single precision"
            ),
        }
    }
}

impl core::error::Error for CurveError {}

#[cfg(test)]
mod tests {
    use super::super::integer::tests::{RATE, TEMP, signed, words};
    use super::*;
    use alloc::string::ToString;

    fn curve(pbc_dps: f64, btc_dps_per_c: f64, t3_c: f64, btc2_dps_per_c2: f64, btc3_dps_per_c3: f64) -> Correction {
        Correction { btc2_dps_per_c2, btc3_dps_per_c3, ..Correction::line(pbc_dps, btc_dps_per_c, t3_c) }
    }

    /// Largest error of an integer curve against f64, in rate codes, less the stated bound. Temperatures beyond the
    /// reach are clamped.
    fn beyond_the_bound(correction: &Correction, rate_scale: &Scale, temp_scale: &Scale, count: u32) -> f64 {
        let form = CurveForm::new(rate_scale, temp_scale);
        let integer = correction.to_integer_curve(rate_scale, temp_scale).unwrap();
        let bound = integer.bound_codes();
        let of = |word: u32, scale: &Scale| scale.codes().0 + i64::from(word >> (32 - scale.width_bits));
        let corners = [(0, 0), (u32::MAX, 0), (0, u32::MAX), (u32::MAX, u32::MAX)];
        let mut worst = f64::MIN;
        for (rate, temp) in words(count).chain(corners) {
            let (rate, temp) = (of(rate, rate_scale), of(temp, temp_scale));
            let (first, last) = form.reach();
            let held_temp = (temp - i64::from(integer.t3_code)).clamp(first, last) + i64::from(integer.t3_code);
            let temp_c = temp_scale.value(held_temp - temp_scale.zero_code);
            let exact = rate as f64 + correction.at(temp_c) * rate_scale.lsb_per_unit;
            let exact = exact.clamp(form.rate_codes.0 as f64, form.rate_codes.1 as f64);
            // rounding of f64 itself: 2⁻⁵² of numbers up to 2³¹ codes
            worst = worst.max((integer.apply_as(&form, rate, temp) as f64 - exact).abs() - bound - 1e-4);
        }
        worst
    }

    /// Multiplies each of the largest coefficients that an ADIS16130 can need by −1, 0 and 1, in every combination:
    /// 250 °/s, 1 °/s/°C, 0.02 °/s/°C² and 2·10⁻⁴ °/s/°C³. The third is forty times the spread of M-02. T3 lies at the
    /// ends of the operating range and between them.
    #[test]
    fn the_bound_holds_at_every_corner() {
        for corner in 0..3_u32.pow(4) {
            let sign = |place: u32| f64::from(corner / 3_u32.pow(place) % 3) - 1.0;
            for t3_c in [-40.0, 25.0, 31.512_345, 85.0] {
                let correction = curve(250.0 * sign(0), sign(1), t3_c, 0.02 * sign(2), 2e-4 * sign(3));
                let beyond = beyond_the_bound(&correction, &RATE, &TEMP, 300);
                assert!(beyond <= 0.0, "{correction:?}: {beyond}");
            }
        }
    }

    #[test]
    fn the_bound_holds_for_any_coefficients() {
        for (a, b) in words(1500) {
            let of = |word: u32, largest: f64| largest * (f64::from(word) / f64::from(u32::MAX) * 2.0 - 1.0);
            let (c, d) = (a.rotate_left(16) ^ b, b.rotate_left(9) ^ a);
            let small = libm::exp2(-f64::from(a % 12));
            let correction = curve(
                small * of(a, 20.0),
                small * of(b, 0.5),
                25.0 + of(c ^ d, 60.0),
                small * of(c, 0.01),
                small * of(d, 1e-4),
            );
            let beyond = beyond_the_bound(&correction, &RATE, &TEMP, 100);
            assert!(beyond <= 0.0, "{correction:?}: {beyond}");
        }
    }

    /// Checks a curve of usual size at every third code from −2.6 to 89.7 °C.
    #[test]
    fn a_usual_curve_is_within_51_hundredths_of_a_code() {
        let correction = curve(-0.2537, -0.04, 31.5123, 0.0005, -3e-6);
        let integer = correction.to_integer_curve(&RATE, &TEMP).unwrap();
        assert!((8..=16).contains(&integer.fraction), "{integer:?}");
        for temp in (8_000_000..9_300_000_u32).step_by(3) {
            let temp_c = (f64::from(temp) - 8_388_608.0) / 14_093.0 + 25.0;
            let exact = 8_388_608.0 + correction.at(temp_c) * 23_488.0;
            let error = f64::from(integer.apply(8_388_608, temp)) - exact;
            assert!(error.abs() <= 0.511, "{temp}: {error}");
        }
    }

    #[test]
    fn the_bound_holds_on_any_scale() {
        for (rate, temp) in [
            (signed(16, 20.0, 0.0), signed(12, 7.14, 25.0)),
            (signed(14, 12.5, 0.0), signed(16, 256.0, 0.0)),
            (signed(32, 1e6, 0.0), signed(16, 256.0, 0.0)),
            (signed(32, 1e6, 0.0), Scale { zero_code: 1 << 30, signed: false, ..signed(32, 1e7, 25.0) }),
            (RATE, signed(8, 0.1, 25.0)),
        ] {
            let correction = curve(-2.5, 0.04, 30.3, 0.001, -2e-6);
            let beyond = beyond_the_bound(&correction, &rate, &temp, 20_000);
            assert!(beyond <= 0.0, "{rate:?} {temp:?}: {beyond}");
        }
    }

    #[test]
    fn a_term_beyond_its_integer_is_named() {
        let named = |correction: Correction| correction.to_integer_curve(&RATE, &TEMP).unwrap_err();
        assert_eq!(named(curve(0.0, 0.0, 25.0, 0.0, 0.1)).coefficient, "btc3_dps_per_c3");
        assert_eq!(named(curve(0.0, 0.0, 25.0, 1.0, 0.0)).coefficient, "btc2_dps_per_c2");
        assert_eq!(named(curve(3e4, 0.0, 25.0, 0.0, 0.0)).coefficient, "pbc_dps");
        assert_eq!(named(curve(0.0, 0.0, f64::NAN, 0.0, 0.0)).coefficient, "t3_c");
        assert_eq!(named(curve(0.0, f64::NAN, 25.0, 0.0, 0.0)).coefficient, "btc_dps_per_c");
        let said = named(curve(0.0, 0.0, 25.0, 0.0, 0.1)).to_string();
        assert!(said.contains("within ±149 °C of T3"), "{said}");
        let fine = Scale { lsb_per_unit: 1e8, width_bits: 32, ..TEMP };
        let line = curve(0.0, 0.0, 25.0, 0.0, 0.0);
        assert!(line.to_integer_curve(&RATE, &fine).unwrap_err().to_string().contains("at most 2^31 codes"));
    }
}
