//! The correction of F-50, and corrections by a curve, in double precision, single precision and integers.

use crate::boundary;
use crate::status::{self, Status, ZERORATE_E_COEFFICIENT};
use adis16130::{RateCode, TempCode, Width};

/// A correction: corrected rate = rate + PBC + d * (BTC + d * (BTC2 + d * BTC3)) with d = temperature - T3. For a line
/// (F-50), BTC2 and BTC3 are zero.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Correction {
    /// PBC, the correction at T3, deg/s.
    pub pbc_dps: f64,
    /// BTC, the linear term, deg/s per deg C.
    pub btc_dps_per_c: f64,
    /// T3, the temperature that the part reported when PBC was measured, deg C.
    pub t3_c: f64,
    /// BTC2, the quadratic term, deg/s per (deg C)^2. Zero for a line.
    pub btc2_dps_per_c2: f64,
    /// BTC3, the cubic term, deg/s per (deg C)^3. Zero for a line.
    pub btc3_dps_per_c3: f64,
}

impl Correction {
    /// Returns ZERORATE_E_COEFFICIENT if a coefficient is not finite.
    pub fn checked(self) -> Result<zerorate::Correction, Status> {
        let terms = [self.pbc_dps, self.btc_dps_per_c, self.t3_c, self.btc2_dps_per_c2, self.btc3_dps_per_c3];
        let is_finite = terms.iter().all(|term| term.is_finite());
        if is_finite { Ok(self.to_core()) } else { Err(ZERORATE_E_COEFFICIENT) }
    }

    pub fn to_core(self) -> zerorate::Correction {
        let Self { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = self;
        zerorate::Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 }
    }

    pub fn from_core(of: zerorate::Correction) -> Self {
        let zerorate::Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = of;
        Self { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 }
    }
}

/// A correction in single precision. The formula is that of zerorate_correction.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CorrectionF32 {
    /// PBC, deg/s.
    pub pbc_dps: f32,
    /// BTC, deg/s per deg C.
    pub btc_dps_per_c: f32,
    /// T3, deg C.
    pub t3_c: f32,
    /// BTC2, deg/s per (deg C)^2. Zero for a line.
    pub btc2_dps_per_c2: f32,
    /// BTC3, deg/s per (deg C)^3. Zero for a line.
    pub btc3_dps_per_c3: f32,
}

/// A linear correction (F-50) of 24-bit codes, without floating point or division.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CorrectionInteger {
    /// PBC in rate codes, times 2^30.
    pub offset_q30: i64,
    /// BTC in rate codes per temperature code, times 2^30.
    pub slope_q30: i32,
    /// T3 as a temperature code.
    pub t3_code: i32,
}

/// A correction of 24-bit codes by a curve of order 3, without floating point or division. It can hold a line as well,
/// but zerorate_correction_integer takes fewer instructions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CorrectionCurve {
    /// The correction at T3, then the coefficients of x, x^2 and x^3 with x = (temperature code - t3_code) * 2^10 /
    /// 2^32. All are in rate codes times 2^fraction.
    pub terms: [i32; 4],
    /// T3 as a temperature code.
    pub t3_code: i32,
    /// Fraction bits of the terms, 1 to 16.
    pub fraction: u32,
}

/// Converts a 24-bit rate code to deg/s (F-40).
#[unsafe(no_mangle)]
pub extern "C" fn zerorate_rate_dps(rate_code: u32) -> f32 {
    RateCode::new(rate_code, Width::Bits24).to_dps()
}

/// Converts a 24-bit temperature code to deg C (F-41).
#[unsafe(no_mangle)]
pub extern "C" fn zerorate_temp_c(temp_code: u32) -> f32 {
    TempCode::new(temp_code, Width::Bits24).to_celsius()
}

/// Converts a correction to single precision. Returns ZERORATE_E_COEFFICIENT if a coefficient is not finite.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_correction_to_f32(from: *const Correction, to: *mut CorrectionF32) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::input(from) }.and_then(|from| {
        let zerorate::CorrectionF32 { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } =
            from.checked()?.to_f32();
        // SAFETY: by the contract.
        unsafe {
            boundary::output(to, CorrectionF32 { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 })
        }
    }))
}

/// Converts a line to integers. Returns ZERORATE_E_COEFFICIENT if a coefficient does not fit, or if the correction is
/// a curve. For a curve, use zerorate_correction_to_curve.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_correction_to_integer(
    from: *const Correction,
    to: *mut CorrectionInteger,
) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::input(from) }.and_then(|from| {
        const ADIS16130: zerorate::Axis = zerorate::Axis::ADIS16130;
        let zerorate::IntegerCorrection { offset_q, slope_q, t3_code } =
            from.to_core().to_integer(&ADIS16130.rate, &ADIS16130.temp).map_err(|_| ZERORATE_E_COEFFICIENT)?;
        // SAFETY: by the contract.
        unsafe { boundary::output(to, CorrectionInteger { offset_q30: offset_q, slope_q30: slope_q, t3_code }) }
    }))
}

/// Converts a correction of order 3 or less to integers. Returns ZERORATE_E_COEFFICIENT if a coefficient does not fit.
/// Within 148 deg C of T3, a corrected code differs from the exact curve by at most 1/2 + 2.69 / 2^fraction codes.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_correction_to_curve(from: *const Correction, to: *mut CorrectionCurve) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { boundary::input(from) }.and_then(|from| {
        const ADIS16130: zerorate::Axis = zerorate::Axis::ADIS16130;
        let zerorate::IntegerCurve { terms, t3_code, fraction } =
            from.to_core().to_integer_curve(&ADIS16130.rate, &ADIS16130.temp).map_err(|_| ZERORATE_E_COEFFICIENT)?;
        // SAFETY: by the contract.
        unsafe { boundary::output(to, CorrectionCurve { terms, t3_code, fraction }) }
    }))
}

/// Returns the corrected rate, deg/s. Returns the rate itself if `correction` is null.
///
/// # Safety
/// `correction` is null or points to a correction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_correct(correction: *const Correction, rate_dps: f64, temp_c: f64) -> f64 {
    // SAFETY: by the contract.
    unsafe { boundary::input(correction) }.map_or(rate_dps, |correction| correction.to_core().apply(rate_dps, temp_c))
}

/// Returns the corrected rate in single precision, deg/s. Returns the rate itself if `correction` is null.
///
/// # Safety
/// `correction` is null or points to a correction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_correct_f32(correction: *const CorrectionF32, rate_dps: f32, temp_c: f32) -> f32 {
    // SAFETY: by the contract.
    unsafe { boundary::input(correction) }.map_or(rate_dps, |correction| {
        let &CorrectionF32 { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = correction;
        zerorate::CorrectionF32 { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 }
            .apply(rate_dps, temp_c)
    })
}

/// Corrects a 24-bit rate code with the 24-bit temperature code that was read with it. The result is rounded to
/// nearest and limited to 0 ... 2^24 - 1. Returns the rate code itself if `correction` is null.
///
/// # Safety
/// `correction` is null or points to a correction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_correct_integer(
    correction: *const CorrectionInteger,
    rate_code: u32,
    temp_code: u32,
) -> u32 {
    // SAFETY: by the contract.
    unsafe { boundary::input(correction) }.map_or(
        rate_code,
        |&CorrectionInteger { offset_q30, slope_q30, t3_code }| {
            let integer = zerorate::IntegerCorrection { offset_q: offset_q30, slope_q: slope_q30, t3_code };
            integer.apply(rate_code, temp_code)
        },
    )
}

/// Corrects a rate code by a curve, as zerorate_correct_integer does by a line. A temperature farther than 148 deg C
/// from T3 counts as 148 deg C away.
///
/// # Safety
/// `curve` is null or points to a curve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_correct_curve(curve: *const CorrectionCurve, rate_code: u32, temp_code: u32) -> u32 {
    // SAFETY: by the contract.
    unsafe { boundary::input(curve) }.map_or(rate_code, |&CorrectionCurve { terms, t3_code, fraction }| {
        let (least, most) = zerorate::IntegerCurve::FRACTION;
        // memory that was never written must not cause a shift by more bits than an integer has
        let fraction = fraction.clamp(least, most);
        zerorate::IntegerCurve { terms, t3_code, fraction }.apply(rate_code, temp_code)
    })
}
