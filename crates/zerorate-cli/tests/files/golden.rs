//! Results that must not change, bit for bit. An early version of the program made the files.
//!
//! A difference is either a defect, or a changed result that CHANGELOG.md must mention. In the latter case
//! `ZERORATE_GOLDEN=write cargo test -p zerorate-cli --all-features --test cli golden` writes the files again.

use super::{Bench, FORMS};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Names of calibrations, and the options that make them: one of 205 s with every sample, and three of an hour with
/// every ninth edge.
const CALIBRATIONS: [(&str, &str); 4] = [
    ("short", "--device twin:seed=7 --average 2s --warmup 60s --settle 120s --offset 20s --max-u-btc 0.2"),
    ("hour-1", "--device twin:seed=1 --divider 9"),
    ("hour-2", "--device twin:seed=2 --divider 9 --assume-linear"),
    ("hour-3", "--device twin:seed=3 --divider 9 --earth-dps 0.003 --serial SN-3"),
];

/// Lines that may change with the wording of a warning.
const WORDS: [&str; 3] = ["warnings", "checksum", "line_checks"];

#[test]
fn calibrations_do_not_change() {
    for (name, options) in CALIBRATIONS {
        let bench = Bench::new();
        bench.zerorate(&format!("calibrate {options} -o unit.toml")).ok();
        let text = bench.text("unit.toml");
        let numbers = text.lines().filter(|line| !WORDS.iter().any(|word| line.starts_with(word)));
        unchanged(&format!("{name}.toml"), &numbers.map(|line| format!("{line}\n")).collect::<String>(), |_| true);
    }
}

#[test]
fn captures_do_not_change() {
    let bench = Bench::new();
    let mut hashes = String::new();
    for options in ["seed=7", "seed=8,fault=rdy_stutter,fault_at_s=0.2", "seed=9,width=16"] {
        for form in FORMS {
            let name = format!("capture.{form}");
            bench.zerorate(&format!("capture --device twin:{options} --samples 3000 -o {name} --force")).ok();
            let hash = Sha256::digest(fs::read(bench.path(&name)).unwrap());
            let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
            writeln!(hashes, "{hash}  {options}.{form}").unwrap();
        }
    }
    let is_built_in = |line: &str| FORMS.iter().any(|form| line.ends_with(form));
    unchanged("captures.sha256", &hashes, is_built_in);
}

/// Compares the lines of the file for which `is_there` holds. If the environment asks for it, writes the file first,
/// but only if `is_there` holds for all lines.
fn unchanged(name: &str, now: &str, is_there: impl Fn(&str) -> bool) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    let before = fs::read_to_string(&path).unwrap_or_default();
    let is_all = before.lines().all(&is_there);
    if is_all && std::env::var_os("ZERORATE_GOLDEN").is_some_and(|value| value == "write") {
        fs::write(&path, now).unwrap();
    }
    let before = fs::read_to_string(&path).unwrap();
    let before: String = before.split_inclusive('\n').filter(|line| is_there(line.trim_end())).collect();
    assert_eq!(now, before, "{name} has changed");
}
