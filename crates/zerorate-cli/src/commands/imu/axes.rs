//! Which columns of a log are axes of an IMU, and of which kind.

use super::ImuArgs;
use crate::column::flag;
use crate::exit::Usage;
use anyhow::Result;
use serde::Serialize;
use std::path::Path;
use zerorate_data::column::{self, Column, ColumnOptions, Names, Quantity, Unit, Wanted};
use zerorate_host::files;

/// What an axis is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Gyroscope,
    Accelerometer,
}

impl Kind {
    pub const ALL: [Self; 2] = [Self::Gyroscope, Self::Accelerometer];

    pub fn name(self) -> &'static str {
        match self {
            Self::Gyroscope => "gyroscope",
            Self::Accelerometer => "accelerometer",
        }
    }

    fn plural(self) -> &'static str {
        match self {
            Self::Gyroscope => "gyroscopes",
            Self::Accelerometer => "accelerometers",
        }
    }

    pub fn quantity(self) -> Quantity {
        match self {
            Self::Gyroscope => Quantity::AngularRate,
            Self::Accelerometer => Quantity::Acceleration,
        }
    }

    /// What measures a quantity.
    pub fn of(quantity: Quantity) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.quantity() == quantity)
    }

    /// By the unit that a column has, or else by its name.
    fn of_column(column: &Column) -> Option<Self> {
        column.quantity.map_or_else(|| Self::named(&column.name), Self::of)
    }

    /// `gyro_x`, `wx`, `omega.x`; `acc_x`, `ax`, `f_y`.
    fn named(name: &str) -> Option<Self> {
        let name = name.to_lowercase();
        let holds = |words: &[&str]| words.iter().any(|word| name.contains(word));
        let short = |letters: &str| {
            let mut rest = name.chars().filter(|c| c.is_alphanumeric());
            let (first, second) = (rest.next(), rest.next());
            let is_axis = second.is_some_and(|axis| "xyz123".contains(axis)) && rest.next().is_none();
            is_axis && first.is_some_and(|first| letters.contains(first))
        };
        match () {
            () if holds(&["mag", "temp", "press", "baro", "quat", "orient"]) => None,
            () if holds(&["gyr", "angular", "omega"]) || short("gw") => Some(Self::Gyroscope),
            () if holds(&["acc", "linear"]) || short("af") => Some(Self::Accelerometer),
            () => None,
        }
    }
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

/// The six quantities of `sensor_msgs/Imu`.
const QUANTITIES: [&str; 6] = [
    "angular_velocity.x",
    "angular_velocity.y",
    "angular_velocity.z",
    "linear_acceleration.x",
    "linear_acceleration.y",
    "linear_acceleration.z",
];

impl Axes {
    /// Reads all of them in one pass.
    pub fn read(args: &ImuArgs, path: &Path) -> Result<Self> {
        let of_topic = args.topic.as_ref().map(|topic| QUANTITIES.map(|name| format!("{topic}.{name}")));
        let wanted = of_topic.as_ref().map_or(Wanted::All, |names| Wanted::Listed(names));
        let options = ColumnOptions {
            rate: args.rate,
            time_column: args.time_column.clone(),
            time_unit: args.time_unit,
            names: Names(flag),
            ..ColumnOptions::default()
        };
        let columns = column::read_parts(path, files::log(path)?, wanted, &options)?;
        let (mut axes, mut left_out, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
        for mut column in columns {
            let Some(kind) = Kind::of_column(&column) else {
                left_out.push(column.name);
                continue;
            };
            give_unit(args, path, kind, &mut column, &mut warnings)?;
            axes.push(column);
        }
        if axes.is_empty() {
            return Err(no_axes(path, &left_out).into());
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
fn give_unit(args: &ImuArgs, path: &Path, kind: Kind, column: &mut Column, warnings: &mut Vec<String>) -> Result<()> {
    let (unit, scale, option) = match kind {
        Kind::Gyroscope => (args.gyro_unit, args.gyro_scale, "--gyro-unit dps, rad/s …"),
        Kind::Accelerometer => (args.accel_unit, args.accel_scale, "--accel-unit m/s², g, mg …"),
    };
    if let Some(unit) = unit.filter(|unit| unit.quantity() != kind.quantity()) {
        return Err(Usage(format!("{unit} is no unit for {}; give {option}", kind.plural())).into());
    }
    let is_known = column.quantity.is_some();
    match (unit, scale) {
        (None, None) if is_known => {}
        (None, None) => {
            let seen = format!("{}: the unit of column {} is not stated", path.display(), column.name);
            return Err(Usage(format!("{seen}, though its name says {}; give {option}", kind.name())).into());
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

fn no_axes(path: &Path, found: &[String]) -> Usage {
    let names = if found.is_empty() { "no numbers at all".to_owned() } else { found.join(", ") };
    Usage(format!(
        "{} has no column whose name or unit says that it is an axis of an IMU (such as gyro_x, wx, `ax [m/s^2]`); it \
         has: {names}; rename them, or analyse one by `zerorate allan --column`",
        path.display()
    ))
}

/// `/imu0` of `/imu0.angular_velocity.x`.
fn topic_of(column: &str) -> Option<String> {
    let topic = column.strip_suffix(QUANTITIES[0])?.strip_suffix('.')?;
    topic.starts_with('/').then(|| topic.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_what_they_are() {
        let cases = [
            ("gyro_x", Some(Kind::Gyroscope)),
            ("GyrX", Some(Kind::Gyroscope)),
            ("wx", Some(Kind::Gyroscope)),
            ("w_x", Some(Kind::Gyroscope)),
            ("g.z", Some(Kind::Gyroscope)),
            ("accel_y", Some(Kind::Accelerometer)),
            ("ax", Some(Kind::Accelerometer)),
            ("fz", Some(Kind::Accelerometer)),
            ("mag_x", None),
            ("temp_acc", None),
            ("axle", None),
            ("x", None),
            ("height", None),
        ];
        for (name, kind) in cases {
            assert_eq!(Kind::named(name), kind, "{name}");
        }
    }
}
