//! The procedure for all axes of a part at once. Each axis has a [`Procedure`], and all of them get the same times
//! and the same temperature.

use super::estimate::Outcome;
use super::one_axis::{Action, Event, Procedure, Progress};
use super::recording::Reached;
use crate::notice::Refusal;
use crate::part::{Part, Scan};
use crate::plan::{Plan, PlanError, Setting, SettingNames, State, Wording};
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;

/// The procedure of F-51 for all axes of a part.
///
/// It takes [`Scan`]s as [`Procedure`] takes readings, and is used in the same way. If one axis is refused, all are: a
/// part moves as a whole, and a calibration that lacks an axis would look like one of a part with fewer axes.
///
/// ```
/// use zerorate::{Action, Part, PartProcedure, Plan};
/// let procedure = PartProcedure::new(&Part::ADIS16130, Plan::default())?;
/// assert_eq!((procedure.next(), procedure.progress().total_s), (Action::Initialise, 3171.0));
/// # Ok::<(), zerorate::PlanError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PartProcedure {
    part: Part,
    plan: Plan,
    axes: Vec<Procedure>,
}

impl PartProcedure {
    /// Prepares a procedure for this part.
    ///
    /// # Errors
    /// Returns an error if a duration or limit of the plan is impossible.
    pub fn new(part: &Part, plan: Plan) -> Result<Self, PlanError> {
        let axes = part.axes.iter().map(|axis| Procedure::new(&axis.axis, plan)).collect::<Result<_, _>>()?;
        Ok(Self { part: part.clone(), plan, axes })
    }

    /// The part for which the procedure was made.
    #[must_use]
    pub fn part(&self) -> &Part {
        &self.part
    }

    /// The plan with which the procedure was made.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns what the caller must do next. All axes are at the same step.
    #[must_use]
    #[inline]
    pub fn next(&self) -> Action {
        self.axes.first().map_or(Action::Done, Procedure::next)
    }

    /// Progress of the measurement.
    #[must_use]
    #[inline]
    pub fn progress(&self) -> Progress {
        let total_s = self.plan.total_s();
        let none = Progress { state: State::Done, elapsed_s: 0.0, total_s };
        self.axes.first().map_or(none, Procedure::progress)
    }

    /// Takes in an event. A refusal is final: the measurement is over. An axis that a scan lacks counts as not
    /// read at that time.
    ///
    /// # Errors
    /// Returns a refusal if the measurement of an axis must not become a calibration.
    #[inline]
    pub fn handle(&mut self, event: Event<'_, Scan>) -> Result<(), AxisRefusal> {
        for (index, procedure) in self.axes.iter_mut().enumerate() {
            let handled = match event {
                Event::Initialised { t_ns } => procedure.handle(Event::Initialised { t_ns }),
                Event::Time { t_ns } => procedure.handle(Event::Time { t_ns }),
                Event::Reading(scan) => match scan.reading(index) {
                    Some(reading) => procedure.handle(Event::Reading(&reading)),
                    None => procedure.handle(Event::Time { t_ns: scan.t_ns }),
                },
            };
            handled.map_err(|refusal| AxisRefusal::new(&self.part, index, refusal))?;
        }
        Ok(())
    }

    /// Returns the refusals that would follow if the present step ended now ([`Procedure::pending_refusal`]).
    pub fn pending_refusals(&self) -> impl Iterator<Item = AxisRefusal> + '_ {
        let of =
            |(index, axis): (usize, &Procedure)| Some(AxisRefusal::new(&self.part, index, axis.pending_refusal()?));
        self.axes.iter().enumerate().filter_map(of)
    }

    /// Ends the recording now ([`Procedure::end_recording`]).
    ///
    /// # Errors
    /// Returns the same errors as [`PartProcedure::handle`].
    pub fn end_recording(&mut self) -> Result<bool, AxisRefusal> {
        let mut ended = !self.axes.is_empty();
        for (index, procedure) in self.axes.iter_mut().enumerate() {
            ended &= procedure.end_recording().map_err(|refusal| AxisRefusal::new(&self.part, index, refusal))?;
        }
        Ok(ended)
    }

    /// The uncertainties if the recording ended now ([`Procedure::reached`]). Each number comes from its worst axis.
    pub fn reached(&self) -> Option<Result<Reached, AxisRefusal>> {
        let of = |(index, axis): (usize, &Procedure)| {
            Some(axis.reached()?.map_err(|refusal| AxisRefusal::new(&self.part, index, refusal)))
        };
        let all: Option<Result<Vec<Reached>, AxisRefusal>> = self.axes.iter().enumerate().map(of).collect();
        all?.map(|all| all.into_iter().reduce(Reached::or_worse)).transpose()
    }

    /// Returns the outcomes in the order of the axes, once [`PartProcedure::next`] returns [`Action::Done`].
    ///
    /// # Errors
    /// Returns the errors of [`PartProcedure::handle`] or, before the end, a refusal because a window has too few
    /// samples.
    pub fn finish(self) -> Result<Vec<Outcome>, AxisRefusal> {
        let Self { part, axes, .. } = self;
        let finish = |(index, procedure): (usize, Procedure)| {
            procedure.finish().map_err(|refusal| AxisRefusal::new(&part, index, refusal))
        };
        axes.into_iter().enumerate().map(finish).collect()
    }
}

/// The refusal of a measurement because of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisRefusal {
    /// Name of the axis. `None` if the part has one axis only.
    pub axis: Option<String>,
    /// The reason why the axis is refused.
    pub refusal: Refusal,
}

impl AxisRefusal {
    #[cold]
    fn new(part: &Part, index: usize, refusal: Refusal) -> Self {
        let named = part.axes.get(index).filter(|_| part.axes.len() > 1);
        Self { axis: named.map(|axis| axis.name.to_string()), refusal }
    }
}

impl Wording for AxisRefusal {
    fn fmt_with(&self, f: &mut fmt::Formatter<'_>, names: SettingNames) -> fmt::Result {
        if let Some(axis) = &self.axis {
            write!(f, "axis {axis}: ")?;
        }
        self.refusal.fmt_with(f, names)
    }
}

impl fmt::Display for AxisRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fmt_with(f, Setting::name)
    }
}

impl core::error::Error for AxisRefusal {}
