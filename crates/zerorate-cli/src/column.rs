//! Which numbers of a log are meant, as options.

use clap::Args;
use zerorate_jobs::allan::Columns;
use zerorate_logs::{ColumnOptions, Decimal, Names, RawType, Setting, TimeUnit, Unit};

/// Which numbers of a log are meant, and what the log does not say about them itself.
#[derive(Args, Debug, Default)]
pub struct ColumnArgs {
    /// The column, by its name or its number counted from 0 [default: the rate of a capture, or the only column].
    ///
    /// In a ROS bag x, y or z (of angular_velocity), linear_acceleration.z, or either behind a topic and a point.
    /// `allan` takes several, in one pass over the file: gx,gy,gz or all.
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "raw")]
    column: Option<String>,

    /// The topic of a bag or of a PX4 log, where it has several IMUs.
    #[arg(long, value_name = "TOPIC", conflicts_with = "raw")]
    topic: Option<String>,

    /// The column with the time of each row: it tells the rate, and where samples are missing [default: the only one
    /// whose name states a unit of time, as t_ns does].
    #[arg(long, value_name = "NAME|INDEX", conflicts_with_all = ["raw", "rate"])]
    time_column: Option<String>,

    /// The unit of the time column [default: the one that its name or type states, as in t_ns or `timestamp [ms]`].
    #[arg(long, value_enum, requires = "time_column")]
    time_unit: Option<TimeUnit>,

    /// Samples per second [default: as the time column, the timestamps of a capture or the stamps of a bag tell]. With
    /// it, the stamps of a bag are not looked at.
    #[arg(long, value_name = "HZ", value_parser = positive)]
    rate: Option<f64>,

    /// The unit of the column: dps, mdps, deg/min, deg/h, rad/s, mrad/s or urad/s [default: the one that its name
    /// states, as in gyro_z_dps or `gz [rad/s]`].
    #[arg(long, value_name = "UNIT")]
    unit: Option<Unit>,

    /// Take --unit where the name of the column states another unit.
    #[arg(long, requires = "unit")]
    force_unit: bool,

    /// What a step of 1 in the column is, in the unit of --unit [default: 1] or else in °/s [default: the scale of the
    /// part for the codes of a capture].
    #[arg(long, value_name = "X", value_parser = positive)]
    scale: Option<f64>,

    /// What stands before the decimals in a text file [default: a point, or a comma where it can be nothing else].
    #[arg(long, value_enum, value_name = "MARK")]
    decimal: Option<Decimal>,

    /// The file is nothing but numbers of this type, little endian.
    #[arg(long, value_enum)]
    raw: Option<RawType>,

    /// Broken lines of a text file that are skipped and counted, as a share of all; with more it is refused
    /// [default: 0.01].
    #[arg(long, value_name = "SHARE", value_parser = share)]
    max_bad: Option<f64>,
}

impl ColumnArgs {
    /// Whether several columns are meant.
    pub fn is_list(&self) -> bool {
        self.column.as_deref().is_some_and(|column| column == ALL || column.contains(','))
    }

    /// Which are meant.
    pub fn columns(&self) -> Columns {
        match self.column.as_deref().filter(|_| self.is_list()) {
            Some(list) => listed(list).map_or(Columns::All, Columns::Listed),
            None => Columns::Single,
        }
    }

    /// What a log does not say of them.
    pub fn options(&self) -> ColumnOptions {
        let Self { column, topic, time_column, time_unit, rate, unit, force_unit, scale, decimal, raw, max_bad } =
            self;
        ColumnOptions {
            column: column.clone(),
            topic: topic.clone(),
            time_column: time_column.clone(),
            time_unit: *time_unit,
            rate: *rate,
            unit: *unit,
            scale: *scale,
            force_unit: *force_unit,
            decimal: *decimal,
            raw: *raw,
            max_bad: *max_bad,
            names: Names(flag),
        }
    }
}

/// All columns with numbers.
const ALL: &str = "all";

/// The names of a list with commas; none: all.
pub fn listed(list: &str) -> Option<Vec<String>> {
    (list != ALL).then(|| list.split(',').map(|name| name.trim().to_owned()).collect())
}

/// What the options are called here.
pub fn flag(setting: Setting) -> &'static str {
    match setting {
        Setting::Column => "--column",
        Setting::Topic => "--topic",
        Setting::TimeColumn => "--time-column",
        Setting::TimeUnit => "--time-unit",
        Setting::Rate => "--rate",
        Setting::Unit => "--unit",
        Setting::Scale => "--scale",
        Setting::Decimal => "--decimal",
        Setting::Raw => "--raw",
        Setting::MaxBad => "--max-bad",
        Setting::GyroUnit => "--gyro-unit",
        Setting::AccelUnit => "--accel-unit",
        Setting::ForceUnit => "give --force-unit",
        Setting::Combine => "--combine",
        Setting::Format => "--format",
        Setting::Skip => "--skip",
        Setting::Detrend => "--detrend",
        Setting::TempColumn => "--temp-column",
        other => other.name(),
    }
}

pub fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share: &f64| (0.0..1.0).contains(share));
    share.ok_or_else(|| "must be a share from 0 to below 1, such as 0.05".to_owned())
}

pub fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number: &f64| *number > 0.0 && number.is_finite())
        .ok_or_else(|| "must be a number above zero".to_owned())
}
