//! The option that names the part.

use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::Result;
use clap::Args;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use zerorate::Part;
use zerorate_jobs::catalogue;
use zerorate_record::CaptureInfo;

/// The part that is measured.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArgs {
    /// The properties of the part: a name of `zerorate parts`, or a file (docs/formats/part.md) [default: as a
    /// recording states, or adis16130]. With a full scale other than the first: icm20948:500.
    #[arg(long = "part", value_name = "PART", help_heading = "Sensor")]
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

    /// The part that was named, from the catalogue or from its file.
    pub fn named(&self, outputs: &mut Outputs) -> Result<Option<Part>> {
        let Some(named) = &self.part else { return Ok(None) };
        let (text, range_dps) = text(named, outputs)?;
        let wrong = |error| Usage(format!("--part {}: {error}", named.display()));
        Ok(Some(Part::parse_at(&text, range_dps).map_err(wrong)?))
    }
}

/// The text of the part that `--part` names, and its full scale in °/s, if `named` states one.
pub fn text(named: &Path, outputs: &mut Outputs) -> Result<(String, Option<f64>)> {
    let wrong = |why: String| Usage(format!("--part {}: {why}", named.display()));
    let (file, range_dps) = split(named);
    let text = catalogue::text(&file, outputs)?.map_err(|error| match error.kind() {
        ErrorKind::NotFound => wrong(catalogue::unknown(&file.display().to_string()).0),
        _ => wrong(format!("cannot read it: {error}")),
    })?;
    Ok((text, range_dps))
}

/// `icm20948:500` is a part and its full scale in °/s.
fn split(named: &Path) -> (PathBuf, Option<f64>) {
    let of_text = |text: &str| {
        let (name, range) = text.rsplit_once(':')?;
        Some((PathBuf::from(name), Some(range.parse().ok()?)))
    };
    named.to_str().and_then(of_text).unwrap_or_else(|| (named.to_owned(), None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_scale_stands_behind_a_colon() {
        for (text, name, range_dps) in [
            ("icm20948:500", "icm20948", Some(500.0)),
            ("icm20948", "icm20948", None),
            ("a/part.toml:62.5", "a/part.toml", Some(62.5)),
            ("C:\\part.toml", "C:\\part.toml", None),
        ] {
            assert_eq!(split(Path::new(text)), (PathBuf::from(name), range_dps), "{text}");
        }
    }
}
