//! Prints the result of a calibration, even if its files cannot be written.

use super::{ResultArgs, text};
use crate::output::{print, print_json, print_lines, reader_left, say};
use crate::wording;
use anyhow::Result;
use zerorate::Calibration;
use zerorate_jobs::calibrate::{CalibrationReport, DeliveryFailure, RescuedCalibration};

/// Prints the result. If printing fails and no file holds the calibration, the calibration is saved to a new file.
pub fn print_result(report: &CalibrationReport, calibration: &Calibration, args: &ResultArgs) -> Result<()> {
    let assumes_line = calibration.run.as_ref().is_some_and(|run| run.assume_linear);
    let printed = match args.json {
        true => print_json(report),
        false => print_lines(&text::text(report, report.file.as_deref(), calibration.serial.as_deref(), assumes_line)),
    };
    match printed {
        Err(why) if report.file.is_none() => {
            let left = reader_left(&why);
            let error = DeliveryFailure::rescue(why, &[], calibration).error("");
            if left {
                say(format_args!("warning: {}", wording::text(&error)));
            }
            Err(error)
        }
        printed => printed,
    }
}

/// Prints the calibration after its file could not be written: as the text of a file, or in the JSON object.
pub fn print_undelivered(
    failure: DeliveryFailure,
    mut report: CalibrationReport,
    calibration: &Calibration,
    json: bool,
) -> Result<()> {
    let text = calibration.to_toml();
    let printed = if json {
        report.rescued = Some(RescuedCalibration { file: failure.rescued.clone(), calibration: text });
        print_json(&report)
    } else {
        print(&text)
    };
    let also = if printed.is_ok() { ", and is printed to stdout" } else { "" };
    Err(failure.error(also))
}
