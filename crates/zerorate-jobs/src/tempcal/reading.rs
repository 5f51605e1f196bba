//! Reads the sensors in logs: the means of each axis and the temperatures at which they were measured.

use super::ardupilot::AppliedCorrections;
use super::{TempcalOptions, UnitLog};
use crate::InvalidOptions;
use crate::code_scales::concerns;
use anyhow::Result;
use std::collections::BTreeMap;
use std::path::Path;
use zerorate_host::files;
use zerorate_imu::{Axes, ImuOptions, Kind};
use zerorate_logs::{
    Column, ColumnOptions, ColumnSelection, LogError, LogWarning, Series, Setting, TEMPERATURE_NAMES,
};
use zerorate_view::tempcal::{
    ImuColumns, Sensor, Sensors, foreign_unit, number_of_imu, possible_c, span_c, topic_of, values,
};

/// Reads all sensors of all logs. Also returns the warnings about the logs.
pub(super) fn sensors(logs: &[UnitLog], options: &TempcalOptions) -> Result<(Vec<Sensor>, Vec<String>)> {
    let (mut sensors, mut notes) = (Sensors::default(), Vec::new());
    for log in logs {
        let other = |why: String| InvalidOptions(format!("{why}; give logs of the same unit"));
        sensors.take(log.path(), imus(log, options, &mut notes)?)?.map_err(other)?;
    }
    Ok((sensors.all(), notes))
}

/// Undoes the corrections and the rotation that the parameters of an ArduPilot log applied to an IMU's readings.
fn undo(imu: &mut ImuColumns, parameters: &BTreeMap<String, f64>, log: &Path) -> Result<()> {
    let corrected = AppliedCorrections::new(parameters, number_of_imu(imu.topic.as_deref()));
    for kind in Kind::ALL {
        let of_kind = |column: &&mut Column| column.quantity == Some(kind.quantity());
        let mut columns: Vec<&mut Column> = imu.columns.iter_mut().filter(of_kind).collect();
        let Ok([x, y, z]) = <&mut [&mut Column; 3]>::try_from(&mut columns[..]) else { continue };
        let mut axes = [values(x.clone(), log)?, values(y.clone(), log)?, values(z.clone(), log)?];
        let wrong = |why: String| LogError::Ask(format!("{}: {why}", log.display()));
        corrected.undo(kind, &mut axes, &imu.temps_c).map_err(wrong)?;
        for (column, values) in [x, y, z].into_iter().zip(axes) {
            column.replace(Series::Numbers(values));
            column.scale = 1.0;
        }
    }
    Ok(())
}

pub(super) fn imus(log: &UnitLog, options: &TempcalOptions, notes: &mut Vec<String>) -> Result<Vec<ImuColumns>> {
    let mut of_axes = options.axes.clone();
    let assumed = options.codes.apply(&mut of_axes)?;
    let parameters = parameters(log)?;
    if !parameters.is_empty() && options.axes.log.cut.until.is_none() {
        check_unchanged(log.path(), options)?;
    }
    let mut imus = Vec::new();
    for axes in all_axes(log, &of_axes)? {
        let topic = axes.columns.first().and_then(|column| topic_of(&column.name));
        let temperature = temperature(log, &axes, topic.as_deref(), options)?;
        // the temperature column is used, so the warning that it was left out is dropped
        let is_temperature =
            |note: &LogWarning| matches!(note, LogWarning::ColumnsLeftOut { names, .. } if *names == temperature.name);
        let of_scale = assumed.iter().filter(|(kind, _)| concerns(*kind, &axes.columns)).map(|(_, said)| said);
        for note in axes.warnings.iter().chain(of_scale).filter(|note| !is_temperature(note)) {
            let note = note.coded();
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        let device_id = topic.as_deref().and_then(|topic| device_id(log, topic, options));
        let (temps_hz, temps_start_s) = (temperature.rate_hz, temperature.start_s);
        let unstated = temperature.quantity.is_none().then(|| temperature.name.clone());
        let temps_c = values(temperature, log.path())?;
        let span = unstated.zip(span_c(&temps_c));
        let assumed_c = span.map(|(name, ends)| assumed_celsius(log.path(), &name, ends));
        let assumed_c = assumed_c.filter(|said| !notes.contains(said));
        notes.extend(assumed_c);
        let mut imu = ImuColumns { topic, columns: axes.columns, temps_c, temps_hz, temps_start_s, device_id };
        if !parameters.is_empty() {
            undo(&mut imu, &parameters, log.path())?;
        }
        imus.push(imu);
    }
    Ok(imus)
}

/// The parameters of the flight controller that wrote the log; empty for any other log.
fn parameters(log: &UnitLog) -> Result<BTreeMap<String, f64>> {
    // a folder is a ROS bag, which has no parameters
    let UnitLog::File(path) = log else { return Ok(BTreeMap::new()) };
    if path.is_dir() {
        return Ok(BTreeMap::new());
    }
    let parameters = files::open(path).ok().map(|input| zerorate_logs::parameters(path, input)).transpose()?;
    Ok(parameters.unwrap_or_default())
}

/// Returns an error if a parameter that corrects or rotates the readings changes within the log. The error tells
/// before which time the log can be used. ArduPilot applies a calibration as soon as the calibration is learned.
fn check_unchanged(path: &Path, options: &TempcalOptions) -> Result<()> {
    let corrects = |name: &str| name.starts_with("INS_TCAL") || name == "AHRS_ORIENTATION";
    let changed = zerorate_logs::changed_parameter(path, files::open(path)?, corrects)?;
    let Some((name, at_s)) = changed else { return Ok(()) };
    let (path, option, until_s) = (path.display(), options.axes.log.names.of(Setting::Until), at_s.floor());
    let text = format!("{path}: its {name} changes after {until_s} s, and corrects the readings from then on; ");
    Err(LogError::Ask(format!("{text}give {option} {until_s}, or less")).into())
}

/// The device id that a PX4 driver logs beside its readings; `None` for other topics and logs.
fn device_id(log: &UnitLog, topic: &str, options: &TempcalOptions) -> Option<i64> {
    let name = topic.starts_with("sensor_").then(|| format!("{topic}.device_id"))?;
    let log_options = ColumnOptions { topic: Some(topic.to_owned()), ..options.axes.log.clone() };
    let columns = log.columns(ColumnSelection::Listed(&[name]), &log_options).ok()?;
    columns.first()?.points(log.path()).ok()?.into_iter().find(|value| value.is_finite()).map(|value| value as i64)
}

/// The axes of each IMU in the log, or in the topics that the options name. Flight controllers log several IMUs.
fn all_axes(log: &UnitLog, options: &ImuOptions) -> Result<Vec<Axes>> {
    let of_topic = |topic: &String| {
        let one = ColumnOptions { topic: Some(topic.clone()), ..options.log.clone() };
        log.axes(&ImuOptions { log: one, more_topics: Vec::new(), ..options.clone() })
    };
    let given: Vec<&String> = options.log.topic.iter().chain(&options.more_topics).collect();
    if !given.is_empty() {
        return Ok(given.into_iter().map(of_topic).collect::<Result<_, _>>()?);
    }
    let topics = match log.axes(options) {
        Ok(axes) => {
            // this topic combines several sensors and has no temperature
            let is_combined = axes.columns.iter().any(|column| column.name.starts_with(COMBINED));
            match if is_combined { topics(log, options)? } else { Vec::new() } {
                topics if topics.is_empty() => return Ok(vec![axes]),
                topics => topics,
            }
        }
        Err(LogError::Choose { topics, .. }) if !topics.is_empty() => topics,
        Err(error) => return Err(error.into()),
    };
    Ok(with_temperatures(topics).iter().map(of_topic).collect::<Result<_, _>>()?)
}

/// The PX4 topic with the readings of the currently selected sensors.
const COMBINED: &str = "sensor_combined.";

/// Selects the topics that also hold a temperature: those of PX4 drivers, or the IMU messages of ArduPilot. Returns
/// all topics if none is of these.
fn with_temperatures(topics: Vec<String>) -> Vec<String> {
    let starting = |start: &str| topics.iter().filter(|topic| topic.starts_with(start)).cloned().collect::<Vec<_>>();
    let of_px4 = [starting("sensor_gyro"), starting("sensor_accel")].concat();
    [of_px4, starting("IMU")].into_iter().find(|some| !some.is_empty()).unwrap_or(topics)
}

/// The names of all topics with an IMU; empty if there is only one.
fn topics(log: &UnitLog, options: &ImuOptions) -> Result<Vec<String>> {
    let none = ColumnOptions { topic: Some(String::new()), ..options.log.clone() };
    match log.columns(ColumnSelection::All, &none) {
        Err(LogError::Choose { topics, .. }) => Ok(topics),
        Err(error) => Err(error.into()),
        Ok(_) => Ok(Vec::new()),
    }
}

/// Finds the temperature column of an IMU: by the given name, as the only one beside the axes, or by a usual name.
fn temperature(log: &UnitLog, axes: &Axes, topic: Option<&str>, options: &TempcalOptions) -> Result<Column> {
    let names = options.axes.log.names;
    let option = names.of(Setting::TempColumn);
    let path = log.path().display();
    if let (None, [only]) = (&options.temperature, &axes.temperatures[..]) {
        return checked(log.path(), only.clone(), options);
    }
    if let (None, [_, _, ..]) = (&options.temperature, &axes.temperatures[..]) {
        let all: Vec<&str> = axes.temperatures.iter().map(|column| column.name.as_str()).collect();
        let all = all.join(", ");
        return Err(LogError::Ask(format!("{path} has several temperatures: {all}; choose with {option}")).into());
    }
    let of_topic = topic.map(|topic| ["temperature", "T", "Temp"].map(|field| format!("{topic}.{field}")));
    let of_topic = of_topic.into_iter().flatten();
    // a bag may have temperature messages of other names, but reading all of them takes long
    let is_bag = topic.is_some_and(|topic| topic.starts_with('/'));
    let wanted: Vec<String> = match &options.temperature {
        Some(name) => vec![name.clone()],
        None if is_bag => vec!["temperature".to_owned()],
        None => of_topic.chain(TEMPERATURE_NAMES.map(str::to_owned)).collect(),
    };
    let log_options = ColumnOptions {
        column: None,
        unit: None,
        scale: None,
        increments: None,
        topic: topic.map(str::to_owned).filter(|_| options.temperature.is_none()).or(options.axes.log.topic.clone()),
        ..options.axes.log.clone()
    };
    let read = |name: &String| match log.columns(ColumnSelection::Listed(std::slice::from_ref(name)), &log_options) {
        Ok(mut columns) => columns.pop().map(Ok),
        Err(question @ LogError::Choose { .. }) => Some(Err(question)),
        Err(_) => None,
    };
    match (wanted.iter().find_map(read).transpose()?, &options.temperature) {
        (Some(column), _) => checked(log.path(), column, options),
        (None, None) if is_bag => Err(LogError::Ask(format!(
            "{path} has no topic of sensor_msgs/Temperature, which would tell the temperature of its IMU"
        ))
        .into()),
        (None, Some(name)) => Err(LogError::Ask(format!("{option}: {path} has no column {name:?} of numbers")).into()),
        (None, None) => Err(LogError::Ask(format!(
            "{path} has no temperature: no column states °C or is called {}; name it with {option}",
            TEMPERATURE_NAMES.join(", ")
        ))
        .into()),
    }
}

/// The temperature column of a capture, in codes.
const TEMP_CODE: &str = "temp_code";

/// Checks that the values of a column can be temperatures in °C. A few impossible values count as missing.
fn checked(log: &Path, mut column: Column, options: &TempcalOptions) -> Result<Column> {
    let option = options.axes.log.names.of(Setting::TempColumn);
    if let Some(unit) = foreign_unit(&column.name) {
        let (path, name) = (log.display(), &column.name);
        let why = format!("{path}: the temperature {name} is in {unit}, and must be in °C");
        return Err(LogError::Ask(format!("{why}. Convert it, or name another column with {option}")).into());
    }
    let (low, high) = match possible_c(values(column.clone(), log)?) {
        Ok(values) => {
            column.replace(Series::Numbers(values));
            column.scale = 1.0;
            return Ok(column);
        }
        Err(ends) => ends,
    };
    if column.name == TEMP_CODE {
        let what = "this is a capture of one sensor; `zerorate recalibrate --method warmup` finds its bias";
        return Err(LogError::Ask(format!("{}: {what}", log.display())).into());
    }
    let like = looks_like(low, high);
    Err(LogError::Ask(format!(
        "{}: the temperature {} goes from {low} to {high}{like}; it must be in °C. Convert it, or name another \
         column with {option}",
        log.display(),
        column.name
    ))
    .into())
}

/// The warning that a temperature states no unit.
fn assumed_celsius(path: &Path, name: &str, (low, high): (f64, f64)) -> String {
    let text = format!("{name} states no unit, and is taken in °C ({low:.1} to {high:.1})");
    LogWarning::OfReadings { path: path.display().to_string(), code: "units-taken", text }.coded()
}

/// The unit that impossible temperatures may be in. Kelvins may also be tenths of °C.
fn looks_like(low: f64, high: f64) -> &'static str {
    match () {
        () if low >= 230.0 && high <= 400.0 => ", which looks like kelvins or 0.1 °C",
        () if low >= -800.0 && high <= 1800.0 => ", which looks like 0.1 °C",
        () => "",
    }
}

#[cfg(test)]
mod tests {
    use super::looks_like;

    #[test]
    fn impossible_temperatures_look_like_their_unit() {
        assert_eq!(looks_like(280.0, 320.0), ", which looks like kelvins or 0.1 °C");
        assert_eq!(looks_like(250.0, 443.0), ", which looks like 0.1 °C");
        assert_eq!(looks_like(22_000.0, 45_000.0), "");
    }
}
