//! A session: one device, everything that is known of it, and everybody who looks at it.

mod ask;
mod axis;
mod checkup;
mod frame;
mod guide;
mod notices;
mod shelf;
mod statistics;
mod strips;

use crate::message::{Calibrating, CheckResult, DeviceState, Register};
use adis16130_twin::Truth;
use axis::{AxisState, BLOCK_NS};
use checkup::Examination;
use guide::Guide;
use notices::Notices;
use shelf::Shelf;
use statistics::Statistics;
use zerorate::{Calibration, Correction, Corrector, Part, Reading, Tally};
use zerorate_data::capture::{CaptureInfo, Layout, Row};

/// What is being read.
#[derive(Clone, Debug)]
pub struct About {
    /// As `--device` names it.
    pub name: String,
    /// How the samples are taken.
    pub info: CaptureInfo,
    /// What is known of the part.
    pub part: Part,
    /// Its time is simulated, or recorded.
    pub simulated: bool,
    /// How often it should convert, Hz, if that is known.
    pub nominal_hz: Option<f64>,
    /// Its registers when it was opened.
    pub registers: Vec<Register>,
    /// What the check of the connection found.
    pub checks: Vec<CheckResult>,
}

/// What became of a request.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// The answer, as text.
    Answer(String),
    /// Whoever owns the device does this, and [`Session::done`] makes the answer of how it went.
    Host {
        /// Of the request.
        id: u32,
        /// What to do.
        wish: HostWish,
    },
}

/// What only the owner of the device can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HostWish {
    /// Let simulated time go so many times as fast as the clock; 0: as fast as it can.
    Speed(f64),
    /// Open the device again, from a reset on: [`Session::reopened`].
    Reopen,
}

/// Readings and requests in, frames and answers out.
///
/// ```
/// use adis16130::Width;
/// use zerorate::Part;
/// use zerorate_data::capture::{CaptureInfo, Layout, Row};
/// use zerorate_web::session::{About, Asked, Session};
/// let part = Part::ADIS16130;
/// let info = CaptureInfo::new(Layout::adis16130(Width::Bits24));
/// let mut session = Session::new(About {
///     name: "twin:".into(), info, part, simulated: true, nominal_hz: None, registers: vec![], checks: vec![],
/// });
/// for k in 0..1000u32 {
///     session.take(&Row::new(u64::from(k) * 1_000_000, k, &[8_388_608 + 23_488]).unwrap());
/// }
/// let frame = session.frame().expect("there is something new");
/// assert!(String::from_utf8_lossy(&frame).contains("\"samples\":1000"));
/// let asked = session.ask(r#"{"id": 1, "do": "zero-angle"}"#);
/// assert_eq!(asked, Asked::Answer(r#"{"id":1,"ok":{}}"#.into()));
/// ```
#[derive(Debug)]
pub struct Session {
    about: About,
    state: DeviceState,
    speed: f64,
    layout: Layout,
    axes: Vec<AxisState>,
    statistics: Vec<Statistics>,
    /// Of the first seconds, until they are over.
    examination: Option<Examination>,
    corrector: Option<Corrector<Vec<Correction>>>,
    shelf: Shelf,
    calibrating: Calibrating,
    guide: Option<Guide>,
    /// What begins with the next reading, after the device was opened again.
    wanted: Option<Guide>,
    truths: Vec<Truth>,
    tally: Tally,
    missed: u64,
    notices: Notices,
    start_ns: Option<u64>,
    last_ns: u64,
    block_ends_ns: u64,
    seq: u32,
    changed: Changed,
}

/// What the next frame must state.
#[derive(Clone, Copy, Debug, Default)]
struct Changed {
    device: bool,
    readings: bool,
    notices: bool,
    statistics: bool,
    calibration: bool,
    calibrations: bool,
    everything: bool,
}

impl Session {
    /// Of a device that was just opened.
    #[must_use]
    pub fn new(about: About) -> Self {
        let layout = about.info.layout.clone();
        let axes: Vec<AxisState> = about.part.axes.iter().map(AxisState::new).collect();
        Self {
            state: DeviceState::Opening,
            speed: 1.0,
            layout,
            statistics: axes.iter().map(|axis| Statistics::new(&axis.axis)).collect(),
            examination: Some(Examination::new(axes.len(), about.nominal_hz)),
            axes,
            corrector: None,
            shelf: Shelf::default(),
            calibrating: Calibrating::Idle,
            guide: None,
            wanted: None,
            truths: Vec::new(),
            tally: Tally::default(),
            missed: 0,
            notices: Notices::default(),
            start_ns: None,
            last_ns: 0,
            block_ends_ns: BLOCK_NS,
            seq: 0,
            changed: Changed { everything: true, ..Changed::default() },
            about,
        }
    }

    /// Of the same device, opened again: everything begins anew, but calibrations stay on file, and the calibration
    /// that was asked for begins.
    #[must_use]
    pub fn reopened(self, about: About) -> Self {
        let Self { speed, shelf, calibrating, wanted, seq, .. } = self;
        let mut anew = Self { speed, shelf, calibrating, seq, ..Self::new(about) };
        let applied = anew.shelf.applied().map(Calibration::id);
        // another part than before may not bear it
        let _ = anew.apply(applied.as_deref());
        if anew.guide.is_none() && matches!(anew.calibrating, Calibrating::Running(_)) {
            anew.guide = wanted;
        }
        anew
    }

    /// Takes a reading, in the order of time.
    #[inline]
    pub fn take(&mut self, row: &Row) {
        let start_ns = *self.start_ns.get_or_insert(row.t_ns);
        let at_ns = row.t_ns.saturating_sub(start_ns);
        if at_ns >= self.block_ends_ns {
            self.close_blocks(at_ns);
        }
        self.last_ns = at_ns;
        let scan = self.layout.scan(row);
        if let Some(first) = scan.reading(0) {
            self.tally.count(&first);
        }
        for index in 0..self.axes.len() {
            if let Some(reading) = scan.reading(index) {
                self.take_axis(index, at_ns, &reading);
            }
        }
        self.changed.readings = true;
        if self.guide.is_some() {
            self.guide(row, &scan);
        }
    }

    #[inline]
    fn take_axis(&mut self, index: usize, at_ns: u64, reading: &Reading) {
        let corrector = self.corrector.as_ref();
        let correct = |rate_dps| corrector.and_then(|corrector| corrector.correct(index, Some(rate_dps)));
        let judged = self.axes[index].show(at_ns, reading, correct);
        for _ in 0..reading.lost.min(MOST_FILLED) {
            self.statistics[index].push(None);
        }
        let Some(judged) = judged else { return };
        self.statistics[index].push(judged.rate());
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

    /// Ends the blocks that are over at a time.
    #[cold]
    fn close_blocks(&mut self, at_ns: u64) {
        let over = (at_ns - self.block_ends_ns) / BLOCK_NS + 1;
        self.block_ends_ns += over * BLOCK_NS;
        for _ in 0..over.min(MOST_BLOCKS) {
            for (axis, statistics) in self.axes.iter_mut().zip(&mut self.statistics) {
                let block = axis.close_block();
                statistics.push_block(&block, axis.is_at_rest());
            }
        }
        let start_ns = self.start_ns.unwrap_or_default();
        let ended = self.examination.as_ref().and_then(|one| one.ended(&self.axes, &self.tally, start_ns));
        if let Some(checks) = ended {
            self.examination = None;
            self.checked(checks);
        }
        let temp_c = self.axes.first().and_then(AxisState::temp_c);
        if let Some(guide) = &mut self.guide {
            guide.look(temp_c);
            self.changed.calibration = true;
        }
    }

    /// What the source has to say: `code: text`, or a text.
    pub fn note(&mut self, text: &str) {
        self.notices.push(text, self.now_s());
        self.changed.notices = true;
    }

    /// So many samples did not come here, but are no loss of the device.
    pub fn missed(&mut self, samples: u64) {
        self.missed += samples;
        self.changed.readings = true;
    }

    /// What the twin knows of itself, with the newest samples.
    pub fn truths(&mut self, truths: &[Truth]) {
        self.truths.clear();
        self.truths.extend_from_slice(truths);
    }

    /// What was read since the device was opened.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// What the check of the connection found, beside what was known when the device was opened.
    pub fn checked(&mut self, checks: impl IntoIterator<Item = CheckResult>) {
        self.about.checks.extend(checks);
        self.changed.device = true;
    }

    /// How it is with the device.
    pub fn state(&mut self, state: DeviceState) {
        if self.state == state {
            return;
        }
        match &state {
            DeviceState::Ended => self.end_guide("the recording ended before the procedure did"),
            DeviceState::Failed { why } => self.abort_guide(why.clone()),
            DeviceState::Opening | DeviceState::Reading => {}
        }
        self.state = state;
        self.changed.device = true;
    }

    /// Puts a calibration on file, by its TOML; its id.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn add_calibration(&mut self, toml: &str) -> Result<String, String> {
        self.changed.calibrations = true;
        self.shelf.add_file(toml)
    }

    /// Applies a calibration on file, or none.
    ///
    /// # Errors
    /// It is not on file, or of another part.
    pub fn apply(&mut self, id: Option<&str>) -> Result<(), String> {
        self.corrector = self.shelf.apply(id, &self.about.part)?;
        self.changed.calibrations = true;
        Ok(())
    }

    /// Calibrations on file, the newest last.
    pub fn calibrations(&self) -> impl Iterator<Item = &Calibration> {
        self.shelf.all()
    }

    fn now_s(&self) -> f64 {
        self.last_ns as f64 * 1e-9
    }
}

/// Readings that are filled in for one gap at most, and blocks: what was lost beyond is a gap in time.
const MOST_FILLED: u32 = 100_000;
const MOST_BLOCKS: u64 = 36_000;
