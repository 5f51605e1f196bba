//! Warnings about a device, the calibration that is applied to it, the live page and its server.

use std::net::SocketAddr;
use zerorate::calibration::FileWarning;
use zerorate_allan::rows;

/// A warning about a running session. `cal` names the calibration by its file or its id. `why` is the error.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum SessionWarning {
    /// A warning about the calibration file itself.
    OfCalibration { cal: String, warning: FileWarning },
    /// The bias differs between warming and cooling in a chamber. The text is from
    /// [`wide_loop`](crate::report::wide_loop).
    WideLoop(String),
    /// Frames of a bridge arrived damaged: their number.
    Damaged(u64),
    /// The device or the capture `name` states no serial number, so the calibration may belong to another. `advice`
    /// says how to state the serial number.
    UnknownSerial { cal: String, calibrated: String, name: String, advice: &'static str },
    /// The calibration does not state the serial number of its sensor.
    NoSerial { cal: String },
    /// Samples did not reach the live page: their number.
    Missed(u64),
    /// The device was opened again, and the calibration does not belong to it. The text is the error.
    NotApplied(String),
    /// A file in the folder of calibrations cannot be read. The text is the error.
    LeftOut(String),
    /// The session has no folder for calibrations.
    NoFolder,
    /// A calibration cannot be written to the folder.
    NotKept { id: String, why: String },
    /// The file of a calibration cannot be removed from the folder.
    NotRemoved { id: String, why: String },
    /// An error ended the recording. The text is the error.
    NotRecorded(String),
    /// The libiio port cannot be opened; another server may use it. `why` is the error.
    LibiioUnserved { address: SocketAddr, why: String },
    /// The calibration cannot be applied for libiio clients. The text is the reason.
    LibiioUncorrected(String),
    /// The server for libiio clients failed. The text is the error.
    LibiioEnded(String),
    /// The program was built without its live page.
    NoPage,
}

rows!(match SessionWarning as Display {
    Self::OfCalibration { ref cal, ref warning } =>
        Row { code: { warning.code() }, text: format_args!("{cal}: {warning}") },
    Self::WideLoop(ref text) => Row { code: "hysteresis", text: format_args!("{text}") },
    Self::Damaged(frames) => Row {
        code: "damaged-frames",
        text: format_args!("{frames} frames from the bridge were damaged; check its cable, or lower the baud rate"),
    },
    Self::UnknownSerial { ref cal, ref calibrated, ref name, advice } => Row {
        code: "unknown-serial",
        text: format_args!("{cal} is for part {calibrated}; {name} may be another: {advice}"),
    },
    Self::NoSerial { ref cal } => Row {
        code: "unknown-serial",
        text: format_args!("{cal} states no serial number; calibrate with one next time"),
    },
    Self::Missed(samples) => Row {
        code: "samples-missed",
        text: format_args!("{samples} samples did not reach the page, statistics restart; use a divider"),
    },
    Self::NotApplied(ref why) =>
        Row { code: "not-applied", text: format_args!("calibration no longer applied: {why}") },
    Self::LeftOut(ref why) => Row { code: "calibration-left-out", text: format_args!("{why}") },
    Self::NoFolder => Row {
        code: "not-kept",
        text: format_args!("calibrations made here are lost when the program ends; --folder DIR keeps them"),
    },
    Self::NotKept { ref id, ref why } =>
        Row { code: "not-kept", text: format_args!("calibration {id} is not written ({why}); download it") },
    Self::NotRemoved { ref id, ref why } =>
        Row { code: "not-removed", text: format_args!("calibration {id} will come back ({why}); remove its file") },
    Self::NotRecorded(ref why) =>
        Row { code: "not-recorded", text: format_args!("the recording ended ({why}); start a new one") },
    Self::LibiioUnserved { address, ref why } =>
        Row { code: "libiio-unserved", text: format_args!("{address}: {why}; try --iio 127.0.0.1:0") },
    Self::LibiioUncorrected(ref why) =>
        Row { code: "libiio-uncorrected", text: format_args!("clients get raw rates: {why}") },
    Self::LibiioEnded(ref why) =>
        Row { code: "libiio-ended", text: format_args!("no libiio client can connect ({why}); restart the program") },
    Self::NoPage => Row {
        code: "no-page",
        text: format_args!("this program was built without its page; run `cargo xtask web`, then build it again"),
    },
});

impl SessionWarning {
    /// Compares the serial numbers of a calibration, which messages call `cal`, and of the device or capture `name`.
    /// Warns if one of them is unknown: every part has its own bias, and nothing in the samples shows a calibration
    /// of another part.
    ///
    /// # Errors
    /// Returns an error text if the serial numbers differ.
    pub fn of_serial(
        (cal, calibrated): (String, Option<&str>),
        (name, serial): (&str, Option<&str>),
        advice: &'static str,
    ) -> Result<Option<Self>, String> {
        match (serial, calibrated) {
            (Some(part), Some(calibrated)) if part == calibrated => Ok(None),
            (Some(part), Some(calibrated)) => {
                Err(format!("{name} is part {part}, {cal} is for part {calibrated}: every part has its own bias"))
            }
            (None, Some(calibrated)) => {
                let (calibrated, name) = (calibrated.to_owned(), name.to_owned());
                Ok(Some(Self::UnknownSerial { cal, calibrated, name, advice }))
            }
            (_, None) => Ok(Some(Self::NoSerial { cal })),
        }
    }
}
