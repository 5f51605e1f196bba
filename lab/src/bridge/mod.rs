//! `cargo xtask bridge`: tests the program with the bridge's firmware on an emulated Cortex-M4F that contains the
//! twin, over a socket and over a serial port. The program's own tests cover faulty connections.

mod emulator;
/// The firmware's own loop, compiled for the host to get the bytes that it sends.
#[path = "../../../firmware/qemu/src/bridge.rs"]
mod firmware;
mod script;

use crate::app::ProgramArgs;
use crate::targets;
use crate::tools::available;
use anyhow::{Context, Result, ensure};
use emulator::{Emulator, Line};
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;
use xtask::images::{self, QEMU};

/// Number of samples of each capture, and number of samples that controller and host must send as the same bytes.
const SAMPLES: u32 = 5_000;
/// Options of a calibration that takes half a minute of the part's time.
const PLAN: [&str; 10] =
    ["--average", "1s", "--warmup", "10s", "--settle", "10s", "--offset", "5s", "--max-u-btc", "1"];

pub fn run(args: &ProgramArgs) -> Result<()> {
    if !available(&[QEMU], "the bridge in the emulator")? {
        return Ok(());
    }
    targets::add_missing(["thumbv7em-none-eabihf"].into_iter())?;
    let program = args.program()?;
    let bench = Bench { program, image: images::build("release", "bridge")?, seed: args.seed };
    std::fs::create_dir_all(WORK)?;
    let bytes_alike = script::compare(&bench.emulator(Line::Socket)?, bench.seed, SAMPLES)?;
    bench.probe()?;
    bench.capture(&bench.emulator(Line::Socket)?.device, "tcp")?;
    bench.capture(&bench.emulator(Line::Serial)?.device, "serial")?;
    bench.calibrate()?;
    eprintln!(
        "seed {}: {bytes_alike} bytes of samples are the same from controller and host. Probe, capture (socket and \
         serial port) and calibrate agree with the twin.",
        bench.seed
    );
    Ok(())
}

const WORK: &str = "target/bridge";

struct Bench {
    program: PathBuf,
    image: PathBuf,
    seed: u64,
}

impl Bench {
    fn emulator(&self, line: Line) -> Result<Emulator> {
        Emulator::start(&self.image, self.seed, line)
    }

    fn json(&self, arguments: &[&str]) -> Result<Value> {
        let output = Command::new(&self.program).args(arguments).output().context("starting zerorate")?;
        let said = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "zerorate {} ended with {}: {said}", arguments.join(" "), output.status);
        serde_json::from_slice(&output.stdout).with_context(|| format!("zerorate {}", arguments.join(" ")))
    }

    fn probe(&self) -> Result<()> {
        let emulator = self.emulator(Line::Socket)?;
        let found = self.json(&["probe", "--device", &emulator.device, "--duration", "1s", "--json"])?;
        ensure!(found["lost_samples"] == 0 && found["fastest_clean_sclk_hz"] == 10_000_000, "probe found {found}");
        Ok(())
    }

    fn capture(&self, device: &str, name: &str) -> Result<()> {
        let (file, samples) = (format!("{WORK}/{name}.csv"), SAMPLES.to_string());
        let arguments = ["capture", "--device", device, "--samples", &samples, "--force", "--json", "-o", &file];
        let summary = self.json(&arguments)?;
        ensure!(summary["samples"] == SAMPLES && summary["lost_samples"] == 0, "{name}: {summary}");
        Ok(())
    }

    /// Calibrates the same unit by the same plan, through the bridge and directly. At the same temperature, the
    /// two PBC must agree within twice the standard uncertainty of their difference.
    fn calibrate(&self) -> Result<()> {
        let emulator = self.emulator(Line::Socket)?;
        let calibrate = |device: &str| {
            self.json(&[&["calibrate", "--no-save", "--json", "--device", device], PLAN.as_slice()].concat())
        };
        let (there, here) = (calibrate(&emulator.device)?, calibrate(&format!("twin:seed={}", self.seed))?);
        let number = |of: &Value, key: &str| of[key].as_f64().with_context(|| format!("no {key} in {of}"));
        let shift_c = number(&there, "t3_c")? - number(&here, "t3_c")?;
        let here_dps = number(&here, "pbc_dps")? + shift_c * number(&here, "btc_dps_per_c")?;
        let difference = number(&there, "pbc_dps")? - here_dps;
        let limit = 2.0 * number(&there, "u_pbc_dps")?.hypot(number(&here, "u_pbc_dps")?);
        ensure!(difference.abs() <= limit, "PBC differs by {difference} °/s from PBC in process, more than {limit}");
        Ok(())
    }
}
