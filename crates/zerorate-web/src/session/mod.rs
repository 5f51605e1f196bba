//! A session: one device, everything that is known of it, and everybody who looks at it.

mod ask;
mod axis;
mod checkup;
mod frame;
mod guide;
mod live_view;
mod notices;
mod shelf;
mod statistics;
mod strips;
mod temperatures;

use crate::message::{Calibrating, CheckResult, DeviceState, Register};
use adis16130_twin::Truth;
pub(crate) use frame::encode;
use guide::Guide;
pub(crate) use live_view::LiveView;
pub use notices::Said;
use shelf::Shelf;
use statistics::Statistics;
use zerorate::{Calibration, Part, Tally};
use zerorate_record::{CaptureInfo, Row};
use zerorate_view::SessionWarning;

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
pub enum Handled {
    /// The answer, as text.
    Answer(String),
    /// Whoever owns the device does this, and [`Session::done`] makes the answer of how it went.
    Host {
        /// Of the request.
        id: u32,
        /// What to do.
        command: HostCommand,
    },
}

/// What only the owner of the device can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HostCommand {
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
/// use zerorate_record::{CaptureInfo, Layout, Row};
/// use zerorate_web::session::{About, Handled, Session};
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
/// assert_eq!(asked, Handled::Answer(r#"{"id":1,"ok":{}}"#.into()));
/// ```
#[derive(Debug)]
pub struct Session {
    live_view: LiveView,
    statistics: Vec<Statistics>,
    shelf: Shelf,
    calibrating: Calibrating,
    guide: Option<Guide>,
    /// What begins with the next reading, after the device was opened again.
    wanted: Option<Guide>,
    /// The calibration that was measured since the device was opened, which is of this part for sure.
    measured: Option<String>,
    /// Samples are missing before the next one.
    is_torn: bool,
    truths: Vec<Truth>,
    changed: Changed,
}

/// What the next frame must state beside what is seen.
#[derive(Clone, Copy, Debug, Default)]
struct Changed {
    statistics: bool,
    calibration: bool,
    calibrations: bool,
}

impl Session {
    /// Of a device that was just opened.
    #[must_use]
    pub fn new(about: About) -> Self {
        let live_view = LiveView::new(about);
        Self {
            statistics: live_view.axes.iter().map(|axis| Statistics::new(&axis.axis)).collect(),
            live_view,
            shelf: Shelf::default(),
            calibrating: Calibrating::Idle,
            guide: None,
            wanted: None,
            measured: None,
            is_torn: false,
            truths: Vec::new(),
            changed: Changed::default(),
        }
    }

    /// What is known of the device.
    #[must_use]
    pub fn about(&self) -> &About {
        &self.live_view.about
    }

    /// Of the same device, opened again: everything begins anew, but calibrations stay on file, and the calibration
    /// that was asked for begins; one that had begun is over.
    #[must_use]
    pub fn reopened(self, about: About) -> Self {
        let Self { live_view, shelf, calibrating, guide, wanted, .. } = self;
        let mut anew = Self { live_view: live_view.reopened(about.clone()), shelf, calibrating, ..Self::new(about) };
        anew.apply_again();
        // a bridge is opened when that is asked for, and once more when its part has answered
        anew.guide = wanted.or(guide).filter(|guide| !guide.has_begun());
        if anew.guide.is_none() {
            anew.abort_calibration("the device was opened again");
        }
        anew
    }

    /// What was applied before, unless the part does not bear it.
    fn apply_again(&mut self) {
        let applied = self.shelf.applied().map(Calibration::id);
        if let Err(why) = self.apply(applied.as_deref()) {
            self.shelf.apply_none();
            self.note(SessionWarning::NotApplied(why));
        }
    }

    /// Takes a reading, in the order of time.
    #[inline]
    pub fn take(&mut self, row: &Row) {
        if self.live_view.take(row, &mut self.statistics) {
            self.look();
        }
        if self.is_torn {
            self.is_torn = false;
            self.restart_statistics();
        }
        if self.guide.is_some() {
            let scan = self.live_view.scan(row);
            self.guide(row, &scan);
        }
    }

    /// At the end of a block: what takes longer than a reading should.
    #[cold]
    fn look(&mut self) {
        let temp_c = self.live_view.temp_c();
        if let Some(guide) = &mut self.guide {
            guide.look(temp_c);
            self.changed.calibration = true;
        }
    }

    /// What there is to say.
    pub fn note(&mut self, said: impl Into<Said>) {
        self.live_view.note(&said.into());
    }

    /// So many samples did not come here, but are no loss of the device. What takes one sample for the successor of
    /// the other begins anew: statistics with the next sample, a calibration when it is asked for.
    pub fn missed(&mut self, samples: u64) {
        self.live_view.missed += samples;
        self.live_view.changed.readings = true;
        self.is_torn = true;
        if self.guide.is_some() {
            let why = "for the computer had too much else to do: end what else it does, and begin again";
            self.abort_calibration(&format!("{samples} samples were not seen here, {why}"));
        }
        self.note(SessionWarning::Missed(samples));
    }

    /// What the twin knows of itself, with the newest samples.
    pub fn truths(&mut self, truths: &[Truth]) {
        self.truths.clear();
        self.truths.extend_from_slice(truths);
    }

    /// What was read since the device was opened.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.live_view.tally
    }

    /// What the check of the connection found, beside what was known when the device was opened.
    pub fn checked(&mut self, checks: impl IntoIterator<Item = CheckResult>) {
        self.live_view.checked(checks);
    }

    /// How it is with the device.
    pub fn state(&mut self, state: DeviceState) {
        if self.live_view.state == state {
            return;
        }
        match &state {
            DeviceState::Ended => self.end_guide("the recording ended before the procedure did"),
            DeviceState::Failed { why } => self.abort_calibration(why),
            DeviceState::Opening | DeviceState::Reading => {}
        }
        self.live_view.state(state);
    }

    /// Puts a calibration on file, by its TOML; its id. The place of one that is being measured stays free.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn add_calibration(&mut self, toml: &str) -> Result<String, String> {
        let id = self.shelf.add_file(toml, usize::from(self.is_calibrating()))?;
        self.changed.calibrations = true;
        Ok(id)
    }

    /// Applies a calibration on file, or none, and notes what there is to say of it; the angle is zero then.
    ///
    /// # Errors
    /// It is not on file, or of another part.
    pub fn apply(&mut self, id: Option<&str>) -> Result<(), String> {
        let stranger = id.filter(|id| self.measured.as_deref() != Some(id));
        let doubts = stranger.map(|id| self.shelf.doubts(id, &self.live_view.about)).transpose()?;
        self.live_view.correct(self.shelf.apply(id, &self.live_view.about.part)?);
        self.changed.calibrations = true;
        doubts.into_iter().flatten().for_each(|doubt| self.note(doubt));
        Ok(())
    }

    /// The calibration that is applied.
    #[must_use]
    pub fn applied(&self) -> Option<&Calibration> {
        self.shelf.applied()
    }

    /// Calibrations on file, the newest last.
    pub fn calibrations(&self) -> impl Iterator<Item = &Calibration> {
        self.shelf.all()
    }

    /// Counts what was put on file and taken off it.
    #[must_use]
    pub const fn shelf_changes(&self) -> u64 {
        self.shelf.changes()
    }
}
