//! `zerorate correct`: a recorded file, corrected, with its raw columns as they were.

use super::serial::Part;
use super::warn;
use crate::capture::columns::{self, Rows};
use crate::capture::{CaptureInfo, CaptureReader, Format, info, table};
use crate::interrupt;
use crate::output::{Outputs, say};
use anyhow::{Context, Result, bail, ensure};
use arrow::array::{ArrayRef, Float64Array, Float64Builder, RecordBatch};
use arrow::datatypes::{Metadata, SchemaRef};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zerorate::{Calibration, Correction};

/// Corrects a capture: RATE + PBC + (TEMP − T3) · BTC.
///
/// The result keeps all raw columns and adds rate_dps, temp_c and rate_corrected_dps. A row whose temperature was not read takes the last one read before
/// it. The result carries the id of the calibration, and is never corrected again.
#[derive(Args, Debug)]
pub struct CorrectArgs {
    /// The capture, in any of its forms.
    #[arg(value_name = "CAPTURE")]
    capture: PathBuf,

    /// The calibration file.
    #[arg(long, value_name = "FILE")]
    cal: PathBuf,

    /// The file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// The form of the file; by default what its name ends with, else arrows.
    #[arg(long, value_enum)]
    format: Option<Format>,

    /// Overwrite an existing file; and correct even if the calibration is of another serial number, with a warning.
    #[arg(long)]
    force: bool,
}

pub fn run(args: &CorrectArgs) -> Result<()> {
    interrupt::listen();
    let mut outputs = Outputs::new(args.force).reading([&*args.capture, &*args.cal])?;
    let calibration = load(&args.cal)?;
    let mut reader = CaptureReader::open(&args.capture)?;
    refuse_corrected(&args.capture, &reader)?;
    check_serial(args, reader.info(), &calibration)?;
    let output = outputs.derived(&args.output)?;
    let schema = schema(reader.info(), &calibration);
    let format = Format::choose(args.format, &args.output);
    let mut sink = table::create(&args.output, output.file()?, format, &schema)?;
    let mut corrector = Corrector::new(calibration.correction);
    while let Some(rows) = reader.next_rows()? {
        ensure!(!interrupt::asked(), "interrupted; nothing written");
        sink.write(&corrector.correct(&rows, &schema)?)?;
    }
    sink.finish()?;
    warn(reader.warning().map(str::to_owned).as_slice());
    corrector.seen.check(args, &calibration)?;
    output.publish()?;
    say(format_args!(
        "{}: {} samples, corrected with calibration {}",
        args.output.display(),
        corrector.seen.rows,
        calibration.id()
    ));
    Ok(())
}

/// Reads a calibration and says what there is to know of it.
pub(super) fn load(path: &Path) -> Result<Calibration> {
    let name = path.display();
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {name}"))?;
    let (calibration, warnings) = Calibration::parse(&text).with_context(|| name.to_string())?;
    let warnings: Vec<String> = warnings.iter().map(|warning| format!("{name}: {warning}")).collect();
    warn(&warnings);
    Ok(calibration)
}

/// What to say where temperatures from `low` to `high`, in °C, leave the span of the calibration.
pub fn extrapolation(calibration: &Calibration, low: f64, high: f64) -> Option<String> {
    let span = calibration.validity?;
    let inside = span.covers(low) && span.covers(high);
    (!inside).then(|| {
        format!(
            "{low:.1} … {high:.1} °C leaves the {:.1} … {:.1} °C of the calibration: the correction is extrapolated; calibrate over a wider span",
            span.temp_min_c, span.temp_max_c
        )
    })
}

fn refuse_corrected(path: &Path, reader: &CaptureReader) -> Result<()> {
    match reader.calibration_id() {
        None => Ok(()),
        Some(id) => bail!(
            "{} is corrected already (calibration {id}), and a bias must not be removed twice: give the capture it was made from",
            path.display()
        ),
    }
}

fn check_serial(args: &CorrectArgs, info: &CaptureInfo, calibration: &Calibration) -> Result<()> {
    let name = args.capture.display().to_string();
    let advice = "record with `zerorate capture --serial SN`";
    let checked = Part { name: &name, serial: info.serial.as_deref(), advice }.check(calibration, &args.cal);
    let doubt = match checked {
        Err(mismatch) if args.force => Some(mismatch.to_string()),
        Err(mismatch) => bail!("{mismatch} (--force corrects all the same)"),
        Ok(doubt) => doubt,
    };
    warn(doubt.as_slice());
    Ok(())
}

fn schema(info: &CaptureInfo, calibration: &Calibration) -> SchemaRef {
    let Correction { pbc_dps, btc_dps_per_c, t3_c } = calibration.correction;
    let metadata: Metadata = info
        .to_metadata()
        .with(info::CALIBRATION_ID, calibration.id())
        .with("zerorate.pbc_dps", pbc_dps.to_string())
        .with("zerorate.btc_dps_per_c", btc_dps_per_c.to_string())
        .with("zerorate.t3_c", t3_c.to_string());
    columns::schema([columns::raw_fields(), columns::derived_fields()].concat(), metadata)
}

/// Applies a correction row by row.
struct Corrector {
    correction: Correction,
    /// The temperature in force, until the next is read.
    temp_c: Option<f64>,
    seen: Seen,
}

impl Corrector {
    fn new(correction: Correction) -> Self {
        Self { correction, temp_c: None, seen: Seen::default() }
    }

    fn correct(&mut self, rows: &Rows, schema: &SchemaRef) -> Result<RecordBatch> {
        let mut rates_dps = Vec::with_capacity(rows.len());
        let mut temps_c = Float64Builder::with_capacity(rows.len());
        let mut corrected_dps = Float64Builder::with_capacity(rows.len());
        for sample in rows.samples() {
            let rate_dps = zerorate::rate_dps(sample.rate);
            let read_c = sample.temp.map(zerorate::temp_c);
            self.temp_c = read_c.or(self.temp_c);
            self.seen.count(read_c, self.temp_c, sample.status.is_some_and(|status| status.out_of_range()));
            rates_dps.push(rate_dps);
            temps_c.append_option(self.temp_c);
            corrected_dps.append_option(self.temp_c.map(|temp_c| self.correction.apply(rate_dps, temp_c)));
        }
        let derived: [ArrayRef; 3] =
            [Arc::new(Float64Array::from(rates_dps)), Arc::new(temps_c.finish()), Arc::new(corrected_dps.finish())];
        Ok(RecordBatch::try_new(schema.clone(), rows.columns().into_iter().chain(derived).collect())?)
    }
}

/// What there was in the capture that its user should know.
#[derive(Default)]
struct Seen {
    rows: u64,
    without_temp: u64,
    out_of_range: u64,
    temps_c: Option<(f64, f64)>,
}

impl Seen {
    fn count(&mut self, read_c: Option<f64>, used_c: Option<f64>, out_of_range: bool) {
        self.rows += 1;
        self.without_temp += u64::from(used_c.is_none());
        self.out_of_range += u64::from(out_of_range);
        if let Some(temp_c) = read_c {
            let (low, high) = self.temps_c.unwrap_or((temp_c, temp_c));
            self.temps_c = Some((low.min(temp_c), high.max(temp_c)));
        }
    }

    /// Warns; without any temperature there is no result.
    fn check(&self, args: &CorrectArgs, calibration: &Calibration) -> Result<()> {
        let name = args.capture.display();
        let Some((low, high)) = self.temps_c else {
            ensure!(
                self.rows == 0,
                "{name} holds no temperature at all: nothing can be corrected; record with --every-temp 1"
            );
            return Ok(());
        };
        if self.without_temp > 0 {
            warn(&[format!(
                "{name}: the first {} rows come before the first temperature and stay uncorrected (empty)",
                self.without_temp
            )]);
        }
        if self.out_of_range > 0 {
            warn(&[format!("{name}: {} samples are out of range (F-35): their rates may be wrong", self.out_of_range)]);
        }
        if let Some(extrapolated) = extrapolation(calibration, low, high) {
            warn(&[format!("{name}: {extrapolated}")]);
        }
        Ok(())
    }
}
