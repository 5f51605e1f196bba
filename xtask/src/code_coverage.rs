//! `cargo xtask code-coverage`: counts the lines of each crate that a test reaches, with cargo-llvm-cov.

use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::tools;
use xtask::venv::done;

pub const HELP: &str = "\
\x20 --at-least SHARE  Fail if the tests reach less of a crate, in percent
  --missed CRATE    List the lines that the last run did not reach, and run nothing

The lines of tests do not count. All crates take some 40 minutes on two cores; of a named CRATE, only its own tests
run. Without the component llvm-tools, the task prints SKIPPED and passes.";

const VERSION: &str = "0.9.1";
/// The result of the last run, in LCOV's format.
const REPORT: &str = "target/coverage.lcov";

pub fn run(mut arguments: Arguments) -> Result<()> {
    let missed = arguments.value("--missed")?;
    let least = arguments.value("--at-least")?.map(|share| share.parse::<f64>()).transpose().context("--at-least")?;
    let names = arguments.words()?;
    if let Some(name) = missed {
        read()?.iter().filter(|file| file.of == name).for_each(File::print_missed);
        return Ok(());
    }
    if !has_llvm_tools() {
        eprintln!("SKIPPED: lines that tests reach: rustup component add llvm-tools");
        return Ok(());
    }
    count(&names)?;
    let files = read()?.into_iter().filter(|file| names.is_empty() || names.contains(&file.of));
    let shares = shares(files.collect());
    println!("| crate | lines | reached |\n|---|---|---|");
    shares.iter().for_each(|(name, lines, share)| println!("| {name} | {lines} | {share:.1} % |"));
    match least.and_then(|least| shares.iter().find(|(_, _, share)| *share < least)) {
        Some((name, _, share)) => bail!("tests reach {share:.1} % of {name}; --missed {name} lists the other lines"),
        None => Ok(()),
    }
}

fn has_llvm_tools() -> bool {
    let list = Command::new("rustup").args(["component", "list", "--installed"]).output();
    list.is_ok_and(|list| String::from_utf8_lossy(&list.stdout).contains("llvm-tools"))
}

/// Runs the tests of these crates, or of all.
fn count(names: &[String]) -> Result<()> {
    let program = tools::of_cargo("cargo-llvm-cov", VERSION)?;
    // tests kill some programs, whose profiles are then incomplete: `--failure-mode all` accepts them
    let tests = ["llvm-cov", "test", "--all-features", "--no-fail-fast", "--failure-mode", "all", "--lcov"];
    let packages = names.iter().flat_map(|name| ["--package", name]);
    done(Command::new(program).args(tests).args(["--output-path", REPORT]).args(packages))
}

fn read() -> Result<Vec<File>> {
    let report = fs::read_to_string(REPORT).with_context(|| format!("{REPORT}; run the task without --missed"))?;
    Ok(files(&report))
}

/// The executable lines of a source file.
struct File {
    /// The folder of the crate to which the file belongs.
    of: String,
    path: String,
    /// Line numbers, each with true if a test reached the line.
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
    let is_test = |path: &str| path.split('/').any(|part| matches!(part, "tests" | "tests.rs"));
    files.retain(|file| file.path.starts_with("crates/") && !is_test(&file.path));
    files
}

/// Each crate with its number of lines and the share that tests reach, %.
fn shares(files: Vec<File>) -> Vec<(String, usize, f64)> {
    let mut crates: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for file in files {
        let (all, reached) = crates.entry(file.of).or_default();
        *all += file.lines.len();
        *reached += file.lines.values().filter(|is_reached| **is_reached).count();
    }
    let share = |all: usize, reached: usize| 100.0 * reached as f64 / all.max(1) as f64;
    crates.into_iter().map(|(name, (all, reached))| (name, all, share(all, reached))).collect()
}

impl File {
    /// Prints the first line of each run of lines that no test reached.
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
