//! Encodes frames: the changes for all windows, or everything for one window (docs/formats/page.md).

use super::axis::AxisState;
use super::live_view::{LiveView, ViewChanges};
use super::notices::NoticeText;
use super::statistics::Statistics;
use super::{Session, SessionChanges, strips};
use crate::message::{AxisAbout, Device, Durations, Frame, Now, SampleCounts};
use zerorate::health::Health;
use zerorate::{Calibration, Plan};
use zerorate_record::valid;

impl Session {
    /// The frame with all changes since the last one, for all windows; `None` if nothing changed.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        self.recompute();
        let SessionChanges { statistics, calibration, calibrations } = self.changed;
        if !(statistics || calibration || calibrations || self.live_view.is_changed()) {
            return None;
        }
        let (frame, payload) = self.live_view.news(self.store.applied());
        let changed = std::mem::take(&mut self.changed);
        Some(encode(&self.completed(frame, changed), &payload))
    }

    /// A complete frame, for a window that was just opened or was too slow.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        let (frame, payload) = self.live_view.everything(self.store.applied());
        encode(&self.completed(frame, SessionChanges::default()), &payload)
    }

    /// Updates statistics, conditions and guided calibration. This takes too long to be done with each reading.
    fn recompute(&mut self) {
        if !self.live_view.changed.readings {
            return;
        }
        let rate_hz = self.live_view.tally.sampling_hz();
        for statistics in &mut self.statistics {
            self.changed.statistics |= statistics.refresh(rate_hz);
        }
        if self.changed.statistics {
            let axes = self.live_view.axes.iter().map(|axis| (axis.name.as_str(), &axis.health));
            let findings = valid::of_axes(axes, &self.live_view.tally, self.live_view.start_ns());
            self.live_view.set_conditions(&findings.iter().map(NoticeText::from).collect::<Vec<_>>());
        }
        if let Some(guided) = &self.guided {
            self.calibrating = guided.shown();
        }
    }

    fn completed(&self, seen: Frame, changed: SessionChanges) -> Frame {
        let all = seen.snapshot;
        Frame {
            statistics: (all || changed.statistics)
                .then(|| self.statistics.iter().map(|one| one.shown.clone()).collect()),
            calibration: (all || changed.calibration).then(|| self.calibrating.clone()),
            calibrations: (all || changed.calibrations).then(|| self.store.entries()),
            ..seen
        }
    }

    pub(super) fn restart_statistics(&mut self) {
        self.statistics = self.live_view.axes.iter().map(|axis| Statistics::new(&axis.axis)).collect();
        self.changed.statistics = true;
    }
}

impl LiveView {
    pub fn is_changed(&self) -> bool {
        let ViewChanges { device, readings, notices, everything } = self.changed;
        device || readings || notices || everything
    }

    /// The frame of all changes since the last call, with a new number.
    pub fn news(&mut self, applied: Option<&Calibration>) -> (Frame, Vec<f32>) {
        self.seq += 1;
        let changed = std::mem::take(&mut self.changed);
        let news = self.told(changed, applied);
        self.axes.iter_mut().for_each(|axis| axis.strips.mark_given());
        news
    }

    pub fn everything(&self, applied: Option<&Calibration>) -> (Frame, Vec<f32>) {
        self.told(ViewChanges { everything: true, ..ViewChanges::default() }, applied)
    }

    fn told(&self, changed: ViewChanges, applied: Option<&Calibration>) -> (Frame, Vec<f32>) {
        let all = changed.everything;
        let (mut strips, mut payload) = (Vec::new(), Vec::new());
        for (index, axis) in self.axes.iter().enumerate() {
            axis.strips.give(index as u32, all, &mut strips, &mut payload);
        }
        let frame = Frame {
            seq: self.seq,
            snapshot: all,
            strips,
            device: (all || changed.device).then(|| self.device()),
            now: (all || changed.readings).then(|| self.now(applied)),
            ledger: (all || changed.readings).then(|| self.ledger()),
            notices: (all || changed.notices).then(|| self.notices.all()),
            ..Frame::default()
        };
        (frame, payload)
    }

    fn device(&self) -> Device {
        let about = &self.about;
        let of_axis = |axis: &AxisState| AxisAbout {
            name: axis.name.clone(),
            range_dps: axis.axis.range_dps,
            bandwidth_hz: about.info.bandwidth_hz.or(axis.axis.bandwidth_hz),
            resonance_hz: axis.axis.resonance.map(|tone| tone.hz),
        };
        let plan = Plan::default();
        Device {
            name: about.name.clone(),
            state: self.state.clone(),
            simulated: about.simulated,
            speed: self.speed,
            part: about.part.name.to_string(),
            axes: self.axes.iter().map(of_axis).collect(),
            bins_s: strips::bins_s().collect(),
            bins_kept: strips::KEPT as u32,
            nominal_hz: about.nominal_hz,
            registers: about.registers.clone(),
            checks: about.checks.clone(),
            durations: Durations {
                average_s: plan.average_s,
                warmup_s: plan.warmup_s,
                settle_s: plan.settle_s,
                offset_s: plan.offset_s,
            },
            software: zerorate::SOFTWARE.to_owned(),
        }
    }

    fn now(&self, applied: Option<&Calibration>) -> Now {
        let extrapolated = self.corrector.as_ref().is_some_and(|corrector| corrector.is_extrapolated());
        let now = |axis: &AxisState| axis.now(applied, extrapolated);
        Now { t_s: self.now_s(), temp_c: self.temp_c(), axes: self.axes.iter().map(now).collect() }
    }

    fn ledger(&self) -> SampleCounts {
        let start_ns = self.start_ns();
        let since_s = |t_ns: u64| t_ns.saturating_sub(start_ns) as f64 * 1e-9;
        let sum = |count: fn(&Health) -> u64| self.axes.iter().map(|axis| count(&axis.health)).sum();
        SampleCounts {
            samples: self.tally.samples,
            lost: self.tally.lost,
            missed: self.missed,
            impossible: sum(|health| health.fault_counts().impossible),
            out_of_range: sum(|health| health.fault_counts().out_of_range),
            rate_hz: self.tally.rate_hz(),
            rdy_hz: self.tally.rdy_hz(),
            frozen_since_s: self.axes.iter().find_map(|axis| axis.health.frozen()).map(|one| since_s(one.since_ns)),
            duration_s: self.tally.duration_s(),
        }
    }
}

/// Encodes a frame: the length of the header, the header as JSON, zeros for alignment, and the payload.
pub fn encode(frame: &Frame, payload: &[f32]) -> Vec<u8> {
    // numbers, texts and lists always serialise; NaN becomes null
    let header = serde_json::to_vec(frame).unwrap_or_default();
    let padded = (4 + header.len()).next_multiple_of(4);
    let mut bytes = Vec::with_capacity(padded + 4 * payload.len());
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(&header);
    bytes.resize(padded, 0);
    payload.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}
