//! Code that the images share.

#![no_std]

#[cfg(feature = "twin")]
pub mod arguments;
pub mod bare;
#[cfg(feature = "twin")]
pub mod bridge;
#[cfg(feature = "twin")]
pub mod heap;
#[cfg(feature = "twin")]
pub mod scenario;
#[cfg(feature = "twin")]
pub mod tracking;
#[cfg(feature = "twin")]
pub mod uart;

#[cfg(feature = "twin")]
use panic_semihosting as _;

#[cfg(not(feature = "twin"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        cortex_m::asm::bkpt();
    }
}
