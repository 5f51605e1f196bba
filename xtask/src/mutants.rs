//! `cargo xtask mutants`: does a test fail when a line of the code is wrong? cargo-mutants makes the wrong lines.

use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::tools;

const VERSION: &str = "27.1.0";

/// What `--help` prints.
pub fn help() -> String {
    let row = |tried: &Tried| format!("  {:16} one of {}\n", tried.name, tried.share);
    format!(
        "Builds cargo-mutants once, below target/. It changes one place of a crate at a time, and runs the tests: a \
         mutant that passes them survives. The crates have 15,000 mutants, which take days, so that every Nth is \
         tried:\n\n{}\n\
         The task prints survivors, and fails if more than a tenth survive.\n\n  \
         --share N  Try every Nth mutant instead",
        TRIED.iter().map(row).collect::<String>()
    )
}

/// A crate, with what tests it.
struct Tried {
    name: &'static str,
    /// Every so manieth mutant is tried.
    share: u32,
    /// How cargo-mutants runs its tests.
    options: &'static str,
}

/// Its own tests, in the profile that builds fastest.
const OWN: &str = "--jobs 2 --minimum-test-timeout 60";
/// Most of what tests the jobs are tests of the program. They use all processors, and cargo-mutants does not time them
/// before it begins.
const OF_THE_PROGRAM: &str =
    "--profile release --timeout 900 --test-package zerorate-jobs --test-package zerorate-cli";

const TRIED: [Tried; 4] = [
    Tried { name: "adis16130", share: 4, options: OWN },
    Tried { name: "zerorate", share: 90, options: OWN },
    Tried { name: "zerorate-allan", share: 100, options: OWN },
    Tried { name: "zerorate-jobs", share: 12, options: OF_THE_PROGRAM },
];

/// Tries a sample of each crate, or of those that are named.
pub fn run(mut arguments: Arguments) -> Result<()> {
    let share = arguments.value("--share")?.map(|n| n.parse::<u32>()).transpose().context("--share")?;
    let names = arguments.words()?;
    if let Some(unknown) = names.iter().find(|name| TRIED.iter().all(|tried| tried.name != **name)) {
        bail!("no mutants are made of {unknown}; --help lists the crates");
    }
    let program = tools::of_cargo("cargo-mutants", VERSION)?;
    let mut weak = Vec::new();
    println!("crate, mutants, killed, survived, not compiled");
    for tried in TRIED.iter().filter(|tried| names.is_empty() || names.iter().any(|name| name == tried.name)) {
        let found = tried.run(&program, share.unwrap_or(tried.share))?;
        println!("{}, {}, {}, {}, {}", tried.name, found.all(), found.killed, found.survived.len(), found.unviable);
        found.survived.iter().for_each(|mutant| println!("  survived: {mutant}"));
        if found.survived.len() * 9 > found.killed {
            weak.push(tried.name);
        }
    }
    if weak.is_empty() { Ok(()) } else { bail!("more than a tenth of the mutants survive in {}", weak.join(", ")) }
}

/// What became of the mutants of a crate.
struct Found {
    killed: usize,
    survived: Vec<String>,
    unviable: usize,
}

impl Tried {
    fn run(&self, program: &Path, share: u32) -> Result<Found> {
        let out = Path::new("target/mutants").join(self.name);
        fs::create_dir_all(&out)?;
        let mut mutants = Command::new(program);
        mutants.args(["mutants", "--package", self.name, "--all-features"]).args(self.options.split(' '));
        mutants.args(["--shard", &format!("0/{share}"), "--sharding", "round-robin"]);
        // its exit code says no more than its report: 2 where some survive, 3 where some hang
        mutants.arg("--output").arg(&out).status().context("cargo-mutants")?;
        Found::read(&out.join("mutants.out"))
    }
}

impl Found {
    /// Reads the lists of cargo-mutants. A mutant that hangs counts as killed.
    fn read(report: &Path) -> Result<Self> {
        let list = |name: &str| -> Result<Vec<String>> {
            let path = report.join(name);
            let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            Ok(text.lines().map(str::to_owned).collect())
        };
        Ok(Self {
            killed: list("caught.txt")?.len() + list("timeout.txt")?.len(),
            survived: list("missed.txt")?,
            unviable: list("unviable.txt")?.len(),
        })
    }

    fn all(&self) -> usize {
        self.killed + self.survived.len() + self.unviable
    }
}
