//! The tasks of `cargo xtask` that need more than a compiler: campaigns, emulated hardware, benchmarks, distribution.
//!
//! To add a command: write a module with `#[derive(clap::Args)] pub struct NameArgs` and
//! `pub fn run(args: &NameArgs)`, and give it a variant in [`Task`].

mod app;
mod attacks;
mod bench_peers;
mod bench_serve;
mod bench_web;
mod book;
mod bridge;
mod c;
mod coverage;
mod coverage_allan;
mod coverage_tempcal;
mod dist;
mod endurance;
mod firmware;
mod iiod;
mod killed;
mod methods;
mod proofs;
mod residuals;
mod rig;
mod seeds;
mod server;
mod tracking;
mod trial;
mod trust;
mod twin_usb;

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
    ///
    /// The whole table takes about half an hour on two cores. It is written with its pictures, also with fewer
    /// `--seeds`. `--quick` runs the methods on a few units.
    Methods(methods::MethodsArgs),
    /// Track many units of the twin for a day in four worlds, and print the table of docs/tracking.md
    ///
    /// It takes some minutes on two cores. The worlds differ by the share of the moving time in slow rotations.
    Tracking(tracking::TrackingArgs),
    /// Simulate records at rest and compare the fitted noise coefficients with their truth
    CoverageAllan(coverage_allan::CoverageAllanArgs),
    /// Simulate logs of gyroscopes that warm, and compare their curves over temperature with the truth
    CoverageTempcal(coverage_tempcal::CoverageTempcalArgs),
    /// Time the Allan deviation beside its peers, which it installs, and print ratios
    BenchPeers(bench_peers::BenchPeersArgs),
    /// Serve the twin to 20 pages and 4 clients of libiio while it is recorded, and print what that costs
    ///
    /// It lasts a minute. The recording must be what the twin gives alone, and each client must have got what was
    /// recorded, on a machine however busy. It also prints the cost, and whether real time was kept: the figures of
    /// docs/serve.md. Neither fails the task.
    BenchServe(bench_serve::BenchServeArgs),
    /// Time the core in WebAssembly beside the program, and the page's first picture and its size
    BenchWeb,
    /// Run driver, twin and correction on an emulated Cortex-M4F; count instructions and bytes
    ///
    /// Runs an image in QEMU (apt install qemu-system-arm). If QEMU is missing, the task installs it as root on
    /// Debian; otherwise it skips the run with a message. The task fails if a figure rises by more than 5 % over
    /// docs/reference/footprint.md; `--update` writes that page. A missed goal does not fail the task: the page and
    /// the output mark it as GOAL MISSED.
    Firmware(firmware::FirmwareArgs),
    /// Read the twin through a bridge's firmware on an emulated Cortex-M4F, by socket and by serial port
    ///
    /// The emulator is QEMU (apt install qemu-system-arm), as for `firmware`.
    Bridge(app::ProgramArgs),
    /// Check the C interface: library, and C against Rust on the host and on an emulated Cortex-M4F
    ///
    /// Needs gcc-arm-none-eabi, libnewlib-arm-none-eabi and qemu-system-arm, and without them does the same as
    /// `firmware`: installs them, or says what it skips. After a change of the interface run `cargo xtask codegen`,
    /// which writes the header. The numbers in bindings/c/src/status.rs never change their meaning.
    C(c::CArgs),
    /// Read the libiio server with libiio's own clients, and with pyadi-iio
    ///
    /// The clients are apt's libiio-utils and python3-libiio, and pyadi-iio in an environment below target/. Where
    /// these are missing and cannot be installed, the task says so and passes.
    Iiod,
    /// Boot a stock Linux kernel in QEMU with the twin as hardware, and read it there
    ///
    /// Boots Debian's kernel on Debian and x86-64 (apt install qemu-system-x86 busybox-static cpio kmod xz-utils
    /// acpica-tools); elsewhere it says that it is skipped. It downloads the kernel package, 107 MB, once. It takes
    /// two minutes of wall time, because its sensor keeps that time: run nothing else meanwhile. In the guest,
    /// lab/src/rig/gyro.rs makes a HID gyroscope with three axes for `--device iio:`, beside the ADIS16130. The checks
    /// of that gyroscope hold on a busy machine too.
    ///
    /// The guest gets the program of the test with its libraries. The program that is handed out has none; to try it:
    /// `cargo xtask dist program`, then `cargo xtask rig --program target/dist/zerorate-0.1.0-x86_64-linux`.
    Rig(app::ProgramArgs),
    /// Plug the twin into a virtual machine, as an SPI and GPIO adapter on its USB port
    ///
    /// The adapter is an Intel LJCA (8086:0b63), which the kernel's own drivers bind: usb-ljca, spi-ljca and gpio-ljca
    /// of Linux 6.12. RDY is line 3 of its GPIO chip. Ctrl-C unplugs the twin, and prints what it saw and its true
    /// values as one JSON object. lab/src/twin_usb/README.md has the messages, and the options of QEMU.
    TwinUsb(Box<twin_usb::TwinUsbArgs>),
    /// Break the part, the files and the program at random moments, and look for results that are wrong and silent
    ///
    /// Fails if a result is wrong and silent, and prints the command that repeats that run. The whole campaign, 500
    /// runs of each class, takes about an hour, and `--update` writes docs/reference/reliability.md. Power cuts need
    /// root and loop devices; the task says where these are missing.
    Trust(trust::TrustArgs),
    /// Turn other projects' attacks and test files on the program: HTTP, WebSocket, libiio, MCAP, Arrow, Parquet
    ///
    /// Each case is read right, or refused with a reason; a crash, a hang, other numbers or a second answer fail the
    /// task. Nothing of these projects is carried along. `--data DIR` is a folder with checkouts, each under its own
    /// name; a part whose checkout or tool is missing says so and is skipped. PyArrow, which judges the files, goes
    /// into an environment below target/.
    Attacks(attacks::AttacksArgs),
    /// Serve the twin for long while visitors come and go; set the clock by an hour; fill the disk and free it
    ///
    /// 20 pages and 4 clients of libiio come and go while the twin is served and recorded, faster than real time. The
    /// task fails where memory or descriptors grow, or a sample is not recorded as the twin gives it. Then libfaketime
    /// sets the computer's clock of a server by an hour, forward and back, and a disk in memory (root) fills and is
    /// freed. What is missing here is skipped with a message.
    Endurance(endurance::EnduranceArgs),
    /// Look for undefined behaviour and data races: Miri, AddressSanitizer, UBSan, ThreadSanitizer, valgrind
    ///
    /// `miri`, `asan` and `tsan` need nightly Rust, `miri` and `tsan` with its components miri and rust-src. `asan`
    /// also needs clang, `valgrind` the wheel's environment of `cargo xtask python`. A part whose tools are missing
    /// says so and passes. All parts take most of an hour on one core.
    Proofs(proofs::ProofsArgs),
    /// Make docs/ a book; run its commands, follow its links
    ///
    /// Renders docs/ with mdBook's library, by lab/tools/book, and follows every link. `--check` also runs the
    /// commands of the chapters with the program, and opens three pages in Chromium (apt install chromium). Without
    /// Chromium, where it cannot be installed, the task says that it skips these three and does all the rest.
    Book(book::BookArgs),
    /// Make what is handed out, into target/dist: programs, packages, wheels, libraries, firmware, pictures, licences
    ///
    /// Runs on Debian 12 on x86-64. Root installs the cross compilers; anybody else is told their names. `--check`
    /// tries what lies in target/dist, and needs root. Neither is a step of `ci`: they take an hour. The files that go
    /// into packages lie in packaging/, and xtask/tests/packaging.rs holds them together.
    Dist(dist::DistArgs),
    /// Write the licences of the software in the page, for `cargo xtask web --site`
    #[command(hide = true)]
    PageLicences { out: PathBuf },
}

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Coverage(args) => coverage::run(&args),
        Task::Methods(args) => methods::run(&args),
        Task::Tracking(args) => tracking::run(&args),
        Task::CoverageAllan(args) => coverage_allan::run(&args),
        Task::CoverageTempcal(args) => coverage_tempcal::run(&args),
        Task::BenchPeers(args) => bench_peers::run(&args),
        Task::BenchServe(args) => bench_serve::run(&args),
        Task::BenchWeb => bench_web::run(),
        Task::Firmware(args) => firmware::run(&args),
        Task::Bridge(args) => bridge::run(&args),
        Task::C(args) => c::run(&args),
        Task::Iiod => iiod::run(),
        Task::Rig(args) => rig::run(&args),
        Task::TwinUsb(args) => twin_usb::run(&args),
        Task::Trust(args) => trust::run(&args),
        Task::Attacks(args) => attacks::run(&args),
        Task::Endurance(args) => endurance::run(&args),
        Task::Proofs(args) => proofs::run(&args),
        Task::Book(args) => book::run(&args),
        Task::Dist(args) => dist::run(&args),
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
