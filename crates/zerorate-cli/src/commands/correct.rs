//! `zerorate correct`: a recorded file, corrected, with its raw columns as they were.

use super::serial::Part;
use crate::interrupt;
use crate::output::{Outputs, say, warn};
use crate::part::PartArgs;
use crate::wording::flag;
use anyhow::{Context, Result, bail, ensure};
use arrow_array::builder::Float64Builder;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt8Array};
use arrow_schema::{Metadata, SchemaRef};
use clap::Args;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zerorate::health::Judged;
use zerorate::{Axis, Calibration, Correction, Corrector, Say, Tally};
use zerorate_jobs::JudgedAxis;
use zerorate_record::columns::Rows;
use zerorate_record::{
    CALIBRATION_ID, CaptureInfo, CaptureReader, Format, Layout, believed, checked_schema, limits, table,
};

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
    let mut reader = outputs.capture(&args.capture)?;
    let part = args.part.of(reader.info(), &mut outputs)?;
    refuse_corrected(&args.capture, &reader)?;
    check_serial(args, reader.info(), &calibration)?;
    let format = Format::choose(args.format, &args.output)?;
    let output = outputs.derived(&args.output)?;
    let schema = schema(reader.info(), &calibration);
    let mut sink = table::create(&args.output, Box::new(output.file()?), format, &schema)?;
    let mut correcting = Correcting::new(reader.info(), &part, &calibration)?;
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
        correcting.rows,
        calibration.id()
    ));
    Ok(())
}

/// Reads a calibration and says what there is to know of it.
pub(super) fn load(path: &Path, outputs: &mut Outputs) -> Result<Calibration> {
    let name = path.display();
    let text = outputs.text(path, limits::TEXT)?;
    let (calibration, warnings) = Calibration::parse(&text).with_context(|| name.to_string())?;
    let warnings: Vec<String> = warnings.iter().map(|warning| format!("no-checksum: {name}: {warning}")).collect();
    warn(&warnings);
    Ok(calibration)
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
    let axes = info.layout.axes();
    for name in axes.iter().map(|axis| &axis.name) {
        let Some(correction) = calibration.axis(name).map(|axis| axis.correction) else { continue };
        let Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = correction;
        let key = if axes.len() == 1 { "zerorate".to_owned() } else { format!("zerorate.axis.{name}") };
        metadata = metadata
            .with(format!("{key}.pbc_dps"), pbc_dps.to_string())
            .with(format!("{key}.btc_dps_per_c"), btc_dps_per_c.to_string())
            .with(format!("{key}.t3_c"), t3_c.to_string());
        if !correction.is_line() {
            metadata = metadata
                .with(format!("{key}.btc2_dps_per_c2"), btc2_dps_per_c2.to_string())
                .with(format!("{key}.btc3_dps_per_c3"), btc3_dps_per_c3.to_string());
        }
    }
    checked_schema([info.layout.raw_fields(), info.layout.derived_fields()].concat(), metadata)
}

/// Applies a correction row by row, two rows late: so long it takes to judge one.
struct Correcting {
    layout: Layout,
    axes: Vec<JudgedAxis>,
    corrector: Corrector<Vec<Correction>>,
    /// Batches that are not judged to their end yet.
    waiting: VecDeque<Rows>,
    rows: u64,
    without_temp: u64,
    tally: Tally,
    start_ns: Option<u64>,
}

impl Correcting {
    fn new(info: &CaptureInfo, part: &zerorate::Part, calibration: &Calibration) -> Result<Self> {
        Ok(Self {
            corrector: calibration.corrector(&part.name, part.axes.iter().map(|axis| &*axis.name))?,
            layout: info.layout.clone(),
            axes: part.axes.iter().map(JudgedAxis::new).collect(),
            waiting: VecDeque::new(),
            rows: 0,
            without_temp: 0,
            tally: Tally::default(),
            start_ns: None,
        })
    }

    /// Takes a batch in, and gives those that are judged.
    fn take(&mut self, rows: Rows, schema: &SchemaRef) -> Result<Vec<RecordBatch>> {
        for row in rows.iter() {
            self.start_ns.get_or_insert(row.t_ns);
            for (index, axis) in self.axes.iter_mut().enumerate() {
                let Some(reading) = self.layout.reading(&row, index) else { continue };
                if index == 0 {
                    self.tally.count(&reading);
                }
                axis.judged.extend(axis.health.push(&reading));
            }
        }
        self.waiting.push_back(rows);
        self.complete(schema)
    }

    /// The batches that are left.
    fn finish(&mut self, schema: &SchemaRef) -> Result<Vec<RecordBatch>> {
        for axis in &mut self.axes {
            while let Some(last) = axis.health.finish() {
                axis.judged.push_back(last);
            }
        }
        self.complete(schema)
    }

    fn complete(&mut self, schema: &SchemaRef) -> Result<Vec<RecordBatch>> {
        let mut batches = Vec::new();
        while let Some(rows) = self.waiting.front().filter(|rows| self.are_judged(rows.len())) {
            let (columns, len) = (rows.columns()?, rows.len());
            self.waiting.pop_front();
            batches.push(self.correct(columns, len, schema)?);
        }
        Ok(batches)
    }

    fn are_judged(&self, rows: usize) -> bool {
        self.axes.iter().all(|axis| axis.judged.len() >= rows)
    }

    fn correct(&mut self, raw: Vec<ArrayRef>, rows: usize, schema: &SchemaRef) -> Result<RecordBatch> {
        let judged: Vec<Vec<Judged>> = self.axes.iter_mut().map(|axis| axis.judged.drain(..rows).collect()).collect();
        let mut temps_c = Float64Builder::with_capacity(rows);
        let mut corrected_dps: Vec<_> = judged.iter().map(|_| Float64Builder::with_capacity(rows)).collect();
        for row in 0..rows {
            // all axes have the same temperature
            let read = judged.first().zip(self.axes.first());
            let read_c = read.and_then(|(judged, first)| Some(first.axis.temp.value(judged[row].temp()?.into())));
            self.corrector.read(read_c);
            self.without_temp += u64::from(self.corrector.temp_c().is_none());
            temps_c.append_option(self.corrector.temp_c());
            for (index, (judged, axis)) in judged.iter().zip(&self.axes).enumerate() {
                let rate_dps = judged[row].rate().map(|code| axis.axis.rate.value(code.into()));
                corrected_dps[index].append_option(self.corrector.correct(index, rate_dps));
            }
        }
        self.rows += rows as u64;
        let rates = self.axes.iter().zip(&judged).map(|(axis, judged)| rates_dps(&axis.axis, judged));
        let corrected = corrected_dps.iter_mut().map(|column| -> ArrayRef { Arc::new(column.finish()) });
        let derived = rates.chain([Arc::new(temps_c.finish()) as ArrayRef]).chain(corrected);
        let columns = raw.into_iter().chain(derived).chain(judged.iter().map(|judged| flags(judged))).collect();
        Ok(RecordBatch::try_new(schema.clone(), columns)?)
    }
}

/// As they were measured.
fn rates_dps(axis: &Axis, judged: &[Judged]) -> ArrayRef {
    let rates_dps = judged.iter().map(|judged| axis.rate.value(judged.reading.rate.into()));
    Arc::new(Float64Array::from_iter_values(rates_dps))
}

fn flags(judged: &[Judged]) -> ArrayRef {
    Arc::new(UInt8Array::from_iter_values(judged.iter().map(|judged| judged.flags.bits())))
}

impl Correcting {
    /// Warns; without any temperature there is no result.
    fn check(&self, args: &CorrectArgs) -> Result<()> {
        let name = args.capture.display();
        if self.corrector.range_c().is_none() {
            ensure!(
                self.rows == 0,
                "{name} holds no temperature at all: nothing can be corrected; record with --every-temp 1"
            );
            return Ok(());
        }
        if self.without_temp > 0 {
            warn(&[format!(
                "before-temperature: {name}: the first {} rows come before the first temperature and stay \
                 uncorrected (empty)",
                self.without_temp
            )]);
        }
        let axes = self.axes.iter().map(|axis| (axis.name.as_str(), &axis.health));
        let found = believed::of_axes(axes, &self.tally, self.start_ns.unwrap_or_default());
        warn(&found.iter().map(|note| format!("{}: {name}: {}", note.code, note.text)).collect::<Vec<_>>());
        if let Some(extrapolated) = self.corrector.warning() {
            warn(&[format!("{}: {name}: {}", extrapolated.code(), extrapolated.with(flag))]);
        }
        Ok(())
    }
}
