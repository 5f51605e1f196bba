//! Options for the scale of integer codes.

use crate::column::{UNITS, positive};
use crate::exit::Usage;
use crate::output::Outputs;
use crate::part;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use zerorate_jobs::code_scales::{CodeOptions, CodeScales};

/// Options for the scale of integer codes.
#[derive(Args, Clone, Debug)]
pub struct CodeArgs {
    /// The sensor whose integer codes the columns hold: a name of `zerorate parts`, or a file
    /// (docs/formats/part.md). It gives the scales of each kind without a unit. --gyro-range and --accel-range choose
    /// the full scale [default: as after power-up, with a warning].
    #[arg(long, value_name = "PART", help_heading = UNITS)]
    part: Option<PathBuf>,

    /// The full scale of the gyroscope, °/s, if its columns hold integer codes of 16 bits: 250 means 250/32768 °/s for
    /// each, or the sensitivity of --part there.
    #[arg(long, value_name = "DPS", value_parser = positive, conflicts_with_all = ["gyro_unit", "gyro_scale"],
        help_heading = UNITS)]
    gyro_range: Option<f64>,

    /// The full scale of the accelerometer, g, likewise.
    #[arg(long, value_name = "G", value_parser = positive, conflicts_with_all = ["accel_unit", "accel_scale"],
        help_heading = UNITS)]
    accel_range: Option<f64>,
}

impl CodeArgs {
    pub fn options(&self, outputs: &mut Outputs) -> Result<CodeOptions> {
        let Self { part, gyro_range, accel_range } = self;
        let (mut gyro_range_dps, accel_range_g) = (*gyro_range, *accel_range);
        let mut scales = None;
        if let Some(named) = part {
            let wrong = |why: String| Usage(format!("--part {}: {why}", named.display()));
            let (text, range_dps) = part::text(named, outputs)?;
            if gyro_range.is_some() && range_dps.is_some() {
                return Err(wrong("it states the full scale, and so does --gyro-range".to_owned()).into());
            }
            gyro_range_dps = gyro_range_dps.or(range_dps);
            scales = Some(CodeScales::parse(&text).map_err(|error| wrong(error.to_string()))?);
        }
        Ok(CodeOptions { part: scales, gyro_range_dps, accel_range_g })
    }
}
