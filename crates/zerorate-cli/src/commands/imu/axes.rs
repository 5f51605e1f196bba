//! Options for the columns of an IMU's axes and their units, shared by `imu` and `tempcal`.

use super::codes::CodeArgs;
use crate::column::{LogArgs, UNITS, flag, listed, positive};
use clap::Args;
use zerorate_allan::SettingName;
use zerorate_imu::{ImuOptions, KindOptions};
use zerorate_logs::{Names, Setting, Unit};

/// Options for the columns of the axes, and for facts about them that the log does not state.
#[derive(Args, Clone, Debug)]
pub struct AxisArgs {
    /// The columns, by name or by number from 0, as in gx,gy,gz,ax,ay,az [default: all axes].
    #[arg(long, value_name = "LIST", help_heading = UNITS)]
    column: Option<String>,

    /// The columns of the gyroscope, by name or by number from 0, as in 0,1,2: for columns whose names do not say so.
    #[arg(long, value_name = "LIST", conflicts_with = "column", help_heading = UNITS)]
    gyro: Option<String>,

    /// The columns of the accelerometer, likewise.
    #[arg(long, value_name = "LIST", conflicts_with = "column", help_heading = UNITS)]
    accel: Option<String>,

    /// The unit of the gyroscope's columns: dps, mdps, deg/min, deg/h, rad/s, mrad/s, urad/s or rpm [default: the one
    /// that their names state].
    #[arg(long, value_name = "UNIT", help_heading = UNITS)]
    gyro_unit: Option<Unit>,

    /// The unit of the accelerometer's columns: m/s², g, mg, ug, cm/s² or mm/s² [default: the one that their names
    /// state].
    #[arg(long, value_name = "UNIT", help_heading = UNITS)]
    accel_unit: Option<Unit>,

    /// The size of a step of 1 in the gyroscope's columns, in their unit, such as 1/131.
    #[arg(long, value_name = "X", value_parser = positive, requires = "gyro_unit", help_heading = UNITS)]
    gyro_scale: Option<f64>,

    /// The size of a step of 1 in the accelerometer's columns, in their unit, such as 1/16384.
    #[arg(long, value_name = "X", value_parser = positive, requires = "accel_unit", help_heading = UNITS)]
    accel_scale: Option<f64>,

    #[command(flatten)]
    pub codes: CodeArgs,
}

impl AxisArgs {
    /// `reading` has the options that concern the whole log.
    pub fn options(&self, reading: &LogArgs) -> ImuOptions {
        ImuOptions {
            columns: self.column.as_deref().and_then(listed),
            gyro: kind(&self.gyro, self.gyro_unit, self.gyro_scale),
            accel: kind(&self.accel, self.accel_unit, self.accel_scale),
            log: reading.options(Names(option)),
            more_topics: reading.more_topics().to_vec(),
        }
    }
}

fn kind(columns: &Option<String>, unit: Option<Unit>, scale: Option<f64>) -> KindOptions {
    KindOptions { columns: columns.as_deref().and_then(listed).unwrap_or_default(), unit, scale, codes: None }
}

/// The option that messages name for a setting. Unit and scale have one option for each kind of sensor.
pub fn option(setting: Setting) -> SettingName {
    SettingName::text(match setting {
        Setting::Unit => "--gyro-unit or --accel-unit",
        Setting::Scale => "--gyro-scale or --accel-scale",
        other => return flag(other),
    })
}
