//! What the live page says of itself.

use super::{Explanation, Says};

pub(super) const ROWS: &[Explanation] = &[
    Explanation {
        code: "samples-missed",
        says: Says::Warning,
        by: &["serve"],
        seen: "The computer had too much else to do, and samples of a real part did not come to the page.",
        matters: "A recording (`-o`) has them all the same. But Allan deviation, spectrum and bias over temperature \
            begin anew, and a calibration that was under way is ended: across a hole they would be wrong.",
        remedy: "End what else the computer does, or use a divider.",
        command: "zerorate serve --divider 2",
    },
    Explanation {
        code: "not-applied",
        says: Says::Warning,
        by: &["serve"],
        seen: "The device was opened again, and the calibration that was applied is not that of this part.",
        matters: "Raw rates are shown.",
        remedy: "Apply the calibration of this part, or measure it.",
        command: "",
    },
    Explanation {
        code: "calibration-left-out",
        says: Says::Warning,
        by: &["serve"],
        seen: "A file in the folder of calibrations cannot be read, or there are too many of them.",
        matters: "The page does not list it.",
        remedy: "Look at what the text says of the file, and mend it or take it out of the folder.",
        command: "zerorate verify calibrations/unit.toml",
    },
    Explanation {
        code: "not-removed",
        says: Says::Warning,
        by: &["serve"],
        seen: "A calibration was removed on the page, and its file in the folder could not be given another name.",
        matters: "It is on file again when the program is started the next time.",
        remedy: "Take the file out of the folder by hand.",
        command: "",
    },
    Explanation {
        code: "libiio-unserved",
        says: Says::Warning,
        by: &["serve"],
        seen: "Something else serves at the port of libiio already.",
        matters: "Clients of libiio do not reach this part; the page is served all the same.",
        remedy: "End the other server, or take another port.",
        command: "zerorate serve --iio 127.0.0.1:0",
    },
    Explanation {
        code: "libiio-uncorrected",
        says: Says::Warning,
        by: &["serve"],
        seen: "The calibration cannot be applied for clients of libiio.",
        matters: "They see raw rates alone.",
        remedy: "Give the calibration of this kind of part, with the axes that the part has.",
        command: "",
    },
    Explanation {
        code: "libiio-ended",
        says: Says::Warning,
        by: &["serve"],
        seen: "The server for clients of libiio failed.",
        matters: "No client can connect any more; the page and the recording go on.",
        remedy: "Look at what the system says in the text, and start the program again.",
        command: "",
    },
    Explanation {
        code: "no-page",
        says: Says::Warning,
        by: &["serve"],
        seen: "The program was built without its page.",
        matters: "Browsers see nothing; frames, metrics and libiio are served all the same.",
        remedy: "Build the page, and then the program again.",
        command: "cargo xtask web",
    },
];
