//! `imu.yaml`, as Kalibr made it common: the noise of an IMU for visual-inertial odometry.

use super::record::Record;
use crate::exit::{Refused, Usage};
use crate::output::{Staged, plain};
use anyhow::Result;
use std::fmt::Write;
use zerorate_data::column::Quantity;

/// Writes the gyroscope's part of the file. The accelerometer's is left to be filled in: no gyroscope can tell it.
pub fn write(file: Staged, records: &[Record]) -> Result<()> {
    Ok(file.fill(yaml(records)?.as_bytes())?)
}

/// Kalibr's continuous-time noise: N in rad/s/√Hz and K in rad/s²/√Hz. Their Allan variances are N²/τ and K²τ/3, so
/// both are the coefficients of the fit in radians, without a factor.
fn yaml(records: &[Record]) -> Result<String> {
    if let Some(unknown) = records.iter().find(|record| record.quantity != Some(Quantity::AngularRate)) {
        let why = "the column is not stated to be an angular rate, and the file has no place for anything else; give --unit or --scale";
        return Err(Usage(format!("{}: {why}", unknown.label())).into());
    }
    let mut text =
        String::from("# Gyroscope noise, continuous time, as Kalibr takes it (not multiplied by any factor).\n");
    let (mut density, mut walk, mut rate_hz) = (0.0f64, 0.0f64, 0.0f64);
    for record in records {
        let fit = record
            .believed()
            .map_err(|why| Refused(format!("{}: imu.yaml needs the noise coefficients: {why}", record.label())))?;
        let (n, k) = (fit.n.value.to_radians(), fit.k.value.to_radians());
        let doubt = if fit.k.identified {
            String::new()
        } else {
            format!(", not identified, at most {:.3e}", fit.k.hi.to_radians())
        };
        // a name with a line break in it would end the comment
        let label = record.label();
        let label = plain::line(&label);
        writeln!(text, "# {label}: N = {n:.4e} rad/s/√Hz, K = {k:.4e} rad/s²/√Hz{doubt}")?;
        (density, walk, rate_hz) = (density.max(n), walk.max(k), rate_hz.max(record.analysis.rate_hz));
    }
    writeln!(text, "gyroscope_noise_density: {density:.6e}   # rad/s/√Hz")?;
    writeln!(text, "gyroscope_random_walk: {walk:.6e}   # rad/s²/√Hz")?;
    writeln!(text, "update_rate: {rate_hz:.6}   # Hz")?;
    text.push_str("# To be filled in before Kalibr accepts the file:\n");
    text.push_str(
        "# accelerometer_noise_density:   # m/s²/√Hz\n# accelerometer_random_walk:   # m/s³/√Hz\n# rostopic:\n",
    );
    Ok(text)
}
