//! `zerorate stream`: prints the corrected rate live.

mod track;

use super::correct::load;
use super::serial::{GIVE, one_line};
use crate::device::{DeviceArgs, SamplingArgs};
use crate::exit::Usage;
use crate::output::{CANNOT_WRITE, Outputs, Stdout, say, warn};
use crate::wording::coded;
use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use serde::Serializer;
use serde_json::json;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use track::{TrackArgs, say_learned};
use zerorate_jobs::stream::{LearnedAxis, Listener, StreamOptions, StreamRow, check_serial, period_ns, stream};
use zerorate_jobs::{Acquisition, JobWarning};
use zerorate_view::duration::Seconds;

/// Print the corrected rate live, as CSV or JSON lines
///
/// The columns are t_s, rate_dps, temp_c, lost, calibration and flags. A part with several axes has a column NAME_dps
/// for each axis. t_s counts from the first sample. lost counts the samples lost since the row before. calibration
/// names the calibration that was applied.
///
/// flags is empty, or names the readings that were left out: impossible, out-of-range, impossible-temperature or
/// frozen, joined by +. A reading is impossible (a bit error) if a part of 300 Hz cannot have made it between its
/// neighbours. A row without any good reading has no rate. This check delays each row by two samples.
///
/// The stream ends after --duration, at the end of a replay, on Ctrl-C, or when the reader of its output leaves. A
/// frozen sensor ends it with exit code 3. On the twin give --duration, or --realtime for rows at the speed of a real
/// sensor.
#[derive(Args, Debug)]
pub struct StreamArgs {
    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// The calibration file.
    #[arg(long, value_name = "FILE")]
    cal: PathBuf,

    /// The serial number of the sensor. A calibration with another serial number is an error.
    #[arg(long, value_name = "SN", value_parser = one_line)]
    serial: Option<String>,

    /// The form of the rows.
    #[arg(long, value_enum, default_value = "csv")]
    format: RowFormat,

    /// Rows per second [default: 10 on a terminal, a row for each sample elsewhere].
    ///
    /// Each row is the mean of all samples in its interval, without overlap. An incomplete last interval gives no row.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,

    /// Time to stream: 10s, 10m, 1h30m, or seconds [default: until Ctrl-C or the end].
    #[arg(long, value_name = "TIME")]
    duration: Option<Seconds>,

    #[command(flatten)]
    tracking: TrackArgs,
}

/// Number of rows per second that a person can read.
const READABLE_HZ: f64 = 10.0;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RowFormat {
    Csv,
    Jsonl,
}

pub fn run(args: &StreamArgs) -> Result<()> {
    let mut outputs = Outputs::without_force();
    let calibration = load(&args.cal, &mut outputs)?;
    let on_terminal = io::stdout().is_terminal() && args.rate.is_none();
    let rate_hz = args.rate.or(on_terminal.then_some(READABLE_HZ));
    let wrong = |rate_hz| Usage(format!("--rate is {rate_hz}; it must lie between 0.0001 and 1000000 Hz"));
    let period_ns = rate_hz.map(|rate_hz| period_ns(rate_hz).ok_or_else(|| wrong(rate_hz))).transpose()?;
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    if on_terminal {
        say(format_args!("{READABLE_HZ} rows a second, at the speed of the clock; --rate HZ gives others"));
    }
    let acquisition = args.device.open_at(setup, on_terminal)?;
    if args.device.device.is_simulated() {
        say(format_args!("SIMULATED: these are rates of {}", args.device.device));
    }
    let (cal, device) = (args.cal.display().to_string(), args.device.device.to_string());
    let part = (device.as_str(), args.serial.as_deref());
    warn(check_serial(&acquisition, (&cal, &calibration), part, GIVE)?.map(coded).as_slice());
    acquisition.initialise()?;
    let tracking = args.tracking.begin(acquisition.facts(), &calibration, &mut outputs)?;
    let mut rows = RowPrinter::new(args.format, &acquisition, calibration.id(), tracking.is_some())?;
    let options = StreamOptions { period_ns, duration_ns: args.duration.map(Seconds::nanos) };
    stream(acquisition, &calibration, options, tracking, &mut rows)
}

struct RowPrinter {
    out: BufWriter<Stdout>,
    format: RowFormat,
    rates: Vec<String>,
    /// The names of the columns with the tracked bias and its uncertainty, for each axis.
    biases: Vec<String>,
    id: String,
    flush_each: bool,
}

impl RowPrinter {
    fn new(format: RowFormat, acquisition: &Acquisition, id: String, is_tracked: bool) -> Result<Self> {
        let mut out = BufWriter::with_capacity(1 << 16, Stdout::lock());
        let axes = &*acquisition.part().axes;
        let column = |axis: &zerorate::NamedAxis, of: &str| match axes.len() {
            1 => of.to_owned(),
            _ => format!("{}_{of}", axis.name),
        };
        let rates: Vec<String> = match axes {
            [_] => vec!["rate_dps".to_owned()],
            axes => axes.iter().map(|axis| column(axis, "dps")).collect(),
        };
        let bias = |axis| [column(axis, "bias_dps"), column(axis, "u_bias_dps")];
        let biases: Vec<String> = axes.iter().filter(|_| is_tracked).flat_map(bias).collect();
        if let RowFormat::Csv = format {
            let tracked = if is_tracked { format!(",{},phase", biases.join(",")) } else { String::new() };
            writeln!(out, "t_s,{},temp_c,lost,calibration,flags{tracked}", rates.join(",")).context(CANNOT_WRITE)?;
        }
        Ok(Self { out, format, rates, biases, id, flush_each: acquisition.is_paced() })
    }

    fn csv(&mut self, row: &StreamRow) -> io::Result<()> {
        let StreamRow { t_s, rates_dps, temp_c, lost, flags, tracked } = row;
        let (out, id) = (&mut self.out, &self.id);
        write!(out, "{t_s:.6}")?;
        for rate_dps in rates_dps {
            write!(out, ",")?;
            rate_dps.map_or(Ok(()), |rate_dps| write!(out, "{rate_dps:.6}"))?;
        }
        write!(out, ",{temp_c:.4},{lost},{id},{flags}")?;
        if let Some(tracked) = tracked {
            for axis in &tracked.axes {
                write!(out, ",{:.6},{:.6}", axis.bias_dps, axis.tracked.u_dps)?;
            }
            write!(out, ",{}", tracked.phase)?;
        }
        writeln!(out)
    }

    fn jsonl(&mut self, row: &StreamRow) -> io::Result<()> {
        let StreamRow { t_s, rates_dps, temp_c, lost, flags, tracked } = row;
        let rates = self.rates.iter().map(String::as_str).zip(rates_dps.iter().map(|rate_dps| json!(rate_dps)));
        let biases = tracked.iter().flat_map(|tracked| &tracked.axes).flat_map(|of| [of.bias_dps, of.tracked.u_dps]);
        let biases = self.biases.iter().map(String::as_str).zip(biases.map(|value| json!(value)));
        let row = [("temp_c", json!(temp_c)), ("lost", json!(lost)), ("calibration", json!(self.id))];
        let phase = tracked.iter().map(|tracked| ("phase", json!(tracked.phase)));
        let flags = [("flags", json!(flags.to_string()))];
        let all = [("t_s", json!(t_s))].into_iter().chain(rates).chain(row).chain(flags).chain(biases).chain(phase);
        serde_json::Serializer::new(&mut self.out).collect_map(all)?;
        self.out.write_all(b"\n")
    }
}

impl Listener for RowPrinter {
    fn row(&mut self, row: &StreamRow) -> Result<()> {
        let written = match self.format {
            RowFormat::Csv => self.csv(row),
            RowFormat::Jsonl => self.jsonl(row),
        };
        written.context(CANNOT_WRITE)?;
        if self.flush_each { self.end() } else { Ok(()) }
    }

    fn end(&mut self) -> Result<()> {
        self.out.flush().context(CANNOT_WRITE)
    }

    fn warn(&mut self, warning: JobWarning) {
        warn(&[coded(warning)]);
    }

    fn kept_again(&mut self, state: &Path) {
        say(format_args!("what was learned is in {} again", state.display()));
    }

    fn learned(&mut self, learned: &LearnedAxis<'_>) {
        say_learned(learned);
    }
}
