//! The messages between the page and its session: `docs/formats/page.md`. `web/src/protocol.ts` is made from these
//! types, which a test checks.

mod calibrating;
mod statistics;

pub use calibrating::{AxisResult, Calibrating, CalibrationEntry, CalibrationResult, CurvePoint, Running, Step};
use serde::{Deserialize, Serialize};
pub use statistics::{
    AllanPoint, Coefficient, MarkKind, OverTemperature, SpectrumMark, SpectrumPoint, Statistics, TemperatureLine,
    TemperaturePoint,
};
#[cfg(test)]
use ts_rs::TS;

/// What the page asks for; `id` comes back with the answer.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(test, derive(TS))]
pub struct Request {
    /// Chosen by the page.
    pub id: u32,
    /// What to do.
    #[serde(flatten)]
    pub command: Command,
}

/// Something that the page can ask for.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
pub enum Command {
    /// Begin a guided calibration. Answer: nothing.
    Calibrate(CalibrateCommand),
    /// End it without a result. Answer: nothing.
    AbortCalibration,
    /// End the recording of `warmup` or `cycle` here, with its result. Answer: nothing.
    FinishCalibration,
    /// Put the result, the refusal or the abort of the last one away. Answer: nothing.
    DismissCalibration,
    /// Apply a calibration on file to what is shown; none: show raw rates alone. Answer: nothing.
    Apply {
        /// Its `id`.
        calibration: Option<String>,
    },
    /// Put a calibration on file, from its TOML. Answer: its [`CalibrationEntry`].
    AddCalibration {
        /// What stands in the file.
        toml: String,
    },
    /// Take a calibration off file that is not applied. Answer: nothing.
    RemoveCalibration {
        /// Its `id`.
        calibration: String,
    },
    /// A calibration as a file. Answer: [`Download`].
    Download {
        /// Its `id`.
        calibration: String,
        /// In which form.
        #[cfg_attr(test, ts(type = "Form"))]
        form: String,
    },
    /// Begin the statistics anew: Allan deviation, spectrum, bias over temperature. Answer: nothing.
    Restart,
    /// The angle is zero now. Answer: nothing.
    ZeroAngle,
    /// How many times as fast as the clock a simulated part runs; 0: as fast as it goes. Answer: nothing.
    Speed {
        /// 0 … 1000.
        factor: f64,
    },
    /// Open the device again: another look at its registers, or a part that was unplugged. Answer: nothing.
    Reopen,
}

/// A guided calibration: a method and what differs from its defaults.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(test, derive(TS))]
pub struct CalibrateCommand {
    /// How.
    pub method: MethodName,
    /// Steps 4 and 6, s.
    #[cfg_attr(test, ts(optional))]
    pub average_s: Option<f64>,
    /// Step 5, s.
    #[cfg_attr(test, ts(optional))]
    pub warmup_s: Option<f64>,
    /// Step 7, s.
    #[cfg_attr(test, ts(optional))]
    pub settle_s: Option<f64>,
    /// Step 8, s.
    #[cfg_attr(test, ts(optional))]
    pub offset_s: Option<f64>,
    /// Where the part is, if its axis is vertical, °, north of the equator positive.
    #[cfg_attr(test, ts(optional))]
    pub latitude_deg: Option<f64>,
    /// Serial number of the part.
    #[cfg_attr(test, ts(optional))]
    pub serial: Option<String>,
    /// Of the method `chamber`: the name of a plan that comes with the software, or a plan itself
    /// (docs/formats/plan.md).
    #[cfg_attr(test, ts(optional))]
    pub plan: Option<String>,
}

/// Ways to calibrate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
#[expect(missing_docs, reason = "as on the command line")]
pub enum MethodName {
    An1042,
    Warmup,
    Cycle,
    Chamber,
}

/// What comes back for a request.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Answer {
    /// That of the request.
    pub id: u32,
    /// How it ended.
    #[serde(flatten)]
    pub outcome: Answered,
}

/// How a request ended.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
pub enum Answered {
    /// Done.
    Ok(Reply),
    /// Not done: what is wrong, and what to do.
    Error(String),
}

/// What a request gives.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
#[cfg_attr(test, derive(TS))]
pub enum Reply {
    /// It is done, and that is all.
    Nothing {},
    /// A file.
    Download(Download),
    /// The calibration that is on file now.
    Calibration(CalibrationEntry),
}

/// A file for the user.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Download {
    /// What it is called.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// What stands in it.
    pub text: String,
}

/// What is new since the frame before; in a snapshot, all there is. What is absent is as it was.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Frame {
    /// Counts the frames of a session.
    pub seq: u32,
    /// Everything that was shown before is void: of a new session, or of a page that just came.
    pub snapshot: bool,
    /// Bins that are complete, whose numbers follow in the payload.
    pub strips: Vec<Strip>,
    /// What is being read.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub device: Option<Device>,
    /// The newest numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub now: Option<Now>,
    /// What was read and lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub ledger: Option<SampleCounts>,
    /// What there is to say, the newest last; at most 100.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub notices: Option<Vec<Notice>>,
    /// Of each axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub statistics: Option<Vec<Statistics>>,
    /// The guided calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub calibration: Option<Calibrating>,
    /// What is on file, the newest last.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub calibrations: Option<Vec<CalibrationEntry>>,
}

/// Bins in a row of one axis at one level. In the payload: rate_min_dps, rate_max_dps, corrected_min_dps,
/// corrected_max_dps, temp_min_c, temp_max_c, each `count` numbers (f32, little endian). NaN where nothing is known.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Strip {
    /// Which axis, from 0.
    pub axis: u32,
    /// Which level, from 0.
    pub level: u32,
    /// Number of the first bin: it begins at `first` times the level's `bin_s`, since the first sample.
    #[cfg_attr(test, ts(type = "number"))]
    pub first: u64,
    /// How many.
    pub count: u32,
    /// Where its numbers begin in the payload, in numbers.
    pub at: u32,
}

/// What is being read.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Device {
    /// As `zerorate --device` names it.
    pub name: String,
    /// How it is with it.
    pub state: DeviceState,
    /// Whether its time is simulated, so that `speed` works.
    pub simulated: bool,
    /// How many times as fast as the clock; 0: as fast as it goes.
    pub speed: f64,
    /// What kind of gyroscope it is.
    pub part: String,
    /// Its axes.
    pub axes: Vec<AxisAbout>,
    /// Length of a bin at each level, s.
    pub bins_s: Vec<f64>,
    /// Bins that are kept of each level.
    pub bins_kept: u32,
    /// How often it should convert, Hz, if that is known.
    pub nominal_hz: Option<f64>,
    /// Its registers when it was opened; empty where there are none to read.
    pub registers: Vec<Register>,
    /// What the check of the connection found.
    pub checks: Vec<CheckResult>,
    /// What a guided calibration takes where a command leaves it open.
    pub durations: Durations,
    /// Version of the program.
    pub software: String,
}

/// Of the steps of application note AN-1042, s.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
#[expect(missing_docs, reason = "as in a command")]
pub struct Durations {
    pub average_s: f64,
    pub warmup_s: f64,
    pub settle_s: f64,
    pub offset_s: f64,
}

/// How it is with a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
pub enum DeviceState {
    /// It is being opened.
    Opening,
    /// Samples come.
    Reading,
    /// There are no more: a recording ended.
    Ended,
    /// It cannot be read, and why; what to do about it.
    Failed {
        /// In words.
        why: String,
    },
}

/// An axis of the part.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct AxisAbout {
    /// What it is called.
    pub name: String,
    /// Largest rate, °/s.
    pub range_dps: Option<f64>,
    /// −3 dB, Hz.
    pub bandwidth_hz: Option<f64>,
    /// The mechanical resonance, Hz.
    pub resonance_hz: Option<f64>,
}

/// A register and what it says.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Register {
    /// As the data sheet calls it.
    pub name: String,
    /// Where.
    pub address: u32,
    /// What stands in it.
    pub value: u32,
    /// How wide it is.
    pub bits: u32,
    /// Its fields.
    pub fields: Vec<Field>,
}

/// Bits of a register.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Field {
    /// As the data sheet calls them.
    pub name: String,
    /// What stands in them.
    pub value: u32,
    /// In plain words.
    pub meaning: String,
    /// Not what it should be.
    pub wrong: bool,
}

/// A check of the connection.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct CheckResult {
    /// What was tried.
    pub what: String,
    /// Whether it is well.
    pub ok: bool,
    /// What was seen, and what to do.
    pub text: String,
}

/// The newest numbers.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Now {
    /// Since the first sample, s.
    pub t_s: f64,
    /// Mean temperature of the last second, °C.
    pub temp_c: Option<f64>,
    /// Of each axis.
    pub axes: Vec<AxisNow>,
}

/// The newest numbers of an axis: means over the last second, with the standard uncertainty that their digits warrant.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct AxisNow {
    /// °/s.
    pub rate_dps: Option<f64>,
    /// Of that mean, by its noise, °/s.
    pub u_rate_dps: Option<f64>,
    /// °/s; null where no calibration is applied.
    pub corrected_dps: Option<f64>,
    /// Of that mean with the calibration's, °/s.
    pub u_corrected_dps: Option<f64>,
    /// The temperature is outside of the calibration's.
    pub extrapolated: bool,
    /// Integral of the corrected rate (of the raw one where none is applied) since it was zero, °: by `zero-angle`, or
    /// when another calibration was applied.
    pub angle_deg: f64,
    /// Its standard uncertainty by noise and calibration, °.
    pub u_angle_deg: Option<f64>,
    /// Whether the part is at rest.
    pub rest: Rest,
}

/// Whether the part is at rest, over the last 10 s.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Rest {
    /// The verdict; `unjudged` before there is enough, or where the part's noise is not known.
    pub verdict: RestVerdict,
    /// In words, with the numbers.
    pub text: String,
}

/// Verdicts on rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
#[expect(missing_docs, reason = "the text says it")]
pub enum RestVerdict {
    AtRest,
    Moving,
    Noisy,
    Step,
    Unjudged,
}

/// What was read and lost since the beginning.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct SampleCounts {
    /// Samples that came here.
    #[cfg_attr(test, ts(type = "number"))]
    pub samples: u64,
    /// Lost in front of the device's thread, as its samples count them.
    #[cfg_attr(test, ts(type = "number"))]
    pub lost: u64,
    /// Read, but not shown: this page's session was too slow for them. A recording has them.
    #[cfg_attr(test, ts(type = "number"))]
    pub missed: u64,
    /// Readings that are impossible for the part.
    #[cfg_attr(test, ts(type = "number"))]
    pub impossible: u64,
    /// Readings out of range.
    #[cfg_attr(test, ts(type = "number"))]
    pub out_of_range: u64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Edges of data ready a second.
    pub rdy_hz: f64,
    /// Since when the part has stopped, s since the first sample.
    pub frozen_since_s: Option<f64>,
    /// How long it takes, s, from the first sample.
    pub duration_s: f64,
}

/// Something to know.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Notice {
    /// Its code, which `zerorate explain` knows; empty where it has none.
    pub code: String,
    /// What was seen, why it matters, what to do.
    pub text: String,
    /// When first, s since the first sample.
    pub at_s: f64,
    /// How often it happened, or began to be so.
    pub count: u32,
}

#[cfg(test)]
mod tests {
    use super::{Answer, Frame, Request};
    use std::path::Path;
    use std::{env, fs};
    use ts_rs::{Config, TS};
    use zerorate_view::export::ExportForm;

    /// `cargo xtask codegen` sets `ZERORATE_UPDATE`, which writes the file anew.
    #[test]
    fn the_page_knows_these_types() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/src/protocol.ts");
        let folder = env::temp_dir().join(format!("zerorate-protocol-{}", std::process::id()));
        let made = typescript(&folder);
        fs::remove_dir_all(&folder).unwrap();
        if env::var_os("ZERORATE_UPDATE").is_some() {
            fs::write(&path, &made).unwrap();
        }
        let there = fs::read_to_string(&path).unwrap_or_default();
        assert!(there == made, "{} is out of date; `cargo xtask codegen` writes it", path.display());
    }

    fn typescript(folder: &Path) -> String {
        let config = Config::new().with_out_dir(folder);
        Request::export_all(&config).unwrap();
        Answer::export_all(&config).unwrap();
        Frame::export_all(&config).unwrap();
        crate::log::message::LogSettings::export_all(&config).unwrap();
        crate::log::message::Looked::export_all(&config).unwrap();
        crate::log::message::LogAxis::export_all(&config).unwrap();
        crate::log::message::LogSummary::export_all(&config).unwrap();
        crate::log::message::NoiseFileCommand::export_all(&config).unwrap();
        let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        let declared = files.iter().map(|file| {
            let text = fs::read_to_string(file).unwrap();
            let lines = text.lines().filter(|line| !line.starts_with("import ") && !line.starts_with("// This file"));
            lines.collect::<Vec<_>>().join("\n").trim().to_owned() + "\n"
        });
        let head =
            "// Made from message.rs and log/message.rs of crates/zerorate-web/src, which say more.\n\n".to_owned();
        let exports = ExportForm::ALL.into_iter().filter(|form| !form.is_autopilot());
        let exports = exports.map(|form| (form.row().name, form.row().label));
        let forms: Vec<_> = [("toml", "TOML")].into_iter().chain(exports).chain([("report", "Report")]).collect();
        let forms = serde_json::to_string(&forms).unwrap();
        let forms = format!(
            "\n/**\n * Forms of a download: name and label.\n */\nexport const FORMS = {forms} as const;\n\n\
             export type Form = (typeof FORMS)[number][0];\n"
        );
        head + &declared.collect::<Vec<_>>().join("\n") + &forms
    }
}
