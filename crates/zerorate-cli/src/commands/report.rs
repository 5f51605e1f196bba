//! `zerorate report`: a calibration as one page, to be read, printed and filed.

use super::correct::load;
use super::print;
use crate::output::Outputs;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use zerorate_view::report;

/// Writes a calibration as one self-contained HTML page.
///
/// The page has the coefficients with their uncertainties, how to apply them, the correction over temperature, the
/// look-up table around T3, and how and from which samples they were measured. It needs no network and prints on
/// paper.
#[derive(Args, Debug)]
pub struct ReportArgs {
    /// The calibration file.
    #[arg(value_name = "CALIBRATION")]
    cal: PathBuf,

    /// The file to write [default: stdout].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Overwrite an existing file, but never a capture.
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn run(args: &ReportArgs) -> Result<()> {
    let mut outputs = Outputs::new(args.force).reading([&*args.cal])?;
    let calibration = load(&args.cal)?;
    let page = report::calibration_page(&calibration, &args.cal.display().to_string())?;
    match &args.output {
        None => print(&page),
        Some(path) => Ok(outputs.derived(path)?.fill(page.as_bytes())?),
    }
}
