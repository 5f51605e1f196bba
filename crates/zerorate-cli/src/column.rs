//! The options that select the data of a log.

use clap::Args;
use clap::builder::BoolishValueParser;
use zerorate_allan::SettingName;
use zerorate_jobs::InvalidOptions;
use zerorate_jobs::allan::Columns;
use zerorate_logs::{ColumnOptions, Cut, CutTime, Decimal, Names, RawType, RowFilter, Setting, TimeUnit, Unit};

/// Options for reading a log, which `allan`, `imu`, `tempcal` and `correct` share.
#[derive(Args, Clone, Debug, Default, PartialEq)]
#[command(next_help_heading = "The log")]
pub struct LogArgs {
    /// The topic, where a bag or a PX4 log has several IMUs. `imu` takes two, one with the gyroscope and one with the
    /// accelerometer.
    #[arg(long, value_name = "TOPIC", conflicts_with = "raw")]
    topic: Vec<String>,

    /// Read only the rows in which a column has this value, as in SensorId=1, or several have theirs, as in
    /// bus=0,sensor=1: for a table or text with the rows of several sensors. The value * stands for all, as in
    /// 'idx=*': the rows are of one sensor. Each further --where gives a result of its own.
    #[arg(long = "where", value_name = "COLUMN=VALUE", conflicts_with = "raw")]
    pub only: Vec<RowFilter>,

    /// The decimal mark of a text file [default: a point, or a comma where it cannot be anything else].
    #[arg(long, value_enum, value_name = "MARK")]
    decimal: Option<Decimal>,

    /// The largest share of broken lines in a text file that are skipped and counted; a file with more is refused
    /// [default: 0.01].
    #[arg(long, value_name = "SHARE", value_parser = share)]
    max_bad: Option<f64>,

    /// Read a file of plain numbers of this type: i16, i32, f32 or f64, little endian, or i16be and so on for big
    /// endian. 6xi16be are records of six, in columns 0 to 5.
    #[arg(long, value_name = "TYPE")]
    raw: Option<RawType>,

    /// Samples per second [default: from the time column, the timestamps of a capture or the stamps of a bag]. This
    /// option overrides the stamps of a bag.
    #[arg(long, value_name = "HZ", value_parser = positive, help_heading = TIME)]
    rate: Option<f64>,

    /// The column with the time of each row, which gives the rate and shows missing samples [default: the only one
    /// whose name states a unit of time, as t_ns does].
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "rate", help_heading = TIME)]
    time_column: Option<String>,

    /// The unit of the time column [default: as its name or type states, such as t_ns or `timestamp [ms]`].
    #[arg(long, value_enum, requires = "time_column", help_heading = TIME)]
    time_unit: Option<TimeUnit>,

    /// Leave out the beginning, such as the first 45m while the sensor warms, or all before 12:30:00.
    ///
    /// A clock time or a date is read from the stamps of the log; a stamp without a zone counts as UTC.
    #[arg(long, visible_alias = "from", value_name = "TIME", help_heading = TIME)]
    skip: Option<CutTime>,

    /// Leave out what follows this time since the first sample, or this clock time, likewise.
    #[arg(long, visible_alias = "to", value_name = "TIME", help_heading = TIME)]
    until: Option<CutTime>,

    /// The columns hold the angle or the velocity of each sample (delta angle, delta velocity) in place of the rate;
    /// give the unit rad/s for rad, and m/s² for m/s. `--increments=no` says that they hold rates.
    #[arg(long, value_name = "yes|no", num_args = 0..=1, require_equals = true, default_missing_value = "yes",
        value_parser = BoolishValueParser::new(), hide_possible_values = true, help_heading = UNITS)]
    increments: Option<bool>,

    /// Take the given unit where the name of a column states another.
    #[arg(long, help_heading = UNITS)]
    force_unit: bool,
}

const TIME: &str = "Time";
pub const UNITS: &str = "Columns and units";

impl LogArgs {
    pub fn more_topics(&self) -> &[String] {
        self.topic.get(1..).unwrap_or_default()
    }

    /// `names` returns the option that error messages name for a setting.
    pub fn options(&self, names: Names) -> ColumnOptions {
        ColumnOptions {
            topic: self.topic.first().cloned(),
            only: self.only.first().cloned(),
            time_column: self.time_column.clone(),
            cut: Cut { from: self.skip, until: self.until },
            time_unit: self.time_unit,
            rate: self.rate,
            increments: self.increments,
            force_unit: self.force_unit,
            decimal: self.decimal,
            raw: self.raw,
            max_bad: self.max_bad,
            described: Some(zerorate_record::open_described),
            names,
            ..ColumnOptions::default()
        }
    }
}

/// Options for the column of a log to read, and for facts about it that the log does not state.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = UNITS)]
pub struct ColumnArgs {
    /// The column, by name or by number from 0 [default: the rate of a capture, or the only column].
    ///
    /// In a ROS bag: x, y or z (of angular_velocity), linear_acceleration.z, or either after a topic and a point.
    /// `allan` takes several, in one pass over the file: gx,gy,gz or all.
    #[arg(long, value_name = "NAME|INDEX")]
    column: Option<String>,

    /// The unit of the column: dps, mdps, deg/min, deg/h, rad/s, mrad/s, urad/s, rpm, m/s², g, mg, ug, cm/s² or mm/s²
    /// [default: the one that the log or the name of the column states, as in gyro_z_dps or `gz [rad/s]`].
    #[arg(long, value_name = "UNIT")]
    unit: Option<Unit>,

    /// The size of a step of 1 in the column, such as 1/131, in its unit, or else in °/s [default: 1; for the codes of
    /// a capture, the scale of the part].
    #[arg(long, value_name = "X", value_parser = positive)]
    scale: Option<f64>,

    #[command(flatten)]
    log: LogArgs,
}

impl ColumnArgs {
    pub fn is_list(&self) -> bool {
        self.column.as_deref().is_some_and(|column| column == ALL || column.contains(','))
    }

    /// The conditions of `--where`. Each one selects rows for a separate record.
    pub fn series(&self) -> &[RowFilter] {
        &self.log.only
    }

    /// Refuses several topics, since only `imu` can join the topics of one IMU.
    pub fn check(&self) -> Result<(), InvalidOptions> {
        match self.log.more_topics() {
            [] => Ok(()),
            _ => Err(InvalidOptions("--topic: allan reads one topic; `zerorate imu` takes two of one IMU".to_owned())),
        }
    }

    /// The columns to analyse: all columns, a list of columns, or a single column, which [`Self::options`] may name.
    pub fn columns(&self) -> Columns {
        match self.column.as_deref().filter(|_| self.is_list()) {
            Some(list) => listed(list).map_or(Columns::All, Columns::Listed),
            None => Columns::Single,
        }
    }

    pub fn options(&self) -> ColumnOptions {
        let Self { column, unit, scale, log } = self;
        ColumnOptions { column: column.clone(), unit: *unit, scale: *scale, ..log.options(Names(flag)) }
    }
}

/// The value of an option that selects all columns of numbers.
const ALL: &str = "all";

/// The names or numbers in a list of columns; `None` means all columns.
pub fn listed(list: &str) -> Option<Vec<String>> {
    (list != ALL).then(|| list.split(',').map(|name| name.trim().to_owned()).collect())
}

pub fn flag(setting: Setting) -> SettingName {
    match setting {
        Setting::ForceUnit => SettingName { prefix: "give --", ..flag_of(setting.word()) },
        Setting::Detrend => SettingName { suffix: " temp", ..flag_of(setting.word()) },
        Setting::NoIncrements => SettingName::text("--increments=no"),
        other => flag_of(other.word()),
    }
}

pub const fn flag_of(word: &'static str) -> SettingName {
    SettingName { prefix: "--", word, joint: '-', suffix: "" }
}

pub fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share: &f64| (0.0..1.0).contains(share));
    share.ok_or_else(|| "must be a share from 0 to below 1, such as 0.05".to_owned())
}

/// Parses a number above zero, or a fraction such as 1/131.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let found = match text.split_once('/') {
        Some((above, below)) => number(above).zip(number(below)).map(|(above, below)| above / below),
        None => number(text),
    };
    found
        .filter(|number| *number > 0.0 && number.is_finite())
        .ok_or_else(|| "must be a number above zero, such as 0.0076 or 1/131".to_owned())
}
