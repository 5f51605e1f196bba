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
