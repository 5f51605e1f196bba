//! `zerorate stream`: the corrected rate, live.

use super::correct::{corrector, load};
use super::serial::{Part, one_line};
use super::{flag, warn};
use crate::acquire::Acquisition;
use crate::cli::{DeviceArgs, SamplingArgs};
use crate::exit::{Refused, Usage};
use crate::output::{Outputs, Stdout};
use anyhow::{Result, bail, ensure};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use zerorate::health::{Flags, Judged};
use zerorate::{Axis, Calibration, CodeSum, Corrected, Correction, Corrector, Say};
use zerorate_data::believed;
use zerorate_host::Facts;
use zerorate_view::duration::Seconds;

/// Prints the corrected rate as it comes: columns t_s, rate_dps, temp_c, lost, calibration, flags.
///
/// t_s counts from the first sample; lost counts the samples lost since the row before; calibration names the
/// calibration that was applied. flags is empty, or says which readings are not to be believed and were left out:
/// impossible (a bit error: one that a part of 300 Hz cannot have made between its neighbours), out-of-range,
/// impossible-temperature or frozen, joined by +; a row without any good reading has no rate. Judging takes two
/// samples more. A part that is frozen ends the stream with exit code 3. Ends after --duration, at the end of a
/// replay, on Ctrl-C, or when the reader of its output goes away. On the twin give --duration, or --realtime for rows
/// at the speed of a real part.
#[derive(Args, Debug)]
pub struct StreamArgs {
    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// The calibration file.
    #[arg(long, value_name = "FILE")]
    cal: PathBuf,

    /// Serial number of the part; a calibration of another serial number is an error.
    #[arg(long, value_name = "SN", value_parser = one_line)]
    serial: Option<String>,

    /// The form of the rows.
    #[arg(long, value_enum, default_value = "csv")]
    format: Form,

    /// Rows per second: each is the mean of all samples in its share of time, without overlap; a share that is not
    /// complete at the end gives no row [default: a row for each sample].
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,

    /// How long to go on: 10s, 10m, 1h30m, or seconds [default: until Ctrl-C or the end].
    #[arg(long, value_name = "TIME")]
    duration: Option<Seconds>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Form {
    Csv,
    Jsonl,
}

pub fn run(args: &StreamArgs) -> Result<()> {
    let calibration = load(&args.cal)?;
    let period_ns = args.rate.map(period_ns).transpose()?.unwrap_or(1);
    Outputs::new(false).reading(args.device.file().into_iter().chain([&*args.cal]))?;
    let mut acquisition = Acquisition::open(&args.device, args.sampling)?;
    check_serial(args, acquisition.facts(), &calibration)?;
    acquisition.initialise()?;
    let mut rows = Rows::new(args.format, *acquisition.axis(), &calibration, acquisition.is_paced())?;
    let mut mean = Mean::default();
    let ends_after_ns = args.duration.map_or(u64::MAX, Seconds::nanos);
    let mut first_ns = None;
    while let Some(judged) = acquisition.next_judged()? {
        let t_ns = judged.reading.t_ns - *first_ns.get_or_insert(judged.reading.t_ns);
        if mean.belongs_to_next(t_ns / period_ns) {
            rows.write(&mut mean)?;
        }
        if t_ns >= ends_after_ns {
            break;
        }
        mean.push(t_ns, t_ns / period_ns, &judged);
        if acquisition.health().frozen().is_some() {
            return stop_frozen(&acquisition, &mut rows, &mut mean);
        }
    }
    if args.rate.is_none() {
        rows.write(&mut mean)?;
    }
    rows.out.flush()?;
    warn(&believed::warnings(acquisition.health(), acquisition.tally(), acquisition.start_ns()));
    Ok(())
}

/// The row that says so, then the end: nothing after it would be a measurement.
#[cold]
fn stop_frozen(acquisition: &Acquisition, rows: &mut Rows, mean: &mut Mean) -> Result<()> {
    mean.flags = mean.flags.and(Flags::FROZEN);
    rows.write(mean)?;
    rows.out.flush()?;
    let frozen = acquisition.health().frozen();
    let why = frozen.map(|frozen| believed::frozen_text(&frozen, acquisition.start_ns())).unwrap_or_default();
    Err(Refused(why).into())
}

/// A serial number that is given must be that of the calibration, and that of the recording where one is read.
fn check_serial(args: &StreamArgs, facts: &Facts, calibration: &Calibration) -> Result<()> {
    let (given, recorded) = (args.serial.as_deref(), facts.info.serial.as_deref());
    if let (Some(given), Some(recorded)) = (given, recorded) {
        ensure!(given == recorded, "{} was recorded from part {recorded}, not from part {given}", args.device.device);
    }
    if let (Some(given), None) = (given, &calibration.serial) {
        bail!("{} is the calibration of a part without a serial number, not of part {given}", args.cal.display());
    }
    let name = args.device.device.to_string();
    let part = Part { name: &name, serial: given.or(recorded), advice: "give --serial SN to have it checked" };
    warn(part.check(calibration, &args.cal)?.as_slice());
    Ok(())
}

fn period_ns(rate_hz: f64) -> Result<u64> {
    if !(1e-4..=1e6).contains(&rate_hz) {
        return Err(Usage(format!("--rate is {rate_hz}; it must lie between 0.0001 and 1000000 Hz")).into());
    }
    Ok((1e9 / rate_hz).round() as u64)
}

/// The samples of one row: exact sums of codes, divided once.
#[derive(Default)]
struct Mean {
    slot: u64,
    readings: u64,
    first_ns: u64,
    last_ns: u64,
    rate: CodeSum,
    temp: CodeSum,
    lost: u64,
    flags: Flags,
}

impl Mean {
    fn is_empty(&self) -> bool {
        self.readings == 0
    }

    #[inline]
    fn belongs_to_next(&self, slot: u64) -> bool {
        !self.is_empty() && slot != self.slot
    }

    #[inline]
    fn push(&mut self, t_ns: u64, slot: u64, judged: &Judged) {
        if self.is_empty() {
            (self.slot, self.first_ns) = (slot, t_ns);
        }
        self.last_ns = t_ns;
        self.readings += 1;
        if let Some(rate) = judged.rate() {
            self.rate.push(rate);
        }
        if let Some(temp) = judged.temp() {
            self.temp.push(temp);
        }
        self.lost += u64::from(judged.reading.lost);
        self.flags = self.flags.and(judged.flags);
    }

    /// Middle of the samples, s.
    fn t_s(&self) -> f64 {
        (self.first_ns + self.last_ns) as f64 * 0.5e-9
    }
}

/// Writes corrected rows.
struct Rows {
    out: BufWriter<Stdout>,
    form: Form,
    axis: Axis,
    corrector: Corrector<Vec<Correction>>,
    id: String,
    flush_each: bool,
    warned: Warned,
}

#[derive(Default)]
struct Warned {
    span: bool,
    flags: Flags,
}

#[derive(Serialize)]
struct Row<'a> {
    t_s: f64,
    rate_dps: Option<f64>,
    temp_c: f64,
    lost: u64,
    calibration: &'a str,
    flags: String,
}

impl Rows {
    fn new(form: Form, axis: Axis, calibration: &Calibration, flush_each: bool) -> Result<Self> {
        let mut out = BufWriter::with_capacity(1 << 16, Stdout::lock());
        if let Form::Csv = form {
            writeln!(out, "t_s,rate_dps,temp_c,lost,calibration,flags")?;
        }
        let (corrector, id) = (corrector(calibration)?, calibration.id());
        Ok(Self { out, form, axis, corrector, id, flush_each, warned: Warned::default() })
    }

    /// Writes the row of these samples and empties the mean. Before the first temperature there is nothing to correct
    /// with.
    fn write(&mut self, mean: &mut Mean) -> Result<()> {
        let Axis { rate, temp, .. } = &self.axis;
        let corrected = self.corrector.take(mean.rate.mean(rate), mean.temp.mean(temp));
        if let Corrected { temp_c: Some(temp_c), rate_dps, extrapolated } = corrected
            && !mean.is_empty()
        {
            self.watch(extrapolated, mean.flags);
            let flags = mean.flags.to_string();
            let row = Row { t_s: mean.t_s(), rate_dps, temp_c, lost: mean.lost, calibration: &self.id, flags };
            match self.form {
                Form::Csv => row.csv(&mut self.out)?,
                Form::Jsonl => row.jsonl(&mut self.out)?,
            }
            if self.flush_each {
                self.out.flush()?;
            }
            *mean = Mean::default();
        }
        Ok(())
    }

    fn watch(&mut self, extrapolated: bool, flags: Flags) {
        if extrapolated && !self.warned.span {
            let said = self.corrector.warning().map(|warning| warning.with(flag).to_string());
            warn(said.as_slice());
            self.warned.span = true;
        }
        let new = flags != Flags::NONE && !self.warned.flags.has(flags);
        if new {
            warn(&[format!("readings that are not to be believed ({flags}) are left out; their rows are flagged")]);
            self.warned.flags = self.warned.flags.and(flags);
        }
    }
}

impl Row<'_> {
    fn csv(&self, out: &mut impl Write) -> io::Result<()> {
        let Self { t_s, rate_dps, temp_c, lost, calibration, flags } = self;
        write!(out, "{t_s:.6},")?;
        rate_dps.map_or(Ok(()), |rate_dps| write!(out, "{rate_dps:.6}"))?;
        writeln!(out, ",{temp_c:.4},{lost},{calibration},{flags}")
    }

    fn jsonl(&self, out: &mut impl Write) -> Result<()> {
        serde_json::to_writer(&mut *out, self).map_err(io::Error::from)?;
        Ok(out.write_all(b"\n")?)
    }
}
