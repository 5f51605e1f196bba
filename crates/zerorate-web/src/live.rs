//! A session with its device in a browser. Readings are handled in short turns, so that the page stays responsive.

use crate::message::DeviceState;
use crate::session::{About, HostCommand, RequestResult, Session};
use crate::source::{Next, Source};
use zerorate_record::Row;

/// A function that opens the device anew. Its argument is the page's time, ms.
pub type Open = Box<dyn Fn(f64) -> Result<Box<dyn Source>, String>>;

/// A session and its device.
pub struct Live {
    /// The session, for requests that do not need the device.
    pub session: Session,
    open: Open,
    /// `None` once the recording has ended or the device cannot be read any longer.
    source: Option<Box<dyn Source>>,
    pace: Pace,
}

/// Number of readings between two checks of the clock.
const AT_ONCE: u32 = 64;

impl Live {
    /// Opens a device and starts a session.
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

    /// Continues the session with another device. Stored calibrations stay. A running calibration ends without result.
    ///
    /// # Errors
    /// Returns an error if the new device cannot be opened. The session then keeps the old device.
    pub fn instead(&mut self, open: Open, now_ms: f64) -> Result<(), String> {
        let source = open(now_ms)?;
        self.session.abort_calibration("another device was opened");
        self.open = open;
        self.pace = Pace::of(&source.about());
        self.session.speed(1.0);
        self.reopened(source);
        Ok(())
    }

    /// Reads the samples that are due, for about `budget_ms`. `clock` returns the page's time, ms.
    pub fn turn(&mut self, clock: &mut dyn FnMut() -> f64, budget_ms: f64) {
        let Some(mut source) = self.source.take() else { return };
        let began_ms = clock();
        source.received(&[], began_ms);
        if source.opened() {
            self.anew(source.about());
            self.session.state(DeviceState::Reading);
        }
        let take = |row: &Row| self.session.take(row);
        let read = self.pace.readings(&mut *source, clock, began_ms + budget_ms, take);
        source.notes().into_iter().for_each(|note| self.session.note(note));
        match read {
            Ok(true) => {
                self.session.truths(&source.truths());
                self.source = Some(source);
            }
            Ok(false) => self.session.state(DeviceState::Ended),
            Err(why) => self.session.state(DeviceState::Failed { why }),
        }
    }

    /// Reads up to the time that a preview of the same unit has reached, `shown_s` after its first reading
    /// ([`FirstLook`](crate::first::FirstLook)).
    pub fn catch_up(&mut self, shown_s: f64, clock: &mut dyn FnMut() -> f64) {
        self.pace.begun_s = shown_s;
        self.turn(clock, f64::INFINITY);
    }

    /// Answers a request, and acts on the device if necessary.
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

    /// Passes on bytes that the serial port received.
    pub fn received(&mut self, bytes: &[u8], now_ms: f64) {
        if let Some(source) = &mut self.source {
            source.received(bytes, now_ms);
        }
    }

    /// Takes the bytes to write to the serial port.
    pub fn to_send(&mut self) -> Vec<u8> {
        self.source.as_mut().map_or_else(Vec::new, |source| source.to_send())
    }

    /// Reports that the serial port was disconnected.
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

    /// Marks a simulated or recorded device as being read. [`Live::turn`] marks a real device once it was opened.
    fn begun(&mut self) {
        if self.pace.is_simulated {
            self.session.state(DeviceState::Reading);
        }
    }
}

/// Paces simulated time against the page's clock.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// True if the part's time is simulated or replayed; false for a real part.
    is_simulated: bool,
    /// Multiple of real time; 0 means as fast as possible.
    factor: f64,
    /// Simulated time that a preview has already shown, s; 0 without a preview, and after a restart of the pace.
    begun_s: f64,
    /// A simulated time, ns, and the page's time, ms, at which it is due. `None` before the first reading, and after
    /// the speed changed or the page was too slow.
    since: Option<(u64, f64)>,
}

impl Pace {
    /// The pace of real time for a simulated device; no pace for a real one.
    pub fn of(about: &About) -> Self {
        Self { is_simulated: about.simulated, factor: 1.0, begun_s: 0.0, since: None }
    }

    const fn at(self, factor: f64) -> Self {
        Self { factor, begun_s: 0.0, since: None, ..self }
    }

    /// Reads the samples that are due, until the page's time `until_ms`. Returns false if the device has no more.
    ///
    /// # Errors
    /// Returns an error if the device cannot be read any longer.
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
                // the page was too slow: the session does not have to catch up
                (self.since, self.begun_s) = (None, 0.0);
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

    /// True if a sample at `t_ns` is ahead of the pace. Only simulated samples can be.
    fn is_ahead(&mut self, t_ns: u64, now_ms: f64) -> bool {
        let begun_ms = 1000.0 * self.begun_s;
        let &mut (from_ns, from_ms) = self.since.get_or_insert((t_ns, now_ms - begun_ms));
        let gone_ms = t_ns.saturating_sub(from_ns) as f64 * 1e-6;
        self.is_simulated && self.factor > 0.0 && gone_ms > (now_ms - from_ms) * self.factor
    }
}
