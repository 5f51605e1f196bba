//! The bias over temperature of a log in which the temperature changes.

use super::message::{LogBias, LogPicture};
use super::settings::LABELS;
use crate::message::Download;
use std::path::Path;
use zerorate::temperature::curve::{CurveRefusal, LEAST_SPAN_C, LogCurve};
use zerorate_input::Input;
use zerorate_logs::{Column, ColumnOptions, ColumnSelection};
use zerorate_view::tempcal::{
    AxisCurve, FittedAxis, ImuColumns, Points, Sensor, Sensors, TempcalPage, UnitNames, ardupilot, calibration, csv,
    foreign_unit, over_temperature, possible_c, px4, refusal_text, span_c, table, tempcal_page, topic_of, values,
    warnings_of_axes,
};

/// The name of the part in a calibration, since the page does not ask for it.
const PART: &str = "gyroscope";

/// The averages of a log for curves of the bias over temperature, or the reason why there are none.
pub enum Bias {
    Sensors(Vec<Sensor>),
    /// The reason why the page cannot make curves of this log.
    Elsewhere(String),
}

impl Bias {
    /// Averages the axes of a log. `None` without axes, or if the temperature is impossible or has too small a span.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, or too many samples are missing.
    pub fn of(
        path: &Path,
        open: &impl Fn() -> Input,
        columns: &[Column],
        temperature: &Column,
        options: &ColumnOptions,
    ) -> zerorate_logs::Result<Option<Self>> {
        if let Some(unit) = foreign_unit(&temperature.name) {
            let why = format!("{} is in {unit}, and a curve takes °C; convert it", temperature.name);
            return Ok(Some(Self::Elsewhere(why)));
        }
        let (temps_hz, temps_start_s) = (temperature.rate_hz, temperature.start_s);
        let Ok(temps_c) = possible_c(values(temperature.clone(), path)?) else { return Ok(None) };
        if span_c(&temps_c).is_none_or(|(low_c, high_c)| high_c - low_c < LEAST_SPAN_C) {
            return Ok(None);
        }
        if !zerorate_logs::parameters(path, open())?.is_empty() {
            return Ok(Some(Self::Elsewhere(CORRECTED.to_owned())));
        }
        let topic = columns.first().and_then(|column| topic_of(&column.name));
        let device_id = topic.as_deref().and_then(|topic| device_id(path, open, topic, options));
        let imu = ImuColumns { topic, columns: Vec::new(), temps_c, temps_hz, temps_start_s, device_id };
        let mut sensors = Sensors::default();
        for column in columns {
            if let Err(why) = sensors.take_axis(path, &imu, column.clone())? {
                return Ok(Some(Self::Elsewhere(why)));
            }
        }
        let sensors = sensors.all();
        Ok((!sensors.is_empty()).then_some(Self::Sensors(sensors)))
    }

    /// The reason why a temperature that the user named gives no curve.
    pub fn unfit(name: &str) -> Self {
        Self::Elsewhere(format!("{name} is not a temperature in °C that changes by {LEAST_SPAN_C} °C or more"))
    }

    /// Fits the curves, and returns them as text, plots and files. `notes` are the warnings about the log.
    pub fn message(self, path: &Path, notes: &[String]) -> LogBias {
        let fitted = match self {
            Self::Elsewhere(why) => Err(why),
            Self::Sensors(sensors) => fitted(sensors).map_err(|why| refusal_text(&why, LABELS)),
        };
        fitted.map_or_else(
            |why_not| LogBias { why_not: Some(why_not), ..LogBias::default() },
            |axes| found(path, notes, axes),
        )
    }
}

/// The reason why the page does not make curves of an ArduPilot log.
const CORRECTED: &str = "ArduPilot has corrected and turned the readings of this log. `zerorate tempcal` takes that \
                         back by the log's parameters, and writes new ones.";

/// The device id that a PX4 driver logs beside its readings.
fn device_id(path: &Path, open: &impl Fn() -> Input, topic: &str, options: &ColumnOptions) -> Option<i64> {
    let name = topic.starts_with("sensor_").then(|| format!("{topic}.device_id"))?;
    let columns = zerorate_logs::read_all(path, open(), ColumnSelection::Listed(&[name]), options).ok()?;
    columns.first()?.points(path).ok()?.into_iter().find(|value| value.is_finite()).map(|value| value as i64)
}

fn fitted(sensors: Vec<Sensor>) -> Result<Vec<FittedAxis>, CurveRefusal> {
    let each = sensors.into_iter().map(|sensor| sensor.fitted(None)).collect::<Result<Vec<_>, _>>()?;
    Ok(each.into_iter().flatten().collect())
}

fn found(path: &Path, notes: &[String], fitted: Vec<FittedAxis>) -> LogBias {
    let (axes, curves, points): (Vec<_>, Vec<_>, Vec<_>) = fitted.into_iter().collect();
    let warnings = warnings_of_axes(&axes);
    let (mut files, mut no_files) = (Vec::new(), Vec::new());
    for (name, media_type, text) in texts(path, notes, &axes, &curves, &points) {
        match text {
            Ok(text) => files.push(Download { name: name.to_owned(), media_type: media_type.to_owned(), text }),
            Err(why) => no_files.push(format!("{name}: {why}")),
        }
    }
    LogBias { text: table(&axes), pictures: pictures(&axes, &points), warnings, files, no_files, why_not: None }
}

fn pictures(axes: &[AxisCurve], points: &[Points]) -> Vec<LogPicture> {
    let all: Vec<(&AxisCurve, &Points)> = axes.iter().zip(points).collect();
    let of_sensor = |axes: &[(&AxisCurve, &Points)]| {
        let kind = axes.first().map_or("", |(axis, _)| axis.kind.name());
        let title = format!("Bias over temperature: {kind}");
        LogPicture { name: format!("{kind}-bias.svg"), title, svg: over_temperature(axes) }
    };
    all.chunk_by(|one, other| one.0.sensor == other.0.sensor).map(of_sensor).collect()
}

/// The files: name, media type, and the text or the reason why there is none.
type Texts = [(&'static str, &'static str, Result<String, String>); 5];

fn texts(path: &Path, notes: &[String], axes: &[AxisCurve], curves: &[LogCurve], points: &[Points]) -> Texts {
    let logs = path.display().to_string();
    let title = format!("Bias over temperature in {logs}");
    let command = format!("zerorate tempcal {logs}");
    let page = tempcal_page(TempcalPage { title, command, warnings: notes, axes, points });
    let unit = UnitNames { part: PART.to_owned(), serial: None, logs };
    let toml = calibration(axes, curves, unit, LABELS).map(|calibration| calibration.to_toml());
    [
        ("bias-report.html", "text/html", page.map_err(|error| error.to_string())),
        ("bias-curve.csv", "text/csv", Ok(csv(axes))),
        ("calibration.toml", "application/toml", toml.map_err(|why| why.0)),
        ("px4.params", "text/plain", px4(axes).map_err(|why| why.0)),
        ("ardupilot.param", "text/plain", ardupilot(axes).map_err(|why| why.0)),
    ]
}
