//! Noise analysis of an IMU.

use crate::code_scales::{CodeOptions, concerns};
use crate::{InvalidOptions, allan, temperature};
use anyhow::Result;
use std::path::Path;
use zerorate_host::files;
use zerorate_imu::{AnalysisOptions, Record};
use zerorate_imu::{Axes, Format, ImuOptions, ImuWarning, Kind, NoNoiseFile};
use zerorate_logs::{LogWarning, Setting};

/// The settings of the noise analysis of an IMU's log.
pub struct ImuNoiseOptions {
    /// The columns of the axes, and facts that the log does not state.
    pub axes: ImuOptions,
    /// The scales of integer codes, for axes whose unit is not given.
    pub codes: CodeOptions,
    /// The temperature column; `None` looks for a column with a usual name.
    pub temperature: Option<String>,
    /// The options of the analysis of each axis.
    pub analysis: AnalysisOptions,
    /// The program that will read the noise file; `None` for no file.
    pub format: Option<Format>,
}

/// The noise of all axes of an IMU.
pub struct ImuNoise {
    /// The record of each axis, gyroscopes first.
    pub axes: Vec<Record>,
    /// The topic of the IMU, if the log is a bag.
    pub topic: Option<String>,
    /// The warnings about the log.
    pub notes: Vec<LogWarning>,
    /// Warnings about missing kinds of axis, gyroscopes or accelerometers.
    pub absent: Vec<ImuWarning>,
}

/// Analyses all axes of the IMU in a log.
///
/// # Errors
/// Returns an error if the log cannot be read, lacks axes or a required temperature, or has axes that the noise file
/// cannot hold, or if an axis cannot be analysed.
pub fn imu(log: &Path, options: &ImuNoiseOptions) -> Result<ImuNoise> {
    let mut of_axes = options.axes.clone();
    let assumed = options.codes.apply(&mut of_axes)?;
    let mut axes = Axes::read(log, files::log(log)?, &of_axes)?;
    let absent = axes.absent(&options.axes).collect();
    axes.warnings.extend(assumed.into_iter().filter(|(kind, _)| concerns(*kind, &axes.columns)).map(|(_, said)| said));
    let kinds = axes.columns.iter().filter_map(|column| Kind::of(column.quantity?));
    let not_taken = |why: NoNoiseFile| {
        let [column, format] = [Setting::Column, Setting::Format].map(|of| options.axes.log.names.of(of));
        InvalidOptions(format!("{}: {why} with {column}, or another {format}", log.display()))
    };
    options.format.map_or(Ok(()), |format| format.check(kinds)).map_err(not_taken)?;
    let Axes { columns, topic, warnings: notes, .. } = axes;
    let (named, detrending) = (options.temperature.as_deref(), &options.analysis.detrending);
    let temperature = temperature::required(log, named, None, detrending, &options.axes.log)?;
    let axes = allan::analysed(log, columns, temperature, &options.analysis)?;
    Ok(ImuNoise { axes, topic, notes, absent })
}
