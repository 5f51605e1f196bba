//! `cargo xtask bridge`: tries the program with a bridge's firmware on an emulated Cortex-M4F that contains the twin.
//! It uses a socket, a serial port, and a cable that does harm.

mod cable;
mod emulator;
/// The firmware's own loop, to get the bytes that it sends on the host.
#[path = "../../../firmware/qemu/src/bridge.rs"]
mod firmware;
mod script;

use crate::app::ProgramArgs;
use crate::firmware::{QEMU, image_of};
use crate::targets;
use crate::tools::available;
use anyhow::{Context, Result, bail, ensure};
use cable::Cable;
use emulator::{Emulator, Line};
use serde::Serialize;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

/// Samples that controller and host must send alike, byte for byte, and of each capture.
const SAMPLES: u32 = 5_000;
/// A calibration of half a minute of part time.
const PLAN: [&str; 10] =
    ["--average", "1s", "--warmup", "10s", "--settle", "10s", "--offset", "5s", "--max-u-btc", "1"];
/// Number of frames of which one is damaged.
const DAMAGED_EVERY: u64 = 50;
/// Number of bytes after which the cable is pulled.
const PULLED_AFTER: u64 = 60_000;

/// The results.
#[derive(Serialize)]
struct Findings {
    seed: u64,
    duration_s: f64,
    /// Bytes of the stream that controller and host send alike.
    bytes_alike: usize,
    probe: Value,
    capture_tcp: Value,
    capture_serial: Value,
    calibration: Value,
    calibration_in_process: Value,
    damaged_frames: u64,
    lost_by_damage: u64,
    samples_before_the_cable_was_pulled: u64,
}

/// Runs everything and stops at the first error.
pub fn run(args: &ProgramArgs) -> Result<()> {
    if !available(&[QEMU], "the bridge in the emulator")? {
        return Ok(());
    }
    targets::add_missing(["thumbv7em-none-eabihf"].into_iter())?;
    let program = args.program()?;
    let bench = Bench { program, image: image_of("bridge")?, seed: args.seed };
    std::fs::create_dir_all(WORK)?;
    let started = Instant::now();
    let mut findings = bench.findings()?;
    findings.duration_s = started.elapsed().as_secs_f64();
    if args.json {
        println!("{}", serde_json::to_string_pretty(&findings)?);
    }
    eprintln!(
        "seed {}: {} bytes of samples are the same from controller and host. Probe, capture (socket and serial port) \
         and calibrate agree with the twin. {} damaged frames cost {} samples. {} samples were kept when the cable \
         was pulled.",
        findings.seed,
        findings.bytes_alike,
        findings.damaged_frames,
        findings.lost_by_damage,
        findings.samples_before_the_cable_was_pulled
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
    fn findings(&self) -> Result<Findings> {
        let bytes_alike = script::compare(&self.emulator(Line::Socket)?, self.seed, SAMPLES)?;
        let probe = self.probe()?;
        let capture_tcp = self.capture(&self.emulator(Line::Socket)?.device(), "tcp")?;
        let capture_serial = self.capture(&self.emulator(Line::Serial)?.device(), "serial")?;
        let (calibration, calibration_in_process) = self.calibrate()?;
        let (damaged_frames, lost_by_damage) = self.damage()?;
        Ok(Findings {
            seed: self.seed,
            duration_s: 0.0,
            bytes_alike,
            probe,
            capture_tcp,
            capture_serial,
            calibration,
            calibration_in_process,
            damaged_frames,
            lost_by_damage,
            samples_before_the_cable_was_pulled: self.pull()?,
        })
    }

    fn emulator(&self, line: Line) -> Result<Emulator> {
        Emulator::start(&self.image, self.seed, line)
    }

    fn zerorate(&self, arguments: &[&str]) -> Result<Output> {
        Command::new(&self.program).args(arguments).output().context("starting zerorate")
    }

    fn json(&self, arguments: &[&str]) -> Result<Value> {
        let output = self.zerorate(arguments)?;
        let said = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "zerorate {} ended with {}: {said}", arguments.join(" "), output.status);
        serde_json::from_slice(&output.stdout).with_context(|| format!("zerorate {}", arguments.join(" ")))
    }

    fn probe(&self) -> Result<Value> {
        let emulator = self.emulator(Line::Socket)?;
        let found = self.json(&["probe", "--device", &emulator.device(), "--duration", "1s", "--json"])?;
        ensure!(found["lost_samples"] == 0 && found["fastest_clean_sclk_hz"] == 10_000_000, "probe found {found}");
        Ok(found)
    }

    fn capture(&self, device: &str, name: &str) -> Result<Value> {
        let (file, samples) = (format!("{WORK}/{name}.csv"), SAMPLES.to_string());
        let arguments = ["capture", "--device", device, "--samples", &samples, "--force", "--json", "-o", &file];
        let summary = self.json(&arguments)?;
        ensure!(summary["samples"] == SAMPLES && summary["lost_samples"] == 0, "{name}: {summary}");
        Ok(summary)
    }

    /// The same plan through the bridge and in process: they differ by no more than their uncertainties.
    fn calibrate(&self) -> Result<(Value, Value)> {
        let emulator = self.emulator(Line::Socket)?;
        let calibrate = |device: &str| {
            self.json(&[&["calibrate", "--no-save", "--json", "--device", device], PLAN.as_slice()].concat())
        };
        let (there, here) = (calibrate(&emulator.device())?, calibrate(&format!("twin:seed={}", self.seed))?);
        let number = |of: &Value, key: &str| of[key].as_f64().with_context(|| format!("no {key} in {of}"));
        let shift_c = number(&there, "t3_c")? - number(&here, "t3_c")?;
        let here_dps = number(&here, "pbc_dps")? + shift_c * number(&here, "btc_dps_per_c")?;
        let difference = number(&there, "pbc_dps")? - here_dps;
        let limit = 2.0 * number(&there, "u_pbc_dps")?.hypot(number(&here, "u_pbc_dps")?);
        ensure!(difference.abs() <= limit, "PBC differs by {difference} °/s from PBC in process, more than {limit}");
        Ok((there, here))
    }

    /// Damaged frames are found, and their samples are counted as lost.
    fn damage(&self) -> Result<(u64, u64)> {
        let emulator = self.emulator(Line::Socket)?;
        let cable = Cable::lay(emulator.port(), Some(DAMAGED_EVERY), None)?;
        let (device, samples) = (format!("tcp:127.0.0.1:{}", cable.port()), SAMPLES.to_string());
        let file = format!("{WORK}/damaged.csv");
        let summary =
            self.json(&["capture", "--device", &device, "--samples", &samples, "--force", "--json", "-o", &file])?;
        let lost = summary["lost_samples"].as_u64().context("no lost_samples")?;
        let expected = u64::from(SAMPLES) / (DAMAGED_EVERY - 1);
        ensure!(
            lost.abs_diff(expected) <= 2,
            "{lost} samples are counted as lost; about {expected} frames were damaged"
        );
        let warnings = summary["warnings"].to_string();
        let said = warnings.split("damaged-frames: ").nth(1).and_then(|rest| rest.split(' ').next()?.parse().ok());
        let Some(found) = said else { bail!("no word on damaged frames: {warnings}") };
        // frames after the last recorded sample are among them
        ensure!(found + 2 >= lost, "{found} damaged frames, but {lost} lost samples");
        Ok((found, lost))
    }

    /// Samples recorded before the cable was pulled stay.
    fn pull(&self) -> Result<u64> {
        let emulator = self.emulator(Line::Socket)?;
        let cable = Cable::lay(emulator.port(), None, Some(PULLED_AFTER))?;
        let (device, file) = (format!("tcp:127.0.0.1:{}", cable.port()), format!("{WORK}/pulled.csv"));
        let output = self.zerorate(&["capture", "--device", &device, "--duration", "1m", "--force", "-o", &file])?;
        let said = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.code() == Some(1) && said.contains("cable was pulled"), "{}: {said}", output.status);
        let kept = rows(Path::new(&file))?;
        ensure!(kept > 1_000 && said.contains(&format!("ends after {kept} samples")), "{kept} rows, but: {said}");
        Ok(kept)
    }
}

fn rows(capture: &Path) -> Result<u64> {
    let text = std::fs::read_to_string(capture).with_context(|| format!("no {}", capture.display()))?;
    Ok(text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).count() as u64)
}
