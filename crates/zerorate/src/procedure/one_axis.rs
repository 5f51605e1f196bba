//! The calibration of F-51 as a state machine without clock or bus: samples and times go in, and the next task comes
//! out. Its states and their transitions are in `states.rs`.

use super::blocks::Blocks;
use super::estimate::{self, Evidence, Outcome, WindowWarnings};
use super::recording::{self, Reached};
use super::running::Running;
use super::window_sums::WindowSums;
use crate::health::block_means::BLOCK_S;
use crate::health::stationarity::Verdict;
use crate::health::{Frozen, Health, Judged, Tally};
use crate::notice::Refusal;
use crate::part::{Axis, Reading};
use crate::plan::{Check, Method, Plan, PlanError, State, TABLE, Until, ns};

/// Time from the start of a step in which [`Procedure::pending_refusal`] returns `None`, s.
const FIRST_LOOK_S: f64 = 2.0;

/// Time from the start after which samples without any temperature are refused, ns. Longer waits would not help.
const TEMPERATURE_NS: u64 = 30_000_000_000;

/// The next task of the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Initialise the part with F-30 and report [`Event::Initialised`].
    Initialise,
    /// Pass on each reading, or the present time while there is none.
    Read,
    /// Call [`Procedure::finish`].
    Done,
}

/// An event that the caller saw. Times are nanoseconds of one clock that never goes back. `R` is a [`Reading`] of one
/// axis, or a [`Scan`](crate::Scan) of all.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a, R = Reading> {
    /// The part was initialised.
    Initialised {
        /// Time of the initialisation.
        t_ns: u64,
    },
    /// The part was read.
    Reading(&'a R),
    /// Time went by without a reading.
    Time {
        /// The present time.
        t_ns: u64,
    },
}

/// Progress of the procedure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The present step.
    pub state: State,
    /// Time since initialisation, s.
    pub elapsed_s: f64,
    /// Duration of the whole procedure, s.
    pub total_s: f64,
}

/// The procedure of F-51, step by step.
///
/// ```
/// use zerorate::{Action, Axis, Plan, Procedure};
/// let procedure = Procedure::new(&Axis::ADIS16130, Plan::default())?;
/// assert_eq!(procedure.next(), Action::Initialise);
/// assert_eq!(procedure.progress().total_s, 10.0 + 600.0 + 10.0 + 2400.0 + 150.0 + 1.0);
/// # Ok::<(), zerorate::PlanError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Procedure<S = Blocks> {
    axis: Axis,
    plan: Plan,
    state: State,
    started_ns: u64,
    now_ns: u64,
    /// Time at which the present state ends, ns from the start of the procedure.
    ends_ns: u64,
    sums: S,
    tally: Tally,
    health: Health,
}

/// The procedure on fixed memory, about 3 KB, for a microcontroller. It allocates nothing. It always follows
/// AN-1042, even if its plan names another method, because the other methods need every block.
///
/// PBC, BTC and T3 agree with [`Procedure`] bit for bit. Uncertainties and refusals agree too, with two
/// differences. First, it does not check the measurement as a whole ([`Warning::Found`](crate::Warning::Found)),
/// so its uncertainties do not allow for such deviations.
/// [`Warning::HourUnchecked`](crate::Warning::HourUnchecked) says so. Second, it refuses a small step inside an
/// average as motion or as unsteady, while [`Procedure`] accepts it with a warning. If some blocks of 0.1 s are
/// empty, the two may group the others differently, and then their uncertainties differ by a few per cent.
///
/// ```
/// use zerorate::{Action, Axis, FixedProcedure, Plan};
/// let procedure = FixedProcedure::on_fixed_memory(&Axis::ADIS16130, Plan::default())?;
/// assert_eq!(procedure.next(), Action::Initialise);
/// assert!(size_of_val(&procedure) < 4096);
/// # Ok::<(), zerorate::PlanError>(())
/// ```
pub type FixedProcedure = Procedure<Running>;

impl Procedure {
    /// Prepares a procedure for this axis.
    ///
    /// # Errors
    /// Returns an error if a duration or limit of the plan is impossible.
    pub fn new(axis: &Axis, plan: Plan) -> Result<Self, PlanError> {
        Self::with_sums(axis, plan)
    }

    /// Returns the result, once [`Procedure::next`] returns [`Action::Done`].
    ///
    /// # Errors
    /// Returns the errors of [`Procedure::handle`] or, before the end, a refusal because a window has too few samples.
    pub fn finish(self) -> Result<Outcome, Refusal> {
        match self.plan.method {
            Method::An1042 => estimate::outcome_of_hour(&self.seen(), &self.sums),
            Method::Warmup | Method::Cycle => recording::outcome(&self.seen(), &self.sums),
        }
    }

    /// Returns the uncertainties if the recording ended now, or the refusal. `None` outside of a recording, as
    /// during AN-1042. It takes as long as [`Procedure::finish`].
    pub fn reached(&self) -> Option<Result<Reached, Refusal>> {
        (self.state == State::Recording).then(|| {
            let mut ahead = self.clone();
            ahead.end_recording()?;
            recording::reached(&ahead.seen(), &ahead.sums)
        })
    }
}

impl FixedProcedure {
    /// Prepares a procedure for this axis.
    ///
    /// # Errors
    /// Returns an error if a duration or limit of the plan is impossible.
    pub fn on_fixed_memory(axis: &Axis, plan: Plan) -> Result<Self, PlanError> {
        Self::with_sums(axis, Plan { method: Method::An1042, ..plan })
    }

    /// Returns the result, once [`Procedure::next`] returns [`Action::Done`]. The procedure stays as it is.
    ///
    /// # Errors
    /// Returns the errors of [`Procedure::handle`] or, before the end, a refusal because a window has too few samples.
    pub fn outcome(&self) -> Result<Outcome<WindowWarnings>, Refusal> {
        estimate::outcome_of_windows(&self.seen())
    }
}

impl<S: WindowSums> Procedure<S> {
    fn with_sums(axis: &Axis, plan: Plan) -> Result<Self, PlanError> {
        plan.check()?;
        Ok(Self {
            axis: *axis,
            plan,
            state: State::Start,
            started_ns: 0,
            now_ns: 0,
            ends_ns: 0,
            sums: S::new(axis),
            tally: Tally::default(),
            health: Health::new(axis),
        })
    }

    /// The plan with which the procedure was made.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns what the caller must do next.
    #[must_use]
    #[inline]
    pub fn next(&self) -> Action {
        match self.state {
            State::Start => Action::Initialise,
            State::Done => Action::Done,
            _ => Action::Read,
        }
    }

    /// Progress of the measurement.
    #[must_use]
    #[inline]
    pub fn progress(&self) -> Progress {
        Progress { state: self.state, elapsed_s: self.now_ns as f64 * 1e-9, total_s: self.plan.total_s() }
    }

    /// The refusal that would follow if the present step ended now. `None` if none would or in its first two seconds.
    #[must_use]
    pub fn pending_refusal(&self) -> Option<Refusal> {
        let mut ahead = self.clone();
        let start_s = self.sums.summary(self.state).start_s;
        ahead.sums.close(self.state, self.now_ns);
        let lasted = self.now_ns as f64 * 1e-9 - start_s >= FIRST_LOOK_S;
        lasted.then(|| ahead.check(self.state.row().check).err()).flatten()
    }

    /// Takes in an event. A refusal is final: the measurement is over.
    ///
    /// # Errors
    /// Returns a refusal if the measurement must not become a calibration.
    #[inline]
    pub fn handle(&mut self, event: Event<'_>) -> Result<(), Refusal> {
        match event {
            Event::Initialised { t_ns } => {
                if self.state == State::Start {
                    self.started_ns = t_ns;
                    self.enter_next()?;
                }
                Ok(())
            }
            Event::Time { t_ns } => self.pass_to(t_ns, 0),
            Event::Reading(reading) => self.take(reading),
        }
    }

    fn seen(&self) -> Evidence<'_> {
        let windows = TABLE.each_ref().map(|row| self.sums.summary(row.from));
        Evidence { axis: &self.axis, plan: &self.plan, windows, tally: &self.tally }
    }

    /// Ends the recording now. Call this if the source of the samples has ended. It returns false and does nothing
    /// outside of a recording, because AN-1042 needs the steps that are still to come.
    ///
    /// # Errors
    /// Returns the same errors as [`Procedure::handle`].
    pub fn end_recording(&mut self) -> Result<bool, Refusal> {
        if self.state != State::Recording {
            return Ok(false);
        }
        self.judge_waiting(0);
        self.enter_next()?;
        Ok(true)
    }

    /// Ends the states that are over at `t_ns`. Waiting samples are judged before that, except for the newest `keep`.
    #[inline]
    fn pass_to(&mut self, t_ns: u64, keep: u64) -> Result<(), Refusal> {
        if matches!(self.state, State::Start | State::Done) {
            return Ok(());
        }
        self.now_ns = t_ns.saturating_sub(self.started_ns);
        while self.now_ns >= self.ends_ns && self.state != State::Done {
            self.judge_waiting(keep);
            self.enter_next()?;
        }
        Ok(())
    }

    #[inline]
    fn take(&mut self, reading: &Reading) -> Result<(), Refusal> {
        if self.state == State::Start {
            return Ok(());
        }
        if let Some(judged) = self.health.push(reading) {
            self.record(&judged);
        }
        // the sample that ends a step is not part of the step, but a recording includes its last sample
        let keep = u64::from(self.state != State::Recording);
        if keep == 0 {
            self.tally.count(reading);
        }
        self.pass_to(reading.t_ns, keep)?;
        if self.state == State::Done {
            return Ok(());
        }
        if keep > 0 {
            self.tally.count(reading);
        }
        if self.tally.lacks_temperature() && self.now_ns >= TEMPERATURE_NS {
            return Err(self.tally.no_temperature(self.state));
        }
        self.health.frozen().map_or(Ok(()), |frozen| Err(self.frozen(frozen)))
    }

    fn judge_waiting(&mut self, keep: u64) {
        while self.health.waiting() > keep
            && let Some(judged) = self.health.finish()
        {
            self.record(&judged);
        }
    }

    #[inline]
    fn record(&mut self, judged: &Judged) {
        self.sums.push(self.state, judged.reading.t_ns.saturating_sub(self.started_ns), judged);
    }

    #[cold]
    fn frozen(&self, frozen: Frozen) -> Refusal {
        let since_ns = frozen.since_ns.saturating_sub(self.started_ns);
        let (at_s, for_s) = (self.now_ns as f64 * 1e-9, self.now_ns.saturating_sub(since_ns) as f64 * 1e-9);
        Refusal::Frozen { at_s, for_s, both: frozen.both }
    }

    fn enter_next(&mut self) -> Result<(), Refusal> {
        let row = self.state.row();
        if self.state == State::Recording {
            self.ends_ns = self.now_ns;
        }
        self.sums.close(self.state, self.ends_ns);
        self.check(row.check)?;
        self.state = self.state.next(self.plan.method);
        let start_ns = self.ends_ns;
        if let Until::After(duration_s) = self.state.row().until {
            self.ends_ns = start_ns + ns(duration_s(&self.plan));
        }
        self.sums.open(self.state, start_ns, self.ends_ns);
        Ok(())
    }

    fn check(&self, check: Check) -> Result<(), Refusal> {
        match check {
            Check::Nothing => Ok(()),
            Check::AtRest => self.at_rest(),
            Check::AtRestAndWarmer => self.at_rest().and_then(|()| estimate::span_suffices(&self.seen())),
            Check::TemperatureWasRead => self.temperature_was_read(),
        }
    }

    /// Checks the number of samples, the losses, the range, bit errors, the temperature and rest.
    fn at_rest(&self) -> Result<(), Refusal> {
        let (window, seen) = (self.state, self.sums.summary(self.state));
        let (samples, lost, limit) = (seen.samples, seen.lost, self.plan.max_lost);
        if seen.overranged > seen.faulty {
            return Err(Refusal::Overranged { window, count: seen.overranged, samples });
        }
        if seen.overranged > 0 {
            // no more readings are out of range than have bit errors, and a bit error can flip the status
            let count = seen.faulty + seen.overranged;
            return Err(Refusal::BitErrors { window, count, samples, still_moves: false });
        }
        let needed = libm::ceil(0.8 * (seen.end_s - seen.start_s) / BLOCK_S) as u64;
        let tenths = seen.rates.count as u64;
        if tenths < needed {
            return Err(Refusal::TooFew { window, tenths, needed });
        }
        if lost as f64 > limit * (lost + samples) as f64 {
            return Err(self.lost(window, lost, samples));
        }
        let count = seen.faulty;
        if count as f64 > limit * samples as f64 {
            return Err(Refusal::BitErrors { window, count, samples, still_moves: false });
        }
        self.temperature_was_read()?;
        let rate_dps = seen.rate_dps.unwrap_or_default();
        if let Some(limit_dps) = self.axis.bias.largest_dps().filter(|limit_dps| rate_dps.abs() > *limit_dps) {
            return Err(Refusal::Turning { window, rate_dps, limit_dps });
        }
        match self.sums.verdict(window) {
            Verdict::AtRest | Verdict::Step { .. } => Ok(()),
            _ if count > 0 => Err(Refusal::BitErrors { window, count, samples, still_moves: true }),
            Verdict::Moving { tau_s, seen_dps, limit_dps } => {
                Err(Refusal::Moving { window, tau_s, seen_dps, limit_dps })
            }
            Verdict::Noisy { seen_dps_per_rt_hz, limit_dps_per_rt_hz } => {
                Err(Refusal::Noisy { window, seen_dps_per_rt_hz, limit_dps_per_rt_hz })
            }
        }
    }

    /// The refusal for lost samples. If data ready itself was silent in the gaps, the host is not to blame.
    fn lost(&self, window: State, lost: u64, samples: u64) -> Refusal {
        let Tally { gaps, silent_gaps, .. } = self.tally;
        if self.tally.data_ready_stutters() {
            Refusal::Stuttering { window, lost, samples, silent_gaps, gaps }
        } else {
            Refusal::Lost { window, lost, samples, limit: self.plan.max_lost }
        }
    }

    fn temperature_was_read(&self) -> Result<(), Refusal> {
        self.sums.summary(self.state).temp_c.map(|_| ()).ok_or(self.tally.no_temperature(self.state))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Setting;
    use alloc::string::ToString;

    #[test]
    fn a_refusal_is_known_before_its_step_ends() {
        let mut procedure = Procedure::new(&Axis::ADIS16130, Plan::default()).unwrap();
        procedure.handle(Event::Initialised { t_ns: 0 }).unwrap();
        for seq in 0..400 {
            let t_ns = u64::from(seq) * 10_000_000;
            let turning = if seq < 300 { 0 } else { 23_488 * 2 * (seq as i32 - 300) / 100 };
            let rate = turning + 100 * (seq as i32 % 5);
            let reading = Reading { t_ns, seq, rate, temp: Some(0), out_of_range: false, lost: 0 };
            procedure.handle(Event::Reading(&reading)).unwrap();
            match procedure.pending_refusal() {
                Some(refusal) => assert!(
                    seq > 300 && matches!(refusal, Refusal::Moving { .. } | Refusal::Noisy { .. }),
                    "{seq} {refusal}"
                ),
                None => assert!(seq < 380, "{seq}"),
            }
        }
    }

    #[test]
    fn plans_that_make_no_sense_are_refused_by_name() {
        let named = |plan: Plan| Procedure::new(&Axis::ADIS16130, plan).unwrap_err().setting;
        assert_eq!(named(Plan { average_s: 0.0, ..Plan::default() }), Setting::Average);
        assert_eq!(named(Plan { settle_s: f64::NAN, ..Plan::default() }), Setting::Settle);
        assert_eq!(named(Plan { max_u_btc_dps_per_c: 0.0, ..Plan::default() }), Setting::MaxUBtc);
        assert_eq!(named(Plan { earth_dps: Some(f64::INFINITY), ..Plan::default() }), Setting::Earth);
        assert_eq!(named(Plan { warmup_s: 1e9, ..Plan::default() }), Setting::WarmUp);
        assert_eq!(named(Plan { final_temp_s: -1.0, ..Plan::default() }), Setting::FinalTemperature);
        assert_eq!(named(Plan { max_lost: 1.5, ..Plan::default() }), Setting::MaxLost);
        assert_eq!(named(Plan { max_u_btc_dps_per_c: 2.0, ..Plan::default() }), Setting::MaxUBtc);
    }

    /// The Earth rotates by 15.04 °/h, which is 0.00418 °/s (F-16).
    #[test]
    fn a_rotation_in_degrees_per_hour_is_refused_with_its_unit() {
        let given = |dps| Procedure::new(&Axis::ADIS16130, Plan { earth_dps: Some(dps), ..Plan::default() });
        assert!([0.00418, -0.00418, 15.041 / 3600.0, 0.0].map(|dps| given(dps).is_ok()).iter().all(|ok| *ok));
        let text = given(15.04).unwrap_err().to_string();
        assert!(text.contains("-0.00418 to 0.00418 °/s") && text.contains("if that was °/h, give 0.00418"), "{text}");
        assert!(given(-0.0042).is_err() && given(f64::NAN).is_err());
        let text = given(0.5).unwrap_err().to_string();
        assert!(text.contains("°/h"), "{text}");
    }
}
