//! Handles requests, and starts and ends guided calibrations.

use super::guided::{GuidedCalibration, Measurement};
use super::{HostCommand, LiveView, RequestResult, Session};
use crate::message::{
    Answer, AnswerOutcome, CalibrateCommand, Calibrating, Command, DeviceState, MethodName, Reply, Request, Running,
};
use serde::Deserialize;
use zerorate::Scan;
use zerorate_record::Row;

/// The largest speed of simulated time that a request can set, as a multiple of real time. Speed 0 has no limit.
const FASTEST: f64 = 1000.0;

/// The `id` of a request whose command cannot be parsed.
#[derive(Deserialize)]
struct Anonymous {
    id: u32,
}

impl Session {
    /// Carries out a request, or returns the command that the owner of the device must carry out.
    pub fn ask(&mut self, request: &str) -> RequestResult {
        let Request { id, command } = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(error) => {
                let id = serde_json::from_str(request).map_or(0, |Anonymous { id }| id);
                return answer(id, Err(format!("not understood: {error}")));
            }
        };
        match self.command(command) {
            Ok(Outcome::Reply(reply)) => answer(id, Ok(reply)),
            Ok(Outcome::Host(command)) => RequestResult::Host { id, command },
            Err(why) => answer(id, Err(why)),
        }
    }

    /// Makes the answer after the owner of the device carried out a command or failed to. A failure ends a calibration
    /// that waits for the device to be opened.
    pub fn done(&mut self, id: u32, result: Result<(), String>) -> String {
        if let Err(why) = &result
            && self.wanted.is_some()
        {
            self.abort_calibration(why);
        }
        written(id, result.map(|()| Reply::Nothing {}))
    }

    /// Notes the current speed of simulated time.
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
            Command::FinishCalibration => self.finish_guided()?,
            Command::DismissCalibration => self.dismiss()?,
            Command::Apply { calibration } => self.apply(calibration.as_deref())?,
            Command::AddCalibration { toml } => {
                let id = self.add_calibration(&toml)?;
                let entry = self.store.entry_of(&id).ok_or("the calibration is not on file")?;
                return Ok(Outcome::Reply(Reply::Calibration(entry)));
            }
            Command::RemoveCalibration { calibration } => {
                self.store.remove(&calibration)?;
                self.changed.calibrations = true;
            }
            Command::Download { calibration, form } => {
                return Ok(Outcome::Reply(Reply::Download(self.store.download(&calibration, &form)?)));
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

    /// Prepares a calibration. It starts with the first reading after the device was opened again, because the
    /// procedure needs a part that was just reset (F-51, step 3).
    fn calibrate(&mut self, command: &CalibrateCommand) -> Result<(), String> {
        if self.is_calibrating() {
            return Err("a calibration is running: end it first".to_owned());
        }
        self.store.has_room(1)?;
        if let DeviceState::Failed { why } = &self.live_view.state {
            return Err(format!("the device cannot be read: {why}"));
        }
        let guided = GuidedCalibration::new(command, &self.live_view.about.part, &self.live_view.about.info)?;
        self.calibrating = guided.shown();
        self.wanted = Some(guided);
        self.changed.calibration = true;
        Ok(())
    }

    /// The method of the calibration that is running or about to start.
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

    /// Ends a calibration that is running or about to start, without a result. `why` is the reason.
    pub fn abort_calibration(&mut self, why: &str) {
        let Some(method) = self.method() else { return };
        (self.guided, self.wanted) = (None, None);
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

    fn finish_guided(&mut self) -> Result<(), String> {
        let guided = self.guided.as_mut().ok_or("no calibration is running")?;
        match guided.end_recording() {
            Ok(true) => self.complete_guided(),
            Ok(false) => return Err("this method has more steps: wait for them, or abort it".to_owned()),
            Err(why) => self.refuse_guided(why),
        }
        Ok(())
    }

    /// Handles the end of a recording. A method that can end early gives its result or is refused. Any other method is
    /// aborted for the reason `otherwise`.
    pub(super) fn end_guided(&mut self, otherwise: &str) {
        let Some(guided) = &mut self.guided else { return self.abort_calibration(otherwise) };
        match guided.end_recording() {
            Ok(true) => self.complete_guided(),
            Ok(false) => self.abort_calibration(otherwise),
            Err(why) => self.refuse_guided(why),
        }
    }

    #[inline]
    pub(super) fn take_guided(&mut self, row: &Row, scan: &Scan) {
        match self.guided.as_mut().map(|guided| guided.take(row, scan)) {
            None | Some(Ok(false)) => {}
            Some(Ok(true)) => self.complete_guided(),
            Some(Err(why)) => self.refuse_guided(why),
        }
    }

    fn refuse_guided(&mut self, text: String) {
        let Some(guided) = self.guided.take() else { return };
        self.calibrating = Calibrating::Refused { method: guided.method, text };
        self.changed.calibration = true;
    }

    fn complete_guided(&mut self) {
        let Some(guided) = self.guided.take() else { return };
        let method = guided.method;
        let LiveView { about, tally, axes, .. } = &self.live_view;
        let measurement = Measurement { info: &about.info, tally, axes, truths: &self.truths };
        let kept = guided.finish(&measurement).and_then(|(result, calibration)| {
            self.measured = Some(self.store.add(calibration)?);
            Ok(result)
        });
        self.calibrating = match kept {
            Ok(result) => Calibrating::Done(result),
            Err(text) => Calibrating::Refused { method, text },
        };
        (self.changed.calibration, self.changed.calibrations) = (true, true);
    }
}

enum Outcome {
    Reply(Reply),
    Host(HostCommand),
}

fn answer(id: u32, result: Result<Reply, String>) -> RequestResult {
    RequestResult::Answer(written(id, result))
}

fn written(id: u32, result: Result<Reply, String>) -> String {
    let outcome = result.map_or_else(AnswerOutcome::Error, AnswerOutcome::Ok);
    // numbers, texts and lists always serialise
    serde_json::to_string(&Answer { id, outcome }).unwrap_or_default()
}
