//! Reads the command line that the emulator passes to the image.

use cortex_m_semihosting::{nr, syscall1};

/// Returns the first argument as a number. `None` if it is missing or not a number.
pub fn seed() -> Option<u64> {
    let mut text = [0_u8; 64];
    let mut block = [text.as_mut_ptr() as usize, text.len()];
    let address = block.as_mut_ptr();
    #[expect(unsafe_code, reason = "the emulator writes through an address")]
    // SAFETY: SYS_GET_CMDLINE takes the address of two words, address and length of a buffer, and writes no further
    // than that buffer and these two words; both live until it returns.
    let status = unsafe { syscall1(nr::GET_CMDLINE, address as usize) };
    let line = core::str::from_utf8(text.get(..*block.get(1)?)?).ok()?;
    if status == 0 { line.split(' ').nth(1)?.parse().ok() } else { None }
}
