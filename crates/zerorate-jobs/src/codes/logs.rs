//! What is said of logs and recordings as files.

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
        by: &["allan", "imu", "probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A capture or a log lacks its end: it was not closed, as after a power cut, or its end was removed.",
        matters: "Every whole block of rows that a check vouches for is read, of a log without checks whatever is \
            whole; what stands behind is dropped. So the recording is shorter than it was.",
        remedy: "Nothing, if the rest is long enough; of a capture `zerorate repair` writes the whole blocks to a \
            file of their own, and says what is missing.",
        command: "zerorate repair torn.arrows -o whole.arrows",
    },
    Explanation {
        code: "messages-miscounted",
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A bag states at its end, in its index or in its `metadata.yaml`, how many messages a topic has, and \
            holds another number of them.",
        matters: "Messages were lost or came from elsewhere: bytes were changed, a file was cut and closed again, or \
            a file of another recording lies in the folder. What is there is read.",
        remedy: "Take another copy of the bag. If there is none, `ros2 bag reindex` counts the messages again.",
        command: "",
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
        code: "times-mended",
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Rows of a log were out of order, there twice, or had stamps that cannot be theirs, in a way that \
            has one explanation: a queue, a counter that wrapped around, a coarse clock.",
        matters: "They were put right: the order is that of the times, what is there twice counts once, and a wrong \
            stamp is replaced by the one between its neighbours.",
        remedy: "Nothing, if the text says what you expect of that log; else look at the first row that it names.",
        command: "",
    },
    Explanation {
        code: "times-jitter",
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "The stamps of the rows are off an even clock, by chance and by much of an interval.",
        matters: "The samples are taken as even, at their mean rate. The text says from which averaging time on \
            that changes a deviation by less than 1 %.",
        remedy: "Let the sensor or its driver stamp the samples, not whatever writes them; or judge longer \
            averages only.",
        command: "",
    },
    Explanation {
        code: "lines-skipped",
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Lines stand above the data that are no header.",
        matters: "They are not read; the first is shown, so that none is skipped that should count.",
        remedy: "Nothing, if they are remarks.",
        command: "",
    },
    Explanation {
        code: "lines-broken",
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Lines of a text have too few cells, or cells that are no numbers.",
        matters: "They are skipped. Without a time column each counts as a missing sample; with one, the times \
            tell.",
        remedy: "Look at the first, which is named. `--max-bad` sets the share from which on the log is refused.",
        command: "zerorate allan log.csv --max-bad 0",
    },
    Explanation {
        code: "resampled",
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Many samples repeat the one before, or lie on the line between their neighbours, to the last \
            digit, as noise does not.",
        matters: "The log was resampled or filled in, or the sensor converts more slowly than it is read: what is \
            found is the noise of such a log, and the angle random walk N of the sensor is another.",
        remedy: "Take the log as the sensor gave it, at its own rate.",
        command: "",
    },
    Explanation {
        code: "unit-unknown",
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The unit of a column is not stated, by its name or by the form of the log.",
        matters: "The result is in the unit of the column, whatever that is, and no unit of a coefficient can be \
            named.",
        remedy: "Give the unit or the scale.",
        command: "zerorate allan log.csv --column gz --unit rad/s",
    },
    Explanation {
        code: "columns-left-out",
        says: Says::Warning,
        by: &["imu", "serve"],
        seen: "Columns of a log are neither gyroscope nor accelerometer; or are 0 in every row, as a message has \
            it whose part has fewer axes.",
        matters: "They are not analysed; were one of them an axis, its number would be missing in the file.",
        remedy: "Name the columns that are axes, if one of these is.",
        command: "zerorate imu log.csv --column gx,gy,gz",
    },
    Explanation {
        code: "several-imus",
        says: Says::Warning,
        by: &["imu", "serve"],
        seen: "More than three columns are gyroscopes, or accelerometers.",
        matters: "One IMU has three axes of each, so these are of several, and one file for a filter would mix \
            them.",
        remedy: "Choose the columns of one.",
        command: "zerorate imu log.csv --column gx,gy,gz",
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
        code: "off-codes",
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Values of a log do not lie on the codes of the part; they are rounded to the nearest.",
        matters: "The log is an average, was printed with too few digits, or is in another unit than its \
            column says.",
        remedy: "Check the unit in the column's name and the scale in the file of the part; log more digits.",
        command: "",
    },
];
