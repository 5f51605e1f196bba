//! The session of one device: all data that are derived from its samples. All windows of the page share it.

mod ask;
mod axis;
mod calibration_store;
mod checkup;
mod frame;
mod guided;
mod live_view;
mod notices;
mod statistics;
mod strips;
mod temperatures;

use crate::message::{Calibrating, CheckResult, DeviceState, Register};
use adis16130_twin::Truth;
use calibration_store::CalibrationStore;
pub(crate) use frame::encode;
use guided::GuidedCalibration;
pub(crate) use live_view::LiveView;
pub use notices::NoticeText;
use statistics::Statistics;
use zerorate::{Calibration, Part, Tally};
use zerorate_record::{CaptureInfo, Row};
use zerorate_view::SessionWarning;

/// Facts about the device.
#[derive(Clone, Debug)]
pub struct About {
    /// The address, in the syntax of `--device`.
    pub name: String,
    /// The description of the samples as a capture.
    pub info: CaptureInfo,
    /// The part's type, with its axes and limits.
    pub part: Part,
    /// True if the part's time is simulated or replayed.
    pub simulated: bool,
    /// Nominal conversion rate, Hz; `None` if unknown.
    pub nominal_hz: Option<f64>,
    /// The registers, as read when the device was opened.
    pub registers: Vec<Register>,
    /// The results of the connection check.
    pub checks: Vec<CheckResult>,
}

/// The answer to a request, or a command that the owner of the device carries out before the answer.
#[derive(Clone, Debug, PartialEq)]
pub enum RequestResult {
    /// The answer, as JSON text.
    Answer(String),
    /// The owner of the device must carry out a command. [`Session::done`] then makes the answer.
    Host {
        /// The `id` of the request.
        id: u32,
        /// The command to carry out.
        command: HostCommand,
    },
}

/// A command that only the owner of the device can carry out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HostCommand {
    /// Set the speed of simulated time, as a multiple of real time; 0: as fast as possible.
    Speed(f64),
    /// Open the device again and reset it, then call [`Session::reopened`].
    Reopen,
}

/// Processes readings and requests, and returns frames and answers.
///
/// ```
/// use adis16130::Width;
/// use zerorate::Part;
/// use zerorate_record::{CaptureInfo, Layout, Row};
/// use zerorate_web::session::{About, RequestResult, Session};
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
/// assert_eq!(asked, RequestResult::Answer(r#"{"id":1,"ok":{}}"#.into()));
/// ```
#[derive(Debug)]
pub struct Session {
    live_view: LiveView,
    statistics: Vec<Statistics>,
    store: CalibrationStore,
    calibrating: Calibrating,
    guided: Option<GuidedCalibration>,
    /// The requested calibration, until the device has been opened again for it.
    wanted: Option<GuidedCalibration>,
    /// The id of the calibration that was measured since the device was opened. It certainly belongs to this part.
    measured: Option<String>,
    /// True if samples right before the next one did not reach the session ([`Session::missed`]).
    is_torn: bool,
    truths: Vec<Truth>,
    changed: SessionChanges,
}

/// The parts of the session, beside the live view, that changed since the last frame.
#[derive(Clone, Copy, Debug, Default)]
struct SessionChanges {
    statistics: bool,
    calibration: bool,
    calibrations: bool,
}

impl Session {
    /// Starts the session of a device that was just opened.
    #[must_use]
    pub fn new(about: About) -> Self {
        let live_view = LiveView::new(about);
        Self {
            statistics: live_view.axes.iter().map(|axis| Statistics::new(&axis.axis)).collect(),
            live_view,
            store: CalibrationStore::default(),
            calibrating: Calibrating::Idle,
            guided: None,
            wanted: None,
            measured: None,
            is_torn: false,
            truths: Vec::new(),
            changed: SessionChanges::default(),
        }
    }

    /// The facts about the device.
    #[must_use]
    pub fn about(&self) -> &About {
        &self.live_view.about
    }

    /// The session after its device was opened again. Speed and stored calibrations stay, and the applied one stays
    /// applied if it fits the part. A requested calibration starts; a running one ends.
    #[must_use]
    pub fn reopened(self, about: About) -> Self {
        let Self { live_view, store, calibrating, guided, wanted, .. } = self;
        let mut anew = Self { live_view: live_view.reopened(about.clone()), store, calibrating, ..Self::new(about) };
        anew.apply_again();
        // a bridge is opened twice: when that is requested, and when its part has answered
        anew.guided = wanted.or(guided).filter(|guided| !guided.begun);
        if anew.guided.is_none() {
            anew.abort_calibration("the device was opened again");
        }
        anew
    }

    /// Applies the previous calibration again, if it belongs to the part.
    fn apply_again(&mut self) {
        let applied = self.store.applied().map(Calibration::id);
        if let Err(why) = self.apply(applied.as_deref()) {
            self.store.apply_none();
            self.note(SessionWarning::NotApplied(why));
        }
    }

    /// Processes a row; rows must be in order of time.
    #[inline]
    pub fn take(&mut self, row: &Row) {
        if self.live_view.take(row, &mut self.statistics) {
            self.look();
        }
        if self.is_torn {
            self.is_torn = false;
            self.restart_statistics();
        }
        if self.guided.is_some() {
            let scan = self.live_view.layout.scan(row);
            self.take_guided(row, &scan);
        }
    }

    /// Updates the guided calibration at the end of a block. This takes too long to be done with each reading.
    #[cold]
    fn look(&mut self) {
        let temp_c = self.live_view.temp_c();
        if let Some(guided) = &mut self.guided {
            guided.look(temp_c);
            self.changed.calibration = true;
        }
    }

    /// Adds a notice of an event. It replaces an older one with the same code and axis.
    pub fn note(&mut self, text: impl Into<NoticeText>) {
        self.live_view.note(&text.into());
    }

    /// Reports samples that did not reach the session, although the device did not lose them. The statistics restart
    /// with the next sample, and a running calibration ends without a result.
    pub fn missed(&mut self, samples: u64) {
        self.live_view.missed += samples;
        self.live_view.changed.readings = true;
        self.is_torn = true;
        if self.guided.is_some() {
            let why = "because the computer was too busy. Close other programs, and begin again";
            self.abort_calibration(&format!("{samples} samples did not reach the session, {why}"));
        }
        self.note(SessionWarning::Missed(samples));
    }

    /// Replaces the true values of the twin by those at the newest sample.
    pub fn truths(&mut self, truths: &[Truth]) {
        self.truths.clear();
        self.truths.extend_from_slice(truths);
    }

    /// The counts of samples since the device was opened.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.live_view.tally
    }

    /// Adds results of the connection check to the earlier ones.
    pub fn checked(&mut self, checks: impl IntoIterator<Item = CheckResult>) {
        self.live_view.checked(checks);
    }

    /// Sets the state of the device. A running calibration ends if the device failed or its recording ended.
    pub fn state(&mut self, state: DeviceState) {
        if self.live_view.state == state {
            return;
        }
        match &state {
            DeviceState::Ended => self.end_guided("the recording ended before the procedure did"),
            DeviceState::Failed { why } => self.abort_calibration(why),
            DeviceState::Opening | DeviceState::Reading => {}
        }
        self.live_view.state(state);
    }

    /// Stores a calibration from its TOML text, and returns its id. A place stays free for one that is being measured.
    ///
    /// # Errors
    /// Returns the reason why the calibration cannot be stored.
    pub fn add_calibration(&mut self, toml: &str) -> Result<String, String> {
        let id = self.store.add_file(toml, usize::from(self.is_calibrating()))?;
        self.changed.calibrations = true;
        Ok(id)
    }

    /// Applies a stored calibration, or none, and adds its warnings as notices. The angle restarts at zero.
    ///
    /// # Errors
    /// Returns an error if the calibration is not stored, or belongs to another part.
    pub fn apply(&mut self, id: Option<&str>) -> Result<(), String> {
        let stranger = id.filter(|id| self.measured.as_deref() != Some(id));
        let doubts = stranger.map(|id| self.store.doubts(id, &self.live_view.about)).transpose()?;
        self.live_view.correct(self.store.apply(id, &self.live_view.about.part)?);
        self.changed.calibrations = true;
        doubts.into_iter().flatten().for_each(|doubt| self.note(doubt));
        Ok(())
    }

    /// The applied calibration, if there is one.
    #[must_use]
    pub fn applied(&self) -> Option<&Calibration> {
        self.store.applied()
    }

    /// The stored calibrations, the newest last.
    pub fn calibrations(&self) -> impl Iterator<Item = &Calibration> {
        self.store.all()
    }

    /// Number of calibrations stored or removed so far.
    #[must_use]
    pub const fn store_changes(&self) -> u64 {
        self.store.changes
    }
}
