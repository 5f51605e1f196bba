//! The messages between the page and its session: `docs/formats/page.md`. `web/src/protocol.ts` is made from these
//! types, which a test checks.

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

/// A request of the page. The answer has the same `id`.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Request {
    /// The number of the request, chosen by the page.
    pub id: u32,
    /// The command.
    #[serde(flatten)]
    pub command: Command,
}

/// A command of the page.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum Command {
    /// Begin a guided calibration. Answer: nothing.
    Calibrate(CalibrateCommand),
    /// End the calibration without a result. Answer: nothing.
    AbortCalibration,
    /// End the recording of `warmup` or `cycle` now, with its result. Answer: nothing.
    FinishCalibration,
    /// Dismiss the result, refusal or abort of the last calibration. Answer: nothing.
    DismissCalibration,
    /// Apply a calibration on file to the readings; none: show raw rates alone. Answer: nothing.
    Apply {
        /// Its `id`.
        calibration: Option<String>,
    },
    /// Put a calibration on file, from its TOML. Answer: its [`CalibrationEntry`].
    AddCalibration {
        /// The text of the file.
        toml: String,
    },
    /// Remove a calibration that is not applied. Answer: nothing.
    RemoveCalibration {
        /// Its `id`.
        calibration: String,
    },
    /// Give a calibration as a file. Answer: [`Download`].
    Download {
        /// Its `id`.
        calibration: String,
        /// The form of the file.
        #[cfg_attr(feature = "types", ts(type = "Form"))]
        form: String,
    },
    /// Restart the statistics: Allan deviation, spectrum, bias over temperature. Answer: nothing.
    Restart,
    /// Set the angle to zero. Answer: nothing.
    ZeroAngle,
    /// Set the speed of a simulated part, in multiples of real time; 0: as fast as possible. Answer: nothing.
    Speed {
        /// 0 … 1000.
        factor: f64,
    },
    /// Open the device again, to read its registers anew or after it was unplugged. Answer: nothing.
    Reopen,
}

/// A guided calibration: its method, and the settings that differ from the defaults.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CalibrateCommand {
    /// The method.
    pub method: MethodName,
    /// Duration of steps 4 and 6, s.
    #[cfg_attr(feature = "types", ts(optional))]
    pub average_s: Option<f64>,
    /// Duration of step 5, s.
    #[cfg_attr(feature = "types", ts(optional))]
    pub warmup_s: Option<f64>,
    /// Duration of step 7, s.
    #[cfg_attr(feature = "types", ts(optional))]
    pub settle_s: Option<f64>,
    /// Duration of step 8, s.
    #[cfg_attr(feature = "types", ts(optional))]
    pub offset_s: Option<f64>,
    /// Latitude of the part if its axis is vertical, °, north positive.
    #[cfg_attr(feature = "types", ts(optional))]
    pub latitude_deg: Option<f64>,
    /// Serial number of the part.
    #[cfg_attr(feature = "types", ts(optional))]
    pub serial: Option<String>,
    /// For the method `chamber`: the name of a plan that comes with the software, or the text of a plan
    /// (docs/formats/plan.md).
    #[cfg_attr(feature = "types", ts(optional))]
    pub plan: Option<String>,
}

/// The methods of calibration.
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
    /// The outcome.
    #[serde(flatten)]
    pub outcome: AnswerOutcome,
}

/// The outcome of a request.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum AnswerOutcome {
    /// It was done.
    Ok(Reply),
    /// It was not done: what is wrong, and what to do.
    Error(String),
}

/// The reply to a request that was done.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "types", derive(TS))]
pub enum Reply {
    /// Nothing more.
    Nothing {},
    /// A file.
    Download(Download),
    /// The calibration that is now on file.
    Calibration(CalibrationEntry),
}

/// A file for the user.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Download {
    /// The name of the file.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// The text of the file.
    pub text: String,
}

/// Everything that changed since the last frame; a snapshot has everything. A field that is absent did not change.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Frame {
    /// The number of the frame in its session.
    pub seq: u32,
    /// Everything that was shown before is void: the session is new, or the page just opened.
    pub snapshot: bool,
    /// Complete bins, whose numbers follow in the payload.
    pub strips: Vec<Strip>,
    /// The device.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub device: Option<Device>,
    /// The newest numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub now: Option<Now>,
    /// The counts of samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub ledger: Option<SampleCounts>,
    /// The notices, the newest last; at most 100.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub notices: Option<Vec<Notice>>,
    /// The statistics of each axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub statistics: Option<Vec<Statistics>>,
    /// The guided calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub calibration: Option<Calibrating>,
    /// The calibrations on file, the newest last.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub calibrations: Option<Vec<CalibrationEntry>>,
}

/// Consecutive bins of one axis at one level. In the payload: rate_min_dps, rate_max_dps, corrected_min_dps,
/// corrected_max_dps, temp_min_c, temp_max_c, each `count` numbers (f32, little endian). NaN means unknown.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Strip {
    /// The number of the axis, from 0.
    pub axis: u32,
    /// The number of the level, from 0.
    pub level: u32,
    /// Number of the first bin. It begins at `first` times the level's `bin_s`, since the first sample.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub first: u64,
    /// The number of bins.
    pub count: u32,
    /// Start of its numbers in the payload, counted in numbers.
    pub at: u32,
}

/// The device that is being read.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Device {
    /// The name, as `zerorate --device` takes it.
    pub name: String,
    /// The state.
    pub state: DeviceState,
    /// Whether its time is simulated, so that `speed` works.
    pub simulated: bool,
    /// The speed in multiples of real time; 0: as fast as possible.
    pub speed: f64,
    /// The kind of gyroscope.
    pub part: String,
    /// The axes.
    pub axes: Vec<AxisAbout>,
    /// Length of a bin at each level, s.
    pub bins_s: Vec<f64>,
    /// Number of bins that are kept of each level.
    pub bins_kept: u32,
    /// Nominal conversion rate, Hz, if it is known.
    pub nominal_hz: Option<f64>,
    /// The registers at the time of opening; empty if there are none to read.
    pub registers: Vec<Register>,
    /// The results of the connection check.
    pub checks: Vec<CheckResult>,
    /// The durations of a guided calibration, if a command gives none.
    pub durations: Durations,
    /// Version of the program.
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
    /// It is being opened.
    Opening,
    /// Samples arrive.
    Reading,
    /// The recording ended; there are no more samples.
    Ended,
    /// The device cannot be read.
    Failed {
        /// Why, and what to do about it.
        why: String,
    },
}

/// An axis of the part.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AxisAbout {
    /// The name.
    pub name: String,
    /// Largest rate, °/s.
    pub range_dps: Option<f64>,
    /// Bandwidth (−3 dB), Hz.
    pub bandwidth_hz: Option<f64>,
    /// The mechanical resonance, Hz.
    pub resonance_hz: Option<f64>,
}

/// A register and its content.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Register {
    /// The name in the data sheet.
    pub name: String,
    /// The address.
    pub address: u32,
    /// The content.
    pub value: u32,
    /// The width, bits.
    pub bits: u32,
    /// The fields.
    pub fields: Vec<Field>,
}

/// Bits of a register.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Field {
    /// The name in the data sheet.
    pub name: String,
    /// The value.
    pub value: u32,
    /// The meaning in plain words.
    pub meaning: String,
    /// Whether the value is not as expected.
    pub wrong: bool,
}

/// A check of the connection.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CheckResult {
    /// The subject of the check.
    pub what: String,
    /// Whether the check passed.
    pub ok: bool,
    /// What was seen, and what to do.
    pub text: String,
}

/// The newest numbers.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Now {
    /// Time since the first sample, s.
    pub t_s: f64,
    /// Mean temperature of the last second, °C.
    pub temp_c: Option<f64>,
    /// The numbers of each axis.
    pub axes: Vec<AxisNow>,
}

/// The newest numbers of an axis: means over the last second, with standard uncertainties.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AxisNow {
    /// Raw rate, °/s.
    pub rate_dps: Option<f64>,
    /// Standard uncertainty of the raw rate by its noise, °/s.
    pub u_rate_dps: Option<f64>,
    /// Corrected rate, °/s; null if no calibration is applied.
    pub corrected_dps: Option<f64>,
    /// Standard uncertainty of the corrected rate, including the calibration's, °/s.
    pub u_corrected_dps: Option<f64>,
    /// Whether the temperature is outside the range of the calibration.
    pub extrapolated: bool,
    /// Integral of the corrected rate since it was set to zero, °. Without a calibration, the raw rate is integrated.
    /// `zero-angle` sets it to zero, and so does a change of the calibration.
    pub angle_deg: f64,
    /// Standard uncertainty of the angle by noise and calibration, °.
    pub u_angle_deg: Option<f64>,
    /// Whether the part is at rest.
    pub rest: Rest,
}

/// Whether the part is at rest, over the last 10 s.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Rest {
    /// The verdict; `unjudged` if there are too few readings, or if the noise of the part is unknown.
    pub verdict: RestVerdict,
    /// The verdict in words, with its numbers.
    pub text: String,
}

/// Verdicts on rest.
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

/// The counts of samples since the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct SampleCounts {
    /// Samples that arrived here.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub samples: u64,
    /// Samples that were lost before the thread of the device, as the samples themselves count them.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub lost: u64,
    /// Samples that were read but not shown, because the session of this page was too slow. A recording has them.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub missed: u64,
    /// Readings that are impossible for the part.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub impossible: u64,
    /// Readings out of range.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub out_of_range: u64,
    /// Rate of samples, Hz.
    pub rate_hz: f64,
    /// Rate of edges of data ready, Hz.
    pub rdy_hz: f64,
    /// The time since which the part has stopped, s since the first sample.
    pub frozen_since_s: Option<f64>,
    /// Duration since the first sample, s.
    pub duration_s: f64,
}

/// A notice.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Notice {
    /// The code, which `zerorate explain` knows; empty for a notice without one.
    pub code: String,
    /// What was seen, why it matters, what to do.
    pub text: String,
    /// The first time, s since the first sample.
    pub at_s: f64,
    /// The number of times that it happened or began.
    pub count: u32,
}
