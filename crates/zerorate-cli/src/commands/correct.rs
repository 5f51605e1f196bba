//! `zerorate correct`: a recorded file, corrected, with its raw columns as they were.

use super::serial::Part;
use crate::interrupt;
use crate::output::{Outputs, say, warn};
use crate::part::PartArgs;
use crate::wording::{coded, flag};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use zerorate::{Calibration, Say};
use zerorate_jobs::JobWarning;
use zerorate_jobs::correct::Job;
use zerorate_record::delimited::is_table;
use zerorate_record::{CaptureInfo, Format, limits};

/// Corrects a capture: RATE + PBC + d · BTC, with d = TEMP − T3, and + d² · BTC2 + d³ · BTC3 where the calibration has
/// these terms.
///
/// The result keeps all raw columns and adds rate_dps, temp_c, rate_corrected_dps and flags; of a part with several
/// axes NAME_dps, NAME_corrected_dps and NAME_flags of each. Readings that are not to
/// be believed, because the part cannot have made them (bit errors), because they are out of range, or because it had
/// stopped, are flagged and have no corrected rate. A row whose temperature was not read takes the last one read
/// before it. The result carries the id of the calibration, and is never corrected again.
#[derive(Args, Debug)]
pub struct CorrectArgs {
    /// The capture, in any of its forms.
    #[arg(value_name = "CAPTURE")]
    pub capture: PathBuf,

    /// The calibration file.
    #[arg(long, value_name = "FILE")]
    cal: PathBuf,

    /// The file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// The form of the file; by default what its name ends with, else arrows.
    #[arg(long, value_enum)]
    format: Option<Format>,

    #[command(flatten)]
    part: PartArgs,

    /// Overwrite an existing file; and correct even if the calibration is of another serial number, with a warning.
    #[arg(long)]
    force: bool,
}

pub fn run(args: &CorrectArgs) -> Result<()> {
    interrupt::listen();
    let mut outputs = Outputs::new(args.force);
    let calibration = load(&args.cal, &mut outputs)?;
    let reader = outputs.capture(&args.capture)?;
    let part = args.part.of(reader.info(), &mut outputs)?;
    let job = Job::new(&args.capture, reader, &part, &calibration)?;
    check_serial(args, job.info(), &calibration)?;
    let format = Format::choose(args.format, &args.output)?;
    let output = outputs.derived(&args.output)?;
    let name = args.capture.display();
    let rows = job.run(output, format, interrupt::stop(), flag, &mut |warning| match warning {
        of_file @ JobWarning::Source(_) => warn(&[coded(of_file)]),
        other => warn(&[format!("{}: {name}: {}", other.code(), other.with(flag))]),
    })?;
    say(format_args!("{}: {rows} samples, corrected with calibration {}", args.output.display(), calibration.id()));
    Ok(())
}

/// Reads a calibration and says what there is to know of it.
pub(super) fn load(path: &Path, outputs: &mut Outputs) -> Result<Calibration> {
    let name = path.display();
    let text = outputs.text(path, limits::TEXT)?;
    let (calibration, warnings) = Calibration::parse(&text).with_context(|| match is_table(&text) {
        true => format!("{name} is a CSV, not a calibration; give the file that `zerorate calibrate` wrote"),
        false => name.to_string(),
    })?;
    let of_file = |warning| coded(JobWarning::OfCalibration(name.to_string(), warning));
    warn(&warnings.into_iter().map(of_file).collect::<Vec<_>>());
    Ok(calibration)
}

fn check_serial(args: &CorrectArgs, info: &CaptureInfo, calibration: &Calibration) -> Result<()> {
    let name = args.capture.display().to_string();
    let advice = "record with `zerorate capture --serial SN`";
    let checked = Part { name: &name, serial: info.serial.as_deref(), advice }.check(calibration, &args.cal);
    match checked {
        Err(mismatch) if args.force => warn(&[mismatch]),
        Err(mismatch) => bail!("{mismatch} (--force corrects all the same)"),
        Ok(doubt) => warn(doubt.map(coded).as_slice()),
    }
    Ok(())
}
