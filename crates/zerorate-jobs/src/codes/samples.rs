//! What is said of the samples themselves, by whatever takes them.

use super::{Explanation, Says};

pub(super) const ROWS: &[Explanation] = &[
    Explanation {
        code: "unjudged",
        says: Says::Warning,
        by: &["capture", "stream", "correct"],
        seen: "The readings are too far apart in time, or too little is known of the part, to tell an impossible \
            reading from motion.",
        matters: "Bit errors would pass.",
        remedy: "Use a smaller divider; or state range, bandwidth and noise in the file of the part.",
        command: "",
    },
    Explanation {
        code: "clock-stands",
        says: Says::Warning,
        by: &["capture"],
        seen: "Samples came whose time was not later than that of the one before.",
        matters: "They are left out, and counted as lost.",
        remedy: "Look at the clock of the device or its driver. The recording is whole otherwise.",
        command: "",
    },
    Explanation {
        code: "clock-jump",
        says: Says::Warning,
        by: &["capture"],
        seen: "The time of the device went on by samples that it did not count.",
        matters: "They are counted as lost.",
        remedy: "Look at what stopped the device: a host that slept, a driver that restarted.",
        command: "",
    },
    Explanation {
        code: "no-realtime-priority",
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The reading thread could not get real-time priority.",
        matters: "Other programs can delay it, and cost samples.",
        remedy: "Allow both to the program, once.",
        command: "sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"",
    },
    Explanation {
        code: "memory-not-locked",
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The memory of the reading thread could not be locked.",
        matters: "It may have to wait for memory that was swapped out, and lose samples.",
        remedy: "Allow both to the program, once.",
        command: "sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"",
    },
];
