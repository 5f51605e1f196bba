//! The axes of an IMU in a log.

use super::Kind;
use crate::Input;
use crate::column::{self, Column, ColumnOptions, LogError, Quantity, Setting, Unit, Wanted};
use std::path::{Path, PathBuf};

/// What a log may not say of its axes itself.
#[derive(Clone, Debug, Default)]
pub struct ImuOptions {
    /// The columns, by name or number; none: all that are axes.
    pub columns: Option<Vec<String>>,
    /// Of the gyroscope.
    pub gyro: Said,
    /// Of the accelerometer.
    pub accel: Said,
    /// Topic, rate, time and names of the options.
    pub log: ColumnOptions,
}

/// What the numbers of a kind of axis are, as the user says.
#[derive(Clone, Copy, Debug, Default)]
pub struct Said {
    /// Their unit.
    pub unit: Option<Unit>,
    /// What a step of 1 is in that.
    pub scale: Option<f64>,
}

/// The axes of a log.
pub struct Axes {
    /// In the order of the file, gyroscopes first; each has its quantity.
    pub columns: Vec<Column>,
    /// The topic of a bag.
    pub topic: Option<String>,
    /// What is to be said of the log.
    pub warnings: Vec<String>,
}

/// The end of the first column's name in a bag.
const FIRST: &str = ".angular_velocity.x";

impl Axes {
    /// Reads all of them in one pass; `path` names the log in messages.
    ///
    /// # Errors
    /// As [`column::read_parts`], and where no column is one, or the unit of one is not known.
    pub fn read(path: &Path, parts: Vec<(PathBuf, Input)>, options: &ImuOptions) -> column::Result<Self> {
        let wanted = options.columns.as_deref().map_or(Wanted::All, Wanted::Listed);
        Self::of(path, column::read_parts(path, parts, wanted, &options.log)?, options)
    }

    /// Those among the columns of a log.
    ///
    /// # Errors
    /// Where no column is one, or the unit of one is not known.
    pub fn of(path: &Path, columns: Vec<Column>, options: &ImuOptions) -> column::Result<Self> {
        let (mut axes, mut left_out, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
        for mut column in columns {
            let Some(kind) = Kind::of_column(&column) else {
                left_out.push(column.name);
                continue;
            };
            give_unit(options, path, kind, &mut column, &mut warnings)?;
            axes.push(column);
        }
        if axes.is_empty() {
            return Err(no_axes(path, &left_out));
        }
        axes.sort_by_key(|column| column.quantity != Some(Quantity::AngularRate));
        if !left_out.is_empty() {
            let names = left_out.join(", ");
            warnings.push(format!("left out, being neither gyroscope nor accelerometer: {names}"));
        }
        let topic = axes.first().and_then(|column| topic_of(&column.name));
        Ok(Self { columns: axes, topic, warnings })
    }
}

/// The unit that was given, where the log states none.
fn give_unit(
    options: &ImuOptions,
    path: &Path,
    kind: Kind,
    column: &mut Column,
    warnings: &mut Vec<String>,
) -> column::Result<()> {
    let (said, setting, units) = match kind {
        Kind::Gyroscope => (options.gyro, Setting::GyroUnit, "dps, rad/s …"),
        Kind::Accelerometer => (options.accel, Setting::AccelUnit, "m/s², g, mg …"),
    };
    let Said { unit, scale } = said;
    let remedy = format!("give {} {units}", options.log.names.of(setting));
    if let Some(unit) = unit.filter(|unit| unit.quantity() != kind.quantity()) {
        return Err(LogError::Ask(format!("{unit} is no unit for {}; {remedy}", kind.plural())));
    }
    let is_known = column.quantity.is_some();
    match (unit, scale) {
        (None, None) if is_known => {}
        (None, None) => {
            let seen = format!("{}: the unit of column {} is not stated", path.display(), column.name);
            return Err(LogError::Ask(format!("{seen}, though its name says {}; {remedy}", kind.name())));
        }
        (unit, scale) => {
            if !is_known {
                // the last says that the unit is not known
                column.warnings.pop();
            }
            column.scale = unit.map_or(1.0, Unit::in_results) * scale.unwrap_or(1.0);
        }
    }
    warnings.append(&mut column.warnings);
    column.quantity = Some(kind.quantity());
    Ok(())
}

fn no_axes(path: &Path, found: &[String]) -> LogError {
    let found = if found.is_empty() { "no numbers at all".to_owned() } else { found.join(", ") };
    LogError::Ask(format!(
        "{} has no column whose name or unit says that it is an axis of an IMU (such as gyro_x, wx, `ax [m/s^2]`); it \
         has: {found}; rename those that are",
        path.display(),
    ))
}

/// `/imu0` of `/imu0.angular_velocity.x`.
fn topic_of(column: &str) -> Option<String> {
    let topic = column.strip_suffix(FIRST)?;
    topic.starts_with('/').then(|| topic.to_owned())
}
