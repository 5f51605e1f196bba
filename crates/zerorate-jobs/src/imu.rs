//! The noise of an IMU.

use crate::{InvalidOptions, allan};
use anyhow::Result;
use std::path::Path;
use zerorate_host::files;
use zerorate_logs::imu::{Axes, Format, ImuOptions, ImuWarning, Kind, NoNoiseFile};
use zerorate_logs::{AnalysisOptions, LogWarning, Record, Setting};

/// What is wanted of the log of an IMU.
pub struct ImuNoiseOptions {
    /// Which columns are axes, and what the log does not say of them.
    pub axes: ImuOptions,
    /// The column with the temperature; none: one by the usual names.
    pub temperature: Option<String>,
    /// How each axis is analysed.
    pub analysis: AnalysisOptions,
    /// Who is to read a file of the noise; none: nobody.
    pub format: Option<Format>,
}

/// The noise of all axes of an IMU.
pub struct ImuNoise {
    /// Of each axis, gyroscopes first.
    pub axes: Vec<Record>,
    /// The topic of a bag.
    pub topic: Option<String>,
    /// What is to be said of the log.
    pub notes: Vec<LogWarning>,
    /// The kinds of axis that are not there.
    pub absent: Vec<ImuWarning>,
}

/// Analyses all axes of the IMU in a log, one pass over it.
///
/// # Errors
/// Where the log cannot be read, has no axes or not those of the file, or one cannot be analysed.
pub fn imu(log: &Path, options: &ImuNoiseOptions) -> Result<ImuNoise> {
    let axes = Axes::read(log, files::log(log)?, &options.axes)?;
    let absent = axes.absent(&options.axes).collect();
    let kinds = axes.columns.iter().filter_map(|column| Kind::of(column.quantity?));
    let not_taken = |why: NoNoiseFile| {
        let [column, format] = [Setting::Column, Setting::Format].map(|of| options.axes.log.names.of(of));
        InvalidOptions(format!("{}: {why} with {column}, or another {format}", log.display()))
    };
    options.format.map_or(Ok(()), |format| format.check(kinds)).map_err(not_taken)?;
    let Axes { columns, topic, warnings: notes } = axes;
    let axes = allan::analysed(log, columns, &options.axes.log, options.temperature.as_deref(), &options.analysis)?;
    Ok(ImuNoise { axes, topic, notes, absent })
}
