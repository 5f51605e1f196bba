//! What the live page and its server have to say.

use std::fmt;
use std::net::SocketAddr;
use zerorate::calibration::FileWarning;
use zerorate_allan::{Says, rows};

/// The page goes on, but there is something to know. `why` is what failed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum SessionWarning {
    /// About the file of a calibration.
    OfCalibration { id: String, warning: FileWarning },
    /// A calibration cannot be right on both ways of a chamber.
    WideLoop(String),
    /// So many frames of a bridge were damaged.
    Damaged(u64),
    /// Nothing shows that the calibration is of the device.
    UnknownSerial { calibrated: String, name: String },
    /// The calibration does not state its part.
    NoSerial,
    /// So many samples did not come to the page.
    Missed(u64),
    /// The device was opened again, and does not bear the calibration.
    NotApplied(String),
    /// A file in the folder of calibrations cannot be read.
    LeftOut(String),
    /// There is no folder for calibrations.
    NoFolder,
    /// A calibration cannot be written to the folder.
    NotKept { id: String, why: String },
    /// The file of a calibration cannot be taken out of the folder.
    NotRemoved { id: String, why: String },
    /// The recording ended.
    NotRecorded(String),
    /// Something else serves at the port of libiio.
    LibiioUnserved { address: SocketAddr, why: String },
    /// The calibration cannot be applied for clients of libiio.
    LibiioUncorrected(String),
    /// The server for clients of libiio failed.
    LibiioEnded(String),
    /// The program was built without its page.
    NoPage,
}

rows!(match SessionWarning {
    Self::OfCalibration { ref id, ref warning } =>
        Row { code: { warning.code() }, text: format_args!("calibration {id}: {warning}") },
    Self::WideLoop(ref text) => Row { code: "hysteresis", text: format_args!("{text}") },
    Self::Damaged(frames) => Row {
        code: "damaged-frames",
        text: format_args!("{frames} frames of the bridge arrived damaged; check the cable"),
    },
    Self::UnknownSerial { ref calibrated, ref name } => Row {
        code: "unknown-serial",
        text: format_args!(
            "the calibration that is applied is that of part {calibrated}, and nothing shows that {name} is that \
             part: look at the number on it"
        ),
    },
    Self::NoSerial => Row {
        code: "unknown-serial",
        text: format_args!(
            "the calibration that is applied says of no part that it is its own, and every part has its own bias: \
             calibrate with the serial number"
        ),
    },
    Self::Missed(samples) => Row {
        code: "samples-missed",
        text: format_args!(
            "{samples} samples were not seen here, for the computer had too much else to do; Allan deviation, \
             spectrum and bias over temperature begin anew"
        ),
        says: Says::Warning,
        by: &["serve"],
        seen: "The computer had too much else to do, and samples of a real part did not come to the page.",
        matters: "A recording (`-o`) has them all the same. But Allan deviation, spectrum and bias over temperature \
            begin anew, and a calibration that was under way is ended: across a hole they would be wrong.",
        remedy: "End what else the computer does, or use a divider.",
        command: "zerorate serve --divider 2",
    },
    Self::NotApplied(ref why) => Row {
        code: "not-applied",
        text: format_args!("the calibration that was applied no longer is: {why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The device was opened again, and the calibration that was applied is not that of this part.",
        matters: "Raw rates are shown.",
        remedy: "Apply the calibration of this part, or measure it.",
    },
    Self::LeftOut(ref why) => Row {
        code: "calibration-left-out",
        text: format_args!("{why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "A file in the folder of calibrations cannot be read, or there are too many of them.",
        matters: "The page does not list it.",
        remedy: "Look at what the text says of the file, and mend it or take it out of the folder.",
        command: "zerorate verify calibrations/unit.toml",
    },
    Self::NoFolder => Row {
        code: "not-kept",
        text: format_args!(
            "calibrations made here are lost when the program ends; start it with --folder DIR to keep them"
        ),
    },
    Self::NotKept { ref id, ref why } =>
        Row { code: "not-kept", text: format_args!("calibration {id} could not be written: {why}; download it") },
    Self::NotRemoved { ref id, ref why } => Row {
        code: "not-removed",
        text: format_args!("calibration {id} comes back with the next start: {why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "A calibration was removed on the page, and its file in the folder could not be given another name.",
        matters: "It is on file again when the program is started the next time.",
        remedy: "Take the file out of the folder by hand.",
    },
    Self::NotRecorded(ref why) => Row {
        code: "not-recorded",
        text: format_args!("the recording ended: {why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The recording that was under way ended: the disk is full, or the file was taken away.",
        matters: "The measurement goes on; what is on disk holds everything up to there.",
        remedy: "Make room, look at the file, and start a new recording.",
        command: "zerorate verify recording.arrows",
    },
    Self::LibiioUnserved { address, ref why } => Row {
        code: "libiio-unserved",
        text: format_args!("{address}: {why}: clients of libiio are not served; --iio 127.0.0.1:0 takes a free port"),
        says: Says::Warning,
        by: &["serve"],
        seen: "Something else serves at the port of libiio already.",
        matters: "Clients of libiio do not reach this part; the page is served all the same.",
        remedy: "End the other server, or take another port.",
        command: "zerorate serve --iio 127.0.0.1:0",
    },
    Self::LibiioUncorrected(ref why) => Row {
        code: "libiio-uncorrected",
        text: format_args!("{why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The calibration cannot be applied for clients of libiio.",
        matters: "They see raw rates alone.",
        remedy: "Give the calibration of this kind of part, with the axes that the part has.",
    },
    Self::LibiioEnded(ref why) => Row {
        code: "libiio-ended",
        text: format_args!("no client can connect any more: {why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The server for clients of libiio failed.",
        matters: "No client can connect any more; the page and the recording go on.",
        remedy: "Look at what the system says in the text, and start the program again.",
    },
    Self::NoPage => Row {
        code: "no-page",
        text: format_args!("this program was built without its page: run `cargo xtask web`, then build it again"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The program was built without its page.",
        matters: "Browsers see nothing; frames, metrics and libiio are served all the same.",
        remedy: "Build the page, and then the program again.",
        command: "cargo xtask web",
    },
});

impl fmt::Display for SessionWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}
