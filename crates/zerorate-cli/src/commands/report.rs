//! `zerorate report`: a calibration as one page to read, print and file.

use super::correct::load;
use crate::exit::Usage;
use crate::output::{Outputs, print};
use crate::picture::{self, Kind};
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use zerorate::Calibration;
use zerorate_view::report;

/// Write a calibration as one self-contained HTML page
///
/// The page has the coefficients with their uncertainties, how to apply them, the correction over temperature, the
/// look-up table around T3, and how and from which samples they were measured. It needs no network and prints on
/// paper.
#[derive(Args, Debug)]
pub struct ReportArgs {
    /// The calibration file.
    #[arg(value_name = "CALIBRATION")]
    cal: PathBuf,

    /// The file to write [default: stdout]. A name that ends in .svg or .png gives only the picture of the page, the
    /// correction over temperature.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Overwrite an existing file, but never a capture.
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn run(args: &ReportArgs) -> Result<()> {
    let mut outputs = Outputs::new(args.force);
    let calibration = load(&args.cal, &mut outputs)?;
    let page = || report::calibration_page(&calibration, &args.cal.display().to_string());
    match &args.output {
        None => print(&page()?),
        Some(path) => match Kind::of(path)? {
            Some(kind) => {
                let svg = correction(&calibration)?;
                picture::write(kind, outputs.derived(path)?, &svg)
            }
            None => Ok(outputs.derived(path)?.fill(page()?.as_bytes())?),
        },
    }
}

fn correction(calibration: &Calibration) -> Result<String> {
    match calibration.axes.as_slice() {
        [only] => Ok(report::calibration_picture(only, calibration.validity)),
        axes => Err(Usage(format!(
            "a picture shows one axis, and this calibration has {}: write a page (.html), which has a picture of each",
            axes.len()
        ))
        .into()),
    }
}
