//! The option that names the part.

use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use zerorate::Part;
use zerorate_record::{CaptureInfo, limits};

/// The part that is measured.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArgs {
    /// The properties of the part: adis16130, or the file of another part (docs/formats/part.md) [default: as a
    /// recording states, or adis16130].
    #[arg(long = "part", value_name = "PART")]
    part: Option<PathBuf>,
}

impl PartArgs {
    /// The part of a recording, completed by the part that was named.
    pub fn of(&self, info: &CaptureInfo, outputs: &mut Outputs) -> Result<Part> {
        match self.named(outputs)? {
            Some(part) => Ok(info.part_from(&part).map_err(|error| Usage(error.to_string()))?),
            None => Ok(info.part()),
        }
    }

    /// The part that was named, from its file unless it is built in.
    pub fn named(&self, outputs: &mut Outputs) -> Result<Option<Part>> {
        let Some(path) = &self.part else { return Ok(None) };
        let known = Part::ADIS16130;
        if path.to_str().is_some_and(|name| name.eq_ignore_ascii_case(&known.name)) {
            return Ok(Some(known));
        }
        let wrong = |why: String| Usage(format!("--part {}: {why}", path.display()));
        let text = outputs.try_text(path, limits::TEXT)?.map_err(|error| {
            wrong(format!(
                "cannot read it ({error}); give adis16130, or the file of another part (docs/formats/part.md)"
            ))
        })?;
        Ok(Some(Part::parse(&text).map_err(|error| wrong(error.to_string()))?))
    }
}
