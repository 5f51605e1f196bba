//! C functions of the twin, to which `zerorate_bus` and `zerorate_self_test_pin` can point. They do not check
//! pointers, since they are for tests only. The tests of the library `zerorate-c` include this file too.

extern crate alloc;

use adis16130_twin::{Fault, SelfTestPin, Spec, Twin, TwinDelay, TwinRdy, TwinSpi};
use alloc::boxed::Box;
use core::ffi::{CStr, c_char, c_void};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{InputPin, OutputPin, PinState};
use embedded_hal::spi::SpiDevice;

struct Rig {
    twin: Twin,
    spi: TwinSpi,
    rdy: TwinRdy,
    delay: TwinDelay,
    self_test: SelfTestPin,
}

impl Rig {
    unsafe fn of<'a>(rig: *mut c_void) -> &'a mut Self {
        // SAFETY: by the contract of the functions below, and only one of them is under way.
        unsafe { &mut *rig.cast() }
    }
}

/// Makes a twin from keys such as `seed=7,warmup_s=30`. Returns null if the keys are null or invalid.
///
/// # Safety
/// `keys` is null or a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_new(keys: *const c_char) -> *mut c_void {
    if keys.is_null() {
        return core::ptr::null_mut();
    }
    // SAFETY: not null, and a C string by the contract.
    let keys = unsafe { CStr::from_ptr(keys) };
    let Some(spec) = keys.to_str().ok().and_then(|keys| Spec::parse_keys(keys).ok()) else {
        return core::ptr::null_mut();
    };
    let twin = Twin::new(spec);
    let (spi, rdy, delay, self_test) = (twin.spi(), twin.rdy(), twin.delay(), twin.self_test_pin());
    Box::into_raw(Box::new(Rig { twin, spi, rdy, delay, self_test })).cast()
}

/// Frees a twin.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`] and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_free(rig: *mut c_void) {
    // SAFETY: by the contract.
    drop(unsafe { Box::<Rig>::from_raw(rig.cast()) });
}

/// Exchanges `length` bytes in one frame of CS. Returns 0.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`]; `bytes` points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_transfer(rig: *mut c_void, bytes: *mut u8, length: usize) -> i32 {
    // SAFETY: by the contract.
    let (rig, bytes) = unsafe { (Rig::of(rig), core::slice::from_raw_parts_mut(bytes, length)) };
    rig.spi.transfer_in_place(bytes).map_or(-1, |()| 0)
}

/// Returns the level of RDY: 1 = high, 0 = low.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`], is not null, and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_rdy(rig: *mut c_void) -> i32 {
    // SAFETY: by the contract.
    unsafe { Rig::of(rig) }.rdy.is_high().map_or(-1, i32::from)
}

/// Lets `us` microseconds of simulated time pass.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`], is not null, and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_delay_us(rig: *mut c_void, us: u32) {
    // SAFETY: by the contract.
    unsafe { Rig::of(rig) }.delay.delay_us(us);
}

/// Drives the self-test pins: high if `level` is not 0. Returns 0.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`], is not null, and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_self_test(rig: *mut c_void, level: i32) -> i32 {
    // SAFETY: by the contract.
    unsafe { Rig::of(rig) }.self_test.set_state(PinState::from(level != 0)).map_or(-1, |()| 0)
}

/// Returns the simulated time since the start, ns.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`], is not null, and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_now_ns(rig: *mut c_void) -> u64 {
    // SAFETY: by the contract.
    unsafe { Rig::of(rig) }.twin.now_ns()
}

/// Waits for the next falling edge of RDY. Returns 1, with its time, ns, and number, or 0 if none comes in 0.1 s.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`]. `t_ns` and `seq` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_next_edge(rig: *mut c_void, t_ns: *mut u64, seq: *mut u32) -> i32 {
    // SAFETY: by the contract.
    let Some(edge) = unsafe { Rig::of(rig) }.twin.next_falling_edge(100_000_000) else { return 0 };
    // SAFETY: by the contract.
    unsafe {
        t_ns.write(edge.t_ns);
        seq.write(edge.seq);
    }
    1
}

/// Sets a fault: 0 or any other number none, 1 SDO at zeros, 2 SDO at ones, 3 a dip of the supply, 4 RDY cut.
///
/// # Safety
/// `rig` came from [`zerorate_twin_new`], is not null, and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn zerorate_twin_set_fault(rig: *mut c_void, fault: i32) {
    let fault = match fault {
        1 => Fault::SdoLow,
        2 => Fault::SdoHigh,
        3 => Fault::Brownout,
        4 => Fault::RdyLost,
        _ => Fault::None,
    };
    // SAFETY: by the contract.
    unsafe { Rig::of(rig) }.twin.set_fault(fault);
}
