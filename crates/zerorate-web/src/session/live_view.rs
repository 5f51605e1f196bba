//! The live view of a device: plots over time (strips), newest values, rest, sample counts, connection checks.

use super::About;
use super::axis::{Angle, AxisState, BLOCK_NS, Block};
use super::checkup::Examination;
use super::notices::{NoticeText, Notices};
use crate::message::{CheckResult, DeviceState};
use zerorate::{Correction, Corrector, Reading, Tally};
use zerorate_record::{Layout, Row};

#[derive(Debug)]
pub struct LiveView {
    pub about: About,
    pub axes: Vec<AxisState>,
    pub(super) corrector: Option<Corrector<Vec<Correction>>>,
    pub tally: Tally,
    pub notices: Notices,
    pub(super) state: DeviceState,
    pub(super) speed: f64,
    pub(super) missed: u64,
    pub(super) seq: u32,
    pub(super) changed: ViewChanges,
    pub layout: Layout,
    /// The check of the first seconds; `None` when it is complete.
    examination: Option<Examination>,
    start_ns: Option<u64>,
    last_ns: u64,
    block_ends_ns: u64,
}

/// The parts of the view that changed since the last frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ViewChanges {
    pub device: bool,
    pub readings: bool,
    pub notices: bool,
    pub everything: bool,
}

pub trait ReadingObserver {
    /// Receives a reading of an axis; `None` if it was lost or invalid.
    fn reading(&mut self, axis: usize, code: Option<i32>);

    fn block(&mut self, axis: usize, block: &Block, at_rest: bool);
}

impl ReadingObserver for () {
    fn reading(&mut self, _: usize, _: Option<i32>) {}

    fn block(&mut self, _: usize, _: &Block, _: bool) {}
}

/// Largest number of missing readings that are reported to the observer at a gap.
const MOST_FILLED: u32 = 100_000;
/// Largest number of blocks that are closed at a gap: one hour.
const MOST_BLOCKS: u64 = 36_000;

impl LiveView {
    pub fn new(about: About) -> Self {
        let axes: Vec<AxisState> = about.part.axes.iter().map(AxisState::new).collect();
        Self {
            state: DeviceState::Opening,
            speed: 1.0,
            layout: about.info.layout.clone(),
            examination: Some(Examination::new(axes.len(), about.nominal_hz)),
            axes,
            corrector: None,
            tally: Tally::default(),
            missed: 0,
            notices: Notices::default(),
            start_ns: None,
            last_ns: 0,
            block_ends_ns: BLOCK_NS,
            seq: 0,
            changed: ViewChanges { everything: true, ..ViewChanges::default() },
            about,
        }
    }

    pub fn reopened(&self, about: About) -> Self {
        Self { speed: self.speed, seq: self.seq, ..Self::new(about) }
    }

    /// Adds a row; rows must be in order of time. Returns whether any blocks ended before it.
    #[inline]
    pub fn take(&mut self, row: &Row, observer: &mut impl ReadingObserver) -> bool {
        let start_ns = *self.start_ns.get_or_insert(row.t_ns);
        let at_ns = row.t_ns.saturating_sub(start_ns);
        let ends_blocks = at_ns >= self.block_ends_ns;
        if ends_blocks {
            self.close_blocks(at_ns, observer);
        }
        self.last_ns = at_ns;
        let scan = self.layout.scan(row);
        if let Some(first) = scan.reading(0) {
            self.tally.count(&first);
        }
        for index in 0..self.axes.len() {
            if let Some(reading) = scan.reading(index) {
                self.take_axis(index, at_ns, &reading, observer);
            }
        }
        self.changed.readings = true;
        ends_blocks
    }

    #[inline]
    fn take_axis(&mut self, index: usize, at_ns: u64, reading: &Reading, observer: &mut impl ReadingObserver) {
        let corrector = self.corrector.as_ref();
        let correct = |rate_dps| corrector.and_then(|corrector| corrector.correct(index, Some(rate_dps)));
        let judged = self.axes[index].show(at_ns, reading, correct);
        for _ in 0..reading.lost.min(MOST_FILLED) {
            observer.reading(index, None);
        }
        let Some(judged) = judged else { return };
        observer.reading(index, judged.rate());
        if let Some(examination) = &mut self.examination {
            examination.push(index, &judged);
        }
        let axis = &mut self.axes[index];
        let corrected_dps = self.corrector.as_mut().and_then(|corrector| {
            if let Some(temp) = judged.temp() {
                corrector.read(Some(axis.axis.temp.value(temp.into())));
            }
            corrector.correct(index, judged.rate().map(|rate| axis.axis.rate.value(rate.into())))
        });
        axis.count(&judged, corrected_dps);
    }

    /// Changes the correction. The angle restarts, because it must not mix two corrections.
    pub fn correct(&mut self, corrector: Option<Corrector<Vec<Correction>>>) {
        self.corrector = corrector;
        self.axes.iter_mut().for_each(|axis| axis.angle = Angle::default());
    }

    #[cold]
    fn close_blocks(&mut self, at_ns: u64, observer: &mut impl ReadingObserver) {
        let over = (at_ns - self.block_ends_ns) / BLOCK_NS + 1;
        self.block_ends_ns += over * BLOCK_NS;
        for _ in 0..over.min(MOST_BLOCKS) {
            for (index, axis) in self.axes.iter_mut().enumerate() {
                let block = axis.close_block();
                observer.block(index, &block, axis.is_at_rest());
            }
        }
        let start_ns = self.start_ns();
        let ended = self.examination.as_ref().and_then(|one| one.ended(&self.axes, &self.tally, start_ns));
        if let Some(checks) = ended {
            self.examination = None;
            self.checked(checks);
        }
    }

    pub fn state(&mut self, state: DeviceState) {
        self.state = state;
        self.changed.device = true;
    }

    pub fn note(&mut self, text: &NoticeText) {
        self.notices.push(text, self.now_s());
        self.changed.notices = true;
    }

    pub fn set_conditions(&mut self, findings: &[NoticeText]) {
        self.changed.notices |= self.notices.set_conditions(findings, self.now_s());
    }

    pub fn checked(&mut self, checks: impl IntoIterator<Item = CheckResult>) {
        self.about.checks.extend(checks);
        self.changed.device = true;
    }

    /// Time of the first reading, ns; 0 before it.
    pub fn start_ns(&self) -> u64 {
        self.start_ns.unwrap_or_default()
    }

    /// Time of the newest reading since the first, s.
    pub fn now_s(&self) -> f64 {
        self.last_ns as f64 * 1e-9
    }

    /// Mean temperature over the last second, °C; `None` if unknown.
    pub fn temp_c(&self) -> Option<f64> {
        self.axes.first().and_then(AxisState::temp_c)
    }
}
