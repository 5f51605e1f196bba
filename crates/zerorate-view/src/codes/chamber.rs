//! What a measurement in a temperature chamber says.

use super::{Explanation, Says};

pub(super) const ROWS: &[Explanation] = &[
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
