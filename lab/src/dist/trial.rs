//! The trial that the program must pass on every machine: the twin, files of every kind that needs a third-party
//! decoder, and a plot. All machines must print the same and write the same bytes.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Options of a short calibration, which suffices for a twin with `warmup_s=20`.
const PLAN: &str = "--average 5s --warmup 30s --settle 10s --offset 15s --max-u-btc 0.05";
/// A bag of another project with zstd-compressed chunks. `lay_out` adds an SQLite file that is not a bag.
const BAG: &str = "crates/zerorate-logs/fixtures/imu_zstd.mcap";

/// The command lines, the exit code that each must have, and those of its files whose bytes are compared.
fn steps() -> Vec<(String, i32, &'static [&'static str])> {
    let device = "--device twin:seed=1,warmup_s=20";
    vec![
        ("--version".to_owned(), 0, &[]),
        (format!("calibrate {device} {PLAN} --json -o unit.toml --serial SN17"), 0, &["unit.toml"]),
        ("calibrate --device twin:motion=sway --average 5s --warmup 5s --settle 5s --offset 5s".to_owned(), 3, &[]),
        (format!("capture {device} --duration 20s --divider 57 -o rest.parquet"), 0, &[]),
        (format!("capture {device} --duration 2s -o rest.csv"), 0, &["rest.csv"]),
        ("verify rest.parquet unit.toml".to_owned(), 0, &[]),
        ("allan rest.parquet --fit --json".to_owned(), 0, &[]),
        ("allan bag.mcap --column z --json".to_owned(), 0, &[]),
        ("allan none.db3 --column z".to_owned(), 1, &[]),
        ("allan rest.parquet --fit --plot rest.png".to_owned(), 0, &["rest.png"]),
        ("export unit.toml --format c".to_owned(), 0, &[]),
        ("report unit.toml -o unit.html".to_owned(), 0, &["unit.html"]),
        ("completions bash".to_owned(), 0, &[]),
    ]
}

/// The results of the trial: each step with its output or file.
pub type Observations = Vec<(String, Vec<u8>)>;

pub fn lay_out(here: &Path) -> Result<()> {
    fs::copy(BAG, here.join("bag.mcap")).context(BAG)?;
    let make = "import sqlite3; sqlite3.connect('none.db3').execute('create table notes (text)')";
    crate::venv::done(Command::new("python3").current_dir(here).args(["-c", make]))
}

/// Runs all steps with the command `zerorate`. Its working folder is `here` on this machine.
pub fn run(zerorate: impl Fn() -> Command, here: &Path) -> Result<Observations> {
    let mut seen = Observations::new();
    for (line, code, files) in steps() {
        let output = zerorate().args(line.split(' ')).output().with_context(|| line.clone())?;
        let said = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.code() == Some(code), "zerorate {line}: {}, not exit {code}: {said}", output.status);
        seen.push((line.clone(), output.stdout));
        for file in files {
            seen.push((format!("{line}: {file}"), fs::read(here.join(file))?));
        }
    }
    Ok(seen)
}
