//! A session with its device, as a browser has it: readings are taken in turns, between which the page is served.

use crate::message::DeviceState;
use crate::session::{About, Asked, HostWish, Session};
use crate::source::{Next, Source};

/// Opens the device, from a reset on, at this time of the page, ms.
pub type Open = Box<dyn Fn(f64) -> Result<Box<dyn Source>, String>>;

/// A session and what it reads.
pub struct Live {
    session: Session,
    open: Open,
    /// None: it could not be opened, or can be read no more.
    source: Option<Box<dyn Source>>,
    is_simulated: bool,
    pace: Pace,
}

/// Readings between two looks at the clock.
const AT_ONCE: u32 = 64;

impl Live {
    /// Opens a device.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(open: Open, now_ms: f64) -> Result<Self, String> {
        let source = open(now_ms)?;
        let about = source.about();
        let is_simulated = about.simulated;
        let pace = Pace::new(1.0);
        let mut live = Self { session: Session::new(about), open, source: Some(source), is_simulated, pace };
        live.begun();
        Ok(live)
    }

    /// The same session with another device; calibrations stay on file.
    ///
    /// # Errors
    /// It cannot be opened; then the old one goes on.
    pub fn instead(&mut self, open: Open, now_ms: f64) -> Result<(), String> {
        let source = open(now_ms)?;
        self.open = open;
        self.is_simulated = source.about().simulated;
        self.pace = Pace::new(1.0);
        self.session.speed(1.0);
        self.reopened(source);
        Ok(())
    }

    /// The session, for what is of no device.
    pub fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Takes readings for at most so long, as far as their time has come; `clock` tells the time of the page, ms.
    pub fn turn(&mut self, clock: &mut dyn FnMut() -> f64, budget_ms: f64) {
        let Some(mut source) = self.source.take() else { return };
        let began_ms = clock();
        source.received(&[], began_ms);
        if source.opened() {
            self.anew(source.about());
            self.session.state(DeviceState::Reading);
        }
        match self.take(&mut *source, clock, began_ms + budget_ms) {
            Ok(true) => {
                self.session.truths(&source.truths());
                self.source = Some(source);
            }
            Ok(false) => {
                source.notes().iter().for_each(|note| self.session.note(note));
                self.session.state(DeviceState::Ended);
            }
            Err(why) => self.session.state(DeviceState::Failed { why }),
        }
        if let Some(source) = &mut self.source {
            source.notes().iter().for_each(|note| self.session.note(note));
        }
    }

    /// Whether there may be more.
    fn take(
        &mut self,
        source: &mut dyn Source,
        clock: &mut dyn FnMut() -> f64,
        until_ms: f64,
    ) -> Result<bool, String> {
        loop {
            let now_ms = clock();
            if now_ms >= until_ms {
                self.pace.fell_behind();
                return Ok(true);
            }
            for _ in 0..AT_ONCE {
                match source.next()? {
                    Next::Row(row) => {
                        self.session.take(&row);
                        if self.is_simulated && self.pace.is_ahead(row.t_ns, now_ms) {
                            return Ok(true);
                        }
                    }
                    Next::Waiting => return Ok(true),
                    Next::Ended => return Ok(false),
                }
            }
        }
    }

    /// The answer to a request.
    pub fn ask(&mut self, request: &str, now_ms: f64) -> String {
        let (id, wish) = match self.session.ask(request) {
            Asked::Answer(answer) => return answer,
            Asked::Host { id, wish } => (id, wish),
        };
        let done = match wish {
            HostWish::Speed(factor) => {
                self.pace = Pace::new(factor);
                self.session.speed(factor);
                Ok(())
            }
            HostWish::Reopen => (self.open)(now_ms).map(|source| self.reopened(source)),
        };
        self.session.done(id, done)
    }

    /// What came through the serial port.
    pub fn received(&mut self, bytes: &[u8], now_ms: f64) {
        if let Some(source) = &mut self.source {
            source.received(bytes, now_ms);
        }
    }

    /// What is to be written to it.
    pub fn to_send(&mut self) -> Vec<u8> {
        self.source.as_mut().map_or_else(Vec::new, |source| source.to_send())
    }

    /// The serial port is gone.
    pub fn unplugged(&mut self, why: &str) {
        if let Some(source) = &mut self.source {
            source.unplugged(why);
        }
    }

    fn reopened(&mut self, source: Box<dyn Source>) {
        self.anew(source.about());
        self.pace = Pace::new(self.pace.factor);
        self.source = Some(source);
        self.begun();
    }

    fn anew(&mut self, about: About) {
        let before = std::mem::replace(&mut self.session, Session::new(about.clone()));
        self.session = before.reopened(about);
    }

    /// A part that is simulated or recorded is there at once; another says when.
    fn begun(&mut self) {
        if self.is_simulated {
            self.session.state(DeviceState::Reading);
        }
    }
}

/// How fast simulated time goes by.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// Times as fast as the clock; 0: as fast as it can.
    factor: f64,
    /// A simulated time, ns, and the time of the page then, ms.
    since: Option<(u64, f64)>,
}

impl Pace {
    const fn new(factor: f64) -> Self {
        Self { factor, since: None }
    }

    /// Whether what is of this time is still to come.
    fn is_ahead(&mut self, t_ns: u64, now_ms: f64) -> bool {
        let &mut (from_ns, from_ms) = self.since.get_or_insert((t_ns, now_ms));
        self.factor > 0.0 && t_ns.saturating_sub(from_ns) as f64 * 1e-6 > (now_ms - from_ms) * self.factor
    }

    /// A page that was too slow goes on from where it is: it does not catch up.
    fn fell_behind(&mut self) {
        self.since = None;
    }
}
