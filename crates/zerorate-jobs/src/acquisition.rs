//! Reads all samples of a device in order, counts them and flags faulty readings.

use crate::judged::JudgedAxis;
use crate::warning::JobWarning;
use adis16130::SelfTest;
use adis16130_twin::Truth;
use anyhow::{Result, bail};
use std::sync::Arc;
use zerorate::calibration::Notes;
use zerorate::health::{Frozen, Health, Judged, resonance};
use zerorate::{Axis, Part, SettingNames, Tally, Warning};
use zerorate_host::{
    Batch, Bus, DeviceInfo, DeviceSpec, Hub, Losses, LosslessReader, Pace, Setup, SourceWarning, Stop,
};
use zerorate_record::{CaptureInfo, CaptureWarning, Layout, Row, valid};
use zerorate_view::SessionWarning;

/// Receives the warnings of a device while the device is read.
pub type WarningSink = Box<dyn FnMut(&SourceWarning)>;

/// A device that is being read.
pub struct Acquisition {
    hub: Hub,
    everything: LosslessReader,
    pace: Pace,
    on_warning: WarningSink,
    /// The samples that were read last; `None` before the first request.
    batch: Option<Arc<Batch>>,
    taken: usize,
    marks_ns: Vec<u64>,
    losses: Losses,
    doubts: Vec<CaptureWarning>,
    tally: Tally,
    layout: Layout,
    axes: Vec<JudgedAxis>,
    start_ns: Option<u64>,
    is_recording: bool,
}

impl Acquisition {
    /// Opens the device. Its samples can then be read until they end or `stop` is requested. `on_warning` receives the
    /// warnings of the device.
    ///
    /// # Errors
    /// Returns an error if the device cannot be opened.
    pub fn open(device: &DeviceSpec, setup: Setup, pace: Pace, stop: &Stop, on_warning: WarningSink) -> Result<Self> {
        let hub = Hub::open(device, setup, stop)?;
        let everything = hub.everything();
        let DeviceInfo { info, part, .. } = hub.facts();
        let (layout, axes) = (info.layout.clone(), part.axes.iter().map(JudgedAxis::new).collect());
        Ok(Self {
            hub,
            everything,
            pace,
            on_warning,
            batch: None,
            taken: 0,
            marks_ns: Vec::new(),
            losses: Losses::default(),
            doubts: Vec::new(),
            tally: Tally::default(),
            layout,
            axes,
            start_ns: None,
            is_recording: device.file().is_some(),
        })
    }

    /// True if a recording is read. A recording has no bus to test.
    pub fn is_recording(&self) -> bool {
        self.is_recording
    }

    /// The part, its settings, and the description of the capture.
    pub fn facts(&self) -> &DeviceInfo {
        self.hub.facts()
    }

    /// The description of the capture. `notes` replace recorded notes. `serial` must equal a recorded serial number.
    ///
    /// # Errors
    /// Returns an error if the recording states another serial number.
    pub fn info(&self, serial: Option<&str>, notes: &Notes) -> Result<CaptureInfo> {
        self.check_serial(serial)?;
        let mut info = self.facts().info.clone();
        info.serial = serial.map(str::to_owned).or(info.serial);
        info.notes = notes.clone().or(info.notes);
        Ok(info)
    }

    /// Refuses a recording whose serial number differs from `serial`.
    ///
    /// # Errors
    /// Returns an error if both serial numbers are known and differ.
    pub fn check_serial(&self, serial: Option<&str>) -> Result<()> {
        match (serial, self.facts().info.serial.as_deref()) {
            (Some(given), Some(recorded)) if given != recorded => {
                bail!("the recording is of part {recorded}, not of part {given}; leave the serial number out")
            }
            _ => Ok(()),
        }
    }

    /// Resets and configures the part. Returns its revision; `None` if unknown, as for a recording or kernel driver.
    pub fn initialise(&self) -> Result<Option<u8>> {
        Ok(self.hub.with(|source| source.initialise())?)
    }

    /// Tests the bus and leaves the part configured; `None` without a bus. Call this before the first sample.
    pub fn try_bus(&self) -> Result<Option<Bus>> {
        Ok(self.hub.with(|source| source.try_bus())?)
    }

    /// Measures the change of the rate under self-test (F-11), which the line `gpio` activates. Call this before the
    /// first sample. Error messages use `names` for the settings.
    pub fn self_test(&self, gpio: &str, names: SettingNames) -> Result<SelfTest> {
        let gpio = gpio.to_owned();
        Ok(self.hub.with(move |source| source.self_test(&gpio, names))?)
    }

    /// Requests the true state of a simulated sensor at the first sample that is `after_ns` or more after the start.
    /// Call this before the first sample.
    pub fn mark(&mut self, after_ns: u64) {
        self.marks_ns.push(after_ns);
    }

    /// The twin's true state of each axis at the last returned sample; empty unless `mark` requested it.
    pub fn truths(&self) -> Vec<Truth> {
        let last = self.batch.as_ref().filter(|batch| batch.rows.len() == self.taken);
        last.map_or_else(Vec::new, |batch| batch.truths.clone())
    }

    /// Totals of the samples that were read so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Returns the next sample, or `None` at the end of a recording or after a stop.
    #[inline]
    pub fn next_row(&mut self) -> Result<Option<Row>> {
        if self.is_stopped() {
            return Ok(None);
        }
        loop {
            if let Some(row) = self.batch.as_ref().and_then(|batch| batch.rows.get(self.taken)) {
                self.taken += 1;
                if let Some(first) = self.layout.reading(row, 0) {
                    self.tally.count(&first);
                }
                self.start_ns.get_or_insert(row.t_ns);
                return Ok(Some(*row));
            }
            if !self.next_batch()? {
                return Ok(None);
            }
        }
    }

    fn next_batch(&mut self) -> Result<bool> {
        if self.batch.is_none() {
            self.hub.read(self.pace, std::mem::take(&mut self.marks_ns))?;
        }
        let Some(batch) = self.everything.next()? else { return Ok(false) };
        batch.notes.iter().for_each(|note| (self.on_warning)(note));
        (self.losses, self.taken) = (batch.losses, 0);
        self.doubts.clone_from(&batch.doubts);
        self.batch = Some(batch);
        Ok(true)
    }

    /// Puts the next reading of each axis, with its fault flags, into `judged`. Readings come two samples late,
    /// because the samples after a reading help to judge it. Returns false after the last reading.
    #[inline]
    pub fn next_judged(&mut self, judged: &mut Vec<Judged>) -> Result<bool> {
        judged.clear();
        while self.axes.iter().any(|axis| axis.judged.is_empty()) {
            match self.next_row()? {
                Some(row) => self.judge(&row, true),
                None => {
                    for axis in &mut self.axes {
                        axis.judged.extend(axis.health.finish());
                    }
                    break;
                }
            }
        }
        judged.extend(self.axes.iter_mut().filter_map(|axis| axis.judged.pop_front()));
        Ok(judged.len() == self.axes.len())
    }

    /// Checks the reading of each axis. With `keep`, the checked readings are queued for `next_judged`.
    #[inline]
    fn judge(&mut self, row: &Row, keep: bool) {
        for (index, axis) in self.axes.iter_mut().enumerate() {
            let judged = self.layout.reading(row, index).and_then(|reading| axis.health.push(&reading));
            axis.judged.extend(judged.filter(|_| keep));
        }
    }

    /// Checks a sample without queuing it for `next_judged`, for callers that use the sample without its fault flags.
    #[inline]
    pub fn look_at(&mut self, row: &Row) {
        self.judge(row, false);
    }

    /// The part that is read, with its current settings.
    pub fn part(&self) -> &Part {
        &self.facts().part
    }

    /// The checks of each axis, with the numbers of faulty readings so far.
    pub fn healths(&self) -> impl Iterator<Item = &Health> {
        self.axes.iter().map(|axis| &axis.health)
    }

    /// The frozen readings of the first axis whose last readings do not change; `None` if there is none. At the end
    /// of the samples, a shorter time without change is enough than for [`Acquisition::frozen`].
    pub fn frozen_at_end(&self) -> Option<Frozen> {
        self.healths().find_map(Health::frozen_at_end)
    }

    /// The frozen readings of the first axis that is frozen now; `None` if no axis is frozen.
    pub fn frozen(&self) -> Option<Frozen> {
        self.healths().find_map(Health::frozen)
    }

    /// Time of the first sample, ns; 0 before the first sample.
    pub fn start_ns(&self) -> u64 {
        self.start_ns.unwrap_or_default()
    }

    /// The warnings about all samples so far. First completes the checks of the last samples.
    pub fn warnings(&mut self) -> Vec<JobWarning> {
        for axis in &mut self.axes {
            while axis.health.finish().is_some() {}
        }
        let aliased = self.axes.first().and_then(|first| aliasing(&first.axis, &self.tally));
        let of_the_rate = aliased.into_iter().chain(self.resonance(SHORTEST_AVERAGE_S));
        let on_the_way = lost_on_the_way(self.losses).chain(self.doubts.iter().cloned().map(JobWarning::Readings));
        of_the_rate.map(JobWarning::from).chain(self.disbelief()).chain(on_the_way).collect()
    }

    /// The warnings about readings that cannot be trusted.
    pub fn disbelief(&self) -> impl Iterator<Item = JobWarning> + use<> {
        let axes = self.axes.iter().map(|axis| (axis.name.as_str(), &axis.health));
        valid::of_axes(axes, &self.tally, self.start_ns()).into_iter().map(JobWarning::Readings)
    }

    /// Returns a warning if the resonance aliases to a frequency so low that it looks like a bias in means over
    /// `average_s` seconds (F-07). The check uses the measured sampling rate.
    pub fn resonance(&self, average_s: f64) -> Option<Warning> {
        let edges = self.facts().info.edges_per_reading();
        let rate_hz = self.tally.sampling_hz();
        let first = self.axes.first().filter(|_| self.tally.samples > 1)?;
        resonance::warning(&first.axis, rate_hz, edges, average_s)
    }

    /// True for every 4096th sample, 1.4 times a second for an ADIS16130. Progress is then shown.
    #[inline]
    pub fn is_time_to_show(&self) -> bool {
        self.tally.samples.is_multiple_of(4096)
    }

    /// True if a stop was requested.
    pub fn is_stopped(&self) -> bool {
        self.hub.stop().asked()
    }

    /// True if the samples come at the speed of the wall clock.
    pub fn is_paced(&self) -> bool {
        self.pace == Pace::RealTime || self.facts().is_real
    }
}

/// Averaging time that the warning about an aliased resonance assumes, s.
const SHORTEST_AVERAGE_S: f64 = 1.0;

/// Returns a warning if the sampling rate is below twice the bandwidth of the axis, so that motion aliases (F-56).
pub fn aliasing(axis: &Axis, tally: &Tally) -> Option<Warning> {
    let (rate_hz, needed_hz) = (tally.rate_hz(), 2.0 * axis.bandwidth_hz?);
    (tally.samples > 1 && rate_hz < needed_hz).then_some(Warning::Aliased { rate_hz, needed_hz })
}

/// The warnings about samples that were read from the device but lost before they arrived here.
pub fn lost_on_the_way(losses: Losses) -> impl Iterator<Item = JobWarning> {
    let Losses { overflowed, damaged } = losses;
    let overflow = (overflowed > 0).then_some(JobWarning::Overflowed(overflowed));
    overflow.into_iter().chain((damaged > 0).then(|| SessionWarning::Damaged(damaged).into()))
}
