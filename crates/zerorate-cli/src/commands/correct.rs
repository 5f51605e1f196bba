//! `zerorate correct`: a recorded file, corrected, with its raw columns as they were.

use super::serial::Part;
use super::{flag, warn};
use crate::interrupt;
use crate::output::{Outputs, say};
use anyhow::{Context, Result, bail, ensure};
use arrow_array::builder::Float64Builder;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt8Array};
use arrow_schema::{Metadata, SchemaRef};
use clap::Args;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zerorate::health::{Flags, Health, Judged};
use zerorate::{Axis, Calibration, Correction, Corrector, Reading, Say, Tally};
use zerorate_data::believed;
use zerorate_data::capture::columns::{self, Rows};
use zerorate_data::capture::{CALIBRATION_ID, CaptureInfo, CaptureReader, Format, table};
use zerorate_host::files;

/// Corrects a capture: RATE + PBC + (TEMP − T3) · BTC.
///
/// The result keeps all raw columns and adds rate_dps, temp_c, rate_corrected_dps and flags. Readings that are not to
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

    /// Overwrite an existing file; and correct even if the calibration is of another serial number, with a warning.
    #[arg(long)]
    force: bool,
}

pub fn run(args: &CorrectArgs) -> Result<()> {
    interrupt::listen();
    let mut outputs = Outputs::new(args.force).reading([&*args.capture, &*args.cal])?;
    let calibration = load(&args.cal)?;
    let mut reader = files::capture(&args.capture)?;
    refuse_corrected(&args.capture, &reader)?;
    check_serial(args, reader.info(), &calibration)?;
    let output = outputs.derived(&args.output)?;
    let schema = schema(reader.info(), &calibration);
    let format = Format::choose(args.format, &args.output);
    let mut sink = table::create(&args.output, Box::new(output.file()?), format, &schema)?;
    let mut correcting = Correcting::new(reader.info().axis(), corrector(&calibration)?);
    while let Some(rows) = reader.next_rows()? {
        ensure!(!interrupt::asked(), "interrupted; nothing written");
        for batch in correcting.take(rows, &schema)? {
            sink.write(&batch)?;
        }
    }
    for batch in correcting.finish(&schema)? {
        sink.write(&batch)?;
    }
    sink.finish()?;
    warn(&reader.warnings());
    correcting.check(args)?;
    output.publish()?;
    say(format_args!(
        "{}: {} samples, corrected with calibration {}",
        args.output.display(),
        correcting.seen.rows,
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

/// What is to be applied to the only axis of an ADIS16130.
pub(super) fn corrector(calibration: &Calibration) -> Result<Corrector<Vec<Correction>>> {
    let zerorate::Part { name, axes } = zerorate::Part::ADIS16130;
    Ok(calibration.corrector(&name, axes.iter().map(|axis| &*axis.name))?)
}

fn refuse_corrected(path: &Path, reader: &CaptureReader) -> Result<()> {
    match reader.calibration_id() {
        None => Ok(()),
        Some(id) => bail!(
            "{} is corrected already (calibration {id}), and a bias must not be removed twice: give the capture it \
             was made from",
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
    let mut metadata: Metadata = info.to_metadata().with(CALIBRATION_ID, calibration.id());
    if let Some(Correction { pbc_dps, btc_dps_per_c, t3_c }) = calibration.axes.first().map(|axis| axis.correction) {
        metadata = metadata
            .with("zerorate.pbc_dps", pbc_dps.to_string())
            .with("zerorate.btc_dps_per_c", btc_dps_per_c.to_string())
            .with("zerorate.t3_c", t3_c.to_string());
    }
    columns::schema([columns::raw_fields(), columns::derived_fields()].concat(), metadata)
}

/// Applies a correction row by row, two rows late: so long it takes to judge one.
struct Correcting {
    axis: Axis,
    corrector: Corrector<Vec<Correction>>,
    /// Batches that are not judged to their end yet.
    waiting: VecDeque<Rows>,
    judged: VecDeque<Judged>,
    seen: Seen,
}

impl Correcting {
    fn new(axis: Axis, corrector: Corrector<Vec<Correction>>) -> Self {
        let (waiting, judged) = (VecDeque::new(), VecDeque::new());
        Self { axis, corrector, waiting, judged, seen: Seen::new(&axis) }
    }

    /// Takes a batch in, and gives those that are judged.
    fn take(&mut self, rows: Rows, schema: &SchemaRef) -> Result<Vec<RecordBatch>> {
        for sample in rows.samples() {
            let reading = Reading::from(&sample);
            self.seen.start_ns.get_or_insert(sample.t_ns);
            self.seen.tally.count(&reading);
            self.judged.extend(self.seen.health.push(&reading));
        }
        self.waiting.push_back(rows);
        self.complete(schema)
    }

    /// The batches that are left.
    fn finish(&mut self, schema: &SchemaRef) -> Result<Vec<RecordBatch>> {
        while let Some(last) = self.seen.health.finish() {
            self.judged.push_back(last);
        }
        self.complete(schema)
    }

    fn complete(&mut self, schema: &SchemaRef) -> Result<Vec<RecordBatch>> {
        let mut batches = Vec::new();
        while let Some(rows) = self.waiting.front().filter(|rows| rows.len() <= self.judged.len()) {
            let columns = rows.columns();
            let judged: Vec<Judged> = self.judged.drain(..rows.len()).collect();
            self.waiting.pop_front();
            batches.push(self.correct(columns, &judged, schema)?);
        }
        Ok(batches)
    }

    fn correct(&mut self, raw: Vec<ArrayRef>, rows: &[Judged], schema: &SchemaRef) -> Result<RecordBatch> {
        let mut temps_c = Float64Builder::with_capacity(rows.len());
        let mut corrected_dps = Float64Builder::with_capacity(rows.len());
        let Axis { rate, temp, .. } = self.axis;
        for judged in rows {
            let read_c = judged.temp().map(|code| temp.value(code.into()));
            let corrected = self.corrector.take(judged.rate().map(|code| rate.value(code.into())), read_c);
            self.seen.rows += 1;
            self.seen.without_temp += u64::from(corrected.temp_c.is_none());
            temps_c.append_option(corrected.temp_c);
            corrected_dps.append_option(corrected.rate_dps);
        }
        let rates_dps = rows.iter().map(|judged| rate.value(judged.reading.rate.into()));
        let derived: [ArrayRef; 4] = [
            Arc::new(Float64Array::from_iter_values(rates_dps)),
            Arc::new(temps_c.finish()),
            Arc::new(corrected_dps.finish()),
            Arc::new(UInt8Array::from_iter_values(rows.iter().map(|judged| Flags::bits(judged.flags)))),
        ];
        Ok(RecordBatch::try_new(schema.clone(), raw.into_iter().chain(derived).collect())?)
    }
}

/// What there was in the capture that its user should know.
struct Seen {
    rows: u64,
    without_temp: u64,
    health: Health,
    tally: Tally,
    start_ns: Option<u64>,
}

impl Seen {
    fn new(axis: &Axis) -> Self {
        Self { rows: 0, without_temp: 0, health: Health::new(axis), tally: Tally::default(), start_ns: None }
    }
}

impl Correcting {
    /// Warns; without any temperature there is no result.
    fn check(&self, args: &CorrectArgs) -> Result<()> {
        let (name, seen) = (args.capture.display(), &self.seen);
        if self.corrector.range_c().is_none() {
            ensure!(
                seen.rows == 0,
                "{name} holds no temperature at all: nothing can be corrected; record with --every-temp 1"
            );
            return Ok(());
        }
        if seen.without_temp > 0 {
            warn(&[format!(
                "{name}: the first {} rows come before the first temperature and stay uncorrected (empty)",
                seen.without_temp
            )]);
        }
        let found = believed::warnings(&seen.health, &seen.tally, seen.start_ns.unwrap_or_default());
        warn(&found.iter().map(|found| format!("{name}: {found}")).collect::<Vec<_>>());
        if let Some(extrapolated) = self.corrector.warning() {
            warn(&[format!("{name}: {}", extrapolated.with(flag))]);
        }
        Ok(())
    }
}
