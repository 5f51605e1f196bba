//! Writes `imu.yaml` in Kalibr's format for a gyroscope alone. `zerorate imu` supports all axes and other formats.

use super::warnings;
use crate::column::flag;
use crate::exit::{CodedRefusal, Usage};
use crate::output::StagedOutput;
use anyhow::Result;
use zerorate_imu::Record;
use zerorate_imu::{Combine, Format, NoiseFileOptions, Rejections, Rule};
use zerorate_logs::{Names, Quantity};

/// Writes N and K of the gyroscope by [`Rule::Covers`] with the default horizon. Of several records, the file gets the
/// largest N and the largest K.
pub fn write(file: StagedOutput, records: &[Record]) -> Result<()> {
    if let Some(other) = records.iter().find(|record| record.quantity != Some(Quantity::AngularRate)) {
        let why = "the column does not state a unit of angular rate, and imu.yaml needs rad/s; give --unit or --scale";
        return Err(Usage(format!("{}: {why}", other.label())).into());
    }
    let doubt = records.iter().find_map(|record| Some((record, record.valid_model().err()?)));
    if let Some((record, why)) = doubt {
        return Err(CodedRefusal::new(
            why.code(),
            format!("{}: imu.yaml needs the noise coefficients: {why}", record.label()),
        )
        .into());
    }
    let log = records.iter().map(|record| record.file.display().to_string()).collect::<Vec<_>>().join(", ");
    let names = Names(flag);
    let warnings = NoiseFileOptions::mattering(warnings::condensed(records));
    let (combine, rule) = (Combine::Worst, Rule::Covers(None));
    let choice = NoiseFileOptions { log, topic: None, combine, rule, inflate: 1.0, names, warnings };
    let text = Format::Kalibr.file(choice, &Record::axes(records), &Rejections::default(), false)?;
    Ok(file.fill(text.as_bytes())?)
}
