//! Requests and their answers, and the guided calibrations that they start and end.

use super::guide::{Guide, Measured};
use super::{Handled, HostCommand, LiveView, Session};
use crate::message::{
    Answer, Answered, CalibrateCommand, Calibrating, Command, DeviceState, MethodName, Reply, Request, Running,
};
use serde::Deserialize;
use zerorate::Scan;
use zerorate_record::Row;

/// The largest speed of simulated time.
const FASTEST: f64 = 1000.0;

/// The `id` of a request that is not understood.
#[derive(Deserialize)]
struct Anonymous {
    id: u32,
}

impl Session {
    /// Carries out a request, or says that the owner of the device must.
    pub fn ask(&mut self, request: &str) -> Handled {
        let Request { id, command } = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(error) => {
                let id = serde_json::from_str(request).map_or(0, |Anonymous { id }| id);
                return answer(id, Err(format!("not understood: {error}")));
            }
        };
        match self.command(command) {
            Ok(Outcome::Reply(reply)) => answer(id, Ok(reply)),
            Ok(Outcome::Host(command)) => Handled::Host { id, command },
            Err(why) => answer(id, Err(why)),
        }
    }

    /// The answer after the owner of the device has acted. A calibration that waits for a device that cannot be opened
    /// ends.
    pub fn done(&mut self, id: u32, result: Result<(), String>) -> String {
        if let Err(why) = &result
            && self.wanted.is_some()
        {
            self.abort_calibration(why);
        }
        written(id, result.map(|()| Reply::Nothing {}))
    }

    /// Notes the present speed of simulated time.
    pub fn speed(&mut self, factor: f64) {
        self.live_view.speed = factor;
        self.live_view.changed.device = true;
    }

    fn command(&mut self, command: Command) -> Result<Outcome, String> {
        match command {
            Command::Calibrate(command) => {
                return self.calibrate(&command).map(|()| Outcome::Host(HostCommand::Reopen));
            }
            Command::AbortCalibration => self.abort_calibration("it was ended by hand"),
            Command::FinishCalibration => self.finish_guide()?,
            Command::DismissCalibration => self.dismiss()?,
            Command::Apply { calibration } => self.apply(calibration.as_deref())?,
            Command::AddCalibration { toml } => {
                let id = self.add_calibration(&toml)?;
                let entry = self.shelf.entry_of(&id).ok_or("the calibration is not on file")?;
                return Ok(Outcome::Reply(Reply::Calibration(entry)));
            }
            Command::RemoveCalibration { calibration } => {
                self.shelf.remove(&calibration)?;
                self.changed.calibrations = true;
            }
            Command::Download { calibration, form } => {
                return Ok(Outcome::Reply(Reply::Download(self.shelf.download(&calibration, &form)?)));
            }
            Command::Restart => self.restart_statistics(),
            Command::ZeroAngle => self.live_view.axes.iter_mut().for_each(|axis| axis.angle.zero()),
            Command::Speed { factor } => return self.set_speed(factor),
            Command::Reopen => {
                self.abort_calibration("the device was opened again");
                return Ok(Outcome::Host(HostCommand::Reopen));
            }
        }
        Ok(Outcome::Reply(Reply::Nothing {}))
    }

    fn set_speed(&self, factor: f64) -> Result<Outcome, String> {
        if !self.live_view.about.simulated {
            return Err("a real part has no speed; only simulated and recorded parts can run faster".to_owned());
        }
        if !(0.0..=FASTEST).contains(&factor) {
            return Err(format!("factor must be 0 (as fast as possible) or at most {FASTEST}"));
        }
        Ok(Outcome::Host(HostCommand::Speed(factor)))
    }

    /// The procedure begins with the first reading of a part that was just reset (F-51, step 3).
    fn calibrate(&mut self, command: &CalibrateCommand) -> Result<(), String> {
        if self.is_calibrating() {
            return Err("a calibration is running: end it first".to_owned());
        }
        self.shelf.has_room(1)?;
        if let DeviceState::Failed { why } = &self.live_view.state {
            return Err(format!("the device cannot be read: {why}"));
        }
        let guide = Guide::new(command, &self.live_view.about.part, &self.live_view.about.info)?;
        self.calibrating = guide.shown();
        self.wanted = Some(guide);
        self.changed.calibration = true;
        Ok(())
    }

    /// The method of the calibration that is running or about to begin.
    #[must_use]
    pub fn method(&self) -> Option<MethodName> {
        match &self.calibrating {
            Calibrating::Running(Running { method, .. }) => Some(*method),
            _ => None,
        }
    }

    pub(super) fn is_calibrating(&self) -> bool {
        self.method().is_some()
    }

    /// Ends a calibration that is running or about to begin, without a result, and says why.
    pub fn abort_calibration(&mut self, why: &str) {
        let Some(method) = self.method() else { return };
        (self.guide, self.wanted) = (None, None);
        self.calibrating = Calibrating::Aborted { method, text: why.to_owned() };
        self.changed.calibration = true;
    }

    fn dismiss(&mut self) -> Result<(), String> {
        if self.is_calibrating() {
            return Err("a calibration is running: end it first".to_owned());
        }
        self.calibrating = Calibrating::Idle;
        self.changed.calibration = true;
        Ok(())
    }

    fn finish_guide(&mut self) -> Result<(), String> {
        let guide = self.guide.as_mut().ok_or("no calibration is running")?;
        match guide.end_recording() {
            Ok(true) => self.complete_guide(),
            Ok(false) => return Err("this method has more steps: wait for them, or abort it".to_owned()),
            Err(why) => self.refuse_guide(why),
        }
        Ok(())
    }

    /// A recording has ended. Methods that take all of it can finish.
    pub(super) fn end_guide(&mut self, otherwise: &str) {
        let Some(guide) = &mut self.guide else { return self.abort_calibration(otherwise) };
        match guide.end_recording() {
            Ok(true) => self.complete_guide(),
            Ok(false) => self.abort_calibration(otherwise),
            Err(why) => self.refuse_guide(why),
        }
    }

    #[inline]
    pub(super) fn guide(&mut self, row: &Row, scan: &Scan) {
        match self.guide.as_mut().map(|guide| guide.take(row, scan)) {
            None | Some(Ok(false)) => {}
            Some(Ok(true)) => self.complete_guide(),
            Some(Err(why)) => self.refuse_guide(why),
        }
    }

    fn refuse_guide(&mut self, text: String) {
        let Some(guide) = self.guide.take() else { return };
        self.calibrating = Calibrating::Refused { method: guide.method, text };
        self.changed.calibration = true;
    }

    fn complete_guide(&mut self) {
        let Some(guide) = self.guide.take() else { return };
        let method = guide.method;
        let LiveView { about, tally, axes, .. } = &self.live_view;
        let measured = Measured { info: &about.info, tally, axes, truths: &self.truths };
        let kept = guide.finish(&measured).and_then(|(result, calibration)| {
            self.measured = Some(self.shelf.add(calibration)?);
            Ok(result)
        });
        self.calibrating = match kept {
            Ok(result) => Calibrating::Done(result),
            Err(text) => Calibrating::Refused { method, text },
        };
        (self.changed.calibration, self.changed.calibrations) = (true, true);
    }
}

/// The outcome of a command.
enum Outcome {
    Reply(Reply),
    Host(HostCommand),
}

fn answer(id: u32, result: Result<Reply, String>) -> Handled {
    Handled::Answer(written(id, result))
}

fn written(id: u32, result: Result<Reply, String>) -> String {
    let outcome = result.map_or_else(Answered::Error, Answered::Ok);
    // these are numbers, texts and lists of them, which always serialise
    serde_json::to_string(&Answer { id, outcome }).unwrap_or_default()
}
