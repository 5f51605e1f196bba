//! Gyroscopes that are read through drivers of the Linux kernel (Industrial I/O).
//!
//! [`generic`] reads any gyroscope with the scales that its driver states. It reads through the driver's buffer, with
//! timestamps, or else polls. [`adis16130`] polls the ADIS16130, whose codes are known and whose driver has no buffer.

mod adis16130;
mod channel;
mod generic;
mod sysfs;

use crate::Stop;
use crate::address::Address;
use crate::error::{Cause, UserError};
use crate::options::{bandwidth, number, split};
use crate::source::{Sampling, Setup, Source};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use zerorate::Setting;

/// The address of a gyroscope with a kernel driver: `iio:iio:device0`.
#[derive(Clone, Debug, PartialEq)]
pub struct IioAddress {
    /// The device's folder in sysfs.
    pub folder: PathBuf,
    /// Polls per second. If `None`, the device is read through its buffer if it has one, and is else polled.
    pub hz: Option<u32>,
    /// −3 dB bandwidth of the rate, Hz, if it differs from the part's own (F-04).
    pub bandwidth_hz: Option<f64>,
}

const POLL_RANGE_HZ: RangeInclusive<u32> = 1..=10_000;
const DEFAULT_POLL_HZ: u32 = 100;

impl IioAddress {
    /// Parses the text after `iio:`.
    pub fn read(text: &str) -> Result<Self, String> {
        let (name, options) = split(text);
        if name.is_empty() || name.contains('/') {
            return Err("iio: needs the device's name, as in iio:iio:device0 (ls /sys/bus/iio/devices)".to_owned());
        }
        let (mut hz, mut bandwidth_hz) = (None, None);
        for option in options {
            match option.split_once('=') {
                Some(("hz", text)) => hz = Some(number("hz", text, POLL_RANGE_HZ)?),
                _ => {
                    bandwidth_hz = bandwidth(option)?.ok_or_else(|| {
                        format!(
                            "`{option}` is not an option; there are hz=POLLS_PER_SECOND, roa=none|10nf and \
                             bandwidth_hz=HZ (F-04)"
                        )
                    })?;
                }
            }
        }
        Ok(Self { folder: PathBuf::from("/sys/bus/iio/devices").join(name), hz, bandwidth_hz })
    }
}

impl Address for IioAddress {
    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> crate::Result<Box<dyn Source>> {
        if setup.sampling.divider.is_some() {
            let why = "counts edges of data ready, which the kernel driver does not show; poll less often with ?hz=";
            return Err(UserError::request(format!("{} {why}", (setup.names)(Setting::Divider))).into());
        }
        if !self.folder.is_dir() {
            let folder = self.folder.display();
            let words = format!("no {folder}: is its driver bound? see ls /sys/bus/iio/devices");
            return Err(UserError::new(Cause::Missing, words).into());
        }
        match sysfs::read_text(&self.folder, "name")?.as_str() {
            "adis16130" => Ok(Box::new(adis16130::Adis16130::open(self, name, setup)?)),
            driver => Ok(generic::open(self, name, driver, setup, stop)?),
        }
    }
}

struct Polls {
    period: Duration,
    started: Instant,
    /// Index of the next poll.
    next: u32,
    every_temp: u64,
    taken: u64,
}

struct Poll {
    slot: u32,
    /// Number of polls that were skipped because they were overdue.
    lost: u32,
    t_ns: u64,
    /// Whether to read the temperature, too.
    with_temp: bool,
}

impl Polls {
    fn new(hz: u32, sampling: Sampling) -> Self {
        let every_temp = sampling.every_temp.unwrap_or(1).into();
        Self { period: Duration::from_secs(1) / hz, started: Instant::now(), next: 0, every_temp, taken: 0 }
    }

    /// Waits until the next poll is due, and skips polls that are overdue by a period or more.
    fn wait(&mut self) -> Poll {
        let elapsed = self.started.elapsed();
        let slot = match (self.period * self.next).checked_sub(elapsed) {
            Some(early) => {
                std::thread::sleep(early);
                self.next
            }
            None => (elapsed.as_nanos() / self.period.as_nanos()) as u32,
        };
        let lost = slot - self.next;
        self.next = slot + 1;
        let with_temp = self.taken.is_multiple_of(self.every_temp);
        self.taken += 1;
        Poll { slot, lost, t_ns: self.started.elapsed().as_nanos() as u64, with_temp }
    }
}
