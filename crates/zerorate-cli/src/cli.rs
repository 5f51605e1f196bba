//! The command line: what every command is called and what they share. Each command's own options stand in its file.

use crate::commands::{
    allan::AllanArgs,
    calibrate::{CalibrateArgs, RecalibrateArgs},
    capture::CaptureArgs,
    chamber::ChamberArgs,
    correct::CorrectArgs,
    explain::ExplainArgs,
    export::ExportArgs,
    imu::ImuArgs,
    probe::ProbeArgs,
    repair::RepairArgs,
    report::ReportArgs,
    serve::ServeArgs,
    stream::StreamArgs,
    twin::{self, TwinArgs},
    verify::VerifyArgs,
};
use crate::memory;
use crate::output::Outputs;
use crate::part::PartArgs;
use anyhow::Result;
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use zerorate_data::limits::{self, Bytes};
use zerorate_host::{DeviceSpec, Sampling, Setup};

/// Takes an ADIS16130 gyroscope from its pins to a bias-free angular rate, and tells how well it did so.
#[derive(Parser, Debug)]
#[command(
    name = "zerorate",
    version,
    max_term_width = 110,
    after_help = "Data goes to stdout, progress and messages to stderr.\n\
        Exit code: 0 done, 1 failed, 2 usage, 3 the measurement was refused.\n\n\
        First steps, without any hardware:\n  \
        zerorate probe                                  look at the simulated part\n  \
        zerorate calibrate -o unit.toml --serial SN17   calibrate it, 53 simulated minutes in seconds\n  \
        zerorate stream --cal unit.toml --serial SN17 --duration 10s --rate 10"
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,

    /// What reading files may take of the machine's memory, such as 512M or 2G [default: half of it]. A file takes at
    /// most 256 MiB plus 256 times its size on disk, whatever is given here.
    #[arg(long, global = true, value_name = "SIZE", help_heading = "Limits")]
    pub max_memory: Option<Bytes>,
}

impl Cli {
    /// Puts the limits in force.
    pub fn set_limits(&self) {
        if let Some(bytes) = self.max_memory.or_else(memory::half) {
            limits::set_max_memory(bytes);
        }
    }

    /// The files of unknown origin that the command reads.
    pub fn foreign_files(&self) -> Vec<&Path> {
        match &self.command {
            Command::Allan(args) => args.files.iter().map(PathBuf::as_path).collect(),
            Command::Imu(args) => vec![&args.log],
            Command::Correct(args) => vec![&args.capture],
            Command::Recalibrate(args) => vec![&args.capture],
            Command::Verify(args) => args.files.iter().map(PathBuf::as_path).collect(),
            Command::Repair(args) => vec![&args.capture],
            Command::Capture(args) => args.device.file().into_iter().collect(),
            Command::Chamber(args) => args.device.file().into_iter().collect(),
            Command::Calibrate(args) => args.device.file().into_iter().collect(),
            Command::Stream(args) => args.device.file().into_iter().collect(),
            Command::Probe(args) => args.device.file().into_iter().collect(),
            Command::Serve(args) => args.source.file().into_iter().collect(),
            _ => Vec::new(),
        }
    }
}

#[derive(Subcommand, Debug)]
pub enum Command {
    Probe(ProbeArgs),
    Capture(CaptureArgs),
    Calibrate(CalibrateArgs),
    Recalibrate(RecalibrateArgs),
    Chamber(ChamberArgs),
    Stream(StreamArgs),
    Correct(CorrectArgs),
    Verify(VerifyArgs),
    Repair(RepairArgs),
    Export(ExportArgs),
    Report(ReportArgs),
    Allan(AllanArgs),
    Imu(ImuArgs),
    Serve(ServeArgs),
    #[command(after_help = twin::keys_help())]
    Twin(TwinArgs),
    Explain(ExplainArgs),
    /// Prints the completion script for a shell.
    ///
    /// For example: zerorate completions bash > /etc/bash_completion.d/zerorate
    Completions {
        /// The shell to complete for.
        shell: Shell,
    },
    /// Prints the manual page, all commands in one (roff): zerorate man | man -l -
    Man,
}

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
        Ok(Setup { sampling: sampling.plain(), part: self.part.named(outputs)?, air: None })
    }

    /// The file that is read, where the device is a recording.
    pub fn file(&self) -> Option<&Path> {
        self.device.file()
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }
}
