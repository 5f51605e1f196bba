//! `cargo xtask code-coverage`: which lines of each crate does a test reach? cargo-llvm-cov counts.

use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::tools;
use xtask::venv::done;

/// What `--help` prints.
pub const HELP: &str = "\
Runs the tests of crates/ with a counter in each line, and prints by crate the share of lines that a test reaches. The
lines of tests do not count. It needs the component llvm-tools (rustup component add llvm-tools).

  --missed CRATE  List the lines that the last run did not reach, instead of running";

const VERSION: &str = "0.9.1";
/// What the last run found, by LCOV's format.
const REPORT: &str = "target/coverage.lcov";

/// Runs the tests and prints a row for each crate, or lists lines.
pub fn run(mut arguments: Arguments) -> Result<()> {
    let missed = arguments.value("--missed")?;
    arguments.end()?;
    if missed.is_none() {
        let program = tools::of_cargo("cargo-llvm-cov", VERSION)?;
        // a program that a test kills may leave half a profile
        let tests = ["llvm-cov", "test", "--all-features", "--no-fail-fast", "--failure-mode", "all", "--lcov"];
        done(Command::new(program).args(tests).args(["--output-path", REPORT]))?;
    }
    let report = fs::read_to_string(REPORT).with_context(|| format!("{REPORT}; run the task without --missed"))?;
    let files = files(&report);
    match missed {
        Some(name) => files.iter().filter(|file| file.of == name).for_each(File::print_missed),
        None => print_crates(&files),
    }
    Ok(())
}

/// The lines of a file that count.
struct File {
    /// The folder of its crate.
    of: String,
    path: String,
    /// Each line, and whether a test reached it.
    lines: BTreeMap<u32, bool>,
}

/// Reads LCOV: a file begins with `SF:`, and each of its lines is `DA:line,count`.
fn files(report: &str) -> Vec<File> {
    let here = std::env::current_dir().unwrap_or_default();
    let mut files: Vec<File> = Vec::new();
    for line in report.lines() {
        if let Some(path) = line.strip_prefix("SF:") {
            let path = Path::new(path).strip_prefix(&here).unwrap_or(Path::new(path)).display().to_string();
            let of = path.split('/').nth(1).unwrap_or_default().to_owned();
            files.push(File { of, path, lines: BTreeMap::new() });
        }
        let counted = line.strip_prefix("DA:").and_then(|counted| counted.split_once(','));
        let counted = counted.and_then(|(line, count)| Some((line.parse().ok()?, count.parse::<u64>().ok()?)));
        if let (Some((line, count)), Some(file)) = (counted, files.last_mut()) {
            *file.lines.entry(line).or_default() |= count > 0;
        }
    }
    files.retain(|file| file.path.starts_with("crates/") && !is_test(&file.path));
    files
}

fn is_test(path: &str) -> bool {
    path.split('/').any(|part| matches!(part, "tests" | "tests.rs"))
}

fn print_crates(files: &[File]) {
    let mut crates: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for file in files {
        let (all, reached) = crates.entry(&file.of).or_default();
        *all += file.lines.len();
        *reached += file.lines.values().filter(|is_reached| **is_reached).count();
    }
    println!("| crate | lines | reached |\n|---|---|---|");
    for (name, (all, reached)) in crates {
        println!("| {name} | {all} | {:.1} % |", 100.0 * reached as f64 / all.max(1) as f64);
    }
}

impl File {
    /// Prints runs of lines that no test reached, each with its first line.
    fn print_missed(&self) {
        let text = fs::read_to_string(&self.path).unwrap_or_default();
        let mut before = true;
        for (line, is_reached) in &self.lines {
            if before && !is_reached {
                let code = text.lines().nth(*line as usize - 1).unwrap_or_default();
                println!("{}:{line}: {}", self.path, code.trim());
            }
            before = *is_reached;
        }
    }
}
