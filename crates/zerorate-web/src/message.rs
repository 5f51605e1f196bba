//! The messages between the page and its session: `docs/formats/page.md`. `web/src/protocol.ts` is made from them.

mod calibrating;
mod statistics;

pub use calibrating::{
    AxisResult, Calibrating, CalibrationEntry, CalibrationResult, CurvePoint, Forecast, Running, Step,
};
use serde::{Deserialize, Serialize};
pub use statistics::{
    AllanPoint, Coefficient, MarkKind, OverTemperature, SpectrumMark, SpectrumPoint, Statistics, TemperatureLine,
    TemperaturePoint,
};
#[cfg(feature = "types")]
use ts_rs::TS;

/// A request of the page. Its answer has the same `id`.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Request {
    /// The id of the request, chosen by the page.
    pub id: u32,
    /// The command to carry out.
    #[serde(flatten)]
    pub command: Command,
}

/// A command of the page. Answers are empty unless stated otherwise.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum Command {
    /// Start a guided calibration.
    Calibrate(CalibrateCommand),
    /// End the running calibration without a result.
    AbortCalibration,
    /// End the recording of `warmup` or `cycle` now, with its result.
    FinishCalibration,
    /// Dismiss the result, refusal or abort of the last calibration.
    DismissCalibration,
    /// Apply a stored calibration to the readings; null: show raw rates only.
    Apply {
        /// The `id` of the calibration.
        calibration: Option<String>,
    },
    /// Store a calibration, from its TOML text. Answer: its [`CalibrationEntry`].
    AddCalibration {
        /// The text of the file.
        toml: String,
    },
    /// Remove a stored calibration that is not applied.
    RemoveCalibration {
        /// The `id` of the calibration.
        calibration: String,
    },
    /// Get a stored calibration as a file. Answer: [`Download`].
    Download {
        /// The `id` of the calibration.
        calibration: String,
        /// The format of the file.
        #[cfg_attr(feature = "types", ts(type = "Form"))]
        form: String,
    },
    /// Restart the statistics: Allan deviation, spectrum, bias over temperature.
    Restart,
    /// Set the integrated angle of each axis to zero.
    ZeroAngle,
    /// Set the speed of a simulated or recorded part, as a multiple of real time; 0: as fast as possible.
    Speed {
        /// The speed, 0 to 1000.
        factor: f64,
    },
    /// Open the device again, to read its registers anew or after it was disconnected.
    Reopen,
}

/// A guided calibration: its method, and settings that differ from the defaults.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(TS), ts(optional_fields))]
pub struct CalibrateCommand {
    /// The procedure to run.
    pub method: MethodName,
    /// Duration of steps 4 and 6 of AN-1042, s.
    pub average_s: Option<f64>,
    /// Duration of step 5, the warm-up, s.
    pub warmup_s: Option<f64>,
    /// Duration of step 7, the settling, s.
    pub settle_s: Option<f64>,
    /// Duration of step 8, the average that gives PBC, s.
    pub offset_s: Option<f64>,
    /// Latitude of the place if the part's axis is vertical, °, north positive.
    pub latitude_deg: Option<f64>,
    /// Serial number of the part.
    pub serial: Option<String>,
    /// For the method `chamber`: the name of a shipped plan, or the text of a plan (docs/formats/plan.md).
    pub plan: Option<String>,
}

/// The procedures of calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
#[expect(missing_docs, reason = "as on the command line")]
pub enum MethodName {
    An1042,
    Warmup,
    Cycle,
    Chamber,
}

/// The answer to a request.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Answer {
    /// The `id` of the request.
    pub id: u32,
    /// The reply, or the reason why there is none.
    #[serde(flatten)]
    pub outcome: AnswerOutcome,
}

/// The outcome of a request.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum AnswerOutcome {
    /// The command was carried out.
    Ok(Reply),
    /// The command was not carried out. The text says what is wrong and what to do.
    Error(String),
}

/// The content of an answer.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "types", derive(TS))]
pub enum Reply {
    /// A reply without content.
    Nothing {},
    /// A file for the user to save.
    Download(Download),
    /// The calibration that was stored.
    Calibration(CalibrationEntry),
}

/// A file for the user to save.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Download {
    /// The file name.
    pub name: String,
    /// The media type of the file.
    pub media_type: String,
    /// The text of the file.
    pub text: String,
}

/// The changes since the last frame, or everything in a snapshot. An absent field did not change.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS), ts(optional_fields))]
pub struct Frame {
    /// The number of the frame. It increases with each frame for all windows; a snapshot for one repeats the number.
    pub seq: u32,
    /// True if the frame replaces everything that was shown before.
    pub snapshot: bool,
    /// The completed bins of the plots over time. Their values are in the payload.
    pub strips: Vec<Strip>,
    /// The device that is being read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<Device>,
    /// The newest values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub now: Option<Now>,
    /// The counts of samples that arrived, were lost or have a fault.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ledger: Option<SampleCounts>,
    /// The notices, the newest last, at most 100.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notices: Option<Vec<Notice>>,
    /// The statistics of each axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub statistics: Option<Vec<Statistics>>,
    /// The state of the guided calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<Calibrating>,
    /// The stored calibrations, the newest last.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibrations: Option<Vec<CalibrationEntry>>,
}

/// Consecutive bins of the plots over time, of one axis at one level. The payload has rate_min_dps, rate_max_dps,
/// corrected_min_dps, corrected_max_dps, temp_min_c, temp_max_c, each as `count` numbers (f32, little endian). NaN
/// means unknown.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Strip {
    /// The index of the axis, from 0.
    pub axis: u32,
    /// The level, from 0. Higher levels have longer bins.
    pub level: u32,
    /// Number of the first bin. It starts `first` bin lengths after the first sample. `bins_s` of the device has the
    /// bin length of the level.
    pub first: u64,
    /// The number of bins.
    pub count: u32,
    /// Index of the strip's first number in the payload.
    pub at: u32,
}

/// The device that is being read.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Device {
    /// The address, in the syntax of `zerorate --device`; words for a bridge in a browser, which has no address.
    pub name: String,
    /// Opening, reading, ended or failed.
    pub state: DeviceState,
    /// True if the part is simulated or recorded, so that its `speed` can be set.
    pub simulated: bool,
    /// The speed as a multiple of real time; 0: as fast as possible.
    pub speed: f64,
    /// The type of gyroscope.
    pub part: String,
    /// The axes of the part.
    pub axes: Vec<AxisAbout>,
    /// Length of a bin at each level, s.
    pub bins_s: Vec<f64>,
    /// Number of bins that each level keeps.
    pub bins_kept: u32,
    /// Nominal conversion rate, Hz; null if unknown.
    pub nominal_hz: Option<f64>,
    /// The registers, as read when the device was opened; empty if there are none.
    pub registers: Vec<Register>,
    /// The results of the connection check.
    pub checks: Vec<CheckResult>,
    /// The default durations of a guided calibration.
    pub durations: Durations,
    /// Name and version of the program.
    pub software: String,
}

/// Durations of the steps of application note AN-1042, s.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
#[expect(missing_docs, reason = "as in a command")]
pub struct Durations {
    pub average_s: f64,
    pub warmup_s: f64,
    pub settle_s: f64,
    pub offset_s: f64,
}

/// The state of a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum DeviceState {
    /// The device is being opened.
    Opening,
    /// Samples arrive.
    Reading,
    /// The recording has ended; there are no more samples.
    Ended,
    /// The device cannot be read.
    Failed {
        /// The reason, and what to do.
        why: String,
    },
}

/// An axis of the part.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AxisAbout {
    /// The name of the axis in its part.
    pub name: String,
    /// Largest rate, °/s; null if unknown.
    pub range_dps: Option<f64>,
    /// Bandwidth (−3 dB), Hz; null if unknown.
    pub bandwidth_hz: Option<f64>,
    /// Frequency of the mechanical resonance, Hz; null if unknown.
    pub resonance_hz: Option<f64>,
}

/// A register and its content.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Register {
    /// The name in the data sheet.
    pub name: String,
    /// The address in the data sheet.
    pub address: u32,
    /// The content of the register.
    pub value: u32,
    /// The width of the register in bits.
    pub bits: u32,
    /// The fields of the register.
    pub fields: Vec<Field>,
}

/// A field of a register.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Field {
    /// The name in the data sheet.
    pub name: String,
    /// The bits of the field as a number.
    pub value: u32,
    /// The meaning of the value in plain words.
    pub meaning: String,
    /// True if the value differs from the expected one.
    pub wrong: bool,
}

/// The outcome of one check of the connection.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CheckResult {
    /// The subject of the check.
    pub what: String,
    /// True if the check passed.
    pub ok: bool,
    /// The observation, and the remedy if the check failed.
    pub text: String,
}

/// The newest values.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Now {
    /// Time of the newest sample since the first, s.
    pub t_s: f64,
    /// Mean temperature of the last second, °C; null if unknown.
    pub temp_c: Option<f64>,
    /// The values of each axis.
    pub axes: Vec<AxisNow>,
}

/// The newest values of an axis. Its rates are means over the last second; null if unknown.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AxisNow {
    /// Raw rate, °/s.
    pub rate_dps: Option<f64>,
    /// Standard uncertainty of the raw rate due to its noise, °/s.
    pub u_rate_dps: Option<f64>,
    /// Corrected rate, °/s; null if unknown or if no calibration is applied.
    pub corrected_dps: Option<f64>,
    /// Standard uncertainty of the corrected rate, including the calibration's, °/s.
    pub u_corrected_dps: Option<f64>,
    /// True if the temperature is outside the range of the calibration.
    pub extrapolated: bool,
    /// Integral of the corrected rate, °; of the raw rate without a calibration. It restarts at zero with `zero-angle`
    /// and with any change of the calibration.
    pub angle_deg: f64,
    /// Standard uncertainty of the angle due to noise and calibration, °.
    pub u_angle_deg: Option<f64>,
    /// The judgement whether the part was at rest.
    pub rest: Rest,
}

/// The judgement whether the part was at rest during the last 10 s.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Rest {
    /// The verdict; `unjudged` with too few readings, or if the part's noise or temperature coefficient is unknown.
    pub verdict: RestVerdict,
    /// The verdict in words, with its numbers.
    pub text: String,
}

/// The possible answers to the question whether the part was at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
#[expect(missing_docs, reason = "the text says it")]
pub enum RestVerdict {
    AtRest,
    Moving,
    Noisy,
    Step,
    Unjudged,
}

/// The counts of samples since the device was opened.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct SampleCounts {
    /// Number of samples that reached the session.
    pub samples: u64,
    /// Number of samples that were lost before they were read. Each sample states the number lost before it.
    pub lost: u64,
    /// Number of samples that were read but not shown, because the session was too slow. A recording has them.
    pub missed: u64,
    /// Number of readings of all axes that are impossible for the part.
    pub impossible: u64,
    /// Number of readings of all axes that are out of range.
    pub out_of_range: u64,
    /// Rate of the samples that were read, Hz; 0 before the second sample.
    pub rate_hz: f64,
    /// Rate of data-ready edges, Hz; 0 before the second sample.
    pub rdy_hz: f64,
    /// Time since which the readings of an axis are frozen, s after the first sample; null if no axis is frozen.
    pub frozen_since_s: Option<f64>,
    /// Time from the first to the newest sample, s.
    pub duration_s: f64,
}

/// A warning or message for the user.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Notice {
    /// The code for `zerorate explain`; empty for a notice without a code.
    pub code: String,
    /// The axis, if the notice is about one of several; else empty. Notices without a code differ in their texts.
    pub axis: String,
    /// The observation, its consequence and the remedy.
    pub text: String,
    /// Time at which the event first occurred or the condition first started, s after the first sample.
    pub at_s: f64,
    /// Number of times that the event occurred or the condition started.
    pub count: u32,
}
