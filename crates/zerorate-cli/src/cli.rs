//! The command line: all commands and the option that they share. Most commands define their options in their own
//! files.

use crate::commands::{
    allan::{self, AllanArgs},
    calibrate::{self, CalibrateArgs, RecalibrateArgs},
    capture::{self, CaptureArgs},
    chamber::{self, ChamberArgs},
    correct::{self, CorrectArgs},
    explain::{self, ExplainArgs},
    export::{self, ExportArgs},
    help::{self, HelpArgs},
    imu::{self, ImuArgs},
    man,
    parts::{self, PartsArgs},
    probe::{self, ProbeArgs},
    repair::{self, RepairArgs},
    report::{self, ReportArgs},
    serve::{self, ServeArgs},
    stream::{self, StreamArgs},
    tempcal::{self, TempcalArgs},
    twin,
    verify::{self, VerifyArgs},
};
use crate::memory;
use crate::output::print;
use crate::reference;
use anyhow::Result;
use clap::builder::Styles;
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use zerorate_input::limits::{self, Bytes};

/// Measure the noise of any gyroscope, and find and remove the bias of an ADIS16130.
#[derive(Parser, Debug)]
#[command(
    name = "zerorate",
    version,
    max_term_width = 110,
    disable_help_subcommand = true,
    help_template = template(),
    after_help = "Data goes to stdout, progress and messages to stderr.\n\
        Exit code: 0 done, 1 failed, 2 usage, 3 the measurement was refused.\n\n\
        First steps, without any hardware:\n  \
        zerorate probe                                  check the simulated sensor\n  \
        zerorate calibrate -o unit.toml --serial SN17   calibrate it: 53 simulated minutes in seconds\n  \
        zerorate stream --cal unit.toml --serial SN17 --duration 10s --rate 10"
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,

    /// Memory that reading files may use, such as 512M or 2G [default: half of the machine's]. A file never uses more
    /// than 256 MiB plus 256 times its size on disk.
    #[arg(long, global = true, value_name = "SIZE", help_heading = "Limits")]
    pub max_memory: Option<Bytes>,
}

impl Cli {
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
            Command::Parts(args) => parts::run(args),
            Command::Export(args) => export::run(args),
            Command::Report(args) => report::run(args),
            Command::Allan(args) => allan::run(args),
            Command::Imu(args) => imu::run(args),
            Command::Tempcal(args) => tempcal::run(args),
            Command::Serve(args) => serve::run(args),
            Command::Twin => twin::run(),
            Command::Help(args) => help::run(args, Self::command()),
            Command::Completions { shell } => man::completions(*shell, &mut Self::command()),
            Command::Man { markdown: true } => print(&reference::page(Self::command(), &GROUPS)),
            Command::Man { markdown: false } => man::man(Self::command()),
        }
    }

    /// Limits the memory for reading files to `--max-memory`, or else to half of the machine's memory. If the size of
    /// the machine's memory is unknown, the default of the library applies.
    pub fn set_limits(&self) {
        if let Some(bytes) = self.max_memory.or_else(memory::half) {
            limits::set_max_memory(bytes);
        }
    }

    /// Describes the work of a command that reads whole files without a progress bar. `None` for all other commands.
    pub fn activity(&self) -> Option<String> {
        use Command::{Allan, Correct, Imu, Repair, Report, Tempcal, Verify};
        let (Allan(_) | Imu(_) | Tempcal(_) | Correct(_) | Verify(_) | Repair(_) | Report(_)) = self.command else {
            return None;
        };
        let files = self.foreign_files();
        let (first, rest) = files.split_first()?;
        let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        Some(format!("working on {}{more}", first.display()))
    }

    /// The input files of the command that may come from an untrusted source.
    pub fn foreign_files(&self) -> Vec<&Path> {
        match &self.command {
            Command::Allan(args) => args.files.iter().map(PathBuf::as_path).collect(),
            Command::Imu(args) => vec![&args.log],
            Command::Tempcal(args) => args.logs.iter().map(PathBuf::as_path).collect(),
            Command::Correct(args) => vec![&args.capture],
            Command::Recalibrate(args) => vec![&args.capture],
            Command::Verify(args) => args.files.iter().map(PathBuf::as_path).collect(),
            Command::Repair(args) => vec![&args.capture],
            Command::Report(args) => args.capture.iter().map(PathBuf::as_path).collect(),
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
    Tempcal(TempcalArgs),
    Serve(ServeArgs),
    /// List the keys of the simulated sensor
    ///
    /// Every command that reads a sensor takes the twin as `--device twin:KEY=VALUE,…`.
    #[command(after_help = twin::keys_help())]
    Twin,
    Explain(ExplainArgs),
    Parts(PartsArgs),
    Help(HelpArgs),
    /// Print the completion script of a shell.
    ///
    /// For example: zerorate completions bash > /etc/bash_completion.d/zerorate
    Completions {
        /// The shell to complete for.
        shell: Shell,
    },
    /// Print the manual page of all commands (roff): zerorate man | man -l -
    Man {
        /// Print it in Markdown.
        #[arg(long)]
        markdown: bool,
    },
}

/// The commands by purpose, in the order of `zerorate --help`.
pub const GROUPS: [(&str, &[&str]); 6] = [
    ("Look at a sensor", &["probe", "serve", "twin"]),
    ("Calibrate it", &["calibrate", "recalibrate", "chamber"]),
    ("Use a calibration", &["stream", "correct", "export", "report"]),
    ("Analyse a log", &["allan", "imu", "tempcal"]),
    ("Record and check files", &["capture", "verify", "repair"]),
    ("Other", &["explain", "parts", "help", "completions", "man"]),
];

fn template() -> String {
    let styles = Styles::styled();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let commands = Command::augment_subcommands(clap::Command::new("zerorate"));
    let mut text = "{about-with-newline}\n{usage-heading} {usage}\n".to_owned();
    for (group, names) in GROUPS {
        // writing to a string cannot fail
        let _ = writeln!(text, "\n{header}{group}:{header:#}");
        for name in names {
            let about = commands.find_subcommand(name).and_then(clap::Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            let _ = writeln!(text, "  {literal}{name:<12}{literal:#} {about}");
        }
    }
    text + &format!("\n{header}Options:{header:#}\n") + "{options}{after-help}"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_capture_of_a_report_is_a_foreign_file() {
        let report = Cli::try_parse_from(["zerorate", "report", "unit.toml", "--capture", "rest.csv"]);
        let report = report.expect("a report");
        assert_eq!(report.foreign_files(), [Path::new("rest.csv")]);
        assert_eq!(report.activity().as_deref(), Some("working on rest.csv"));
    }

    #[test]
    fn every_command_is_in_one_group_and_on_one_line() {
        let cli = Cli::command();
        let mut commands: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        commands.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(grouped, commands);
        for command in cli.get_subcommands() {
            let about = command.get_about().map(ToString::to_string).unwrap_or_default();
            assert!((10..=80).contains(&about.chars().count()), "{}: {about}", command.get_name());
        }
    }
}
