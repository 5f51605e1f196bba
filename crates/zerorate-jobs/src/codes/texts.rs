//! Codes of refusals, and of two warnings, that have no enum.

use super::{Explanation, Says};

pub(super) const ROWS: &[Explanation] = &[
    Explanation {
        code: "times-disordered",
        says: Says::Refusal,
        by: &["allan", "imu", "calibrate", "capture"],
        seen: "The times of the rows go back, or stand still, in a way that no counter and no queue explains.",
        matters: "Which sample came when is not known.",
        remedy: "Are two logs in one file, or was a clock set? Cut the log there. If the samples are evenly spaced \
            all the same, give the rate and no time column.",
        command: "zerorate allan log.csv --rate 200",
    },
    Explanation {
        code: "times-uneven",
        says: Says::Refusal,
        by: &["allan", "imu", "calibrate", "capture"],
        seen: "The rows are not evenly spaced.",
        matters: "An Allan deviation, and every average, is of evenly spaced samples.",
        remedy: "Record with a steady rate; or give the rate, if only the times are wrong.",
        command: "zerorate allan log.csv --rate 200",
    },
    Explanation {
        code: "mostly-missing",
        says: Says::Refusal,
        by: &["allan", "imu", "calibrate", "capture"],
        seen: "Between the rows far more samples are missing than there are.",
        matters: "Gaps of such a size are rather two logs.",
        remedy: "Cut the log at its longest gap, or give the rate and no time column.",
        command: "",
    },
    Explanation {
        code: "beyond-codes",
        says: Says::Refusal,
        by: &["calibrate", "capture"],
        seen: "A value of a log is beyond the codes of the part.",
        matters: "It is another column, or another unit, or another part.",
        remedy: "State the unit in the column's name, and check the file of the part.",
        command: "",
    },
    Explanation {
        code: "kind-absent",
        says: Says::Warning,
        by: &["imu"],
        seen: "The log has no gyroscope, or no accelerometer.",
        matters: "The numbers of the kind that is not there are left in the file to be filled in: a filter that \
            reads it as it is fails, rather than trusting a guess.",
        remedy: "Fill them in from another log or from the data sheet, or name the columns.",
        command: "",
    },
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
        code: "motion",
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Several axes jump, or have a glitch, at the same moment.",
        matters: "The sensor moved, or was knocked: that is no noise of it.",
        remedy: "Record where nothing moves, or cut the log there.",
        command: "",
    },
];
