//! What an Allan analysis, and the noise model of a log, say.

use super::{Explanation, Says};

pub(super) const ROWS: &[Explanation] = &[
    Explanation {
        code: "no-model",
        says: Says::Refusal,
        by: &["allan", "imu"],
        seen: "The record has too few samples, too many gaps, or numbers that no noise explains.",
        matters: "There is no model of it at all.",
        remedy: "Record longer and without losses; check unit and readings.",
        command: "",
    },
    Explanation {
        code: "no-common-model",
        says: Says::Refusal,
        by: &["allan"],
        seen: "The records have no common model.",
        matters: "They are not of sensors, or of conditions, that are alike.",
        remedy: "Look at each by itself first.",
        command: "zerorate allan a.csv b.csv --fit",
    },
    Explanation {
        code: "not-alike",
        says: Says::Warning,
        by: &["allan"],
        seen: "Among records that were to have one model, one differs by more than chance.",
        matters: "It is left out, or, of two, both are suspect.",
        remedy: "Look at it by itself. A third record would tell which is the exception.",
        command: "",
    },
    Explanation {
        code: "motion",
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Several axes jump, or have a glitch, at the same moment.",
        matters: "The sensor moved, or was knocked: that is no noise of it.",
        remedy: "Record where nothing moves, or cut the log there.",
        command: "",
    },
];
