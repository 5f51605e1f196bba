//! `cargo xtask rig`: tests the program on a stock Linux kernel in QEMU, with the twin as hardware on its USB port.
//!
//! The guest contains four files of ours: the program under test, a shell script, a simulated HID gyroscope
//! (`gyro.rs`) and its part file. The kernel is not patched. Its own ADIS16130 driver reads the part, and its driver
//! for HID gyroscopes reads the HID gyroscope. Then the program reads the part over spidev and the GPIO chip. All
//! readings must equal the readings that part and gyroscope sent.

mod checks;
mod files;
#[cfg(test)]
mod gyro;
mod hid;
mod initramfs;
mod kernel;
mod machine;
mod part;

use crate::app::{ProgramArgs, emptied, target_folder};
use crate::tools::{Tool, available, is_root};
use anyhow::{Context, Result};
use checks::RigData;
use kernel::Kernel;
use machine::Machine;
use part::{Record, UsbTwin};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const TOOLS: [Tool; 8] = [
    Tool { program: "qemu-system-x86_64", package: "qemu-system-x86" },
    Tool { program: "busybox", package: "busybox-static" },
    Tool { program: "cpio", package: "cpio" },
    Tool { program: "depmod", package: "kmod" },
    Tool { program: "xz", package: "xz-utils" },
    Tool { program: "iasl", package: "acpica-tools" },
    Tool { program: "dpkg-deb", package: "dpkg" },
    Tool { program: "strip", package: "binutils" },
];

/// MCLK, Hz, at which every edge reaches the guest. A pair takes 1054 cycles (F-31), so there are 99.6 pairs a second.
/// Their rate is not 100 Hz, because the resonance (F-07) is a multiple of 100 Hz and would be aliased to a bias.
const SLOW_HZ: &str = "105000";
/// MCLK, Hz, at which the guest cannot keep up: 996 pairs a second.
const FAST_HZ: &str = "1050000";
/// A short calibration that accepts the losses of a busy host (`--max-lost`).
const PLAN: &str = "--average 5s --warmup 30s --settle 10s --offset 15s --max-u-btc 0.05 --max-lost 0.95";
/// Time constant of the self-heating for the calibration by [`PLAN`], s, in place of the 600 s of M-03.
const WARMUP_S: &str = "20";
/// The captures at the slow rate. There are several, because a host may pause the machine for longer than a period.
const SLOW_CAPTURES: [&str; 3] = ["slow1", "slow2", "slow3"];
/// Time limit for each step of the guest.
const LIMIT: Duration = Duration::from_secs(150);

pub fn run(args: &ProgramArgs) -> Result<()> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) || !Path::new("/etc/debian_version").exists() {
        eprintln!("SKIPPED: the rig needs Debian on x86-64, whose kernel it boots");
        return Ok(());
    }
    if !available(&TOOLS, "the rig")? {
        return Ok(());
    }
    let program = args.program()?;
    let folder = std::path::absolute(target_folder()?.join("rig"))?;
    fs::create_dir_all(&folder)?;
    let kernel = Kernel::fetch(&folder)?;
    let started = Instant::now();
    let seen = experiment(args.seed, &program, &folder, &kernel)?;
    checks::run(args.seed, &seen, started.elapsed())
}

/// Boots the guest, plugs in one part after the other when the guest's script asks, and collects all data.
fn experiment(seed: u64, program: &Path, folder: &Path, kernel: &Kernel) -> Result<RigData> {
    let run = emptied(folder.join("run"))?;
    let settings = [("SLOW_HZ", SLOW_HZ), ("FAST_HZ", FAST_HZ), ("PLAN", PLAN)];
    let initramfs = initramfs::build(&run, kernel, program, &settings)?;
    let socket = run.join("part.sock");
    let mut machine = Machine::boot(&run, kernel, &initramfs, &socket)?;
    // the capacitor of F-04 limits the aliasing of noise at 100 samples a second
    let keys = format!("seed={seed},warmup_s={WARMUP_S},roa=10nf");
    let mut stage = |name: &str, arguments: &[&str]| -> Result<Record> {
        let arguments = [&[keys.as_str()], arguments].concat();
        let plugged = UsbTwin::plug(&run, name, &socket, &arguments)?;
        let done = if name == "replug" { "all done".to_owned() } else { format!("{name} done") };
        machine.until(&done, LIMIT)?;
        plugged.unplug()
    };
    let slow = ["--mclk-hz", SLOW_HZ];
    let iio = stage("iio", &["--initialised"])?;
    let spi = stage("spi", &slow)?;
    let fast = stage("fast", &["--mclk-hz", FAST_HZ])?;
    let calibrate = stage("calibrate", &slow)?;
    let cut = stage("cut", &slow)?;
    let replug = stage("replug", &slow)?;
    let files = run.join("guest");
    machine.files(&files)?;
    for capture in SLOW_CAPTURES.iter().chain(&["fast", "cut"]).chain(&hid::CAPTURES) {
        as_csv(program, &files, capture)?;
    }
    let host = calibrate_in_process(program, &keys)?;
    Ok(RigData { files, iio, spi, fast, calibrate, cut, replug, host })
}

fn as_csv(program: &Path, files: &Path, capture: &str) -> Result<()> {
    let recorded = files.join(format!("{capture}.arrows"));
    let mut command = Command::new(program);
    command.arg("capture").arg("--device").arg(format!("replay:{}", recorded.display()));
    command.args(["--duration", "1h", "--json", "-o"]).arg(files.join(format!("{capture}.csv")));
    let output = command.output()?;
    fs::write(files.join(format!("{capture}.replay.err")), &output.stderr)?;
    anyhow::ensure!(output.status.success(), "{capture}.arrows: {}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

/// Calibrates the same unit by the same plan with the program on this computer, without kernel and bus.
fn calibrate_in_process(program: &Path, keys: &str) -> Result<serde_json::Value> {
    let mut command = Command::new(program);
    command
        .args(["calibrate", "--no-save", "--json", "--device"])
        .arg(format!("twin:{keys},mclk_hz={SLOW_HZ}"))
        .args(PLAN.split(' '));
    let output = command.output()?;
    anyhow::ensure!(output.status.success(), "in-process: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).context("the in-process calibration")
}

/// A command with higher priority, if this process may raise it. A process in real time must not wait for a compiler.
fn preferred(program: &Path) -> Command {
    if !is_root() {
        return Command::new(program);
    }
    let mut command = Command::new("nice");
    command.args(["-n", "-15"]).arg(program);
    command
}
