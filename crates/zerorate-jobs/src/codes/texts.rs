//! Codes of refusals that have no enum.

use super::{Explanation, Says};

pub(super) const ROWS: &[Explanation] = &[
    Explanation {
        code: "times-disordered",
        says: Says::Refusal,
        by: &["allan", "imu", "calibrate", "capture"],
        seen: "The times of the rows go back, or stand still, in a way that no counter and no queue explains.",
        matters: "The time of each sample is unknown.",
        remedy: "Are two logs in one file, or was a clock set? Cut the log there. If the samples are evenly spaced \
            all the same, give the rate and no time column.",
        command: "zerorate allan log.csv --rate 200",
    },
    Explanation {
        code: "times-uneven",
        says: Says::Refusal,
        by: &["allan", "imu", "calibrate", "capture"],
        seen: "The rows are not evenly spaced.",
        matters: "An Allan deviation, and every average, needs evenly spaced samples.",
        remedy: "Record with a steady rate; or give the rate, if only the times are wrong.",
        command: "zerorate allan log.csv --rate 200",
    },
    Explanation {
        code: "mostly-missing",
        says: Says::Refusal,
        by: &["allan", "imu", "calibrate", "capture"],
        seen: "Between the rows far more samples are missing than there are.",
        matters: "Gaps of such a size suggest two logs in one file.",
        remedy: "Cut the log at its longest gap, or give the rate and no time column.",
        command: "",
    },
    Explanation {
        code: "beyond-codes",
        says: Says::Refusal,
        by: &["calibrate", "capture"],
        seen: "A value of a log is beyond the codes of the part.",
        matters: "The column, its unit or the part is another than stated.",
        remedy: "State the unit in the column's name, and check the file of the part.",
        command: "",
    },
    Explanation {
        code: "no-model",
        says: Says::Refusal,
        by: &["allan", "imu"],
        seen: "The record has too few samples, too many gaps, or numbers that no noise explains.",
        matters: "The record has no noise model at all.",
        remedy: "Record longer and without losses; check unit and readings.",
        command: "",
    },
    Explanation {
        code: "no-common-model",
        says: Says::Refusal,
        by: &["allan"],
        seen: "The records have no common model.",
        matters: "The sensors, or the conditions, are not alike.",
        remedy: "Look at each by itself first.",
        command: "zerorate allan a.csv b.csv --fit",
    },
];
