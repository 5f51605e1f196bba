//! `zerorate report`: writes calibrations as one HTML page to read, print and file, or only the picture of the page.

use super::correct::load;
use crate::exit::Usage;
use crate::interrupt;
use crate::output::{Outputs, print};
use crate::picture::{self, Kind};
use anyhow::Result;
use clap::Args;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use zerorate::Calibration;
use zerorate_jobs::course::course;
use zerorate_view::report::{self, Course};

/// Write calibrations as one self-contained HTML page
///
/// The page has the coefficients with their uncertainties, how to apply them, the correction over temperature, the
/// look-up table around T3, and how and from which samples they were measured. It needs no network and prints on
/// paper. Several calibrations come one after the other, below a table that compares them.
#[derive(Args, Debug)]
pub struct ReportArgs {
    /// The calibration files.
    #[arg(value_name = "CALIBRATION", required = true)]
    cals: Vec<PathBuf>,

    /// The file to write [default: stdout, if that is not a terminal]. A name that ends in .svg or .png gives only the
    /// picture of the page, the correction over temperature.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// The capture that the calibration was made from, as `calibrate --log` writes it. The page then shows rate,
    /// temperature and corrected rate over time.
    #[arg(long, value_name = "CAPTURE")]
    pub capture: Option<PathBuf>,

    /// Overwrite an existing file, but never a capture.
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn run(args: &ReportArgs) -> Result<()> {
    let mut outputs = Outputs::new(args.force);
    let of_file = |path: &PathBuf| Ok((load(path, &mut outputs)?, path.display().to_string()));
    let calibrations = args.cals.iter().map(of_file).collect::<Result<Vec<_>>>()?;
    let course = args.capture.as_ref().map(|path| course_of(path, &calibrations, &mut outputs)).transpose()?;
    let page = || report::calibration_page(&calibrations, course.as_ref());
    match &args.output {
        None if io::stdout().is_terminal() => {
            Err(Usage("the page is HTML for a browser; name its file: -o report.html".to_owned()).into())
        }
        None => print(&page()?),
        Some(path) => match Kind::of(path)? {
            Some(kind) => {
                let svg = correction(&calibrations)?;
                picture::write(kind, outputs.derived(path)?, &svg)
            }
            None => Ok(outputs.derived(path)?.fill(page()?.as_bytes())?),
        },
    }
}

fn course_of(path: &Path, calibrations: &[(Calibration, String)], outputs: &mut Outputs) -> Result<Course> {
    let [(calibration, _)] = calibrations else {
        return Err(Usage("--capture belongs to one calibration; give that one alone".to_owned()).into());
    };
    let reader = outputs.capture(path)?;
    let part = reader.info().part();
    interrupt::listen();
    course(path, reader, &part, calibration, interrupt::stop())
}

fn correction(calibrations: &[(Calibration, String)]) -> Result<String> {
    let axes = || calibrations.iter().flat_map(|(one, _)| one.axes.iter().map(move |axis| (one, axis)));
    match axes().collect::<Vec<_>>().as_slice() {
        [(calibration, axis)] => Ok(report::calibration_picture(calibration, axis)),
        all => Err(Usage(format!(
            "a picture shows one axis, and these are {}: write a page (.html), which has a picture of each",
            all.len()
        ))
        .into()),
    }
}
