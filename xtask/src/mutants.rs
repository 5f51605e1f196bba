//! `cargo xtask mutants`: checks that a test fails if a line of the code is wrong. cargo-mutants makes the wrong
//! lines.

use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::tools;

const VERSION: &str = "27.1.0";

pub fn help() -> String {
    let row = |tried: &TestedCrate| format!("  {:16} one of {}\n", tried.name, tried.share);
    format!(
        "  --share N  Try every Nth mutant\n  --seed N   Begin with another mutant\n\n\
         Builds cargo-mutants once, below target/. Since the 15,000 mutants of all crates take days, it tries:\n\n\
         {}\nThe task prints the mutants that no test kills. It fails if these show that more than a tenth of all \
         survive.",
        TRIED.iter().map(row).collect::<String>()
    )
}

/// A crate whose tests must kill mutants, and the options for this.
struct TestedCrate {
    name: &'static str,
    /// Tries every N-th mutant, where N is this number.
    share: u32,
    options: &'static str,
}

/// Options for a crate's own tests, in the profile that builds fastest.
const OWN: &str = "--jobs 2 --minimum-test-timeout 60";
/// Options for zerorate-jobs. Most of its tests are tests of the program, which use all processors. `--timeout`, s, is
/// given because cargo-mutants does not time these tests before it begins.
const OF_THE_PROGRAM: &str =
    "--profile release --timeout 900 --test-package zerorate-jobs --test-package zerorate-cli";

const TRIED: [TestedCrate; 4] = [
    TestedCrate { name: "adis16130", share: 4, options: OWN },
    TestedCrate { name: "zerorate", share: 90, options: OWN },
    TestedCrate { name: "zerorate-allan", share: 100, options: OWN },
    TestedCrate { name: "zerorate-jobs", share: 12, options: OF_THE_PROGRAM },
];

pub fn run(mut arguments: Arguments) -> Result<()> {
    let share = arguments.value("--share")?.map(|n| n.parse::<u32>()).transpose().context("--share")?;
    let seed = arguments.value("--seed")?.map(|n| n.parse::<u64>()).transpose().context("--seed")?.unwrap_or(0);
    let names = arguments.words()?;
    if let Some(unknown) = names.iter().find(|name| TRIED.iter().all(|tried| tried.name != **name)) {
        bail!("no mutants are made of {unknown}; --help lists the crates");
    }
    let program = tools::of_cargo("cargo-mutants", VERSION)?;
    let mut weak = Vec::new();
    println!("crate, mutants, killed, survived, not compiled");
    for tried in TRIED.iter().filter(|tried| names.is_empty() || names.iter().any(|name| name == tried.name)) {
        let found = tried.run(&program, share.unwrap_or(tried.share), seed)?;
        println!("{}, {}, {}, {}, {}", tried.name, found.all(), found.killed, found.survived.len(), found.unviable);
        found.survived.iter().for_each(|mutant| println!("  survived: {mutant}"));
        if found.chance_of_so_many() < UNLIKELY {
            weak.push(tried.name);
        }
    }
    if weak.is_empty() { Ok(()) } else { bail!("more than a tenth of the mutants survive in {}", weak.join(", ")) }
}

/// The share of all mutants of a crate that may survive.
const MAY_SURVIVE: f64 = 0.1;
/// Significance level. The task fails if so many survivors have a smaller probability than this, assuming that
/// [`MAY_SURVIVE`] of all mutants survive.
const UNLIKELY: f64 = 0.01;

struct MutantCounts {
    killed: usize,
    survived: Vec<String>,
    unviable: usize,
}

impl TestedCrate {
    fn run(&self, program: &Path, share: u32, seed: u64) -> Result<MutantCounts> {
        let out = Path::new("target/mutants").join(self.name);
        fs::create_dir_all(&out)?;
        let mut mutants = Command::new(program);
        mutants.args(["mutants", "--package", self.name, "--all-features"]).args(self.options.split(' '));
        mutants.args(["--shard", &format!("{}/{share}", seed % u64::from(share)), "--sharding", "round-robin"]);
        // the exit code is ignored, because the report states the same: 2 if some survive, 3 if some hang
        mutants.arg("--output").arg(&out).status().context("cargo-mutants")?;
        MutantCounts::read(&out.join("mutants.out"))
    }
}

impl MutantCounts {
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

    /// The probability of at least as many survivors, if [`MAY_SURVIVE`] of all mutants survive: the upper tail of
    /// the binomial distribution.
    fn chance_of_so_many(&self) -> f64 {
        let (n, survived) = (self.killed + self.survived.len(), self.survived.len());
        let odds = MAY_SURVIVE / (1.0 - MAY_SURVIVE);
        let terms = std::iter::successors(Some((0, (1.0 - MAY_SURVIVE).powi(n as i32))), |&(k, term)| {
            (k < n).then(|| (k + 1, term * odds * (n - k) as f64 / (k + 1) as f64))
        });
        terms.filter(|(k, _)| *k >= survived).map(|(_, term)| term).sum()
    }

    fn all(&self) -> usize {
        self.killed + self.survived.len() + self.unviable
    }
}

#[cfg(test)]
mod tests {
    use super::MutantCounts;

    fn of_nine(survived: usize) -> f64 {
        MutantCounts { killed: 9 - survived, survived: vec![String::new(); survived], unviable: 0 }.chance_of_so_many()
    }

    #[test]
    fn four_survivors_of_nine_are_too_many_for_a_tenth() {
        assert!((of_nine(0) - 1.0).abs() < 1e-12);
        // the probability of a survivor among nine, if a tenth survives: 1 − 0.9⁹
        assert!((of_nine(1) - 0.612_579_511).abs() < 1e-9);
        assert!(of_nine(3) > super::UNLIKELY && of_nine(4) < super::UNLIKELY);
    }
}
