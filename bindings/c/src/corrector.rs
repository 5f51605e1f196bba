//! Applies a correction to a stream of readings.

use crate::boundary::{self, Object};
use crate::correction::Correction;
use crate::status::{self, Status, ZERORATE_E_ARGUMENT, ZERORATE_NOTHING, ZERORATE_OK};
use zerorate::CorrectorConfig;

/// A correction with the temperature that was read last. The caller owns the memory, and the contents are private.
/// Begin it with zerorate_corrector_begin. It needs no tear-down.
#[repr(C)]
pub struct Corrector {
    /// Private.
    pub opaque: [u64; 16],
}

impl Object for Corrector {
    type State = zerorate::Corrector;
    const MARK: u32 = 0x7A72_6331;
}

/// The span of temperatures in which a correction holds, from the `validity` of its calibration.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Validity {
    /// Lowest temperature of the calibration, deg C.
    pub temp_min_c: f64,
    /// Highest temperature of the calibration, deg C.
    pub temp_max_c: f64,
    /// Distance from the span up to which a temperature does not count as extrapolated, deg C: 0.5 for the ADIS16130.
    pub margin_c: f64,
}

impl Validity {
    fn to_core(self) -> Result<zerorate::Validity, Status> {
        let Self { temp_min_c, temp_max_c, margin_c } = self;
        let is_valid = temp_min_c <= temp_max_c && margin_c >= 0.0;
        is_valid.then_some(zerorate::Validity { temp_min_c, temp_max_c, margin_c }).ok_or(ZERORATE_E_ARGUMENT)
    }
}

/// A corrected rate.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Corrected {
    /// The corrected rate, deg/s (F-50).
    pub rate_dps: f64,
    /// The temperature that the correction used, deg C.
    pub temp_c: f64,
    /// 1 = `temp_c` lies outside the span in which the correction holds, by more than its margin. Otherwise 0.
    pub extrapolated: u8,
}

/// Begins a stream, before its first temperature. If `valid` is null, no temperature counts as extrapolated. Returns
/// ZERORATE_E_COEFFICIENT if a coefficient is not finite, ZERORATE_E_ARGUMENT if `valid` is no span.
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
    status::of(unsafe { boundary::input(correction) }.and_then(|correction| {
        // SAFETY: by the contract.
        let validity = unsafe { valid.as_ref() }.map(|valid| valid.to_core()).transpose()?;
        let config = CorrectorConfig { corrections: [correction.checked()?], validity };
        // SAFETY: by the contract.
        unsafe { boundary::set_up(corrector, zerorate::Corrector::new(config)) }
    }))
}

/// Corrects the next rate, deg/s, with the temperature that was read with it, deg C. If no temperature was read, pass
/// NaN, and the last temperature is used. A rate of NaN stands for a reading that must not be used. Returns
/// ZERORATE_NOTHING and writes nothing if the rate is NaN or no temperature has come yet. Returns
/// ZERORATE_E_ARGUMENT if a number is infinite.
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
    if rate_dps.is_infinite() || temp_c.is_infinite() {
        return ZERORATE_E_ARGUMENT;
    }
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
