//! The self-test (F-11).

use crate::boundary;
use crate::bus::SelfTestPin;
use crate::gyro::{Gyro, State};
use crate::status::{self, Status, StatusNumber, ZERORATE_E_MISSING, ZERORATE_E_NULL};
use adis16130::{SelfTestPlan as DriverPlan, WaitBound};

/// Settings of a self-test. Start from zerorate_self_test_plan_default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct SelfTestPlan {
    /// Wait after each change of the pin, us. Default: 100000, a choice, because no time is published.
    pub settle_us: u32,
    /// Longest wait for RDY, us. Default: 20000, enough for the slowest conversion.
    pub timeout_us: u32,
    /// Number of rates to average without the self-test, and as many with it, rounded up to a multiple of 16. Default:
    /// 6000, about a second at the 5693 per second of F-31. A sixteenth of these rates must take long compared with
    /// 1/(300 Hz) (F-03), or else `u_dps` is too small.
    pub samples: u16,
}

/// The measured effect of the self-test. The right size is not known, so the library does not judge it (F-11).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct SelfTest {
    /// Mean rate with the self-test less mean rate without the self-test, deg/s.
    pub shift_dps: f32,
    /// Standard uncertainty of `shift_dps` from the scatter of the rates, deg/s.
    pub u_dps: f32,
    /// Number of rates averaged without the self-test. The same number is averaged with it.
    pub n: u32,
}

impl SelfTestPlan {
    fn to_driver(self) -> DriverPlan {
        DriverPlan::new(self.samples).with_settle_us(self.settle_us).with_bound(WaitBound::from_us(self.timeout_us))
    }
}

/// Writes the default settings: one second without and one second with the self-test, at the rate of F-30.
///
/// # Safety
/// `plan` is null or points to writable memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_self_test_plan_default(plan: *mut SelfTestPlan) -> Status {
    let samples = 6000;
    let driver = DriverPlan::new(samples);
    let default = SelfTestPlan { settle_us: driver.settle_us(), timeout_us: driver.bound().timeout_us(), samples };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::output(plan, default) })
}

/// Measures by how much the self-test shifts the rate. It does not judge the shift (F-11). Needs `rdy` and `delay_us`
/// of the bus, and an initialised part at rest, since motion counts as shift.
///
/// Blocks for two settling times and `2 * samples` rates, which is 2.3 s by default. Each rate takes 3 commands, and
/// at most `4 * timeout_us`. Do not call it from an interrupt. Mask the interrupt that samples this gyroscope. The
/// samples that it misses count as lost.
///
/// The self-test is off when the function returns, also with an error, except perhaps after ZERORATE_E_SELF_TEST_PIN.
/// Returns ZERORATE_E_MISSING, and does nothing, if a function is null. Returns ZERORATE_E_TIMEOUT if RDY was silent
/// or no new rate came. The other errors are ZERORATE_E_PIN and those of zerorate_gyro_read.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the gyroscope during the call. The function
/// in `pin` may be called as its documentation says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_gyro_self_test(
    gyro: *mut Gyro,
    pin: *const SelfTestPin,
    plan: *const SelfTestPlan,
    result: *mut SelfTest,
) -> Status {
    // SAFETY: by the contract.
    status::of(unsafe { self_test(gyro, pin, plan, result) })
}

unsafe fn self_test(
    gyro: *mut Gyro,
    pin: *const SelfTestPin,
    plan: *const SelfTestPlan,
    result: *mut SelfTest,
) -> Result<(), Status> {
    // SAFETY: by the contract.
    let (state, mut pin, plan) = unsafe { (boundary::state(gyro)?, *boundary::input(pin)?, *boundary::input(plan)?) };
    if result.is_null() {
        return Err(ZERORATE_E_NULL);
    }
    let State { driver, bus, .. } = state;
    if bus.rdy.is_none() || bus.delay_us.is_none() || pin.set.is_none() {
        return Err(ZERORATE_E_MISSING);
    }
    let seen = driver.self_test(&mut pin, bus, plan.to_driver()).map_err(|error| error.status())?;
    let seen = SelfTest { shift_dps: seen.shift_dps, u_dps: seen.u_dps, n: seen.n };
    // SAFETY: by the contract.
    unsafe { boundary::output(result, seen) }
}
