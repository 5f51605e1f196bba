//! Samples out of a device, one after the other: paced to the wall clock if wanted, ended by Ctrl-C, counted.

use crate::cli::{DeviceArgs, SamplingArgs};
use crate::commands::coded;
use crate::device::Device;
use crate::interrupt;
use adis16130::Sample;
use anyhow::Result;
use std::time::{Duration, Instant};
use zerorate::health::{Health, Judged};
use zerorate::{Axis, Reading, Tally, Warning, resonance};
use zerorate_data::believed;
use zerorate_data::capture::admission::Admission;

/// A device that is being read.
pub struct Acquisition {
    device: Device,
    pace: Option<Pace>,
    admission: Admission,
    tally: Tally,
    health: Health,
    axis: Axis,
    start_ns: Option<u64>,
}

impl Acquisition {
    /// Opens the device and, from here on, takes Ctrl-C as the wish to end cleanly.
    pub fn open(device: &DeviceArgs, sampling: SamplingArgs) -> Result<Self> {
        interrupt::listen();
        let opened = Device::open(&device.device, sampling)?;
        let pace = (device.realtime && !opened.is_real()).then(Pace::default);
        Ok(Self { pace, ..Self::unpaced(opened) })
    }

    /// Over a device that is open already, as fast as it goes. Ctrl-C stays what it was.
    pub fn unpaced(device: Device) -> Self {
        let axis = device.info(None, None).axis();
        let (admission, tally, health) = (Admission::default(), Tally::default(), Health::new(&axis));
        Self { device, pace: None, admission, tally, health, axis, start_ns: None }
    }

    /// The device itself.
    pub fn device(&mut self) -> &mut Device {
        &mut self.device
    }

    /// What was read so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// The next sample; `None` at the end of a replay or after Ctrl-C ([`interrupt::asked`] tells which).
    #[inline]
    pub fn next(&mut self) -> Result<Option<Sample>> {
        if interrupt::asked() {
            return Ok(None);
        }
        let sample = self.next_admitted()?;
        if let Some(sample) = &sample {
            self.tally.count(&sample.into());
            self.start_ns.get_or_insert(sample.t_ns);
            if let Some(pace) = &mut self.pace {
                pace.keep(sample.t_ns);
            }
        }
        Ok(sample)
    }

    /// The next sample with what is wrong with it, two samples late; at the end, those that are left.
    #[inline]
    pub fn next_judged(&mut self) -> Result<Option<Judged>> {
        loop {
            let judged = match self.next()? {
                Some(sample) => self.health.push(&Reading::from(&sample)),
                None => return Ok(self.health.finish()),
            };
            if judged.is_some() {
                return Ok(judged);
            }
        }
    }

    /// Judges a sample that goes on as it is.
    #[inline]
    pub fn judge(&mut self, sample: &Sample) {
        self.health.push(&sample.into());
    }

    /// The axis that is read.
    pub fn axis(&self) -> &Axis {
        &self.axis
    }

    /// What was found of the samples that were judged.
    pub fn health(&self) -> &Health {
        &self.health
    }

    /// Time of the first sample.
    pub fn start_ns(&self) -> u64 {
        self.start_ns.unwrap_or_default()
    }

    /// What there is to say of the samples: all of them are judged then.
    pub fn warnings(&mut self) -> Vec<String> {
        while self.health.finish().is_some() {}
        let found = believed::warnings(&self.health, &self.tally, self.start_ns());
        let of_the_rate = aliasing(&self.axis, &self.tally).into_iter().chain(self.resonance(SHORTEST_AVERAGE_S));
        let of_the_rate = of_the_rate.map(|warning| coded(&warning));
        of_the_rate.chain(found).chain(self.lost_on_the_way()).collect()
    }

    /// F-07: whether the resonance looks like a bias at the rate that was measured, in means over `average_s`.
    pub fn resonance(&self, average_s: f64) -> Option<Warning> {
        let edges = self.device.info(None, None).edges_per_reading();
        let rate_hz = self.tally.sampling_hz();
        (self.tally.samples > 1).then(|| resonance::warning(&self.axis, rate_hz, edges, average_s)).flatten()
    }

    /// The next sample that may stand in a capture.
    #[inline]
    fn next_admitted(&mut self) -> Result<Option<Sample>> {
        while let Some(sample) = self.device.next()? {
            if let Some(admitted) = self.admission.admit(sample)? {
                return Ok(Some(admitted));
            }
        }
        Ok(None)
    }

    /// Whether progress is to be shown with this sample: with every 4096th, 1.4 times a second of part time.
    #[inline]
    pub fn is_time_to_show(&self) -> bool {
        self.tally.samples.is_multiple_of(4096)
    }

    /// Whether the samples come at the speed of the wall clock.
    pub fn is_paced(&self) -> bool {
        self.pace.is_some() || self.device.is_real()
    }

    /// What is to be said of samples that were read, but lost before they came here.
    pub fn lost_on_the_way(&self) -> Vec<String> {
        let (samples, frames) = (self.device.overflowed(), self.device.damaged());
        let overflow = (samples > 0).then(|| {
            format!(
                "queue-overflow: {samples} samples were read but lost, since the disk or the processor was too \
                slow for them; they are counted as lost"
            )
        });
        let damage = (frames > 0).then(|| {
            format!(
                "damaged-frames: {frames} frames of the bridge were damaged on the way, and their samples are \
                counted as lost; check its cable, or lower the baud rate"
            )
        });
        overflow.into_iter().chain(damage).chain(self.admission.warnings()).collect()
    }
}

/// Means over this are what a recording is good for at least, s.
const SHORTEST_AVERAGE_S: f64 = 1.0;

/// F-56: samples alias when they come below twice the bandwidth.
pub fn aliasing(axis: &Axis, tally: &Tally) -> Option<Warning> {
    let (rate_hz, needed_hz) = (tally.rate_hz(), 2.0 * axis.bandwidth_hz?);
    (tally.samples > 1 && rate_hz < needed_hz).then_some(Warning::Aliased { rate_hz, needed_hz })
}

/// Keeps part time from running ahead of the wall clock; looks at the clock once per [`PACE_NS`] of part time.
#[derive(Default)]
struct Pace {
    started: Option<(Instant, u64)>,
    due_ns: u64,
}

impl Pace {
    #[inline]
    fn keep(&mut self, t_ns: u64) {
        if t_ns >= self.due_ns {
            self.wait(t_ns);
        }
    }

    fn wait(&mut self, t_ns: u64) {
        let (wall, part_ns) = *self.started.get_or_insert_with(|| (Instant::now(), t_ns));
        let target = Duration::from_nanos(t_ns.saturating_sub(part_ns));
        while let Some(early) = target.checked_sub(wall.elapsed()).filter(|d| !d.is_zero()) {
            if interrupt::asked() {
                break;
            }
            std::thread::sleep(early.min(LONGEST_SLEEP));
        }
        self.due_ns = t_ns + PACE_NS;
    }
}

const PACE_NS: u64 = 10_000_000;
/// Ctrl-C is heeded at least this often.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);
