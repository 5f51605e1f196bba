//! Feeds the samples of a device to the calibration procedure.

use super::target::Target;
use crate::acquisition::Acquisition;
use crate::error::CodedRefusal;
use crate::recorder::Recorder;
use crate::warning::JobWarning;
use adis16130_twin::Truth;
use anyhow::{Result, anyhow};
use zerorate::{
    Action, AxisRefusal, Event, Outcome, Part, PartProcedure, Progress, Reached, Refusal, Scan, Setting, SettingNames,
    State, Warning, Wording,
};
use zerorate_record::{Layout, Row, SampleHash};
use zerorate_view::Seconds;

/// Receives the events of a calibration.
pub trait Watch {
    /// Receives the progress every 4096 samples. Returns false to end the measurement.
    fn see(&mut self, progress: &Progress) -> bool;

    /// Receives, at a check of the target, the uncertainties if the recording ended now, unless it would be refused.
    fn approach(&mut self, _reached: Reached) {}

    /// Receives a warning while the measurement goes on.
    fn warn(&mut self, warning: JobWarning);

    /// The names that the front end uses for the settings.
    fn names(&self) -> SettingNames;
}

pub struct Measurement<'a> {
    acquisition: Acquisition,
    layout: Layout,
    procedure: PartProcedure,
    log: Option<Recorder>,
    log_failed: Option<anyhow::Error>,
    hash: SampleHash,
    /// The twin's true state of each axis, at the end of step 8 or of the recording.
    truths: Vec<Truth>,
    target: Target,
    watch: &'a mut dyn Watch,
}

pub struct MeasurementResult {
    pub part: Part,
    pub outcomes: Vec<Outcome>,
    pub capture_sha256: String,
    pub truths: Vec<Truth>,
    /// A warning if the resonance aliases to a frequency at which it looks like a bias (F-07).
    pub resonance: Option<Warning>,
    pub log_failed: Option<anyhow::Error>,
}

impl<'a> Measurement<'a> {
    pub fn new(
        acquisition: Acquisition,
        procedure: PartProcedure,
        log: Option<Recorder>,
        watch: &'a mut dyn Watch,
    ) -> Self {
        let layout = acquisition.facts().info.layout.clone();
        let hash = SampleHash::new(&layout);
        Self {
            acquisition,
            layout,
            procedure,
            log,
            log_failed: None,
            hash,
            truths: Vec::new(),
            target: Target::default(),
            watch,
        }
    }

    pub fn run(mut self) -> Result<MeasurementResult> {
        let fed = self.feed();
        // closes the log properly, even after a failure
        if let Some(Err(error)) = self.log.take().map(Recorder::finish) {
            self.lose_log(error.into());
        }
        fed?;
        let (plan, words) = (self.procedure.plan(), self.words());
        let resonance = self.acquisition.resonance(plan.average_s.min(plan.offset_s));
        Ok(MeasurementResult {
            resonance,
            part: self.procedure.part().clone(),
            outcomes: self.procedure.finish().map_err(|refusal| words.refused(&refusal))?,
            capture_sha256: self.hash.hex(),
            truths: self.truths,
            log_failed: self.log_failed,
        })
    }

    fn feed(&mut self) -> Result<()> {
        loop {
            match self.procedure.next() {
                Action::Initialise => self.initialise()?,
                Action::Read => match self.acquisition.next_row()? {
                    Some(row) => self.take(&row)?,
                    None => self.end()?,
                },
                Action::Done => return Ok(()),
            }
        }
    }

    /// Initialises the part. Time starts with the first row, so that the recorded rows can repeat the procedure.
    fn initialise(&mut self) -> Result<()> {
        self.acquisition.initialise()?;
        let Some(first) = self.acquisition.next_row()? else { return Err(self.ended_early()) };
        self.handle(Event::Initialised { t_ns: first.t_ns })?;
        self.take(&first)
    }

    /// Handles the end of the samples. Only a method without steps accepts a recording that ends early.
    fn end(&mut self) -> Result<()> {
        let words = self.words();
        let whole = !self.acquisition.is_stopped()
            && self.procedure.end_recording().map_err(|refusal| words.refused(&refusal))?;
        if whole { Ok(()) } else { Err(self.ended_early()) }
    }

    #[inline]
    fn take(&mut self, row: &Row) -> Result<()> {
        self.hash.update(row);
        if let Some(Err(error)) = self.log.as_mut().map(|log| log.push(row)) {
            self.lose_log(error.into());
        }
        let before = self.procedure.progress().state;
        self.handle(Event::Reading(&self.layout.scan(row)))?;
        if before == State::Recording || before == State::Offset && self.procedure.progress().state != State::Offset {
            self.mark()?;
        }
        if self.acquisition.is_time_to_show() && !self.watch.see(&self.procedure.progress()) {
            return Err(self.interrupted());
        }
        Ok(())
    }

    /// Stores the twin's true state, and checks the target uncertainty when that is due.
    #[inline]
    fn mark(&mut self) -> Result<()> {
        let truths = self.acquisition.truths();
        if !truths.is_empty() {
            self.truths = truths;
        }
        if self.procedure.plan().target_dps.is_some() && self.target.is_due(&self.procedure) {
            let words = self.words();
            if self.target.is_reached(&self.procedure) {
                self.procedure.end_recording().map_err(|refusal| words.refused(&refusal))?;
            }
            if let Some(reached) = self.target.reached() {
                self.watch.approach(reached);
            }
        }
        Ok(())
    }

    #[inline]
    fn handle(&mut self, event: Event<'_, Scan>) -> Result<()> {
        self.procedure.handle(event).map_err(|refusal| self.words().refused(&refusal))
    }

    fn words(&self) -> Words {
        Words { names: self.watch.names(), is_recording: self.acquisition.is_recording() }
    }

    /// Warns that the log failed and drops the log. The measurement goes on.
    #[cold]
    fn lose_log(&mut self, error: anyhow::Error) {
        let after_s = self.procedure.progress().elapsed_s;
        self.watch.warn(JobWarning::LogFailed { after_s, why: format!("{error:#}") });
        self.log = None;
        self.log_failed = Some(error);
    }

    #[cold]
    fn ended_early(&self) -> anyhow::Error {
        if self.acquisition.is_stopped() {
            return self.interrupted();
        }
        let progress = self.procedure.progress();
        let (elapsed, total) = (Seconds(progress.elapsed_s), Seconds(progress.total_s));
        let names = self.watch.names();
        let times =
            [Setting::Average, Setting::WarmUp, Setting::Settle, Setting::Offset].map(|of| names(of).to_string());
        anyhow!(
            "the recording ends after {elapsed}, during {}, but the procedure takes {total}: give the durations it \
             was recorded for ({})",
            progress.state,
            times.join(", ")
        )
    }

    #[cold]
    fn interrupted(&self) -> anyhow::Error {
        let kept = if self.log.is_some() { "; the log stands whole up to here" } else { "" };
        anyhow!("interrupted after {}; no calibration written{kept}", Seconds(self.procedure.progress().elapsed_s))
    }
}

/// Writes the texts of refusals.
#[derive(Clone, Copy)]
struct Words {
    names: SettingNames,
    /// True if a recording is read, which has no bus to test.
    is_recording: bool,
}

impl Words {
    fn refused(self, refusal: &AxisRefusal) -> anyhow::Error {
        CodedRefusal::new(refusal.refusal.code(), self.text(refusal)).into()
    }

    fn text(self, refusal: &AxisRefusal) -> String {
        let Self { names, is_recording } = self;
        let (Refusal::TooFew { window, tenths, needed }, true) = (refusal.refusal, is_recording) else {
            return refusal.with(names).to_string();
        };
        let axis = refusal.axis.as_ref().map_or(String::new(), |axis| format!("axis {axis}: "));
        format!(
            "{axis}the recording has samples in only {tenths} tenths of a second of {window}, at least {needed} are \
             needed; average longer ({}) or record faster",
            names(Setting::Average)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_has_no_wires_to_check() {
        let refusal = Refusal::TooFew { window: State::FirstAverage, tenths: 12, needed: 30 };
        let refusal = AxisRefusal { axis: Some("z".to_owned()), refusal };
        let text = |is_recording| Words { names: Setting::name, is_recording }.text(&refusal);
        assert!(text(false).contains("wire"), "{}", text(false));
        assert!(!text(true).contains("wire") && text(true).contains("average longer (average_s)"), "{}", text(true));
        assert!(
            text(true).starts_with("axis z: the recording has samples in only 12 tenths of a second of"),
            "{}",
            text(true)
        );
    }
}
