//! Reads scales in the lines above the data. The scales of Gyroflow's logs (.gcsv) and the time of LabVIEW's logs
//! (.lvm) are used, and other scales are reported.

use crate::clock::Times;
use zerorate_input::{TimeUnit, Unit};

/// Name of the column with the time in Gyroflow's logs.
const TIME: &str = "t";

/// Names of the column with the time, s, in LabVIEW's logs, and of the lines that state its quantity and its step.
const X_VALUE: &str = "X_Value";
const X_DIMENSION: &str = "X_Dimension";
const DELTA_X: &str = "Delta_X";

/// The sizes of a step that a log states: of the time, s, and in logs of Gyroflow of `gx`, rad/s, and of `ax`, g.
#[derive(Clone, Debug, Default)]
pub struct Scales {
    /// The column with the time, and the size of its step, s.
    time: Option<(&'static str, f64)>,
    gyro_rad_s: Option<f64>,
    accel_g: Option<f64>,
    /// The first line that states a scale that is not used.
    pub unused: Option<String>,
}

impl Scales {
    /// The scales in the lines above the columns `names`.
    pub fn of<'a>(lines: impl Iterator<Item = &'a str>, names: &[String]) -> Self {
        let mut scales = Self::default();
        let mut is_time = true;
        let has = |column: &str| names.iter().any(|name| name == column);
        for line in lines.map(|line| line.trim_start_matches(['#', '%', ' '])) {
            let pair = pair(line);
            match pair.as_ref().map(|(key, scale)| (key.as_str(), *scale)) {
                Some(("tscale", scale)) if has(TIME) => scales.time = Some((TIME, scale)),
                _ if line.starts_with(X_DIMENSION) => is_time = line.contains("Time"),
                _ if is_time && has(X_VALUE) && line.starts_with(DELTA_X) => scales.time = Some((X_VALUE, 1.0)),
                Some(("gscale", scale)) if has("gx") => scales.gyro_rad_s = Some(scale),
                Some(("ascale", scale)) if has("ax") => scales.accel_g = Some(scale),
                _ if scales.unused.is_none() && states_scale(line) => scales.unused = Some(line.to_owned()),
                _ => {}
            }
        }
        scales
    }

    /// True if the log states its scales as Gyroflow does.
    pub fn are_of_gyroflow(&self) -> bool {
        let time_s = self.time.filter(|(column, _)| *column == TIME).map(|(_, step_s)| step_s);
        time_s.or(self.gyro_rad_s).or(self.accel_g).is_some()
    }

    /// The column with the time, if the log states its step in s.
    pub fn time(&self) -> Option<&'static str> {
        self.time.map(|(column, _)| column)
    }

    /// The unit and the size of a step of a column.
    pub fn of_column(&self, name: &str) -> Option<(Unit, f64)> {
        match name {
            "gx" | "gy" | "gz" => self.gyro_rad_s.map(|step| (Unit::RadPerS, step)),
            "ax" | "ay" | "az" => self.accel_g.map(|step| (Unit::G, step)),
            _ => None,
        }
    }

    /// Converts the times to s, if the log states the scale of their column and their unit is not known.
    pub fn give_unit(&self, name: &str, times: &mut Times) {
        let stated = self.time.filter(|(column, _)| *column == name && times.unit.is_none());
        if let Some((_, step_s)) = stated {
            times.scale(step_s);
            times.unit = Some(TimeUnit::S);
        }
    }
}

/// Parses a word and a number above zero: `gscale,0.00122`.
fn pair(line: &str) -> Option<(String, f64)> {
    let (key, value) = line.split_once([',', '=', ':', ';', '\t'])?;
    let value: f64 = value.trim().parse().ok()?;
    (value > 0.0 && value.is_finite()).then(|| (key.trim().to_lowercase(), value))
}

/// True if a line has a number beside a word for a scale.
fn states_scale(line: &str) -> bool {
    let line = line.to_lowercase();
    let is_scale = |word: &str| word.ends_with("scale") || ["scaling", "sensitivity", "lsb"].contains(&word);
    line.contains(|c: char| c.is_ascii_digit()) && line.split(|c: char| !c.is_alphabetic()).any(is_scale)
}
