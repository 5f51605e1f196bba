//! A guided calibration: its advice, its pending refusals, and its result.

mod chamber;
mod hour;

use super::axis::AxisState;
use super::calibration_store::entry;
use super::notices::NoticeText;
use crate::message::{AxisResult, CalibrateCommand, Calibrating, CalibrationResult, CurvePoint, MethodName, Running};
use adis16130_twin::Truth;
use chamber::ByHand;
use hour::Hour;
use zerorate::calibration::Origin;
use zerorate::{Calibration, Correction, EARTH_DPS, Part, Scan, Setting, Tally, Warning, Wording};
use zerorate_allan::SettingName;
use zerorate_record::{CaptureInfo, Row, SampleHash};
use zerorate_view::remarks_apart;

/// Shortest time between two calls of [`GuidedMethod::look`], s of the part's time.
const LOOK_EVERY_S: f64 = 2.0;
/// Number of points of the reported curve.
const POINTS: u8 = 9;

/// The interface of all methods: a procedure that processes readings.
trait GuidedMethod: std::fmt::Debug + Send {
    /// Starts the procedure, after the sensor was initialised. `t_ns` is the time of the first reading.
    fn begin(&mut self, t_ns: u64) -> Result<(), String>;

    /// Processes a reading. Returns true when the procedure is complete. An error is a refusal.
    fn take(&mut self, scan: &Scan) -> Result<bool, String>;

    /// Ends the recording now. Returns false if none is running: in another method, or before the start.
    fn end_recording(&mut self) -> Result<bool, String> {
        Ok(false)
    }

    /// Does periodic work that takes too long to be done with each reading.
    fn look(&mut self) {}

    fn running(&self, method: MethodName, temps_c: Option<[f64; 4]>) -> Running;

    fn finish(self: Box<Self>, source: &Measurement<'_>, origin: Origin) -> Result<GuidedResult, String>;
}

struct GuidedResult {
    calibration: Calibration,
    axes: Vec<GuidedAxis>,
    warnings: Vec<NoticeText>,
}

struct GuidedAxis {
    correction: Correction,
    u_pbc_dps: f64,
    u_btc_dps_per_c: f64,
    span_c: (f64, f64),
}

#[derive(Debug)]
pub struct GuidedCalibration {
    pub method: MethodName,
    serial: Option<String>,
    procedure: Box<dyn GuidedMethod>,
    pub begun: bool,
    hash: SampleHash,
    temps_c: Option<[f64; 4]>,
    look_s: f64,
}

impl GuidedCalibration {
    /// Prepares a calibration, before the first reading of a part that was just initialised.
    pub fn new(command: &CalibrateCommand, part: &Part, info: &CaptureInfo) -> Result<Self, String> {
        if let Some(deg) = command.latitude_deg.filter(|deg| !(-90.0..=90.0).contains(deg)) {
            return Err(format!("the latitude is {deg}°: give a number from -90 to 90"));
        }
        // the latitude gives the component along a vertical axis (F-16); a recording may state it for any axis
        let earth_dps = command.latitude_deg.map(|deg| EARTH_DPS * deg.to_radians().sin()).or(info.earth_dps);
        let procedure: Box<dyn GuidedMethod> = match command.method {
            MethodName::Chamber => Box::new(ByHand::new(command, part, earth_dps)?),
            _ => Box::new(Hour::new(command, part, earth_dps)?),
        };
        Ok(Self {
            method: command.method,
            serial: command.serial.clone().filter(|serial| !serial.trim().is_empty()),
            procedure,
            begun: false,
            hash: SampleHash::new(&info.layout),
            temps_c: None,
            look_s: 0.0,
        })
    }

    /// Processes a reading. Returns true when the procedure is complete.
    #[inline]
    pub fn take(&mut self, row: &Row, scan: &Scan) -> Result<bool, String> {
        if !std::mem::replace(&mut self.begun, true) {
            self.procedure.begin(row.t_ns)?;
        }
        self.hash.update(row);
        self.procedure.take(scan)
    }

    /// Ends the recording now, as [`GuidedMethod::end_recording`] does.
    pub fn end_recording(&mut self) -> Result<bool, String> {
        self.procedure.end_recording()
    }

    /// Updates the temperatures and, if a check is due, the pending refusals. Called at the end of each block.
    pub fn look(&mut self, temp_c: Option<f64>) {
        if let Some(now_c) = temp_c {
            let [first, _, low, high] = self.temps_c.unwrap_or([now_c; 4]);
            self.temps_c = Some([first, now_c, low.min(now_c), high.max(now_c)]);
        }
        let elapsed_s = self.procedure.running(self.method, None).elapsed_s;
        if elapsed_s >= self.look_s {
            self.look_s = elapsed_s + LOOK_EVERY_S.max(elapsed_s / 100.0);
            self.procedure.look();
        }
    }

    pub fn shown(&self) -> Calibrating {
        Calibrating::Running(self.procedure.running(self.method, self.temps_c))
    }

    pub fn finish(self, source: &Measurement<'_>) -> Result<(CalibrationResult, Calibration), String> {
        let info = CaptureInfo { serial: self.serial.or_else(|| source.info.serial.clone()), ..source.info.clone() };
        let GuidedResult { calibration, axes, warnings } =
            self.procedure.finish(source, info.origin(self.hash.hex()))?;
        let shown = axes.iter().enumerate().map(|(index, found)| source.axis(index, found, &calibration));
        let lines: Vec<String> = warnings.iter().map(NoticeText::to_string).collect();
        let (remarks, warnings) = remarks_apart(&lines);
        let entry = entry(&calibration, false);
        let result = CalibrationResult { method: self.method, entry, axes: shown.collect(), warnings, remarks };
        Ok((result, calibration))
    }
}

/// The facts about a measurement that its procedure does not hold, for the result.
pub struct Measurement<'a> {
    pub info: &'a CaptureInfo,
    pub tally: &'a Tally,
    pub axes: &'a [AxisState],
    pub truths: &'a [Truth],
}

impl Measurement<'_> {
    fn axis(&self, index: usize, found: &GuidedAxis, calibration: &Calibration) -> AxisResult {
        let (truth, axis) = (self.truths.get(index), calibration.axes.get(index));
        let (low_c, high_c) = found.span_c;
        let temps = (0..POINTS).map(|k| low_c + (high_c - low_c) * f64::from(k) / f64::from(POINTS - 1));
        let curve = temps.map(|temp_c| CurvePoint {
            temp_c,
            correction_dps: found.correction.at(temp_c),
            u_dps: axis.and_then(|axis| axis.u_correction_dps(temp_c)),
            truth_dps: truth.map(|truth| truth.pbc_dps(temp_c)),
        });
        let last = self.axes.get(index).and_then(AxisState::last_minute);
        AxisResult {
            name: axis.map_or_else(String::new, |axis| axis.name.clone()),
            pbc_dps: found.correction.pbc_dps,
            u_pbc_dps: found.u_pbc_dps,
            btc_dps_per_c: found.correction.btc_dps_per_c,
            u_btc_dps_per_c: found.u_btc_dps_per_c,
            t3_c: found.correction.t3_c,
            curve: curve.collect(),
            before_dps: last.map(|(rate_dps, _)| rate_dps),
            after_dps: last.map(|(rate_dps, temp_c)| found.correction.apply(rate_dps, temp_c)),
        }
    }
}

/// The page's name for a setting.
fn label(setting: Setting) -> SettingName {
    SettingName::text(match setting {
        Setting::Average => "the two averages",
        Setting::WarmUp => "the warm-up",
        Setting::Settle => "settling",
        Setting::Offset => "the offset average",
        Setting::Earth => "latitude",
        Setting::AssumeLinear => "`zerorate recalibrate --assume-linear`",
        other => return other.name(),
    })
}

/// The texts of the warnings, each once.
fn worded<'a>(warnings: impl IntoIterator<Item = &'a Warning>) -> Vec<NoticeText> {
    let mut all = Vec::new();
    for warning in warnings {
        let text = NoticeText::new(warning.code(), warning.with(label));
        if !all.contains(&text) {
            all.push(text);
        }
    }
    all
}
