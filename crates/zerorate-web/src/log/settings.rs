//! Converts settings of the page to options of the readers, and questions of the readers to settings of the page.

use super::message::{LogSetting, LogSettings};
use zerorate_allan::SettingName;
use zerorate_imu::{Combine, Format, ImuOptions, KindOptions};
use zerorate_logs::{ColumnOptions, Cut, CutTime, Decimal, LogError, Names, Setting, TimeUnit, Unit};

/// The names that messages use for the settings: the label of the page's field, or else a command or other advice.
pub const LABELS: Names = Names(label);

/// The fields of the page, each with the setting that it alone stands for, if there is one, and with its label.
const FIELDS: [(Option<Setting>, &str, LogSetting); 14] = [
    (Some(Setting::Column), "“columns”", LogSetting::Columns),
    (Some(Setting::Topic), "“topic”", LogSetting::Topic),
    (Some(Setting::Where), "“only the rows with”", LogSetting::Where),
    (Some(Setting::Skip), "“leave out before”", LogSetting::Skip),
    (Some(Setting::Until), "“leave out after”", LogSetting::Until),
    (Some(Setting::Rate), "“sample rate”", LogSetting::RateHz),
    (Some(Setting::TimeColumn), "“time column”", LogSetting::TimeColumn),
    (Some(Setting::TimeUnit), "“unit of time”", LogSetting::TimeUnit),
    (Some(Setting::TempColumn), "“temperature column”", LogSetting::TempColumn),
    (Some(Setting::GyroUnit), "“gyroscope unit”", LogSetting::GyroUnit),
    (Some(Setting::AccelUnit), "“accelerometer unit”", LogSetting::AccelUnit),
    (Some(Setting::Decimal), "“decimal mark”", LogSetting::Decimal),
    (None, "“gyroscope scale”", LogSetting::GyroScale),
    (None, "“accelerometer scale”", LogSetting::AccelScale),
];

fn label(setting: Setting) -> SettingName {
    let field = FIELDS.iter().find(|(of, ..)| *of == Some(setting));
    SettingName::text(match setting {
        Setting::ForceUnit => "rename the column",
        // on the page, one field has the columns of both kinds
        Setting::Gyro | Setting::Accel => "“columns”",
        Setting::Unit => "“gyroscope unit” or “accelerometer unit”",
        Setting::Scale => "“gyroscope scale” or “accelerometer scale”",
        Setting::Detrend => "`zerorate allan --detrend temp`",
        Setting::GyroRange => "`zerorate imu --gyro-range`",
        Setting::AccelRange => "`zerorate imu --accel-range`",
        Setting::Part => "`zerorate imu --part`",
        Setting::Increments => "rates in place of increments",
        Setting::Combine => "“one number for all axes”:",
        Setting::Horizon => "for another time `zerorate imu --horizon`",
        Setting::AsFitted => "`zerorate imu --as-fitted`",
        Setting::NoIncrements => "rename the columns",
        _ => field.map_or_else(|| setting.word(), |(_, label, _)| label),
    })
}

/// The page's fields that a message mentions, in the order of the message.
pub fn asked_for(text: &str) -> Vec<LogSetting> {
    let mut named: Vec<(usize, LogSetting)> =
        FIELDS.iter().filter_map(|(_, label, field)| Some((text.find(label)?, *field))).collect();
    named.sort_by_key(|(place, _)| *place);
    named.into_iter().map(|(_, field)| field).collect()
}

pub fn options(said: &LogSettings) -> Result<ImuOptions, LogError> {
    let above_zero = |label: &str, number: Option<f64>| match number {
        Some(number) if !(number > 0.0 && number.is_finite()) => {
            Err(LogError::Ask(format!("“{label}” takes a number above zero")))
        }
        number => Ok(number),
    };
    let log = ColumnOptions {
        topic: said.topic.clone(),
        rate: above_zero("sample rate", said.rate_hz)?,
        time_column: said.time_column.clone(),
        only: said.only.as_deref().map(str::parse).transpose().map_err(|why: String| refused(Setting::Where, &why))?,
        cut: Cut { from: cut_time(&said.skip, Setting::Skip)?, until: cut_time(&said.until, Setting::Until)? },
        time_unit: said.time_unit.as_deref().map(time_unit).transpose()?,
        decimal: said.decimal.as_deref().map(decimal).transpose()?,
        described: Some(zerorate_record::open_described),
        names: LABELS,
        ..ColumnOptions::default()
    };
    let kind = |unit, scale| KindOptions { unit, scale, ..KindOptions::default() };
    let gyro = kind(unit(&said.gyro_unit)?, above_zero("gyroscope scale", said.gyro_scale)?);
    let accel = kind(unit(&said.accel_unit)?, above_zero("accelerometer scale", said.accel_scale)?);
    Ok(ImuOptions { columns: said.columns.clone(), gyro, accel, log, ..ImuOptions::default() })
}

fn cut_time(text: &Option<String>, setting: Setting) -> Result<Option<CutTime>, LogError> {
    text.as_deref().map(str::parse).transpose().map_err(|why: String| refused(setting, &why))
}

fn refused(setting: Setting, why: &str) -> LogError {
    LogError::Ask(format!("{}: {why}", label(setting)))
}

fn unit(text: &Option<String>) -> Result<Option<Unit>, LogError> {
    text.as_deref().map(|text| text.parse().map_err(LogError::Ask)).transpose()
}

fn time_unit(text: &str) -> Result<TimeUnit, LogError> {
    let unknown = || LogError::Ask("“unit of time” takes s, ms, us, ns, min or h".to_owned());
    TimeUnit::ALL.into_iter().find(|unit| unit.name() == text).ok_or_else(unknown)
}

fn decimal(text: &str) -> Result<Decimal, LogError> {
    match text {
        "point" => Ok(Decimal::Point),
        "comma" => Ok(Decimal::Comma),
        _ => Err(LogError::Ask("“decimal mark” takes point or comma".to_owned())),
    }
}

pub fn format(name: &str) -> Result<Format, String> {
    let found = Format::ALL.into_iter().find(|format| format.name() == name);
    found.ok_or_else(|| format!("`{name}` is unknown: take one of {}", Format::ALL.map(Format::name).join(", ")))
}

pub fn combine(name: &str) -> Result<Combine, String> {
    let found = [Combine::Worst, Combine::Mean].into_iter().find(|combine| combine.name() == name);
    found.ok_or_else(|| format!("`{name}` is unknown: take worst or mean"))
}
