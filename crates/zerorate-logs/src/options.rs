//! Options for reading a log.

use crate::cut::Cut;
use crate::error::{LogError, Result};
use crate::number::Decimal;
use crate::only::RowFilter;
use crate::raw_type::RawType;
use crate::setting::{Names, Setting};
use std::path::Path;
use zerorate_input::table::OpenDescribed;
use zerorate_input::{Quantity, TimeUnit, Unit};

/// The wanted numbers of a log, and facts that the log does not state itself.
#[derive(Clone, Debug, Default)]
pub struct ColumnOptions {
    /// The column, by its name or its number counted from 0. `None` selects the rate of a capture, or the only column.
    ///
    /// In a ROS bag: x, y or z for angular_velocity or, if there are several IMUs, TOPIC.angular_velocity.z.
    pub column: Option<String>,

    /// The topic of the log that has the columns; `None` selects the only topic with an IMU or, for all columns of a
    /// PX4 log, `sensor_combined`.
    pub topic: Option<String>,

    /// The column with the time of each row, which shows the rate and where samples are missing. `None` finds the
    /// column by its name, type or content, unless `rate` is given.
    pub time_column: Option<String>,

    /// The rows that are read; `None` reads all rows.
    pub only: Option<RowFilter>,

    /// The part of the log that is read.
    pub cut: Cut,

    /// The unit of the time column; `None` takes it from the column's name or type, as in t_ns or `timestamp [ms]`, or
    /// from numbers that are dates.
    pub time_unit: Option<TimeUnit>,

    /// Samples per second; `None` takes the rate from the time column, the timestamps of a capture, the stamps of a
    /// bag, or a sample rate that the file states. With a given rate, the stamps of a bag are only compared with it.
    pub rate: Option<f64>,

    /// The unit of the column; `None` takes the one that its name (gyro_z_dps or `gz [rad/s]`) or the log states.
    pub unit: Option<Unit>,

    /// The size of a step of 1 in the column, in the given unit, or else the unit that its name or the log states, or
    /// else °/s. `None` means 1 or, for the codes of a capture without a given unit, the scale of the sensor.
    pub scale: Option<f64>,

    /// True if the values are increments (an angle or a velocity for each sample) in place of rates. `None` reads them
    /// as rates, and asks if the names of columns or the size of gravity suggest increments. The `unit` of increments
    /// is given per second: rad/s for rad.
    pub increments: Option<bool>,

    /// True if the given unit overrides another unit in the name of a column. Otherwise such a unit is an error.
    pub force_unit: bool,

    /// The decimal mark of a text file. `None` means a point, or a comma if no other reading is possible.
    pub decimal: Option<Decimal>,

    /// The type of the numbers and of their records, if the file consists of raw numbers.
    pub raw: Option<RawType>,

    /// Largest share of broken lines in a text file; `None` means [`MAX_BAD`]. Broken lines are skipped and counted.
    pub max_bad: Option<f64>,

    /// Opens tables that describe themselves, such as captures. With `None`, such a table is an error.
    pub described: Option<OpenDescribed>,

    /// The names of these options in messages.
    pub names: Names,
}

/// Default of `max_bad`. A bad cable breaks a smaller share of the lines; more broken lines mean that the file has
/// another format.
pub const MAX_BAD: f64 = 0.01;

impl ColumnOptions {
    /// Factor from a value to a rate: `rate_hz` for increments, and 1 for rates.
    pub fn per_second(&self, rate_hz: f64) -> f64 {
        if self.increments == Some(true) { rate_hz } else { 1.0 }
    }

    pub(crate) fn only_of_tables(&self, path: &Path) -> LogError {
        let option = self.names.of(Setting::Where);
        LogError::Ask(format!("{}: {option} chooses rows of text and of tables only; leave it out", path.display()))
    }

    /// Checks that `unit`, given by `setting` and without a scale, is not given for codes whose scale the file states.
    pub fn leaves_scale(&self, path: &Path, column: &str, unit: Option<Unit>, setting: Setting) -> Result<()> {
        let Some(unit) = unit else { return Ok(()) };
        let [given, scale] = [setting, Setting::Scale].map(|of| self.names.of(of));
        Err(LogError::Ask(format!(
            "{}: the file states the scale of the codes in `{column}`, and {given} says {unit}; leave {given} out, or \
             give {scale} as well",
            path.display()
        )))
    }

    /// Checks that `unit`, given by `setting`, is the unit that the name of the column states, if it states one and
    /// `force_unit` does not override it.
    pub fn agrees(&self, path: &Path, column: &str, unit: Unit, setting: Setting) -> Result<()> {
        let differs = |(quantity, size): &(Quantity, f64)| {
            *quantity != Quantity::Temperature && (*quantity, *size) != (unit.quantity(), unit.in_results())
        };
        let may_differ = self.force_unit || Unit::taken_by_words(column).is_some();
        let Some((quantity, size)) = Quantity::of_column(column).filter(|stated| differs(stated) && !may_differ)
        else {
            return Ok(());
        };
        let stated =
            Unit::of_column(column).map_or_else(|| format!("{size} {}", quantity.unit()), |unit| unit.to_string());
        let differs = match unit.quantity() == quantity {
            true => {
                let factor = unit.in_results() / size;
                format!(", {factor:.*} times as large", (2.0 - factor.log10().floor()).max(0.0) as usize)
            }
            false => String::new(),
        };
        let [given, force] = [setting, Setting::ForceUnit].map(|of| self.names.of(of));
        Err(LogError::Ask(format!(
            "{}: the name of column `{column}` states {stated}, and {given} says {unit}{differs}; leave {given} out, \
             or {force}",
            path.display()
        )))
    }
}
