//! The measurement in a chamber, as a state machine without clock, bus or chamber. Readings and times go in, and
//! the set point of the air comes out.
//!
//! All transitions are in one table (`states.rs`), and `procedure/judging.rs` decides from the samples alone when
//! they are due. The air temperature that the chamber reports can only end a measurement, so a recording of the
//! samples gives the same result.

mod judging;

use super::plan::{ChamberPlan, StepEnd};
use super::record::Record;
use super::refusal::ChamberRefusal;
use super::states::{ChamberState, To, Until};
use crate::health::block_means::BLOCK_NS;
use crate::health::{Flags, Health, Judged, Tally};
use crate::part::{Axis, NamedAxis, Part, Scan};
use crate::procedure::Block;

use alloc::vec::Vec;

/// The next thing for the caller to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChamberAction {
    /// Initialise the part and report the time of its first reading by [`ChamberProcedure::begin`].
    Initialise,
    /// Keep the air at [`ChamberProcedure::set_point_c`], and hand in the readings.
    Read,
    /// Call [`ChamberProcedure::finish`].
    Done,
}

/// Progress of the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChamberProgress {
    /// The present state.
    pub state: ChamberState,
    /// Index of the present step, from 0. After the last step it is the number of steps.
    pub step: usize,
    /// Number of steps of the plan, with the steps of every cycle.
    pub steps: usize,
    /// Time since the first reading of this run, s.
    pub elapsed_s: f64,
    /// Least remaining time, s.
    pub left_s: f64,
    /// Set point at the end of the step, °C. After the last step it is `safe_c` of the plan.
    pub to_c: f64,
    /// The part's own temperature during the last second of the record, °C. `None` if the record is empty.
    pub temp_c: Option<f64>,
}

/// Largest allowed share of the time in which the part is not at rest.
const MAX_RESTLESS: f64 = 0.1;
const SECOND_NS: u64 = 10 * BLOCK_NS;

/// State of one axis: its health checks, the second that is being filled, and the blocks from which rest is judged.
#[derive(Clone, Debug)]
struct AxisState {
    axis: Axis,
    health: Health,
    second: [Block; 10],
    /// Mean rate and temperature of each block, °/s and °C.
    blocks: Vec<(f64, f64)>,
    white_dps_per_rt_hz: Option<f64>,
}

/// The approach of the air to the temperature span of the plan. The air may start outside of the span.
#[derive(Clone, Copy, Debug, Default)]
enum AirApproach {
    /// The chamber has not reported an air temperature yet.
    #[default]
    Unknown,
    /// The first air temperature, °C, which is outside of the span, and the step during which it came.
    From { air_c: f64, step: usize },
    /// The air has reached the span, or the step in which it was outside is over.
    Over,
}

/// The beginning of the present state, and whether a reading since then was out of range.
#[derive(Clone, Copy, Debug, Default)]
struct Present {
    began_s: f64,
    /// Index in the record of the first second of the state.
    first: usize,
    /// Length of the average, s, if the state is an average.
    average_s: f64,
    out_of_range: bool,
    has_temp: bool,
}

/// The procedure of a measurement in a chamber, step by step.
///
/// ```
/// use zerorate::Part;
/// use zerorate::chamber::{ChamberAction, ChamberPlan, ChamberProcedure, Step, StepEnd};
/// let step = |to_c| Step { to_c, c_per_min: Some(2.0), end: StepEnd::Average(None) };
/// let plan = ChamberPlan { steps: vec![step(15.0), step(55.0)], ..ChamberPlan::default() };
/// let mut procedure = ChamberProcedure::new(&Part::ADIS16130, plan, 0.001)?;
/// assert_eq!((procedure.next(), procedure.set_point_c()), (ChamberAction::Initialise, 15.0));
/// procedure.begin(1_000);
/// assert_eq!(procedure.next(), ChamberAction::Read);
/// # Ok::<(), zerorate::chamber::ChamberPlanError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ChamberProcedure {
    part: Part,
    plan: ChamberPlan,
    max_lost: f64,
    state: ChamberState,
    step: usize,
    started_ns: u64,
    /// Time of the record at `started_ns`, s. It is above zero if the measurement was resumed.
    offset_s: f64,
    /// Number of the second that is being filled, counted from `started_ns`.
    second: u64,
    axes: Vec<AxisState>,
    record: Record,
    /// Index in the record at which `axes[..].blocks` begin.
    blocks_from: usize,
    tally: Tally,
    present: Present,
    disturbed: u32,
    /// Set point and temperature of the last soak point with an average, °C.
    settled_at_c: Option<(f64, f64)>,
    /// Last air temperature that the chamber reported, °C.
    air_c: Option<f64>,
    coming: AirApproach,
    beyond: u32,
}

impl ChamberProcedure {
    /// Prepares a measurement of this part. A share of at most `max_lost` of all samples may be lost.
    ///
    /// # Errors
    /// Returns an error if the plan does not fit the part.
    pub fn new(part: &Part, plan: ChamberPlan, max_lost: f64) -> Result<Self, super::ChamberPlanError> {
        plan.fits(part)?;
        let axis = |axis: &NamedAxis| AxisState {
            axis: axis.axis,
            health: Health::new(&axis.axis),
            second: Default::default(),
            blocks: Vec::new(),
            white_dps_per_rt_hz: None,
        };
        Ok(Self {
            axes: part.axes.iter().map(axis).collect(),
            record: Record::new(part.axes.len()),
            part: part.clone(),
            plan,
            max_lost,
            state: ChamberState::Start,
            step: 0,
            started_ns: 0,
            offset_s: 0.0,
            second: 0,
            blocks_from: 0,
            tally: Tally::default(),
            present: Present::default(),
            disturbed: 0,
            settled_at_c: None,
            air_c: None,
            coming: AirApproach::default(),
            beyond: 0,
        })
    }

    /// Continues an earlier measurement: `record` is its record, which ended `gap_s` seconds ago, and `steps` is the
    /// number of its finished steps.
    #[must_use]
    pub fn resumed(mut self, record: Record, steps: usize, gap_s: f64) -> Self {
        self.offset_s = record.start_s.last().map_or(0.0, |last_s| libm::ceil(last_s + 1.0 + gap_s.max(0.0)));
        self.blocks_from = record.len();
        self.step = steps.min(self.plan.steps.len());
        self.record = record;
        if self.step == self.plan.steps.len() {
            self.state = ChamberState::Done;
        }
        self
    }

    /// Returns what the caller must do next.
    #[must_use]
    #[inline]
    pub fn next(&self) -> ChamberAction {
        match self.state {
            ChamberState::Start => ChamberAction::Initialise,
            ChamberState::Done => ChamberAction::Done,
            _ => ChamberAction::Read,
        }
    }

    /// The plan with which the procedure was made.
    #[must_use]
    pub fn plan(&self) -> &ChamberPlan {
        &self.plan
    }

    /// The part for which the procedure was made.
    #[must_use]
    pub fn part(&self) -> &Part {
        &self.part
    }

    /// The record so far: the means over each second, and the soak points. Its counts lack the samples of this run.
    #[must_use]
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The record of the finished steps, and their number. Call this when a step ends.
    #[must_use]
    pub fn finished_steps(&self) -> (Record, usize) {
        let [samples, lost, impossible] = self.counts();
        (Record { samples, lost, impossible, ..self.record.clone() }, self.steps_done())
    }

    /// Counts of the samples of this run. The samples before an interruption are counted in the record.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Number of finished steps.
    #[must_use]
    #[inline]
    pub fn steps_done(&self) -> usize {
        if self.state == ChamberState::Done { self.plan.steps.len() } else { self.step }
    }

    /// The present set point, °C.
    #[must_use]
    pub fn set_point_c(&self) -> f64 {
        let (from_c, to_c) = self.plan.course_c(self.step);
        let ramp_s = self.plan.steps.get(self.step).map_or(0.0, |step| step.ramp_s(from_c));
        match self.state {
            ChamberState::Done => self.plan.safe_c,
            ChamberState::Start if ramp_s > 0.0 => from_c,
            ChamberState::Approach if ramp_s > 0.0 => {
                let share = (self.now_s() - self.present.began_s) / ramp_s;
                from_c + (to_c - from_c) * share.clamp(0.0, 1.0)
            }
            _ => to_c,
        }
    }

    /// Progress of the measurement.
    #[must_use]
    pub fn progress(&self) -> ChamberProgress {
        let Self { state, step, .. } = *self;
        let left_s = self.plan.least_s(self.step, &self.part) - self.in_step_s();
        ChamberProgress {
            state,
            step,
            steps: self.plan.steps.len(),
            elapsed_s: self.now_s() - self.offset_s,
            left_s: left_s.max(0.0),
            to_c: self.plan.course_c(step).1,
            temp_c: self.record.temp_c.last().copied(),
        }
    }

    /// Begins the measurement: the part was initialised, and its first reading has this time.
    pub fn begin(&mut self, t_ns: u64) {
        if self.state == ChamberState::Start {
            self.started_ns = t_ns;
            self.enter(ChamberState::Approach);
        }
    }

    /// Takes in a reading of all axes. A refusal is final.
    ///
    /// # Errors
    /// Returns a refusal if the measurement must not become a calibration.
    #[inline]
    pub fn take(&mut self, scan: &Scan) -> Result<(), ChamberRefusal> {
        if matches!(self.state, ChamberState::Start | ChamberState::Done) {
            return Ok(());
        }
        if let Some(first) = scan.reading(0) {
            self.tally.count(&first);
        }
        for index in 0..self.axes.len() {
            let Some(reading) = scan.reading(index) else { continue };
            let Some(judged) = self.axes[index].health.push(&reading) else { continue };
            let at_ns = judged.reading.t_ns.saturating_sub(self.started_ns);
            if index == 0 && at_ns / SECOND_NS > self.second {
                self.close_seconds(at_ns / SECOND_NS)?;
                if self.state == ChamberState::Done {
                    return Ok(());
                }
            }
            self.push(index, at_ns, &judged);
        }
        Ok(())
    }

    /// Returns the record, once [`ChamberProcedure::next`] returns [`ChamberAction::Done`].
    ///
    /// # Errors
    /// Returns a refusal if too many samples were lost, or the part was not at rest for too much of the time.
    pub fn finish(mut self) -> Result<Record, ChamberRefusal> {
        let [samples, lost, impossible] = self.counts();
        (self.record.samples, self.record.lost, self.record.impossible) = (samples, lost, impossible);
        let limit = self.max_lost;
        if lost as f64 > limit * (lost + samples) as f64 {
            return Err(ChamberRefusal::Lost { lost, samples, limit });
        }
        let share = self.record.restless();
        match share > MAX_RESTLESS {
            true => Err(ChamberRefusal::Restless { share, limit: MAX_RESTLESS }),
            false => Ok(self.record),
        }
    }

    /// Time of the record at which the second that is being filled begins, s.
    fn now_s(&self) -> f64 {
        self.offset_s + self.second as f64
    }

    /// Numbers of samples, of lost samples, and of impossible readings on the worst axis, with the earlier runs.
    fn counts(&self) -> [u64; 3] {
        let impossible = self.axes.iter().map(|axis| axis.health.fault_counts().faulty()).max().unwrap_or(0);
        let Record { samples, lost, impossible: before, .. } = self.record;
        [samples + self.tally.samples, lost + self.tally.lost, before + impossible]
    }

    fn in_step_s(&self) -> f64 {
        let (from_c, _) = self.plan.course_c(self.step);
        let ramp_s = self.plan.steps.get(self.step).map_or(0.0, |step| step.ramp_s(from_c));
        let before_s = match self.state {
            ChamberState::Start | ChamberState::Approach | ChamberState::Done => 0.0,
            ChamberState::Hold | ChamberState::Settle => ramp_s,
            ChamberState::Average => ramp_s + self.plan.window_s,
        };
        before_s + self.now_s() - self.present.began_s
    }

    #[inline]
    fn push(&mut self, index: usize, at_ns: u64, judged: &Judged) {
        let state = &mut self.axes[index];
        state.second[(at_ns % SECOND_NS / BLOCK_NS) as usize].push(judged);
        self.present.out_of_range |= judged.flags.has(Flags::OUT_OF_RANGE);
        self.present.has_temp |= judged.temp().is_some();
    }

    fn close_second(&mut self) {
        let start_s = self.now_s();
        let mut means = Vec::with_capacity(self.axes.len());
        for state in &mut self.axes {
            let AxisState { axis, second, blocks, .. } = state;
            let all = Block::merged(second.iter());
            let (rate_dps, temp_c) = (all.rate_dps(axis), all.temp_c(axis));
            for block in core::mem::take(second) {
                blocks.extend(block.rate_dps(axis).zip(block.temp_c(axis).or(temp_c)));
            }
            means.extend(rate_dps.zip(temp_c));
        }
        if means.len() == self.axes.len() {
            self.record.start_s.push(start_s);
            self.record.temp_c.push(means[0].1);
            self.record.at_rest.push(true);
            self.record.rates_dps.iter_mut().zip(&means).for_each(|(rates, (rate_dps, _))| rates.push(*rate_dps));
        }
    }

    /// Enters the next state, or after a disturbance the state in which the step is repeated.
    fn leave(&mut self, disturbed: bool) {
        let row = self.state.row();
        if let (true, Some(back)) = (disturbed, row.disturbed) {
            return self.enter(back);
        }
        match row.to {
            To::State(state) => self.enter(state),
            To::ByStep { hold, average } => {
                let is_held = matches!(self.plan.steps[self.step].end, StepEnd::Hold(_));
                self.enter(if is_held { hold } else { average });
            }
            To::Next { step, end } => {
                (self.step, self.disturbed) = (self.step + 1, 0);
                self.enter(if self.step < self.plan.steps.len() { step } else { end });
            }
        }
    }

    fn enter(&mut self, state: ChamberState) {
        // judge the seconds so far, so that earlier motion does not count in the new state
        let _ = self.judge_rest();
        self.state = state;
        self.present = Present { began_s: self.now_s(), first: self.record.len(), ..Present::default() };
        if matches!(self.state.row().until, Until::Arrived) {
            self.arrived(0.0);
        }
    }
}
