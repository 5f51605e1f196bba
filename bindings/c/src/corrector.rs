//! A correction applied to a stream of readings.

use crate::boundary::{self, Object};
use crate::correction::Correction;
use crate::status::{self, Status, ZERORATE_NOTHING, ZERORATE_OK};
use zerorate::CorrectorConfig;

/// A correction with the temperature that was read last. The memory is the caller's, the contents are private; begin
/// it with zerorate_corrector_begin. It needs no tear-down.
#[repr(C)]
pub struct Corrector {
    /// Private.
    pub opaque: [u64; 16],
}

impl Object for Corrector {
    type State = zerorate::Corrector;
    const MARK: u32 = 0x7A72_6331;
}

/// The span of temperatures in which a correction holds, as the calibration states it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Validity {
    /// Lowest temperature seen while measuring, deg C.
    pub temp_min_c: f64,
    /// Highest temperature seen while measuring, deg C.
    pub temp_max_c: f64,
    /// How far a temperature may leave the span without a mark, deg C: 0.5.
    pub margin_c: f64,
}

/// A corrected rate.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Corrected {
    /// The corrected rate, deg/s (F-50).
    pub rate_dps: f64,
    /// The temperature that was used, deg C.
    pub temp_c: f64,
    /// 1 = that temperature lies outside the span where the correction holds.
    pub extrapolated: u8,
}

/// Begins a stream, before its first temperature. `valid` may be null: then nothing is extrapolated.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_corrector_begin(
    corrector: *mut Corrector,
    correction: *const Correction,
    valid: *const Validity,
) -> Status {
    // SAFETY: by the contract.
    let validity = unsafe { valid.as_ref() }
        .map(|&Validity { temp_min_c, temp_max_c, margin_c }| zerorate::Validity { temp_min_c, temp_max_c, margin_c });
    // SAFETY: by the contract.
    status::of(unsafe { boundary::input(correction) }.and_then(|correction| {
        let config = CorrectorConfig { corrections: [correction.to_core()], validity };
        // SAFETY: by the contract.
        unsafe { boundary::set_up(corrector, zerorate::Corrector::new(config)) }
    }))
}

/// Corrects the next rate, deg/s, with the temperature that was read with it, deg C. Where none was read, pass NaN:
/// the last one is used. Returns ZERORATE_NOTHING and writes nothing before the first temperature, and where the rate
/// is NaN, which marks a reading that must not be used.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_corrector_take(
    corrector: *mut Corrector,
    rate_dps: f64,
    temp_c: f64,
    corrected: *mut Corrected,
) -> Status {
    let known = |value: f64| Some(value).filter(|value| !value.is_nan());
    // SAFETY: by the contract.
    let taken = unsafe { boundary::state(corrector) }.and_then(|corrector| {
        let zerorate::Corrected { rate_dps, temp_c, extrapolated } = corrector.take(known(rate_dps), known(temp_c));
        let Some((rate_dps, temp_c)) = rate_dps.zip(temp_c) else { return Ok(ZERORATE_NOTHING) };
        let made = Corrected { rate_dps, temp_c, extrapolated: extrapolated.into() };
        // SAFETY: by the contract.
        unsafe { boundary::output(corrected, made) }.map(|()| ZERORATE_OK)
    });
    taken.unwrap_or_else(|status| status)
}
