//! The result of an hour reaches its user, whatever happens to the files that were to hold it.

use super::{ResultArgs, text};
use crate::output::{print, print_json, print_lines, reader_left, say};
use anyhow::Result;
use zerorate::Calibration;
use zerorate_jobs::calibrate::{Report, Rescued, Undelivered};

/// Prints the result. Where that fails and no file holds it either, it is rescued.
pub fn print_result(report: &Report, calibration: &Calibration, args: &ResultArgs) -> Result<()> {
    let printed = match args.json {
        true => print_json(report),
        false => print_lines(&text::text(report, report.file.as_deref(), calibration.serial.as_deref())),
    };
    match printed {
        Err(why) if report.file.is_none() => {
            let left = reader_left(&why);
            let error = Undelivered::rescue(why, &[], calibration).error("");
            if left {
                say(format_args!("warning: {error:#}"));
            }
            Err(error)
        }
        printed => printed,
    }
}

/// Prints the calibration itself: as its file, so that it can be redirected into one, or within the JSON object.
pub fn print_undelivered(
    undelivered: Undelivered,
    mut report: Report,
    calibration: &Calibration,
    json: bool,
) -> Result<()> {
    let text = calibration.to_toml();
    let printed = if json {
        report.rescued = Some(Rescued { file: undelivered.rescued.clone(), calibration: text });
        print_json(&report)
    } else {
        print(&text)
    };
    let also = if printed.is_ok() { ", and is printed to stdout" } else { "" };
    Err(undelivered.error(also))
}
