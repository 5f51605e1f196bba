//! The result of an hour reaches its user, whatever happens to the files that were to hold it.

use super::{Report, ResultArgs};
use crate::output::{print, print_json, print_lines, reader_left, rescue, say};
use anyhow::Result;
use serde::Serialize;
use std::path::{Path, PathBuf};
use zerorate::Calibration;

/// What a calibration is called that was given no name.
const UNNAMED: &str = "calibration.toml";

/// Prints the result. Where that fails and no file holds it either, it is rescued.
pub fn print_result(report: &Report, calibration: &Calibration, args: &ResultArgs) -> Result<()> {
    let printed = match args.json {
        true => print_json(report),
        false => print_lines(&report.text(args.output.as_deref(), calibration.serial.as_deref())),
    };
    match printed {
        Err(why) if args.output.is_none() => {
            let left = reader_left(&why);
            let error = Undelivered::rescue(why, &[], calibration).into_error();
            if left {
                say(format_args!("warning: {error:#}"));
            }
            Err(error)
        }
        printed => printed,
    }
}

/// A calibration that is not, or not with all its company, where it was asked for.
#[derive(Debug)]
pub struct Undelivered {
    why: anyhow::Error,
    rescued: Option<PathBuf>,
}

/// In the JSON object of such a calibration.
#[derive(Clone, Debug, Serialize)]
pub struct Rescued {
    file: Option<PathBuf>,
    calibration: String,
}

impl Undelivered {
    /// Puts the calibration beside what was `wanted`, or where it can.
    pub fn rescue(why: anyhow::Error, wanted: &[PathBuf], calibration: &Calibration) -> Self {
        let wanted: Vec<&Path> = wanted.iter().map(PathBuf::as_path).collect();
        let name = wanted.first().copied().filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
        let name = name.unwrap_or(Path::new(UNNAMED));
        Self { why, rescued: rescue(name, &wanted, calibration.to_toml().as_bytes()) }
    }

    /// Prints the calibration itself: as its file, so that it can be redirected into one, or within the JSON object.
    pub fn print(self, mut report: Report, calibration: &Calibration, json: bool) -> Result<()> {
        let text = calibration.to_toml();
        let printed = if json {
            report.rescued = Some(Rescued { file: self.rescued.clone(), calibration: text });
            print_json(&report)
        } else {
            print(&text)
        };
        let also = if printed.is_ok() { ", and is printed to stdout" } else { "" };
        Err(self.error(also))
    }

    /// What failed, and where the calibration is.
    pub fn into_error(self) -> anyhow::Error {
        self.error("")
    }

    fn error(self, also: &str) -> anyhow::Error {
        let place = match self.rescued {
            Some(file) => format!("the calibration is not lost, it stands in {}{also}", file.display()),
            None => format!("no folder takes the calibration{also}"),
        };
        self.why.context(place)
    }
}
