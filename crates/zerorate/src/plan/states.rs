//! The states of the procedure of F-51, and the transitions between them.
//!
//! All transitions stand in [`TABLE`], except that other methods go from the start to the recording ([`State::next`]).

use super::{Method, Plan};
use core::fmt;

/// A state of the procedure. `Display` names it as a user would.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the table and Display say what each is")]
pub enum State {
    Start,
    FirstAverage,
    WarmUp,
    SecondAverage,
    Settle,
    Offset,
    FinalTemperature,
    Recording,
    Done,
}

pub(crate) const STATES: usize = 9;

/// The condition that ends a state.
pub(crate) enum Until {
    Initialised,
    After(fn(&Plan) -> f64),
    Never,
}

/// One row of the table: `until` ends the state `from`, and `to` follows if `check` passes.
pub(crate) struct StateRow {
    pub(crate) from: State,
    name: &'static str,
    pub(crate) until: Until,
    pub(crate) check: Check,
    to: State,
}

/// A check at the end of a state.
#[derive(Clone, Copy)]
pub(crate) enum Check {
    Nothing,
    AtRest,
    AtRestAndWarmer,
    TemperatureWasRead,
}

/// Steps 3 to 9 of F-51, and the one recording of the other methods. Steps 1 and 2, the platform and the supply, are
/// up to the user.
#[rustfmt::skip]
pub(crate) const TABLE: [StateRow; STATES] = [
    StateRow { from: State::Start, name: "initialisation (step 3)",
          until: Until::Initialised, check: Check::Nothing, to: State::FirstAverage },
    StateRow { from: State::FirstAverage, name: "the first average (step 4)",
          until: Until::After(|plan| plan.average_s), check: Check::AtRest, to: State::WarmUp },
    StateRow { from: State::WarmUp, name: "the warm-up (step 5)",
          until: Until::After(|plan| plan.warmup_s), check: Check::Nothing, to: State::SecondAverage },
    StateRow { from: State::SecondAverage, name: "the second average (step 6)",
          until: Until::After(|plan| plan.average_s), check: Check::AtRestAndWarmer, to: State::Settle },
    StateRow { from: State::Settle, name: "settling (step 7)",
          until: Until::After(|plan| plan.settle_s), check: Check::Nothing, to: State::Offset },
    StateRow { from: State::Offset, name: "the offset average (step 8)",
          until: Until::After(|plan| plan.offset_s), check: Check::AtRest, to: State::FinalTemperature },
    StateRow { from: State::FinalTemperature, name: "the final temperature (step 9)",
          until: Until::After(|plan| plan.final_temp_s), check: Check::TemperatureWasRead, to: State::Done },
    StateRow { from: State::Recording, name: "the recording",
          until: Until::After(Plan::total_s), check: Check::AtRest, to: State::Done },
    StateRow { from: State::Done, name: "the end",
          until: Until::Never, check: Check::Nothing, to: State::Done },
];

/// Asserts that the number of each state is the index of its row.
const _: () = {
    let mut index = 0;
    while index < STATES {
        assert!(TABLE[index].from as usize == index);
        index += 1;
    }
};

impl State {
    pub(crate) fn row(self) -> &'static StateRow {
        &TABLE[self as usize]
    }

    pub(crate) fn next(self, method: Method) -> Self {
        match (self, method) {
            (Self::Start, Method::Warmup | Method::Cycle) => Self::Recording,
            _ => self.row().to,
        }
    }
}

impl Plan {
    /// The steps that take time, in their order, each with its beginning and its end since initialisation, s.
    pub fn steps(&self) -> impl Iterator<Item = (State, f64, f64)> + use<'_> {
        let states =
            core::iter::successors(Some(State::Start.next(self.method)), |state| Some(state.next(self.method)));
        states.take_while(|state| *state != State::Done).scan(0.0, |start_s, state| {
            let Until::After(duration_s) = state.row().until else { return None };
            let from_s = *start_s;
            *start_s += duration_s(self);
            Some((state, from_s, *start_s))
        })
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn the_table_reaches_the_end_through_every_state() {
        let steps = core::iter::successors(Some(State::Start), |state| Some(state.row().to));
        let of_the_note = STATES - 2; // without the recording of other methods, and the end
        assert_eq!(steps.take_while(|state| *state != State::Done).count(), of_the_note);
    }

    /// F-51: 10 s, 10 min, 10 s, 40 min, 150 s, and a second for T3.
    #[test]
    fn default_durations() {
        let plan = Plan::default();
        assert_eq!((plan.average_s, plan.warmup_s, plan.settle_s, plan.offset_s), (10.0, 600.0, 2400.0, 150.0));
        assert_eq!(plan.total_s(), 3171.0);
        let steps: Vec<_> = plan.steps().collect();
        assert_eq!((steps.len(), steps[1]), (6, (State::WarmUp, 10.0, 610.0)));
        assert_eq!(steps[5], (State::FinalTemperature, 3170.0, 3171.0));
        let recording = Plan { method: Method::Cycle, ..plan };
        assert_eq!(recording.steps().collect::<Vec<_>>(), [(State::Recording, 0.0, 3171.0)]);
    }
}
