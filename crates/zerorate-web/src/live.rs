//! A session with its device, as a browser runs it. Readings are taken in turns, and the page is served between them.

use crate::message::DeviceState;
use crate::session::{About, HostCommand, RequestResult, Session};
use crate::source::{Next, Source};
use zerorate_record::Row;

/// Opens the device with a reset, at this time of the page, ms.
pub type Open = Box<dyn Fn(f64) -> Result<Box<dyn Source>, String>>;

/// A session and its device.
pub struct Live {
    session: Session,
    open: Open,
    /// `None` if the device could not be opened or can no longer be read.
    source: Option<Box<dyn Source>>,
    pace: Pace,
}

/// Number of readings between two looks at the clock.
const AT_ONCE: u32 = 64;

impl Live {
    /// Opens a device.
    ///
    /// # Errors
    /// Returns an error if the device cannot be opened.
    pub fn open(open: Open, now_ms: f64) -> Result<Self, String> {
        let source = open(now_ms)?;
        let about = source.about();
        let pace = Pace::of(&about);
        let mut live = Self { session: Session::new(about), open, source: Some(source), pace };
        live.begun();
        Ok(live)
    }

    /// Continues the session with another device. Calibrations stay on file, and a running one ends without a result.
    ///
    /// # Errors
    /// Returns an error if the device cannot be opened; then the old one goes on.
    pub fn instead(&mut self, open: Open, now_ms: f64) -> Result<(), String> {
        let source = open(now_ms)?;
        self.session.abort_calibration("another device was opened");
        self.open = open;
        self.pace = Pace::of(&source.about());
        self.session.speed(1.0);
        self.reopened(source);
        Ok(())
    }

    /// The session, for requests that need no device.
    pub fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Takes readings whose time has come, for at most this long. `clock` tells the time of the page, ms.
    pub fn turn(&mut self, clock: &mut dyn FnMut() -> f64, budget_ms: f64) {
        let Some(mut source) = self.source.take() else { return };
        let began_ms = clock();
        source.received(&[], began_ms);
        if source.opened() {
            self.anew(source.about());
            self.session.state(DeviceState::Reading);
        }
        let take = |row: &Row| self.session.take(row);
        match self.pace.readings(&mut *source, clock, began_ms + budget_ms, take) {
            Ok(true) => {
                self.session.truths(&source.truths());
                self.source = Some(source);
            }
            Ok(false) => {
                source.notes().into_iter().for_each(|note| self.session.note(note));
                self.session.state(DeviceState::Ended);
            }
            Err(why) => self.session.state(DeviceState::Failed { why }),
        }
        if let Some(source) = &mut self.source {
            source.notes().into_iter().for_each(|note| self.session.note(note));
        }
    }

    /// Continues where a [`FirstLook`](crate::first::FirstLook) at the same unit is, this long after its first
    /// reading.
    pub fn catch_up(&mut self, shown_s: f64, clock: &mut dyn FnMut() -> f64) {
        self.pace.begun_s = shown_s;
        self.turn(clock, f64::INFINITY);
    }

    /// The answer to a request.
    pub fn ask(&mut self, request: &str, now_ms: f64) -> String {
        let (id, command) = match self.session.ask(request) {
            RequestResult::Answer(answer) => return answer,
            RequestResult::Host { id, command } => (id, command),
        };
        let done = match command {
            HostCommand::Speed(factor) => {
                self.pace = self.pace.at(factor);
                self.session.speed(factor);
                Ok(())
            }
            HostCommand::Reopen => (self.open)(now_ms).map(|source| self.reopened(source)),
        };
        self.session.done(id, done)
    }

    /// Takes bytes from the serial port.
    pub fn received(&mut self, bytes: &[u8], now_ms: f64) {
        if let Some(source) = &mut self.source {
            source.received(bytes, now_ms);
        }
    }

    /// The bytes to write to the serial port.
    pub fn to_send(&mut self) -> Vec<u8> {
        self.source.as_mut().map_or_else(Vec::new, |source| source.to_send())
    }

    /// Reports that the serial port is gone.
    pub fn unplugged(&mut self, why: &str) {
        if let Some(source) = &mut self.source {
            source.unplugged(why);
        }
    }

    fn reopened(&mut self, source: Box<dyn Source>) {
        self.anew(source.about());
        self.pace = self.pace.at(self.pace.factor);
        self.source = Some(source);
        self.begun();
    }

    fn anew(&mut self, about: About) {
        let before = std::mem::replace(&mut self.session, Session::new(about.clone()));
        self.session = before.reopened(about);
    }

    /// A simulated or recorded part is ready at once; another one says when it is.
    fn begun(&mut self) {
        if self.pace.is_simulated {
            self.session.state(DeviceState::Reading);
        }
    }
}

/// The pace of simulated time.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// The part is real and has its own time.
    is_simulated: bool,
    /// Runs this many times as fast as the clock; 0: as fast as possible.
    factor: f64,
    /// The time that should have passed when it begins, s.
    begun_s: f64,
    /// A simulated time, ns, and the time of the page at that moment, ms.
    since: Option<(u64, f64)>,
}

impl Pace {
    /// The pace of the clock.
    pub fn of(about: &About) -> Self {
        Self { is_simulated: about.simulated, factor: 1.0, begun_s: 0.0, since: None }
    }

    const fn at(self, factor: f64) -> Self {
        Self { factor, begun_s: 0.0, since: None, ..self }
    }

    /// Takes readings whose time has come, up to this time. Returns whether there may be more.
    ///
    /// # Errors
    /// Returns an error if the device can no longer be read.
    pub fn readings(
        &mut self,
        source: &mut (impl Source + ?Sized),
        clock: &mut dyn FnMut() -> f64,
        until_ms: f64,
        mut take: impl FnMut(&Row),
    ) -> Result<bool, String> {
        loop {
            let now_ms = clock();
            if now_ms >= until_ms {
                self.fell_behind();
                return Ok(true);
            }
            for _ in 0..AT_ONCE {
                match source.next()? {
                    Next::Row(row) => {
                        take(&row);
                        if self.is_ahead(row.t_ns, now_ms) {
                            return Ok(true);
                        }
                    }
                    Next::Waiting => return Ok(true),
                    Next::Ended => return Ok(false),
                }
            }
        }
    }

    /// Whether this time is still to come.
    fn is_ahead(&mut self, t_ns: u64, now_ms: f64) -> bool {
        let begun_ms = 1000.0 * self.begun_s;
        let &mut (from_ns, from_ms) = self.since.get_or_insert((t_ns, now_ms - begun_ms));
        let gone_ms = t_ns.saturating_sub(from_ns) as f64 * 1e-6;
        self.is_simulated && self.factor > 0.0 && gone_ms > (now_ms - from_ms) * self.factor
    }

    /// Lets a page that was too slow continue from where it is, without catching up.
    fn fell_behind(&mut self) {
        (self.since, self.begun_s) = (None, 0.0);
    }
}
