//! Which part it is, as an option.

use clap::Args;
use std::fs;
use zerorate::Part;
use zerorate_data::capture::CaptureInfo;

use crate::exit::Usage;

/// Which part is measured.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArgs {
    /// What is known of the part: adis16130, or the file of another (docs/formats/part.md) [default: what a recording
    /// states of its own, else adis16130].
    #[arg(long = "part", value_name = "PART", value_parser = part)]
    pub part: Option<Part>,
}

impl PartArgs {
    /// The part of a recording, with what is known of it beside.
    pub fn of(&self, info: &CaptureInfo) -> Result<Part, Usage> {
        let known = |part| info.part_from(part).map_err(|error| Usage(error.to_string()));
        self.part.as_ref().map_or_else(|| Ok(info.part()), known)
    }
}

fn part(text: &str) -> Result<Part, String> {
    if text.eq_ignore_ascii_case(&Part::ADIS16130.name) {
        return Ok(Part::ADIS16130);
    }
    let file = fs::read_to_string(text).map_err(|error| {
        format!("cannot read it ({error}); give adis16130, or the file of another part (docs/formats/part.md)")
    })?;
    Part::parse(&file).map_err(|error| error.to_string())
}
