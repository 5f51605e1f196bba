//! What a measurement in a temperature chamber says.

use super::{Explanation, Says};

/// In the order of the book.
pub const ALL: &[Explanation] = &[
    Explanation {
        code: "silent",
        says: Says::Refusal,
        by: &["chamber"],
        seen: "No reading came for a long time.",
        matters: "The part or its cable failed, perhaps by cold or heat.",
        remedy: "Check cable and connectors. Finished steps are kept: the same command goes on after them.",
        command: "",
    },
    Explanation {
        code: "not-settled",
        says: Says::Refusal,
        by: &["chamber"],
        seen: "The part's temperature never came to rest near the set point.",
        matters: "The soak point would be an average over a drift.",
        remedy: "Close the door; check that the chamber reaches that temperature; shield the part from its fan; or \
            allow more in the plan (drift_c_per_min, settle_timeout_s).",
        command: "",
    },
    Explanation {
        code: "not-reached",
        says: Says::Refusal,
        by: &["chamber"],
        seen: "The air of the chamber is still far from its set point.",
        matters: "The plan cannot be carried out.",
        remedy: "Close the door, and check that the chamber is on and can reach that.",
        command: "",
    },
    Explanation {
        code: "overshoot",
        says: Says::Refusal,
        by: &["chamber"],
        seen: "The air went beyond every temperature of the plan.",
        matters: "It may harm the part, so the chamber was sent to a safe temperature.",
        remedy: "Check the chamber's control, or allow more in the plan (overshoot_c).",
        command: "",
    },
    Explanation {
        code: "beyond-limits",
        says: Says::Either,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The air is colder or warmer than the part may be; of a simulated part, it was asked to be.",
        matters: "A real part may be harmed, so its chamber was sent to a safe temperature. Of a simulated part \
            nobody knows what a real one would do there.",
        remedy: "Look at the chamber: its sensor, its control, and what it did before. Keep a simulated part within \
            the limits (operating_c in the file of a part).",
        command: "",
    },
    Explanation {
        code: "limits-unknown",
        says: Says::Warning,
        by: &["chamber"],
        seen: "The file of the part does not state at which temperatures it may operate.",
        matters: "Only the plan keeps the chamber from harming it.",
        remedy: "State operating_c in the file of the part.",
        command: "",
    },
    Explanation {
        code: "chamber-left",
        says: Says::Warning,
        by: &["chamber"],
        seen: "The chamber did not confirm that it was sent to a safe temperature or stopped.",
        matters: "It may go on heating or cooling.",
        remedy: "Go to the chamber, and switch it off by hand. Then look at its cable.",
        command: "",
    },
    Explanation {
        code: "disturbed",
        says: Says::Refusal,
        by: &["chamber"],
        seen: "Again and again something happened while a soak point was averaged.",
        matters: "There is no quiet average of it.",
        remedy: "Keep the door closed; damp the fan; fix the part; read without losses.",
        command: "",
    },
    Explanation {
        code: "uncertain",
        says: Says::Refusal,
        by: &["chamber"],
        seen: "BTC would be more uncertain than was asked for.",
        matters: "The result would not be what it was measured for.",
        remedy: "Plan for a wider span, or for more time; or accept more.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Explanation {
        code: "no-curve",
        says: Says::Refusal,
        by: &["chamber"],
        seen: "No bias over temperature explains the rate; or there was too little rest to find one.",
        matters: "There is nothing to correct with.",
        remedy: "Check that the part was at rest; plan for longer.",
        command: "",
    },
    Explanation {
        code: "resumed",
        says: Says::Warning,
        by: &["chamber"],
        seen: "The measurement was interrupted, and went on from its finished steps.",
        matters: "A part that was switched off in between may have another bias since. No one recording gives this \
            result again.",
        remedy: "Measure again without an interruption if it matters.",
        command: "",
    },
];
