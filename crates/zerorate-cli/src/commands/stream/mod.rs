//! `zerorate stream`: the corrected rate, live.

mod track;

use super::correct::load;
use super::serial::{Part, one_line};
use crate::device::{DeviceArgs, SamplingArgs};
use crate::exit::{Refused, Usage};
use crate::output::{Outputs, Stdout, warn};
use crate::wording::coded;
use anyhow::{Result, bail, ensure};
use clap::{Args, ValueEnum};
use serde::{Serialize, Serializer};
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use track::{TrackArgs, TrackedRow, Tracking};
use zerorate::health::{Flags, Judged};
use zerorate::{Axis, Calibration, CodeSum, Correction, Corrector};
use zerorate_host::DeviceInfo;
use zerorate_jobs::Acquisition;
use zerorate_record::believed;
use zerorate_view::duration::Seconds;

/// Prints the corrected rate as it comes: columns t_s, rate_dps, temp_c, lost, calibration, flags. A part with several
/// axes has a column NAME_dps for each.
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

    #[command(flatten)]
    tracking: TrackArgs,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Form {
    Csv,
    Jsonl,
}

pub fn run(args: &StreamArgs) -> Result<()> {
    let mut outputs = Outputs::without_force();
    let calibration = load(&args.cal, &mut outputs)?;
    let period_ns = args.rate.map(period_ns).transpose()?.unwrap_or(1);
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    let mut acquisition = args.device.open(setup)?;
    check_serial(args, acquisition.facts(), &calibration)?;
    acquisition.initialise()?;
    let created = acquisition.facts().info.created.clone();
    let tracking = args.tracking.begin(acquisition.part(), &calibration, &created, &mut outputs)?;
    let mut rows = Rows::new(args.format, acquisition.part(), &calibration, acquisition.is_paced(), tracking)?;
    let mut mean = Mean::default();
    let mut judged = Vec::new();
    let ends_after_ns = args.duration.map_or(u64::MAX, Seconds::nanos);
    let mut first_ns = None;
    while acquisition.next_judged(&mut judged)? {
        let now_ns = judged.first().map_or(0, |first| first.reading.t_ns);
        let t_ns = now_ns - *first_ns.get_or_insert(now_ns);
        if mean.belongs_to_next(t_ns / period_ns) {
            rows.write(&mut mean)?;
        }
        if t_ns >= ends_after_ns {
            break;
        }
        mean.push(t_ns, t_ns / period_ns, &judged);
        if let Some(tracking) = &mut rows.tracking {
            tracking.push(t_ns, &judged);
        }
        if acquisition.frozen().is_some() {
            return stop_frozen(&acquisition, &mut rows, &mut mean);
        }
    }
    if args.rate.is_none() {
        rows.write(&mut mean)?;
    }
    rows.finish()?;
    warn(&acquisition.disbelief().map(coded).collect::<Vec<_>>());
    Ok(())
}

/// The row that says so, then the end: nothing after it would be a measurement.
#[cold]
fn stop_frozen(acquisition: &Acquisition, rows: &mut Rows, mean: &mut Mean) -> Result<()> {
    mean.flags = mean.flags.and(Flags::FROZEN);
    rows.write(mean)?;
    rows.finish()?;
    let frozen = acquisition.frozen();
    let why = frozen.map(|frozen| believed::frozen_text(&frozen, acquisition.start_ns())).unwrap_or_default();
    Err(Refused::new("frozen", why).into())
}

/// A serial number that is given must be that of the calibration, and that of the recording where one is read.
fn check_serial(args: &StreamArgs, facts: &DeviceInfo, calibration: &Calibration) -> Result<()> {
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
    /// Of each axis.
    rates: Vec<CodeSum>,
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
    fn push(&mut self, t_ns: u64, slot: u64, axes: &[Judged]) {
        if self.is_empty() {
            (self.slot, self.first_ns) = (slot, t_ns);
        }
        self.last_ns = t_ns;
        self.readings += 1;
        self.rates.resize_with(axes.len(), CodeSum::default);
        for (sum, judged) in self.rates.iter_mut().zip(axes) {
            if let Some(rate) = judged.rate() {
                sum.push(rate);
            }
            self.flags = self.flags.and(judged.flags);
        }
        // temperature and losses are those of all axes
        if let Some(first) = axes.first() {
            if let Some(temp) = first.temp() {
                self.temp.push(temp);
            }
            self.lost += u64::from(first.reading.lost);
        }
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
    axes: Vec<Axis>,
    /// Of the columns with their rates.
    names: Vec<String>,
    corrector: Corrector<Vec<Correction>>,
    id: String,
    flush_each: bool,
    warned: Warned,
    tracking: Option<Tracking>,
}

#[derive(Default)]
struct Warned {
    span: bool,
    flags: Flags,
}

#[derive(Serialize)]
struct Row<'a> {
    t_s: f64,
    /// By the names of their columns.
    #[serde(flatten)]
    rates_dps: Rates<'a>,
    temp_c: f64,
    lost: u64,
    calibration: &'a str,
    flags: String,
    #[serde(flatten)]
    tracked: Option<TrackedRow>,
}

/// Corrected rates of all axes.
struct Rates<'a> {
    names: &'a [String],
    rates_dps: Vec<Option<f64>>,
}

impl Serialize for Rates<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.names.iter().zip(&self.rates_dps))
    }
}

impl Rows {
    fn new(
        form: Form,
        part: &zerorate::Part,
        calibration: &Calibration,
        flush_each: bool,
        tracking: Option<Tracking>,
    ) -> Result<Self> {
        let mut out = BufWriter::with_capacity(1 << 16, Stdout::lock());
        let names = match &*part.axes {
            [_] => vec!["rate_dps".to_owned()],
            axes => axes.iter().map(|axis| format!("{}_dps", axis.name)).collect(),
        };
        if let Form::Csv = form {
            let tracked = tracking.as_ref().map(Tracking::headings).unwrap_or_default();
            writeln!(out, "t_s,{},temp_c,lost,calibration,flags{tracked}", names.join(","))?;
        }
        let corrector = calibration.corrector(&part.name, part.axes.iter().map(|axis| &*axis.name))?;
        let (axes, id) = (part.axes.iter().map(|axis| axis.axis).collect(), calibration.id());
        Ok(Self { out, form, axes, names, corrector, id, flush_each, warned: Warned::default(), tracking })
    }

    /// Writes the row of these samples and empties the mean. Before the first temperature there is nothing to correct
    /// with.
    fn write(&mut self, mean: &mut Mean) -> Result<()> {
        // all axes have the same temperature
        self.corrector.read(self.axes.first().and_then(|first| mean.temp.mean(&first.temp)));
        if let Some(temp_c) = self.corrector.temp_c()
            && !mean.is_empty()
        {
            self.watch(self.corrector.is_extrapolated(), mean.flags);
            let flags = mean.flags.to_string();
            let means = mean.rates.iter().zip(&self.axes).map(|(sum, axis)| sum.mean(&axis.rate)).enumerate();
            let mut rates_dps: Vec<_> = means.map(|(index, rate)| self.corrector.correct(index, rate)).collect();
            let tracked = self.tracking.as_ref().map(|tracking| {
                let corrections = (0..rates_dps.len()).map(|axis| self.corrector.correct(axis, Some(0.0)));
                tracking.row(temp_c, &corrections.map(Option::unwrap_or_default).collect::<Vec<_>>())
            });
            for (rate_dps, change_dps) in rates_dps.iter_mut().zip(tracked.iter().flat_map(|row| &row.changes_dps)) {
                *rate_dps = rate_dps.map(|rate_dps| rate_dps - change_dps);
            }
            let rates_dps = Rates { names: &self.names, rates_dps };
            let (t_s, lost) = (mean.t_s(), mean.lost);
            let row = Row { t_s, rates_dps, temp_c, lost, calibration: &self.id, flags, tracked };
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

    fn finish(&mut self) -> Result<()> {
        self.out.flush()?;
        self.tracking.as_mut().map_or(Ok(()), |tracking| tracking.finish(self.corrector.temp_c()))
    }

    fn watch(&mut self, extrapolated: bool, flags: Flags) {
        if extrapolated && !self.warned.span {
            warn(self.corrector.warning().map(coded).as_slice());
            self.warned.span = true;
        }
        let new = flags != Flags::NONE && !self.warned.flags.has(flags);
        if new {
            warn(&[format!(
                "not-believed: readings that are not to be believed ({flags}) are left out; their rows are flagged"
            )]);
            self.warned.flags = self.warned.flags.and(flags);
        }
    }
}

impl Row<'_> {
    fn csv(&self, out: &mut impl Write) -> io::Result<()> {
        let Self { t_s, rates_dps: Rates { rates_dps, .. }, temp_c, lost, calibration, flags, tracked } = self;
        write!(out, "{t_s:.6}")?;
        for rate_dps in rates_dps {
            write!(out, ",")?;
            rate_dps.map_or(Ok(()), |rate_dps| write!(out, "{rate_dps:.6}"))?;
        }
        write!(out, ",{temp_c:.4},{lost},{calibration},{flags}")?;
        tracked.as_ref().map_or(Ok(()), |tracked| tracked.csv(out))?;
        writeln!(out)
    }

    fn jsonl(&self, out: &mut impl Write) -> Result<()> {
        serde_json::to_writer(&mut *out, self).map_err(io::Error::from)?;
        Ok(out.write_all(b"\n")?)
    }
}
