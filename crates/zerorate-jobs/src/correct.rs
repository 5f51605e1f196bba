//! Corrects a capture and keeps its raw columns unchanged.

use crate::judged::JudgedAxis;
use crate::output::StagedOutput;
use crate::warning::JobWarning;
use anyhow::{Result, bail, ensure};
use arrow_array::builder::Float64Builder;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt8Array};
use arrow_schema::{Metadata, SchemaRef};
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use zerorate::health::Judged;
use zerorate::{Axis, Calibration, Correction, Corrector, Part, Setting, SettingNames, Tally};
use zerorate_host::Stop;
use zerorate_record::columns::Rows;
use zerorate_record::{CALIBRATION_ID, CaptureInfo, CaptureReader, Format, Layout, checked_schema, table, valid};

/// The correction of a capture that was not corrected before.
pub struct Job<'a> {
    capture: &'a Path,
    reader: CaptureReader,
    part: &'a Part,
    calibration: &'a Calibration,
}

impl<'a> Job<'a> {
    /// Prepares the correction. `reader` reads the capture at the path `capture`.
    ///
    /// # Errors
    /// Returns an error if the capture is already corrected.
    pub fn new(
        capture: &'a Path,
        reader: CaptureReader,
        part: &'a Part,
        calibration: &'a Calibration,
    ) -> Result<Self> {
        if let Some(id) = reader.calibration_id() {
            bail!(
                "{} is corrected already (calibration {id}), and a bias must not be removed twice: give the capture \
                 it was made from",
                capture.display()
            );
        }
        Ok(Self { capture, reader, part, calibration })
    }

    /// The description of the capture.
    #[must_use]
    pub fn info(&self) -> &CaptureInfo {
        self.reader.info()
    }

    /// Writes the corrected capture in `format` and returns its number of rows. `warn` receives warnings, and `stop`
    /// can end the job. Messages use `names` for the settings.
    ///
    /// # Errors
    /// Returns an error if the capture is damaged or holds no temperature, if the calibration does not fit the part,
    /// if a stop is requested, or if the file cannot be written.
    pub fn run(
        self,
        output: StagedOutput,
        format: Format,
        stop: &Stop,
        names: SettingNames,
        warn: &mut dyn FnMut(JobWarning),
    ) -> Result<u64> {
        let Self { capture, mut reader, part, calibration } = self;
        let schema = schema(reader.info(), calibration);
        let mut sink = table::create(output.path(), Box::new(output.file()?), format, &schema)?;
        let mut correcting = Correcting::new(reader.info(), part, calibration)?;
        while let Some(rows) = reader.next_rows()? {
            ensure!(!stop.asked(), "interrupted; nothing written");
            for batch in correcting.take(rows, &schema)? {
                sink.write(&batch)?;
            }
        }
        for batch in correcting.finish(&schema)? {
            sink.write(&batch)?;
        }
        sink.finish()?;
        reader.warnings().into_iter().for_each(|warning| warn(JobWarning::Source(warning.into())));
        ensure!(
            correcting.rows == 0 || correcting.corrector.range_c().is_some(),
            "{} holds no temperature at all: nothing can be corrected; record with {} 1",
            capture.display(),
            names(Setting::EveryTemp)
        );
        correcting.warnings().for_each(warn);
        output.publish()?;
        Ok(correcting.rows)
    }
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

/// Applies the correction. The reading checks need two later rows, so each batch waits for these.
struct Correcting {
    layout: Layout,
    axes: Vec<JudgedAxis>,
    corrector: Corrector<Vec<Correction>>,
    /// Batches whose rows are not all checked yet.
    waiting: VecDeque<Rows>,
    rows: u64,
    without_temp: u64,
    tally: Tally,
    start_ns: Option<u64>,
}

impl Correcting {
    fn new(info: &CaptureInfo, part: &Part, calibration: &Calibration) -> Result<Self> {
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

    /// Takes a batch of rows. Returns the batches whose rows are now all checked.
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

    fn warnings(&self) -> impl Iterator<Item = JobWarning> + use<> {
        let before = (self.without_temp > 0).then_some(JobWarning::BeforeTemperature(self.without_temp));
        let axes = self.axes.iter().map(|axis| (axis.name.as_str(), &axis.health));
        let found = valid::of_axes(axes, &self.tally, self.start_ns.unwrap_or_default());
        let found = found.into_iter().map(JobWarning::Readings);
        before.into_iter().chain(found).chain(self.corrector.warning().map(JobWarning::from))
    }
}

fn rates_dps(axis: &Axis, judged: &[Judged]) -> ArrayRef {
    let rates_dps = judged.iter().map(|judged| axis.rate.value(judged.reading.rate.into()));
    Arc::new(Float64Array::from_iter_values(rates_dps))
}

fn flags(judged: &[Judged]) -> ArrayRef {
    Arc::new(UInt8Array::from_iter_values(judged.iter().map(|judged| judged.flags.bits())))
}
