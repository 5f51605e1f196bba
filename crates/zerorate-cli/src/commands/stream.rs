//! `zerorate stream`: the corrected rate, live.

use super::correct::{extrapolation, load};
use super::serial::Part;
use super::warn;
use crate::acquire::Acquisition;
use crate::cli::{DeviceArgs, SamplingArgs};
use crate::device::Device;
use crate::duration::Seconds;
use crate::exit::Usage;
use crate::output::{Outputs, Stdout};
use adis16130::Sample;
use anyhow::{Result, bail, ensure};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use zerorate::{Calibration, CodeSum};

/// Prints the corrected rate as it comes: columns t_s, rate_dps, temp_c, lost, calibration.
///
/// t_s counts from the first sample; lost counts the samples lost since the row before; calibration names the
/// calibration that was applied. Ends after --duration, at the end of a replay, on Ctrl-C, or when the reader of its
/// output goes away. On the twin give --duration, or --realtime for rows at the speed of a real part.
#[derive(Args, Debug)]
pub struct StreamArgs {
    #[command(flatten)]
    device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// The calibration file.
    #[arg(long, value_name = "FILE")]
    cal: PathBuf,

    /// Serial number of the part; a calibration of another serial number is an error.
    #[arg(long, value_name = "SN")]
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
    check_serial(args, acquisition.device(), &calibration)?;
    acquisition.device().initialise()?;
    let mut rows = Rows::new(args.format, &calibration, acquisition.is_paced())?;
    let mut mean = Mean::default();
    let ends_after_ns = args.duration.map_or(u64::MAX, Seconds::nanos);
    let mut first_ns = None;
    while let Some(sample) = acquisition.next()? {
        let t_ns = sample.t_ns - *first_ns.get_or_insert(sample.t_ns);
        if mean.belongs_to_next(t_ns / period_ns) {
            rows.write(&mut mean)?;
        }
        if t_ns >= ends_after_ns {
            break;
        }
        mean.push(t_ns, t_ns / period_ns, &sample);
    }
    if args.rate.is_none() {
        rows.write(&mut mean)?;
    }
    Ok(rows.out.flush()?)
}

/// A serial number that is given must be that of the calibration, and that of the recording where one is read.
fn check_serial(args: &StreamArgs, device: &Device, calibration: &Calibration) -> Result<()> {
    let (given, recorded) = (args.serial.as_deref(), device.info(None, None).serial);
    if let (Some(given), Some(recorded)) = (given, &recorded) {
        ensure!(given == recorded, "{} was recorded from part {recorded}, not from part {given}", args.device.device);
    }
    if let (Some(given), None) = (given, &calibration.serial) {
        bail!("{} is the calibration of a part without a serial number, not of part {given}", args.cal.display());
    }
    let name = args.device.device.to_string();
    let part =
        Part { name: &name, serial: given.or(recorded.as_deref()), advice: "give --serial SN to have it checked" };
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
    first_ns: u64,
    last_ns: u64,
    rate: CodeSum,
    temp: CodeSum,
    lost: u64,
    out_of_range: bool,
}

impl Mean {
    fn is_empty(&self) -> bool {
        self.rate.count() == 0
    }

    #[inline]
    fn belongs_to_next(&self, slot: u64) -> bool {
        !self.is_empty() && slot != self.slot
    }

    #[inline]
    fn push(&mut self, t_ns: u64, slot: u64, sample: &Sample) {
        if self.is_empty() {
            (self.slot, self.first_ns) = (slot, t_ns);
        }
        self.last_ns = t_ns;
        self.rate.push(sample.rate.code24());
        if let Some(temp) = sample.temp {
            self.temp.push(temp.code24());
        }
        self.lost += u64::from(sample.lost);
        self.out_of_range |= sample.status.is_some_and(|status| status.out_of_range());
    }

    /// Middle of the samples, s.
    fn t_s(&self) -> f64 {
        (self.first_ns + self.last_ns) as f64 * 0.5e-9
    }
}

/// Writes corrected rows.
struct Rows<'a> {
    out: BufWriter<Stdout>,
    form: Form,
    calibration: &'a Calibration,
    id: String,
    /// The temperature in force, until the next is read.
    temp_c: Option<f64>,
    flush_each: bool,
    warned: Warned,
}

#[derive(Default)]
struct Warned {
    span: bool,
    range: bool,
}

#[derive(Serialize)]
struct Row<'a> {
    t_s: f64,
    rate_dps: f64,
    temp_c: f64,
    lost: u64,
    calibration: &'a str,
}

impl<'a> Rows<'a> {
    fn new(form: Form, calibration: &'a Calibration, flush_each: bool) -> Result<Self> {
        let mut out = BufWriter::with_capacity(1 << 16, Stdout::lock());
        if let Form::Csv = form {
            writeln!(out, "t_s,rate_dps,temp_c,lost,calibration")?;
        }
        let id = calibration.id();
        Ok(Self { out, form, calibration, id, temp_c: None, flush_each, warned: Warned::default() })
    }

    /// Writes the row of these samples and empties the mean. Before the first temperature there is nothing to correct with.
    fn write(&mut self, mean: &mut Mean) -> Result<()> {
        self.temp_c = mean.temp.temp_c().or(self.temp_c);
        if let (Some(temp_c), Some(rate_dps)) = (self.temp_c, mean.rate.rate_dps()) {
            self.watch(temp_c, mean.out_of_range);
            let rate_dps = self.calibration.correction.apply(rate_dps, temp_c);
            let row = Row { t_s: mean.t_s(), rate_dps, temp_c, lost: mean.lost, calibration: &self.id };
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

    fn watch(&mut self, temp_c: f64, out_of_range: bool) {
        let outside = if self.warned.span { None } else { extrapolation(self.calibration, temp_c, temp_c) };
        if let Some(extrapolated) = outside {
            warn(&[extrapolated]);
            self.warned.span = true;
        }
        if out_of_range && !self.warned.range {
            warn(&["the rate is out of range (F-35): rows from here on may be wrong".to_owned()]);
        }
        self.warned.range |= out_of_range;
    }
}

impl Row<'_> {
    fn csv(&self, out: &mut impl Write) -> io::Result<()> {
        let Self { t_s, rate_dps, temp_c, lost, calibration } = self;
        writeln!(out, "{t_s:.6},{rate_dps:.6},{temp_c:.4},{lost},{calibration}")
    }

    fn jsonl(&self, out: &mut impl Write) -> Result<()> {
        serde_json::to_writer(&mut *out, self).map_err(io::Error::from)?;
        Ok(out.write_all(b"\n")?)
    }
}
