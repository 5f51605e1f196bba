//! The command line: what every command is called. Each command's own options stand in its file.

use crate::commands::{
    allan::{self, AllanArgs},
    calibrate::{self, CalibrateArgs, RecalibrateArgs},
    capture::{self, CaptureArgs},
    chamber::{self, ChamberArgs},
    correct::{self, CorrectArgs},
    explain::{self, ExplainArgs},
    export::{self, ExportArgs},
    imu::{self, ImuArgs},
    man,
    probe::{self, ProbeArgs},
    repair::{self, RepairArgs},
    report::{self, ReportArgs},
    serve::{self, ServeArgs},
    stream::{self, StreamArgs},
    twin::{self, TwinArgs},
    verify::{self, VerifyArgs},
};
use crate::memory;
use anyhow::Result;
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use std::path::{Path, PathBuf};
use zerorate_record::limits::{self, Bytes};

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
    /// Carries out what the command line asks for.
    pub fn run(&self) -> Result<()> {
        match &self.command {
            Command::Probe(args) => probe::run(args),
            Command::Capture(args) => capture::run(args),
            Command::Calibrate(args) => calibrate::run(args),
            Command::Recalibrate(args) => calibrate::run_again(args),
            Command::Chamber(args) => chamber::run(args),
            Command::Stream(args) => stream::run(args),
            Command::Correct(args) => correct::run(args),
            Command::Verify(args) => verify::run(args),
            Command::Repair(args) => repair::run(args),
            Command::Explain(args) => explain::run(args),
            Command::Export(args) => export::run(args),
            Command::Report(args) => report::run(args),
            Command::Allan(args) => allan::run(args),
            Command::Imu(args) => imu::run(args),
            Command::Serve(args) => serve::run(args),
            Command::Twin(args) => twin::run(args),
            Command::Completions { shell } => man::completions(*shell, &mut Self::command()),
            Command::Man => man::man(Self::command()),
        }
    }

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
            Command::Serve(args) => args.file().into_iter().collect(),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }
}
