//! The states of a measurement in a chamber, as a table: the event that ends each state, and the state that follows.

use core::fmt;

/// A state of the measurement. `Display` names it as a user would.
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

/// The event that ends a state.
#[derive(Clone, Copy)]
pub(super) enum Until {
    Initialised,
    /// The ramp of the step has ended.
    Arrived,
    /// The step's time is over.
    Held,
    /// The part's own temperature has come to rest near the set point.
    Settled,
    /// The average is long enough.
    Averaged,
    Never,
}

/// The rule for the state that follows.
#[derive(Clone, Copy)]
pub(super) enum To {
    State(ChamberState),
    /// The state depends on how the step ends.
    ByStep {
        hold: ChamberState,
        average: ChamberState,
    },
    /// The first state of the next step, or the end after the last step.
    Next {
        step: ChamberState,
        end: ChamberState,
    },
}

/// One row of the table: `until` ends the state `from`. The next state is `to`, or `disturbed` after a disturbance.
pub(super) struct StateRow {
    from: ChamberState,
    name: &'static str,
    pub(super) until: Until,
    pub(super) to: To,
    pub(super) disturbed: Option<ChamberState>,
}

const STATES: usize = 6;

#[rustfmt::skip]
const TABLE: [StateRow; STATES] = {
    use ChamberState::{Approach, Average, Done, Hold, Settle, Start};
    let next = To::Next { step: Approach, end: Done };
    [
        StateRow { from: Start, name: "initialisation", until: Until::Initialised,
              to: To::State(Approach), disturbed: None },
        StateRow { from: Approach, name: "going to the set point", until: Until::Arrived,
              to: To::ByStep { hold: Hold, average: Settle }, disturbed: None },
        StateRow { from: Hold, name: "holding the set point", until: Until::Held, to: next, disturbed: None },
        StateRow { from: Settle, name: "settling", until: Until::Settled, to: To::State(Average), disturbed: None },
        StateRow { from: Average, name: "the average", until: Until::Averaged, to: next, disturbed: Some(Settle) },
        StateRow { from: Done, name: "the end", until: Until::Never, to: To::State(Done), disturbed: None },
    ]
};

/// Asserts that the number of each state is the index of its row.
const _: () = {
    let mut index = 0;
    while index < STATES {
        assert!(TABLE[index].from as usize == index);
        index += 1;
    }
};

impl ChamberState {
    pub(super) fn row(self) -> &'static StateRow {
        &TABLE[self as usize]
    }
}

impl fmt::Display for ChamberState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().name)
    }
}
