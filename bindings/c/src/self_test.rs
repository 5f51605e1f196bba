//! The self-test (F-11).

use crate::boundary;
use crate::bus::{Delay, SelfTestPin};
use crate::gyro::{Gyro, State};
use crate::status::{self, Status, StatusNumber, ZERORATE_E_MISSING, ZERORATE_E_NULL};
use adis16130::{SelfTestPlan as DriverPlan, WaitBound};

/// Settings of a self-test. Start from zerorate_self_test_plan_default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct SelfTestPlan {
    /// Wait after each change of the pin, us: 100000 (ours: the time is not published).
    pub settle_us: u32,
    /// Bound of each wait for RDY, us: 20000, enough for the slowest conversion.
    pub timeout_us: u32,
    /// Rates to average without and with the self-test, rounded up to a multiple of 16: 6000, a second's worth at the
    /// 5693 per second of F-31. A sixteenth of them must be long against 1/(300 Hz) (F-03), else `u_dps` is too small.
    pub samples: u16,
}

/// The measured effect of the self-test. Its proper size is not known, so nothing is judged (F-11).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct SelfTest {
    /// Mean rate with the self-test less mean rate without, deg/s.
    pub shift_dps: f32,
    /// Standard uncertainty of `shift_dps` from the scatter, deg/s.
    pub u_dps: f32,
    /// Number of rates averaged without the self-test. The same number is averaged with it.
    pub n: u32,
}

impl SelfTestPlan {
    fn to_driver(self) -> DriverPlan {
        DriverPlan::new(self.samples).with_settle_us(self.settle_us).with_bound(WaitBound::from_us(self.timeout_us))
    }
}

/// The default settings: a second without and a second with the self-test, at the rate of F-30.
///
/// # Safety
/// `plan` is null or points to writable memory for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_self_test_plan_default(plan: *mut SelfTestPlan) -> Status {
    let samples = 6000;
    let driver = DriverPlan::new(samples);
    let default = SelfTestPlan { settle_us: driver.settle_us(), timeout_us: driver.bound().timeout_us(), samples };
    // SAFETY: by the contract.
    status::of(unsafe { boundary::output(plan, default) })
}

/// Measures what the self-test does to the rate, and judges nothing (F-11). Needs `rdy` and `delay_us` of the bus and
/// an initialised part at rest: motion counts as shift.
///
/// Blocks for two settling times and `2 * samples` rates, 3 commands each, each within `4 * timeout_us`: 2.3 s by
/// default, so not for an interrupt. An interrupt that samples this gyroscope must be masked; what it misses counts as
/// lost.
///
/// The self-test is off when this returns, also with an error, except perhaps after ZERORATE_E_SELF_TEST_PIN.
/// ZERORATE_E_MISSING: a function is null, nothing was done. ZERORATE_E_TIMEOUT: RDY was silent, or no new rate came.
/// Else the errors of zerorate_gyro_read, and ZERORATE_E_PIN.
///
/// # Safety
/// Each pointer is null or points to memory of its type. Nothing else uses the gyroscope meanwhile. The
/// function in `pin` may be called as its documentation says.
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
    let seen = driver.self_test(&mut pin, &mut Delay(*bus), plan.to_driver()).map_err(|error| error.status())?;
    let seen = SelfTest { shift_dps: seen.shift_dps, u_dps: seen.u_dps, n: seen.n };
    // SAFETY: by the contract.
    unsafe { boundary::output(result, seen) }
}
