//! The program is killed, stopped by a signal, or cannot write.

use super::bench::{Bench, Folder, Run, SHORT, random};
use super::{Class, Verdict};
use anyhow::{Context, Result};
use rand::RngExt;
use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

pub const CLASSES: &[Class] = &[
    Class::new("kill capture arrows", "SIGKILL at a random moment of a recording", 4, kill_capture),
    Class::new("kill calibrate", "SIGKILL: the older calibration or the new one, whole", 4, kill_calibrate),
    Class::new("term capture csv", "SIGTERM: the recording is whole, and nothing else is left", 4, term_capture),
    Class::new("full disk", "`-o` and `--log` cannot be written: the result goes elsewhere, exit 1", 2, full_disk),
];

/// Runs the program and sends `signal` after a random time. Returns the result of the run.
fn interrupted(bench: &Bench, class: &str, seed: u64, args: &[&str], signal: &str) -> Result<Run> {
    let child = bench.command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    sleep(Duration::from_micros(random(class, seed).random_range(0..400_000)));
    Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status()?;
    Ok(child.wait_with_output()?.into())
}

fn kill_capture(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let folder = Folder::new(&format!("kill-{seed}"))?;
    let file = folder.file("log.arrows");
    let device = format!("twin:seed={seed}");
    interrupted(bench, class, seed, &["capture", "--device", &device, "--duration", "30m", "-o", &file], "-KILL")?;
    if !fs::exists(&file)? {
        return Ok(Verdict::Right);
    }
    repaired(bench, &folder, &file, &device)
}

/// The verdict on a recording that ended early. Repaired, it must be the first samples of `device`.
pub fn repaired(bench: &Bench, folder: &Folder, file: &str, device: &str) -> Result<Verdict> {
    let (repaired, whole) = (folder.file("repaired.arrows"), folder.file("whole.arrows"));
    let repair = bench.run(&["repair", file, "-o", &repaired])?;
    if repair.code != Some(0) {
        return Ok(repair.refusal(&["no row of it can be kept", "it is empty"]));
    }
    let rows = verified(bench, &repaired)?["rows"].as_u64().context("rows")?;
    if rows == 0 {
        return Ok(Verdict::Right);
    }
    bench.must(&["capture", "--device", device, "--samples", &rows.to_string(), "-o", &whole])?;
    let [saved, whole] = [hash(bench, &repaired)?, hash(bench, &whole)?];
    Ok(if saved == whole {
        Verdict::Right
    } else {
        Verdict::Silent(format!("the first {rows} samples differ from the part's"))
    })
}

pub fn hash(bench: &Bench, file: &str) -> Result<String> {
    Ok(verified(bench, file)?["samples_sha256"].as_str().context("samples_sha256")?.to_owned())
}

fn verified(bench: &Bench, file: &str) -> Result<serde_json::Value> {
    Ok(bench.must(&["verify", "--json", file])?.json()?["files"][0].clone())
}

fn kill_calibrate(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let folder = Folder::new(&format!("kill-calibrate-{seed}"))?;
    let file = folder.file("unit.toml");
    fs::copy(bench.file("unit.toml"), &file)?;
    let device = format!("twin:seed={seed}");
    let args = [&["calibrate", "--device", &device, "-o", &file, "--force"], &SHORT[..]].concat();
    interrupted(bench, class, seed, &args, "-KILL")?;
    let whole = bench.run(&["export", &file, "--format", "json"])?;
    Ok(if whole.code == Some(0) {
        Verdict::Right
    } else {
        Verdict::Silent(format!("{}: {}", whole.stderr, fs::read_to_string(&file)?))
    })
}

fn term_capture(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let folder = Folder::new(&format!("term-{seed}"))?;
    let file = folder.file("log.csv");
    let device = format!("twin:seed={seed}");
    let args = ["capture", "--device", &device, "--duration", "30m", "-o", &file];
    interrupted(bench, class, seed, &args, "-TERM")?;
    let left = folder.names()?;
    if left.is_empty() {
        return Ok(Verdict::Right);
    }
    let whole = bench.run(&["verify", &file])?;
    Ok(match (whole.code, left.len()) {
        (Some(0), 1) => Verdict::Right,
        (code, _) => Verdict::Silent(format!("verify ends with {code:?}, {left:?}: {}", whole.stderr)),
    })
}

/// Makes `-o` or `--log` fail as on a full disk. A result, if there is one, must be on stdout or in the file of `-o`.
fn full_disk(bench: &Bench, _: &'static str, seed: u64) -> Result<Verdict> {
    let folder = Folder::new(&format!("full-{seed}"))?;
    let device = format!("twin:seed={seed}");
    let good = folder.file("unit.toml");
    let (output, log) = if seed.is_multiple_of(2) { ("/dev/full", None) } else { (&*good, Some("/dev/full")) };
    let mut args = [&["calibrate", "--device", &device, "-o", output], &SHORT[..]].concat();
    args.extend(log.iter().flat_map(|log| ["--log", log]));
    let run = bench.run(&args)?;
    let kept = run.stdout.contains("pbc_dps") || fs::exists(&good)?;
    Ok(match run.code {
        Some(1) if kept => Verdict::Refused,
        // every result has the warning about the Earth, so without this warning the run ended before its result
        Some(1) if run.says(&["cannot write"]) && !run.says(&["earth-"]) => Verdict::Refused,
        code => Verdict::Silent(format!("{args:?} ended with {code:?}: {}", run.stderr)),
    })
}
