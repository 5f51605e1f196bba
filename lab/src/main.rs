//! The tasks of `cargo xtask` that need more than a compiler: campaigns, rigs, benchmarks and distribution.
//!
//! To add a command: write a module with `#[derive(clap::Args)] pub struct NameArgs` and
//! `pub fn run(args: &NameArgs)`, and give it a variant in [`Task`].

mod app;
mod bench_peers;
mod bench_serve;
mod bench_web;
mod book;
mod bridge;
mod c;
mod coverage;
mod coverage_allan;
mod dist;
mod firmware;
mod iiod;
mod methods;
mod rig;
mod seeds;
mod server;
mod trial;
mod trust;
mod uf2;

use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;
use xtask::{targets, tools, venv, web};

#[derive(Parser)]
#[command(bin_name = "cargo xtask", about, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Calibrate many units of the twin and compare the stated uncertainties with their truth
    Coverage(coverage::CoverageArgs),
    /// Calibrate many units by every method, compare all with their truth, and write docs/reference/methods.md
    Methods(methods::MethodsArgs),
    /// Simulate records at rest and compare the fitted noise coefficients with their truth
    CoverageAllan(coverage_allan::CoverageAllanArgs),
    /// Time the Allan deviation beside its peers, which it installs, and print ratios
    BenchPeers(bench_peers::BenchPeersArgs),
    /// Serve the twin to 20 pages and 4 clients of libiio while it is recorded, and print the cost
    BenchServe(bench_serve::BenchServeArgs),
    /// Time the core in WebAssembly beside the program, and the page's first picture and its size
    BenchWeb,
    /// Run driver, twin and correction on an emulated Cortex-M4F; count instructions and bytes
    Firmware(firmware::FirmwareArgs),
    /// Read the twin through a bridge's firmware on an emulated Cortex-M4F: socket, serial port, damaged and pulled
    /// cable
    Bridge(app::ProgramArgs),
    /// Check the C interface: library, and C against Rust on the host and on an emulated Cortex-M4F
    C(c::CArgs),
    /// Read the libiio server with libiio's own clients, and with pyadi-iio
    Iiod,
    /// Boot a stock Linux kernel in QEMU with the twin as hardware, and read it there
    Rig(app::ProgramArgs),
    /// Break the part, the files and the program at random moments, and look for results that are wrong and silent
    Trust(trust::TrustArgs),
    /// Render docs/ as a book, run its commands and follow its links
    Book(book::BookArgs),
    /// Make the distribution in target/dist: programs, packages, wheels, libraries, firmware, pictures, licences
    Dist(dist::DistArgs),
    /// Convert an image of the bridge to the file for a Pico, or for a board with TinyUF2
    Uf2(uf2::Uf2Args),
    /// Write the licences of the software in the page, for `cargo xtask web --site`
    #[command(hide = true)]
    PageLicences { out: PathBuf },
}

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Coverage(args) => coverage::run(&args),
        Task::Methods(args) => methods::run(&args),
        Task::CoverageAllan(args) => coverage_allan::run(&args),
        Task::BenchPeers(args) => bench_peers::run(&args),
        Task::BenchServe(args) => bench_serve::run(&args),
        Task::BenchWeb => bench_web::run(),
        Task::Firmware(args) => firmware::run(&args),
        Task::Bridge(args) => bridge::run(&args),
        Task::C(args) => c::run(&args),
        Task::Iiod => iiod::run(),
        Task::Rig(args) => rig::run(&args),
        Task::Trust(args) => trust::run(&args),
        Task::Book(args) => book::run(&args),
        Task::Dist(args) => dist::run(&args),
        Task::Uf2(args) => uf2::run(&args),
        Task::PageLicences { out } => dist::write_licences_of_page(&out),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::CommandFactory;

    #[test]
    fn xtask_knows_each_task() {
        let cli = Cli::command();
        let shown = cli.get_subcommands().filter(|task| !task.is_hide_set());
        let here: Vec<&str> = shown.map(clap::Command::get_name).collect();
        assert_eq!(xtask::lab::TASKS.map(|(name, _)| name).to_vec(), here);
    }
}
