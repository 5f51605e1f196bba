//! `cargo xtask instructions`: compares the cost of reading and checking a log with that of its deviations, in
//! instructions.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use xtask::app::{program, target_folder};
use xtask::arguments::Arguments;
use xtask::tools::{Tool, available};
use xtask::venv::{done, printed};

pub const HELP: &str = "\
Runs `zerorate allan` on noise under valgrind. Fails if reading and checking a sample takes more than half as many
instructions as computing its deviations. Their number does not depend on how busy the machine is.";

const TOOLS: [Tool; 1] = [Tool { program: "valgrind", package: "valgrind" }];
/// Numbers of samples in two logs. The instructions for the shorter one are subtracted, so that the start of the
/// program does not count.
const SAMPLES: [usize; 2] = [200_000, 1_200_000];
const MOST: f64 = 0.5;
/// The functions that compute the deviations and name their noise. Their instructions include those of all that they
/// call, since the compiler decides which functions it copies into others.
const DEVIATIONS: [&str; 2] =
    ["zerorate_allan::kernels::deviations_and_missing", "zerorate_allan::noise_id::identify"];

pub fn run(arguments: Arguments) -> Result<()> {
    arguments.end()?;
    if !available(&TOOLS, "instructions")? {
        return Ok(());
    }
    let program = program()?;
    let [short, long] = SAMPLES.map(|samples| counted(&program, samples));
    let ((all_short, deviations_short), (all, deviations)) = (short?, long?);
    let per_sample = |long: f64, short: f64| (long - short) / (SAMPLES[1] - SAMPLES[0]) as f64;
    let deviations = per_sample(deviations, deviations_short);
    let rest = per_sample(all, all_short) - deviations;
    let share = rest / deviations;
    println!(
        "instructions per sample: deviations {deviations:.1}, all else {rest:.1}: {share:.2} of it (most: {MOST})"
    );
    ensure!(share <= MOST, "what is done beside the deviations costs more than {MOST} of them");
    Ok(())
}

/// The instructions for a log of this length: all, and those of the deviations.
fn counted(program: &Path, samples: usize) -> Result<(f64, f64)> {
    let folder = target_folder()?;
    let [log, counts] = ["instructions.f64", "instructions.callgrind"].map(|name| folder.join(name));
    fs::write(&log, noise(samples))?;
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--tool=callgrind"]).arg(format!("--callgrind-out-file={}", counts.display()));
    valgrind.arg(program).arg("allan").arg(&log);
    valgrind.args(["--raw", "f64", "--rate", "200", "--unit", "dps"]).stdout(Stdio::null());
    // without the child process in which the program otherwise reads a log
    done(valgrind.env("ZERORATE_CONFINED", "1").env("RAYON_NUM_THREADS", "1"))?;
    let found = read(&counts)?;
    [log, counts].iter().try_for_each(fs::remove_file)?;
    Ok(found)
}

/// Noise as little-endian f64: each sample is the sum of four uniform random numbers.
fn noise(samples: usize) -> Vec<u8> {
    let mut state = 7_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..samples).flat_map(|_| (0..4).map(|_| uniform()).sum::<f64>().to_le_bytes()).collect()
}

/// Reads the file that callgrind wrote. Each line of its table has a count and the name of a function.
fn read(path: &Path) -> Result<(f64, f64)> {
    let options = ["--inclusive=yes", "--threshold=100", "--auto=no"];
    let table = printed(Command::new("callgrind_annotate").args(options).arg(path))?;
    let all = table.lines().find(|line| line.contains("PROGRAM TOTALS")).and_then(instructions);
    let of = |name: &str| {
        let line = table.lines().find(|line| line.contains(&format!(":{name} [")));
        line.and_then(instructions).with_context(|| format!("callgrind does not name {name}"))
    };
    let deviations = DEVIATIONS.into_iter().map(of).sum::<Result<f64>>()?;
    Ok((all.context("callgrind counted nothing")?, deviations))
}

/// The count at the start of a line.
fn instructions(line: &str) -> Option<f64> {
    line.split_whitespace().next()?.replace(',', "").parse().ok()
}
