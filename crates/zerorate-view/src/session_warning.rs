//! Warnings of the live page and its server.

use std::fmt;
use std::net::SocketAddr;
use zerorate::calibration::FileWarning;
use zerorate_allan::{Says, rows};

/// A warning of a session that goes on. `why` is the error behind it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum SessionWarning {
    /// The file of a calibration has a warning of its own.
    OfCalibration { id: String, warning: FileWarning },
    /// Warming and cooling in a chamber differ; the text is from [`wide_loop`](crate::report::wide_loop).
    WideLoop(String),
    /// This number of frames of a bridge arrived damaged.
    Damaged(u64),
    /// Nothing shows that the calibration belongs to the device.
    UnknownSerial { calibrated: String, name: String },
    /// The calibration does not state its part.
    NoSerial,
    /// This number of samples did not reach the page.
    Missed(u64),
    /// The device was opened again, and the calibration does not fit it.
    NotApplied(String),
    /// A file in the folder of calibrations cannot be read.
    LeftOut(String),
    /// The session has no folder for calibrations.
    NoFolder,
    /// A calibration cannot be written to the folder.
    NotKept { id: String, why: String },
    /// The file of a calibration cannot be removed from the folder.
    NotRemoved { id: String, why: String },
    /// The recording ended.
    NotRecorded(String),
    /// Another server has the libiio port.
    LibiioUnserved { address: SocketAddr, why: String },
    /// The calibration cannot be applied for libiio clients.
    LibiioUncorrected(String),
    /// The server for libiio clients failed.
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
        text: format_args!("{frames} frames of the bridge arrived damaged; check its cable, or lower the baud rate"),
    },
    Self::UnknownSerial { ref calibrated, ref name } => Row {
        code: "unknown-serial",
        text: format_args!("the calibration is of part {calibrated}; check that number on {name}"),
    },
    Self::NoSerial => Row {
        code: "unknown-serial",
        text: format_args!("the calibration names no part; calibrate with the serial number of yours"),
    },
    Self::Missed(samples) => Row {
        code: "samples-missed",
        text: format_args!("{samples} samples did not reach the page, statistics restart; use a divider"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The computer was too busy, and samples of a real part did not reach the page.",
        matters: "A recording (`-o`) has these samples all the same. But a gap would make the statistics wrong, so \
            Allan deviation, spectrum and bias over temperature start again, and a running calibration ends.",
        remedy: "Close other programs, or use a divider.",
        command: "zerorate serve --divider 2",
    },
    Self::NotApplied(ref why) => Row {
        code: "not-applied",
        text: format_args!("calibration no longer applied: {why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The device was opened again, and the calibration does not belong to this part.",
        matters: "The page shows raw rates.",
        remedy: "Apply the calibration of this part, or calibrate it.",
    },
    Self::LeftOut(ref why) => Row {
        code: "calibration-left-out",
        text: format_args!("{why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "A file in the folder of calibrations cannot be read, or there are too many of them.",
        matters: "The page does not list it.",
        remedy: "The warning names the file and the error. Repair the file, or take it out of the folder; with too \
            many files, take some out.",
        command: "zerorate verify calibrations/unit.toml",
    },
    Self::NoFolder => Row {
        code: "not-kept",
        text: format_args!("calibrations made here are lost when the program ends; --folder DIR keeps them"),
    },
    Self::NotKept { ref id, ref why } =>
        Row { code: "not-kept", text: format_args!("calibration {id} is not written ({why}); download it") },
    Self::NotRemoved { ref id, ref why } => Row {
        code: "not-removed",
        text: format_args!("calibration {id} will come back ({why}); remove its file"),
        says: Says::Warning,
        by: &["serve"],
        seen: "A calibration was removed on the page, but its file in the folder could not be renamed.",
        matters: "The calibration is on file again when the program starts the next time.",
        remedy: "Take the file out of the folder by hand.",
    },
    Self::NotRecorded(ref why) => Row {
        code: "not-recorded",
        text: format_args!("the recording ended ({why}); start a new one"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The recording ended early: the disk is full, or the file was taken away.",
        matters: "The measurement goes on. The file holds everything up to that time.",
        remedy: "Free some space, check the file, and start a new recording.",
        command: "zerorate verify recording.arrows",
    },
    Self::LibiioUnserved { address, ref why } => Row {
        code: "libiio-unserved",
        text: format_args!("{address}: {why}; try --iio 127.0.0.1:0"),
        says: Says::Warning,
        by: &["serve"],
        seen: "Another program already serves at the libiio port.",
        matters: "libiio clients do not reach this part. The page is served all the same.",
        remedy: "Stop the other server, or take another port: `--iio 127.0.0.1:0` takes a free one.",
        command: "zerorate serve --iio 127.0.0.1:0",
    },
    Self::LibiioUncorrected(ref why) => Row {
        code: "libiio-uncorrected",
        text: format_args!("clients get raw rates: {why}"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The calibration cannot be applied for libiio clients.",
        matters: "These clients get raw rates only.",
        remedy: "Give a calibration of this kind of part, with the axes that the part has.",
    },
    Self::LibiioEnded(ref why) => Row {
        code: "libiio-ended",
        text: format_args!("no libiio client can connect ({why}); restart the program"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The server for libiio clients failed.",
        matters: "No client can connect any more. The page and the recording go on.",
        remedy: "Remove the cause that the warning names, and start the program again.",
    },
    Self::NoPage => Row {
        code: "no-page",
        text: format_args!("this program was built without its page; run `cargo xtask web`, then build it again"),
        says: Says::Warning,
        by: &["serve"],
        seen: "The program was built without its page.",
        matters: "Browsers see nothing. Frames, metrics and libiio are served all the same.",
        remedy: "Build the page, and then the program again.",
        command: "cargo xtask web",
    },
});

impl fmt::Display for SessionWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_warning_is_one_short_line() {
        let (id, full) = ("1f2e3d4c".to_owned(), "No space left on device (os error 28)".to_owned());
        let wide = "gyro_z: cooling and warming lie ±0.00123 ± 0.00012 °/s about their mean; allow for it".to_owned();
        let axes = "the calibration is of ADIS16130, the part is a MEMS-3".to_owned();
        for warning in [
            SessionWarning::WideLoop(wide),
            SessionWarning::Damaged(1234),
            SessionWarning::UnknownSerial { calibrated: "SN17".to_owned(), name: "ADIS16130".to_owned() },
            SessionWarning::NoSerial,
            SessionWarning::Missed(12_345),
            SessionWarning::NotApplied(axes.clone()),
            SessionWarning::LeftOut("calibrations/unit.toml: line 4: pbc_dps is not a number".to_owned()),
            SessionWarning::NoFolder,
            SessionWarning::NotKept { id: id.clone(), why: full.clone() },
            SessionWarning::NotRemoved { id, why: "Permission denied (os error 13)".to_owned() },
            SessionWarning::NotRecorded(full.clone()),
            SessionWarning::LibiioUnserved {
                address: SocketAddr::from(([127, 0, 0, 1], 30_431)),
                why: "Address already in use (os error 98)".to_owned(),
            },
            SessionWarning::LibiioUncorrected(axes),
            SessionWarning::LibiioEnded("Too many open files (os error 24)".to_owned()),
            SessionWarning::NoPage,
        ] {
            let line = format!("{}: {warning}", warning.code());
            assert!(line.chars().count() <= 100, "{} characters: {line}", line.chars().count());
        }
    }

    /// The warning of the file has its own limit.
    #[test]
    fn the_warning_of_a_file_says_which_calibration() {
        let (id, warning) = ("1f2e3d4c".to_owned(), FileWarning::NoChecksum);
        let said = SessionWarning::OfCalibration { id, warning };
        assert_eq!((said.code(), said.to_string()), (warning.code(), format!("calibration 1f2e3d4c: {warning}")));
    }
}
