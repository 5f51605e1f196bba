//! The option `--part`.

use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::Result;
use clap::Args;
use std::path::{Path, PathBuf};
use zerorate::Part;
use zerorate_jobs::catalogue;
use zerorate_record::CaptureInfo;

/// The part that is measured.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArgs {
    /// The properties of the part: a name of `zerorate parts`, or a file (docs/formats/part.md) [default: as a
    /// recording states, or adis16130]. For another full scale, append it in °/s: icm20948:500.
    #[arg(long = "part", value_name = "PART", help_heading = "Sensor")]
    part: Option<PathBuf>,
}

impl PartArgs {
    /// The part of a recording, completed by the facts about the named part.
    pub fn of(&self, info: &CaptureInfo, outputs: &mut Outputs) -> Result<Part> {
        match self.named(outputs)? {
            Some(part) => Ok(info.part_from(&part).map_err(|error| Usage(error.to_string()))?),
            None => Ok(info.part()),
        }
    }

    /// The named part, from the catalogue or from its file; `None` without the option.
    pub fn named(&self, outputs: &mut Outputs) -> Result<Option<Part>> {
        let Some(named) = &self.part else { return Ok(None) };
        let (text, range_dps) = text(named, outputs)?;
        let wrong = |error| Usage(format!("--part {}: {error}", named.display()));
        Ok(Some(Part::parse_at(&text, range_dps).map_err(wrong)?))
    }
}

/// The text of the part file that `--part` names, and the full scale in °/s if `named` states one.
pub fn text(named: &Path, outputs: &mut Outputs) -> Result<(String, Option<f64>)> {
    catalogue::named(named, outputs).map_err(|error| match error.downcast() {
        Ok(Usage(why)) => Usage(format!("--part {}: {why}", named.display())).into(),
        Err(other) => other,
    })
}
