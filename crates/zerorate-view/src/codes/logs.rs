//! What is said of logs and recordings as files.

use super::{Explanation, Says};

/// In the order of the book.
pub const ALL: &[Explanation] = &[
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
        code: "rows-incomplete",
        says: Says::Either,
        by: &["calibrate", "capture"],
        seen: "Rows of a part's log lack the value of an axis.",
        matters: "They count as lost; where no row has all axes, nothing is left.",
        remedy: "Name the columns that hold the axes, as docs/formats/part.md says.",
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
];
