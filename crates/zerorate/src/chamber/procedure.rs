//! The measurement in a chamber as a state machine without clock, bus or chamber: readings and times go in; where the
//! air is to be comes out.
//!
//! All transitions stand in [`TABLE`]. Samples alone decide them: what the chamber says of its air can only end a
//! measurement, so that a recording of the samples gives the same result.

use super::plan::{ChamberPlan, StepEnd};
use super::record::{Drift, Record, Soak};
use super::refusal::{ChamberRefusal, Disturbance};
use crate::code_sum::CodeSum;
use crate::gls::{dot, take_out};
use crate::health::{Flags, Health, Judged};
use crate::ledger::{BLOCK_NS, BLOCK_S};
use crate::part::{Axis, Part};
use crate::reading::Scan;
use crate::stationarity::{self, Verdict, adjacent};
use crate::tally::Tally;

use alloc::vec::Vec;
use core::fmt;

/// Where the measurement stands. `Display` names it as a user would.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the table and Display say what each is")]
pub enum ChamberState {
    Start,
    Approach,
    Hold,
    Settle,
    Average,
    Done,
}

/// When a state ends.
#[derive(Clone, Copy)]
enum Until {
    Initialised,
    /// The set point is where the step takes it.
    Arrived,
    /// The step's time is over.
    Held,
    /// The part's own temperature has come to rest near the set point.
    Settled,
    /// It was averaged long enough.
    Averaged,
    Never,
}

/// What follows a state.
#[derive(Clone, Copy)]
enum To {
    State(ChamberState),
    /// By how the step ends.
    ByStep {
        hold: ChamberState,
        average: ChamberState,
    },
    /// The next step, or the end.
    Next {
        step: ChamberState,
        end: ChamberState,
    },
}

/// One line of the table: in `from` until `until`, then into `to`, and into `disturbed` where it was disturbed.
struct Row {
    from: ChamberState,
    name: &'static str,
    until: Until,
    to: To,
    disturbed: Option<ChamberState>,
}

const STATES: usize = 6;

#[rustfmt::skip]
const TABLE: [Row; STATES] = {
    use ChamberState::{Approach, Average, Done, Hold, Settle, Start};
    let next = To::Next { step: Approach, end: Done };
    [
        Row { from: Start, name: "initialisation", until: Until::Initialised,
              to: To::State(Approach), disturbed: None },
        Row { from: Approach, name: "going to the set point", until: Until::Arrived,
              to: To::ByStep { hold: Hold, average: Settle }, disturbed: None },
        Row { from: Hold, name: "holding the set point", until: Until::Held, to: next, disturbed: None },
        Row { from: Settle, name: "settling", until: Until::Settled, to: To::State(Average), disturbed: None },
        Row { from: Average, name: "the average", until: Until::Averaged, to: next, disturbed: Some(Settle) },
        Row { from: Done, name: "the end", until: Until::Never, to: To::State(Done), disturbed: None },
    ]
};

/// Each state finds its row by its number.
const _: () = {
    let mut index = 0;
    while index < STATES {
        assert!(TABLE[index].from as usize == index);
        index += 1;
    }
};

impl ChamberState {
    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }
}

impl fmt::Display for ChamberState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().name)
    }
}

/// What the caller does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChamberAction {
    /// Initialise the part and report the time of its first reading by [`ChamberProcedure::begin`].
    Initialise,
    /// Keep the air at [`ChamberProcedure::set_point_c`], and hand in what is read.
    Read,
    /// Call [`ChamberProcedure::finish`].
    Done,
}

/// How far the measurement has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChamberProgress {
    /// What is being done.
    pub state: ChamberState,
    /// At which step, from 0.
    pub step: usize,
    /// Of how many.
    pub steps: usize,
    /// Time since the first reading, s.
    pub elapsed_s: f64,
    /// How long it still takes at least, s.
    pub left_s: f64,
    /// Where the air is to be at the end of the step, °C.
    pub to_c: f64,
    /// The part's own temperature during the last second, °C.
    pub temp_c: Option<f64>,
}

/// Air this near to the set point has reached it, °C.
pub(super) const REACHED_C: f64 = 3.0;
/// The air may be farther away for so long, s, once the set point is where it goes: chambers take an hour for a
/// hundred degrees.
const REACH_S: f64 = 5400.0;
/// Temperature that an average may move through, °C.
const AVERAGE_MOVES_C: f64 = 1.0;
/// So often a soak point is averaged anew.
const MAX_DISTURBED: u32 = 3;
/// Rest is judged over so many seconds while the temperature changes.
const REST_S: usize = 100;
/// Largest share of the time without rest.
const MAX_RESTLESS: f64 = 0.1;
/// A part warms itself by no more than this above the air, °C, and reads no less than that below it (M-03 with room
/// for other parts).
const SELF_HEATING_C: (f64, f64) = (-5.0, 25.0);
/// Without a reading for so long the measurement ends, s.
const SILENT_S: u64 = 60;
/// A part tells its temperature within so long, s.
const TEMPERATURE_S: f64 = 30.0;
/// Ten blocks are a second.
const SECOND_NS: u64 = 10 * BLOCK_NS;

/// Sums of a block of 0.1 s of one axis.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    rate: CodeSum,
    temp: CodeSum,
}

/// One axis: its judge, its second so far, and the blocks over which rest is judged.
#[derive(Clone, Debug)]
struct AxisState {
    axis: Axis,
    health: Health,
    second: [Block; 10],
    /// Rate and temperature, °/s and °C.
    blocks: Vec<(f64, f64)>,
    white_dps_per_rt_hz: Option<f64>,
}

/// What happened in the present state.
#[derive(Clone, Copy, Debug, Default)]
struct Present {
    began_s: f64,
    /// Of the record.
    first: usize,
    /// Of an average: its length, s.
    average_s: f64,
    out_of_range: bool,
}

/// The measurement in a chamber, step by step.
///
/// ```
/// use zerorate::Part;
/// use zerorate::chamber::{ChamberAction, ChamberPlan, ChamberProcedure, Step, StepEnd};
/// let step = |to_c| Step { to_c, c_per_min: Some(2.0), end: StepEnd::Average(None) };
/// let plan = ChamberPlan {
///     name: "two points".into(),
///     steps: vec![step(15.0), step(55.0)],
///     drift_c_per_min: None,
///     window_s: 120.0,
///     settle_timeout_s: 7200.0,
///     overshoot_c: 5.0,
///     safe_c: 25.0,
/// };
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
    /// Time of the record at `started_ns`, s: that of a measurement that was resumed.
    offset_s: f64,
    /// The second that is being filled, from `started_ns`.
    second: u64,
    axes: Vec<AxisState>,
    record: Record,
    /// Where `axes[..].blocks` begin in the record.
    blocks_from: usize,
    tally: Tally,
    present: Present,
    disturbed: u32,
    /// Set point and temperature of the last soak point at which the part had settled.
    settled_at_c: Option<(f64, f64)>,
    /// What the chamber said last.
    air_c: Option<f64>,
    first_air_c: Option<f64>,
    beyond: u32,
}

impl ChamberProcedure {
    /// A measurement of this part that has not begun; no more than a share of `max_lost` of all samples may be lost.
    ///
    /// # Errors
    /// The plan does not fit the part.
    pub fn new(part: &Part, plan: ChamberPlan, max_lost: f64) -> Result<Self, super::ChamberPlanError> {
        plan.fits(part)?;
        let axis = |axis: &crate::NamedAxis| AxisState {
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
            first_air_c: None,
            beyond: 0,
        })
    }

    /// The same with the steps that a record has already, which ended `gap_s` before it goes on.
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

    /// What to do next.
    #[must_use]
    #[inline]
    pub fn next(&self) -> ChamberAction {
        match self.state {
            ChamberState::Start => ChamberAction::Initialise,
            ChamberState::Done => ChamberAction::Done,
            _ => ChamberAction::Read,
        }
    }

    /// The plan that is carried out.
    #[must_use]
    pub fn plan(&self) -> &ChamberPlan {
        &self.plan
    }

    /// What is measured.
    #[must_use]
    pub fn part(&self) -> &Part {
        &self.part
    }

    /// What was measured so far.
    #[must_use]
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// What the steps that are over have measured; to be asked where one of them ends.
    #[must_use]
    pub fn finished_steps(&self) -> (Record, usize) {
        let [samples, lost, impossible] = self.counts();
        (Record { samples, lost, impossible, ..self.record.clone() }, self.steps_done())
    }

    /// Samples of this run; those of one that was resumed are in the record alone.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Steps that are over.
    #[must_use]
    #[inline]
    pub fn steps_done(&self) -> usize {
        if self.state == ChamberState::Done { self.plan.steps.len() } else { self.step }
    }

    /// Where the air is to be now, °C.
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

    /// How far it has come.
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

    /// The part was initialised, and its first reading is of this time.
    pub fn begin(&mut self, t_ns: u64) {
        if self.state == ChamberState::Start {
            self.started_ns = t_ns;
            self.enter(ChamberState::Approach);
        }
    }

    /// Takes in a reading of all axes. A refusal is final.
    ///
    /// # Errors
    /// What was measured must not become a calibration.
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

    /// What the chamber says of its air, °C. Never needed; it only ends a measurement that cannot become one.
    ///
    /// # Errors
    /// The chamber does not do what it is told.
    pub fn air(&mut self, air_c: f64) -> Result<(), ChamberRefusal> {
        self.air_c = Some(air_c);
        // where the air was at first may be where the plan never goes
        let first_c = *self.first_air_c.get_or_insert(air_c);
        let (low_c, high_c) = self.plan.span_c();
        let (low_c, high_c) = (low_c.min(first_c), high_c.max(first_c));
        let (low_c, high_c) = (low_c - self.plan.overshoot_c, high_c + self.plan.overshoot_c);
        self.beyond = if (low_c..=high_c).contains(&air_c) { 0 } else { self.beyond + 1 };
        let step = self.step + 1;
        if self.beyond >= 2 {
            return Err(ChamberRefusal::Overshoot { step, air_c, low_c, high_c });
        }
        let (set_c, after_s) = (self.plan.course_c(self.step).1, self.now_s() - self.present.began_s);
        let waits = matches!(self.state, ChamberState::Settle | ChamberState::Hold);
        if waits && after_s > REACH_S.min(self.plan.settle_timeout_s) && (air_c - set_c).abs() > REACHED_C {
            return Err(ChamberRefusal::NotReached { step, set_c, air_c, after_s });
        }
        Ok(())
    }

    /// The record, once [`ChamberProcedure::next`] says [`ChamberAction::Done`].
    ///
    /// # Errors
    /// Samples were lost, or the part was not at rest, for too great a share of the time.
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
}

impl ChamberProcedure {
    /// Time of the record at which the second that is being filled begins, s.
    fn now_s(&self) -> f64 {
        self.offset_s + self.second as f64
    }

    /// Samples, lost ones and impossible readings, those before it was resumed included.
    fn counts(&self) -> [u64; 3] {
        let impossible = self.axes.first().map_or(0, |axis| axis.health.marks().spoilt());
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
        let block = &mut state.second[(at_ns % SECOND_NS / BLOCK_NS) as usize];
        if let Some(rate) = judged.rate() {
            block.rate.push(rate);
        }
        if let Some(temp) = judged.temp() {
            block.temp.push(temp);
        }
        self.present.out_of_range |= judged.flags.has(Flags::OUT_OF_RANGE);
    }

    /// Ends the seconds before `second`, and the states that are over with them.
    fn close_seconds(&mut self, second: u64) -> Result<(), ChamberRefusal> {
        if second - self.second > SILENT_S {
            return Err(ChamberRefusal::Silent { step: self.step + 1, for_s: (second - self.second) as f64 });
        }
        while self.second < second && self.state != ChamberState::Done {
            self.close_second();
            self.second += 1;
            self.look()?;
        }
        Ok(())
    }

    fn close_second(&mut self) {
        let start_s = self.now_s();
        let mut means = Vec::with_capacity(self.axes.len());
        for state in &mut self.axes {
            let AxisState { axis, second, blocks, .. } = state;
            let sum =
                |all: Block, block: &Block| Block { rate: all.rate.and(block.rate), temp: all.temp.and(block.temp) };
            let all = second.iter().fold(Block::default(), sum);
            let (rate_dps, temp_c) = (all.rate.mean(&axis.rate), all.temp.mean(&axis.temp));
            for block in core::mem::take(second) {
                let temp_c = block.temp.mean(&axis.temp).or(temp_c);
                blocks.extend(block.rate.mean(&axis.rate).zip(temp_c));
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

    /// What has become of the present state.
    fn look(&mut self) -> Result<(), ChamberRefusal> {
        if let Some(frozen) = self.axes.iter().find_map(|axis| axis.health.frozen()) {
            let since_ns = frozen.since_ns.saturating_sub(self.started_ns);
            let at_s = self.second as f64;
            return Err(ChamberRefusal::Frozen { at_s, for_s: at_s - since_ns as f64 * 1e-9 });
        }
        let here_s = self.now_s() - self.present.began_s;
        if self.record.len() == self.present.first && here_s > TEMPERATURE_S {
            return Err(ChamberRefusal::NoTemperature { step: self.step + 1, after_s: here_s });
        }
        if self.record.len() - self.blocks_from >= REST_S && self.state != ChamberState::Average {
            self.judge_rest();
        }
        match self.state.row().until {
            Until::Initialised | Until::Never => {}
            Until::Arrived => self.arrived(here_s),
            Until::Held => self.held(here_s),
            Until::Settled => return self.settled(here_s),
            Until::Averaged => return self.averaged(here_s),
        }
        Ok(())
    }

    fn arrived(&mut self, here_s: f64) {
        let (from_c, _) = self.plan.course_c(self.step);
        if here_s >= self.plan.steps[self.step].ramp_s(from_c) {
            self.leave(false);
        }
    }

    fn held(&mut self, here_s: f64) {
        let StepEnd::Hold(hold_s) = self.plan.steps[self.step].end else { return };
        if here_s >= hold_s {
            let average_s = self.average_s(None).min(hold_s);
            self.keep_soak(self.now_s() - average_s, average_s);
            self.leave(false);
        }
    }

    fn settled(&mut self, here_s: f64) -> Result<(), ChamberRefusal> {
        let StepEnd::Average(planned_s) = self.plan.steps[self.step].end else { return Ok(()) };
        let (window_s, timeout_s) = (self.plan.window_s, self.plan.settle_timeout_s);
        let average_s = self.average_s(planned_s);
        let limit_c_per_s = self.plan.drift_c_per_s(average_s, &self.part);
        let Some(drift) = self.record.drift(self.record.index_of(self.now_s() - window_s)) else { return Ok(()) };
        if here_s >= window_s && drift.is_below(limit_c_per_s) && self.is_near(&drift) {
            self.leave(false);
            self.present.average_s = average_s;
            return Ok(());
        }
        if here_s > timeout_s {
            return Err(ChamberRefusal::NotSettled {
                step: self.step + 1,
                set_c: self.plan.course_c(self.step).1,
                temp_c: drift.mean_c,
                drift_c_per_min: drift.c_per_s * 60.0,
                most_c_per_min: limit_c_per_s * 60.0,
                air_c: self.air_c,
            });
        }
        Ok(())
    }

    /// Whether a part that has come to rest did so at this set point. Its own warmth is what it was at the last one;
    /// at the first it may be anything that parts have.
    fn is_near(&self, drift: &Drift) -> bool {
        let set_c = self.plan.course_c(self.step).1;
        match self.settled_at_c {
            None => (SELF_HEATING_C.0..=SELF_HEATING_C.1).contains(&(drift.mean_c - set_c)),
            Some((last_set_c, last_c)) => {
                let (wanted_c, moved_c) = (set_c - last_set_c, drift.mean_c - last_c);
                (moved_c - wanted_c).abs() <= REACHED_C.min(0.5 * wanted_c.abs()).max(AVERAGE_MOVES_C)
            }
        }
    }

    fn averaged(&mut self, here_s: f64) -> Result<(), ChamberRefusal> {
        let Present { first, average_s, .. } = self.present;
        let moved = self.moved_c(first).filter(|moved_c| moved_c.abs() > AVERAGE_MOVES_C);
        if let Some(moved_c) = moved {
            return self.disturb(Disturbance::Temperature { moved_c, limit_c: AVERAGE_MOVES_C });
        }
        if here_s < average_s {
            return Ok(());
        }
        let seconds = self.record.len() - first;
        if self.present.out_of_range {
            return self.disturb(Disturbance::OutOfRange);
        }
        if (seconds as f64) < 0.8 * average_s {
            return self.disturb(Disturbance::Gaps);
        }
        if let Some(axis) = self.judge_rest() {
            return self.disturb(Disturbance::Motion { axis });
        }
        self.keep_soak(self.now_s() - average_s, average_s);
        let last = self.record.soaks.last();
        self.settled_at_c = last.map(|soak| (soak.set_c, soak.temp_c));
        self.leave(false);
        Ok(())
    }

    /// How far the temperature is from where an average began, °C.
    fn moved_c(&self, first: usize) -> Option<f64> {
        Some(self.record.temp_c.last()? - self.record.temp_c.get(first)?)
    }

    fn disturb(&mut self, why: Disturbance) -> Result<(), ChamberRefusal> {
        self.disturbed += 1;
        if self.disturbed > MAX_DISTURBED {
            return Err(ChamberRefusal::Disturbed { step: self.step + 1, times: self.disturbed, why });
        }
        self.leave(true);
        Ok(())
    }

    fn average_s(&self, planned_s: Option<f64>) -> f64 {
        let white: Vec<Option<f64>> = self.axes.iter().map(|axis| axis.white_dps_per_rt_hz).collect();
        self.plan.average_s(planned_s, &self.part, &white)
    }

    /// Keeps the mean of what was read since `from_s`.
    fn keep_soak(&mut self, from_s: f64, average_s: f64) {
        let from = self.record.index_of(from_s);
        let Some(drift) = self.record.drift(from) else { return };
        let limit_c_per_s = self.plan.drift_c_per_s(average_s, &self.part);
        let mean = |values: &Vec<f64>| values[from..].iter().sum::<f64>() / (values.len() - from) as f64;
        let soak = Soak {
            step: self.step,
            set_c: self.plan.course_c(self.step).1,
            start_s: self.record.start_s[from],
            end_s: self.now_s(),
            temp_c: mean(&self.record.temp_c),
            drift_c_per_min: drift.c_per_s * 60.0,
            settled: drift.is_below(limit_c_per_s),
            rates_dps: self.record.rates_dps.iter().map(mean).collect(),
        };
        self.record.soaks.push(soak);
    }

    /// Whether the part was at rest since this was asked last; else which axis was not. The seconds are marked, and
    /// quiet ones tell the white noise.
    fn judge_rest(&mut self) -> Option<usize> {
        let (from, len) = (self.blocks_from, self.record.len());
        let mut moving = None;
        for (index, state) in self.axes.iter_mut().enumerate() {
            let rates_dps = without_temperature(&core::mem::take(&mut state.blocks));
            match stationarity::judge(&state.axis, &rates_dps, 0.0) {
                Verdict::AtRest | Verdict::Step { .. } => {
                    let white = stationarity::white_density(adjacent(&rates_dps, 1));
                    state.white_dps_per_rt_hz = (rates_dps.len() as f64 * BLOCK_S >= WHITE_S).then_some(white);
                }
                Verdict::Moving { .. } | Verdict::Noisy { .. } => moving = moving.or(Some(index)),
            }
        }
        if moving.is_some() {
            self.record.at_rest[from.min(len)..].fill(false);
        }
        self.blocks_from = len;
        moving
    }

    /// From a state that is over into the next.
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
        // what happened before is no part of the new state
        let _ = self.judge_rest();
        self.state = state;
        self.present = Present { began_s: self.now_s(), first: self.record.len(), ..Present::default() };
        if matches!(self.state.row().until, Until::Arrived) {
            self.arrived(0.0);
        }
    }
}

/// The shortest record that tells the white noise, s.
const WHITE_S: f64 = 20.0;

/// Rates less the parabola over temperature that fits them best: what a bias does that follows the temperature is no
/// motion, and within [`REST_S`] a chamber may go far.
fn without_temperature(blocks: &[(f64, f64)]) -> Vec<f64> {
    let mean_c = blocks.iter().map(|(_, c)| c).sum::<f64>() / blocks.len().max(1) as f64;
    let mut rates_dps: Vec<f64> = blocks.iter().map(|(dps, _)| *dps).collect();
    let mut units: Vec<Vec<f64>> = Vec::with_capacity(3);
    for power in 0..3 {
        let mut unit: Vec<f64> = blocks.iter().map(|(_, c)| libm::pow(c - mean_c, f64::from(power))).collect();
        units.iter().for_each(|before| take_out(&mut unit, before));
        let length = libm::sqrt(dot(&unit, &unit));
        if length > 0.0 {
            unit.iter_mut().for_each(|value| *value /= length);
            take_out(&mut rates_dps, &unit);
            units.push(unit);
        }
    }
    rates_dps
}
