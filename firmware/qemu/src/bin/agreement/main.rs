//! Reads the twin of a seed through the driver, corrects the readings, tracks a bias, and counts instructions. Prints
//! everything over semihosting.
//!
//! Lines: `reading RATE TEMP CORRECTED CURVED TABLE F32BITS`, `tracked CHANGEBITS UBITS PHASE`,
//! `ticks NAME LEAST MOST`, `bytes NAME SIZE`.

#![no_std]
#![no_main]

extern crate alloc;

mod bus;
mod counts;

use adis16130::Sampler;
use adis16130::blocking::Adis16130;
use alloc::vec::Vec;
use core::fmt::Write;
use cortex_m_semihosting::debug;
use cortex_m_semihosting::hio::{HostStream, hstdout};
use firmware_qemu::scenario::{self, Reading};
use firmware_qemu::tracking::{self, TrackerState};
use firmware_qemu::{arguments, heap};
use zerorate::track::{Saved, Tracker};

#[cortex_m_rt::entry]
fn main() -> ! {
    let done = hstdout().ok().and_then(run).is_some();
    debug::exit(if done { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::bkpt();
    }
}

/// Returns `None` if something failed. The last printed line shows where.
fn run(mut out: HostStream) -> Option<()> {
    let peripherals = cortex_m::Peripherals::take()?;
    heap::set_up();
    let seed = arguments::seed()?;
    let mut readings = Vec::new();
    let corrections = scenario::run(seed, |reading| readings.push(reading))?;
    for Reading { rate_code, temp_code, corrected_code, curved_code, table_udps, corrected_f32_bits } in &readings {
        let corrected = format_args!("{corrected_code} {curved_code} {table_udps} {corrected_f32_bits}");
        writeln!(out, "reading {rate_code} {temp_code} {corrected}").ok()?;
    }
    let mut all = Vec::new();
    tracking::run(seed, |known| all.push(known))?;
    for TrackerState { change_bits, u_bits, phase } in all {
        writeln!(out, "tracked {} {} {phase}", change_bits as i64, u_bits as i64).ok()?;
    }
    for (name, ticks) in counts::all(&readings, &corrections, seed, peripherals.SYST)? {
        writeln!(out, "ticks {name} {} {}", ticks.least, ticks.most).ok()?;
    }
    writeln!(out, "bytes driver {}", size_of::<Adis16130<(), ()>>()).ok()?;
    writeln!(out, "bytes sampler {}", size_of::<Sampler>()).ok()?;
    writeln!(out, "bytes tracker {}", size_of::<Tracker>()).ok()?;
    writeln!(out, "bytes tracker_saved {}", size_of::<Saved>()).ok()
}
