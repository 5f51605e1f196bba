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
    Explanation {
        code: "torn-tail",
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A capture lacks its end: it was not closed, as after a power cut, or its end was removed.",
        matters: "Every whole block of rows that a check vouches for is read; what stands behind the last one \
            is dropped. So the recording is shorter than it was.",
        remedy: "Nothing, if the rest is long enough; `zerorate repair` writes the whole blocks to a file of \
            their own, and says what is missing.",
        command: "zerorate repair torn.arrows -o whole.arrows",
    },
    Explanation {
        code: "no-index",
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A bag (MCAP) has no index, because its end is missing.",
        matters: "All rows are there, and were checked. Other programs may not find them without the index.",
        remedy: "`mcap recover` gives the bag an index. For our own commands write its rows to a file with \
            `zerorate repair`.",
        command: "zerorate repair run.mcap -o whole.arrows",
    },
    Explanation {
        code: "bytes-behind-end",
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "Bytes follow after the end of a capture.",
        matters: "They are ignored. Two files may have been joined, of which the second is not read.",
        remedy: "Compare the length with that of the original; read the second capture by itself.",
        command: "zerorate verify rest.arrows",
    },
    Explanation {
        code: "not-checked",
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A capture has no checks over its rows: it is of version 1, or other software has written it \
            again.",
        matters: "Damage may pass unnoticed.",
        remedy: "Prefer the original, as `zerorate capture` wrote it.",
        command: "zerorate verify rest.arrows",
    },
    Explanation {
        code: "edges-misplaced",
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "In some rows of a capture the count of edges of data ready contradicts the time.",
        matters: "Rates and times of the rows stand; the rate of data ready that follows from the count is not \
            to be believed.",
        remedy: "Look at the rows: the capture was edited, or made by other software.",
        command: "zerorate verify rest.arrows",
    },
    Explanation {
        code: "log-doubtful",
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "The log of another part is not quite what a log should be: its end is torn off, its times \
            jitter, or samples are missing. The text says which.",
        matters: "What can be read is read, and what is missing is counted as lost.",
        remedy: "Look at the log at the place that the text names; docs/logs.md says what is expected of each \
            form.",
        command: "",
    },
    Explanation {
        code: "off-codes",
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Values of a log do not lie on the codes of the part; they are rounded to the nearest.",
        matters: "The log is an average, was printed with too few digits, or is in another unit than its \
            column says.",
        remedy: "Check the unit in the column's name and the scale in the file of the part; log more digits.",
        command: "",
    },
    Explanation {
        code: "log-failed",
        says: Says::Warning,
        by: &["calibrate", "chamber"],
        seen: "The file of `--log` could not be written any longer: the disk is full, or was taken away.",
        matters: "The measurement goes on and its result stands, but the exit code is 1: there is no whole \
            recording of it.",
        remedy: "Make room. What was written until then is whole up to its last block.",
        command: "zerorate verify unit.arrows",
    },
    Explanation {
        code: "no-checksum",
        says: Says::Warning,
        by: &["stream", "correct", "export", "report", "serve"],
        seen: "A calibration file has no checksum: it was written by hand, or its check lines were taken out.",
        matters: "Nothing shows whether its numbers are as they were measured.",
        remedy: "Prefer the file that a command has written. For one that was written by hand there is nothing \
            to be done.",
        command: "zerorate verify unit.toml",
    },
    Explanation {
        code: "no-validity",
        says: Says::Warning,
        by: &["export"],
        seen: "A calibration states no [validity].",
        matters: "Nothing says at which temperatures it holds; the export takes a range around T3 that is an \
            assumption.",
        remedy: "State temp_min_c and temp_max_c in the file, or calibrate anew: every calibration that is \
            measured states them.",
        command: "",
    },
    Explanation {
        code: "table-short",
        says: Says::Warning,
        by: &["export"],
        seen: "The table of an export ends before the calibration does.",
        matters: "Beyond the table the row at its end is used, which is wrong by as much as the text says; the \
            look-up says that it is outside.",
        remedy: "Leave the span out, and the table covers the whole range; or take larger steps.",
        command: "zerorate export unit.toml --format c -o unit.h",
    },
    Explanation {
        code: "before-temperature",
        says: Says::Warning,
        by: &["correct"],
        seen: "The first rows of a capture come before its first temperature.",
        matters: "A correction needs a temperature: these rows stay uncorrected, and their cells are empty.",
        remedy: "Nothing, if they are few. Read the temperature more often, so that the first comes sooner.",
        command: "zerorate capture --every-temp 1 -o rest.arrows",
    },
    Explanation {
        code: "not-believed",
        says: Says::Warning,
        by: &["stream"],
        seen: "Readings came that are not to be believed: bit errors, out of range, or a part that stopped.",
        matters: "They are left out of the means, and their rows are flagged.",
        remedy: "Check the cable and the supply; `zerorate probe` says more.",
        command: "zerorate probe",
    },
];
