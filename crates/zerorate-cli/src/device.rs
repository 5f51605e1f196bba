//! Which part is read, and how, as options.

use crate::interrupt;
use crate::output::{Outputs, warn};
use crate::part::PartArgs;
use crate::wording::flag;
use anyhow::Result;
use clap::Args;
use std::ops::Deref;
use std::path::Path;
use zerorate_host::{DeviceSpec, Pace, Sampling, Setup};
use zerorate_jobs::{Acquisition, Tell};

/// Which part to read.
#[derive(Args, Debug)]
pub struct SourceArgs {
    /// The part to read: twin: (simulated), twin:KEY=VALUE,… (see `zerorate twin`; axes=3: three of them on one clock,
    /// with the seeds that follow each other, as the axes of one part), replay:FILE (a capture,
    /// or with --part a log of that part, as docs/formats/part.md describes it),
    /// spi:/dev/spidevB.C?rdy=gpiochipN:LINE (Linux; options hz=SCLK, mclk=HZ), iio:iio:deviceN
    /// (any gyroscope that a driver of the Linux kernel reads: through its buffer where it has one, else polled 100
    /// times a second, or hz=POLLS times), bridge:/dev/ttyACM0 (a microcontroller in between; options
    /// hz=SCLK, mclk=HZ, baud=N) or tcp:HOST:PORT (the same over a socket). All but replay: and iio: take
    /// framing=command|byte (how CS frames the bytes), width=24|16, fw=RATE[:TEMP] and chop=0|1 (the conversion
    /// words), edge=falling|rising (of RDY; rising behind an inverter), and divided=N (a counter in the line lets
    /// every N-th edge of RDY through: tip 2 of the note). All but replay: take roa=10nf or bandwidth_hz=HZ (the
    /// bandwidth, where it is not the part's own; the twin knows roa alone). They stand after ? and & as in
    /// spi:…?rdy=gpiochip0:25&width=16, or are keys of twin: .
    #[arg(short, long, value_name = "DEV", default_value = "twin:")]
    pub device: DeviceSpec,

    #[command(flatten)]
    pub part: PartArgs,
}

/// Which part to read, and how fast its time goes where it is not that of the clock.
#[derive(Args, Debug)]
pub struct DeviceArgs {
    #[command(flatten)]
    pub source: SourceArgs,

    /// Pace simulated or replayed time to the wall clock; without it they run as fast as they can.
    #[arg(long)]
    pub realtime: bool,
}

impl SourceArgs {
    /// How it is to be read, and from then on one of the run's inputs. No command opens a device without it.
    pub fn setup(&self, sampling: SamplingArgs, outputs: &mut Outputs) -> Result<Setup> {
        self.file().map_or(Ok(()), |file| outputs.reads(file))?;
        Ok(Setup { sampling: sampling.plain(), part: self.part.named(outputs)?, air: None, names: flag })
    }

    /// The file that is read, where the device is a recording.
    pub fn file(&self) -> Option<&Path> {
        self.device.file()
    }
}

impl DeviceArgs {
    /// Opens the device and, from here on, takes Ctrl-C as the wish to end cleanly.
    pub fn open(&self, setup: Setup) -> Result<Acquisition> {
        self.open_at(setup, false)
    }

    /// The same, in real time for a person who looks on.
    pub fn open_at(&self, setup: Setup, is_watched: bool) -> Result<Acquisition> {
        interrupt::listen();
        let pace = if self.realtime || is_watched { Pace::RealTime } else { Pace::Free };
        Acquisition::open(&self.device, setup, pace, interrupt::stop(), tell())
    }
}

/// Prints what a device has to say.
pub fn tell() -> Tell {
    Box::new(|warning| warn(&[warning.coded()]))
}

impl Deref for DeviceArgs {
    type Target = SourceArgs;

    fn deref(&self) -> &SourceArgs {
        &self.source
    }
}

/// How often the part is read. A replayed capture has decided this already.
#[derive(Args, Debug, Clone, Copy)]
pub struct SamplingArgs {
    /// Read the temperature with every N-th rate sample, when the host cannot read both each time [default: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub every_temp: Option<u16>,

    /// Read on every N-th data-ready edge only; the rate that results is measured and stated [default: 1]. Where a
    /// counter divides the line itself, say so in the address (divided=N); a divider then counts what it lets through.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub divider: Option<u16>,
}

impl SamplingArgs {
    fn plain(self) -> Sampling {
        Sampling { every_temp: self.every_temp, divider: self.divider }
    }
}
