//! The loop of a measurement in a chamber: samples go to the procedure, and set points to the chamber.

use super::Watch;
use super::finished_steps::FinishedSteps;
use super::set_point_control::{Control, SetPointControl};
use crate::acquisition::Acquisition;
use crate::error::CodedRefusal;
use crate::recorder::Recorder;
use crate::warning::JobWarning;
use adis16130_twin::Truth;
use anyhow::Result;
use zerorate::chamber::{ChamberAction, ChamberProcedure, ChamberRefusal, ChamberState};
use zerorate_host::{Cause, Chamber, DeviceError, ProfileWriter, SimulatedChamber};
use zerorate_record::{Layout, Row, SampleHash};
use zerorate_view::duration::Seconds;

/// Period at which the chamber is set and read, ns of sample time.
pub const TICK_NS: u64 = 1_000_000_000;
/// A moving set point is sent whenever it has changed by this much, °C. This is the resolution of chambers.
const SET_STEP_C: f64 = 0.1;

/// A running measurement. `writer` is the first field, so it is dropped first: the simulated part waits for the
/// temperatures that `writer` sends.
pub struct ChamberLoop<'a> {
    writer: Option<ProfileWriter>,
    /// A simulated chamber that takes the place of the person who sets the chamber, if the sensor is simulated.
    obeying: Option<SimulatedChamber>,
    control: SetPointControl,
    acquisition: Acquisition,
    layout: Layout,
    procedure: ChamberProcedure,
    steps: FinishedSteps,
    log: Option<Recorder>,
    log_failed: Option<anyhow::Error>,
    hash: SampleHash,
    truths: Vec<Truth>,
    next_tick_ns: u64,
    announced: Option<usize>,
    watch: &'a mut dyn Watch,
}

pub struct LoopResult {
    pub procedure: ChamberProcedure,
    pub acquisition: Acquisition,
    pub capture_sha256: String,
    /// The twin's true state of each axis at the end.
    pub truths: Vec<Truth>,
    pub log_failed: Option<anyhow::Error>,
}

impl<'a> ChamberLoop<'a> {
    pub fn new(
        (control, writer): (SetPointControl, Option<ProfileWriter>),
        acquisition: Acquisition,
        procedure: ChamberProcedure,
        steps: FinishedSteps,
        log: Option<Recorder>,
        watch: &'a mut dyn Watch,
    ) -> Self {
        let layout = acquisition.facts().info.layout.clone();
        let by_hand = matches!(control.by, Control::Hand);
        let obeying = writer.as_ref().filter(|_| by_hand).map(|_| SimulatedChamber::default());
        Self {
            writer,
            obeying,
            control,
            hash: SampleHash::new(&layout),
            layout,
            acquisition,
            procedure,
            steps,
            log,
            log_failed: None,
            truths: Vec::new(),
            next_tick_ns: 0,
            announced: None,
            watch,
        }
    }

    /// Runs the measurement. However it ends, the chamber is left (`SetPointControl::leave`), and the log is closed.
    pub fn run(mut self) -> Result<(LoopResult, FinishedSteps)> {
        let ended = self.feed().map_err(|error| if is_stopped(&error) { self.ended_early() } else { error });
        self.control.leave();
        if let Some(Err(error)) = self.log.take().map(Recorder::finish) {
            self.lose_log(error.into());
        }
        ended?;
        let Self { acquisition, procedure, steps, hash, truths, log_failed, writer, .. } = self;
        drop(writer);
        Ok((LoopResult { procedure, acquisition, capture_sha256: hash.hex(), truths, log_failed }, steps))
    }

    fn feed(&mut self) -> Result<()> {
        loop {
            match self.procedure.next() {
                ChamberAction::Initialise => self.initialise()?,
                ChamberAction::Read => {
                    let row = self.row()?;
                    self.take(&row)?;
                }
                ChamberAction::Done => return Ok(()),
            }
        }
    }

    fn initialise(&mut self) -> Result<()> {
        self.set_point()?;
        self.acquisition.initialise()?;
        let first = self.row()?;
        self.procedure.begin(first.t_ns);
        self.next_tick_ns = first.t_ns;
        self.take(&first)
    }

    #[inline]
    fn row(&mut self) -> Result<Row> {
        match self.acquisition.next_row()? {
            Some(row) => Ok(row),
            None => Err(self.ended_early()),
        }
    }

    #[inline]
    fn take(&mut self, row: &Row) -> Result<()> {
        self.hash.update(row);
        if let Some(Err(error)) = self.log.as_mut().map(|log| log.push(row)) {
            self.lose_log(error.into());
        }
        let done = self.procedure.steps_done();
        self.procedure.take(&self.layout.scan(row)).map_err(|refusal| self.refused(&refusal))?;
        if self.procedure.steps_done() != done
            && let Some(warning) = self.steps.keep(&self.procedure)
        {
            self.watch.warn(warning);
        }
        if row.t_ns >= self.next_tick_ns {
            self.tick(row.t_ns)?;
        }
        if self.acquisition.is_time_to_show() {
            self.watch.see(&self.procedure.progress());
        }
        Ok(())
    }

    fn tick(&mut self, now_ns: u64) -> Result<()> {
        self.next_tick_ns += TICK_NS;
        let truths = self.acquisition.truths();
        if !truths.is_empty() {
            self.truths = truths;
        }
        self.announce();
        self.set_point()?;
        let air_c = match &mut self.control.by {
            Control::Recording | Control::Hand => None,
            Control::Chamber(chamber) => {
                chamber.pass(TICK_NS as f64 * 1e-9);
                chamber.read_c()?
            }
        };
        if let Some(air_c) = air_c {
            self.procedure.air(air_c).map_err(|refusal| self.refused(&refusal))?;
        }
        if let Some(obeying) = &mut self.obeying {
            obeying.set(self.procedure.set_point_c())?;
            obeying.pass(TICK_NS as f64 * 1e-9);
        }
        let around_c = air_c.or(self.obeying.as_ref().map(SimulatedChamber::air_c));
        if let (Some(writer), Some(air_c)) = (&self.writer, around_c) {
            writer.ramp_to(air_c, now_ns + TICK_NS);
        }
        Ok(())
    }

    /// Sets the chamber at first, and when its set point has moved by [`SET_STEP_C`] or reached the end of its ramp.
    fn set_point(&mut self) -> Result<()> {
        let wanted_c = self.procedure.set_point_c();
        let is_there = wanted_c == self.procedure.progress().to_c;
        let moved = |set_c: f64| (set_c - wanted_c).abs() >= SET_STEP_C || (is_there && set_c != wanted_c);
        if self.control.set_c().is_none_or(moved) { self.control.set(wanted_c) } else { Ok(()) }
    }

    /// Tells the person who sets the chamber by hand what to do at a new step.
    fn announce(&mut self) {
        let progress = self.procedure.progress();
        let is_new = self.announced != Some(progress.step) && progress.state != ChamberState::Done;
        if !matches!(self.control.by, Control::Hand) || !is_new {
            return;
        }
        self.announced = Some(progress.step);
        if let Some(step) = self.procedure.plan().steps.get(progress.step) {
            self.watch.step(&progress, step);
        }
    }

    /// Warns that the log failed, and drops the log. The measurement goes on, and its result reports the error.
    #[cold]
    fn lose_log(&mut self, error: anyhow::Error) {
        let after_s = self.procedure.progress().elapsed_s;
        self.watch.warn(JobWarning::LogFailed { after_s, why: format!("{error:#}") });
        self.log = None;
        self.log_failed = Some(error);
    }

    #[cold]
    fn refused(&self, why: &ChamberRefusal) -> anyhow::Error {
        CodedRefusal::new(why.code(), format!("{why}{}", self.steps.hint(self.procedure.steps_done()))).into()
    }

    #[cold]
    fn ended_early(&self) -> anyhow::Error {
        let progress = self.procedure.progress();
        let elapsed = Seconds(progress.elapsed_s);
        let where_it_is = format!("step {} of {}, {}", progress.step + 1, progress.steps, progress.state);
        if self.acquisition.is_stopped() {
            let hint = self.steps.hint(self.procedure.steps_done());
            return anyhow::anyhow!("interrupted after {elapsed}, in {where_it_is}; nothing written{hint}");
        }
        anyhow::anyhow!(
            "the recording ends after {elapsed}, in {where_it_is}: give the plan that it was recorded by, or a CSV of \
             what the chamber did"
        )
    }
}

fn is_stopped(error: &anyhow::Error) -> bool {
    error.downcast_ref().map(DeviceError::cause) == Some(Cause::Stopped)
}
