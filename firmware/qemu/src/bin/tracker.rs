//! The smallest image with the tracker: it begins, takes means, is saved and is resumed.

#![no_std]
#![no_main]

#[cfg(not(feature = "twin"))]
use embedded_alloc::LlffHeap;
use firmware_qemu::bare::{edge, put};
use zerorate::track::{Prior, Tracker, TrackerConfig};
use zerorate::{Axis, Correction};

/// The crate `zerorate` needs an allocator to link. This allocator never gets memory. Since nothing allocates, the
/// linker leaves it out of the image. The images with the twin have a real allocator.
#[cfg(not(feature = "twin"))]
#[global_allocator]
static NO_HEAP: LlffHeap = LlffHeap::empty();

#[cortex_m_rt::entry]
fn main() -> ! {
    let correction = Correction::line(number(), number(), number());
    let prior = Prior { u_pbc_dps: number(), u_btc_dps_per_c: number(), ..Prior::default() };
    let config = TrackerConfig::of(&Axis::ADIS16130, correction, prior);
    let mut tracker = Tracker::new(config).aged(number());
    loop {
        let phase = tracker.push(Some(number()), Some(number()), true);
        let tracked = tracker.tracked(number());
        put(&tracked.change_dps.to_le_bytes(), phase as u32);
        put(&tracked.u_dps.to_le_bytes(), 0);
        let saved = tracker.save();
        saved.filter.state.iter().chain(&saved.filter.covariance).for_each(|number| put(&number.to_le_bytes(), 0));
        if let Ok(resumed) = Tracker::resume(config, &saved, number()) {
            tracker = resumed;
        }
    }
}

/// A value that the compiler cannot know.
fn number() -> f64 {
    f64::from_bits(edge().0)
}
