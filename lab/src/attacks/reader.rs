//! Reads files with our library, with the program and with PyArrow, and compares the numbers.

use super::tally::{Outcome, Tally};
use crate::app::{self, target_folder};
use crate::venv::{self, done};
use anyhow::{Context, Result, anyhow};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::Command;

const REQUIREMENTS: &str = "lab/attacks-requirements.txt";
/// Limits of reading one file: time in s, and memory in bytes. Files of some megabytes need far less.
const SECONDS: &str = "60";
const MEMORY: &str = "--as=4294967296";
/// The exit code of `timeout` when the time limit is over.
const TIMED_OUT: i32 = 124;
/// Allowed relative difference. A decimal of more than 53 bits is rounded when it is parsed and again when it is
/// printed: a few units in the last place.
const ROUNDING: f64 = 1e-15;

#[derive(Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reading {
    /// The numeric columns, each with its name.
    Columns(Vec<(String, Vec<Option<f64>>)>),
    Refused(String),
}

/// A Python environment with PyArrow. If it cannot be made, prints that and returns `None`.
pub fn python() -> Option<PathBuf> {
    let python = venv::python("attacks", REQUIREMENTS);
    python.inspect_err(|why| println!("SKIPPED: readers of the projects, in Python: {why:#}")).ok()
}

/// The results of PyArrow for each file. `form` is `arrow` or `parquet`.
pub fn theirs(python: &Path, form: &str, files: &[PathBuf]) -> Result<Vec<Reading>> {
    let mut said = Vec::new();
    while said.len() < files.len() {
        let output =
            Command::new(python).args(["lab/src/attacks/oracle.py", form]).args(&files[said.len()..]).output();
        let output = output.context("PyArrow")?;
        let lines = str::from_utf8(&output.stdout)?.lines().map(serde_json::from_str);
        said.extend(lines.collect::<Result<Vec<Reading>, _>>()?);
        if said.len() < files.len() {
            said.push(Reading::Refused(format!("PyArrow ended with {}", output.status)));
        }
    }
    Ok(said)
}

/// The readers under test: an example of the library that prints all numbers, and the program.
pub struct Reader {
    columns: PathBuf,
    program: PathBuf,
}

impl Reader {
    /// Builds the example with the features of the tests, so that it reads every format.
    pub fn new(program: &Path) -> Result<Self> {
        done(Command::new("cargo").args("build --quiet --example columns".split(' ')).args(app::WHOLE.split(' ')))?;
        Ok(Self { columns: target_folder()?.join("release/examples/columns"), program: program.to_owned() })
    }

    fn ours(&self, file: &Path) -> Result<Reading> {
        let (_, stdout, _) = confined(Command::new(&self.columns).arg(file), &[0])?;
        Ok(serde_json::from_str(&stdout)?)
    }

    /// The program's error about a file; empty if it accepts the file.
    pub fn refusal(&self, file: &Path) -> Result<String> {
        let options = ["allan", "--rate", "100", "--unit", "dps", "--column", "all"];
        let (code, _, stderr) = confined(Command::new(&self.program).args(options).arg(file), &[0, 1, 2, 3])?;
        if code != 0 && !stderr.contains(&file.display().to_string()) {
            return Err(anyhow!("the program does not name the file: {stderr}"));
        }
        Ok(if code == 0 { String::new() } else { stderr })
    }

    pub fn compare(&self, files: &[PathBuf], theirs: &[Reading], folder: &Path) -> Tally {
        let mut tally = Tally::default();
        for (file, theirs) in files.iter().zip(theirs) {
            let name = file.strip_prefix(folder).unwrap_or(file).display().to_string();
            let outcome = self.refusal(file).and_then(|_| Ok(judge(&name, self.ours(file)?, theirs)));
            tally.note(name, outcome.unwrap_or_else(|why| Outcome::Wrong(format!("{why:#}"))));
        }
        tally
    }
}

/// Runs a reader with limits on time and memory. Returns exit code, stdout and stderr.
fn confined(reader: &Command, codes: &[i32]) -> Result<(i32, String, String)> {
    let mut command = Command::new("prlimit");
    command.args([MEMORY, "timeout", SECONDS]).arg(reader.get_program()).args(reader.get_args());
    let output = command.output().context("prlimit and timeout")?;
    let [stdout, stderr] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    match output.status.code() {
        Some(TIMED_OUT) => Err(anyhow!("it takes more than {SECONDS} s")),
        Some(code) if codes.contains(&code) => Ok((code, stdout, stderr)),
        _ => Err(anyhow!("a reader ended with {}: {stderr}", output.status)),
    }
}

fn judge(name: &str, ours: Reading, theirs: &Reading) -> Outcome {
    match (ours, theirs) {
        (Reading::Refused(why), _) if why.contains(name) => Outcome::Refused(why),
        (Reading::Refused(why), _) => Outcome::Wrong(format!("the reason does not name the file: {why}")),
        (Reading::Columns(ours), Reading::Columns(theirs)) => {
            match ours.iter().find(|ours| !is_one_of(ours, theirs)) {
                None => Outcome::Right,
                Some((column, _)) => Outcome::Wrong(format!("column {column} has other numbers than for PyArrow")),
            }
        }
        (Reading::Columns(_), Reading::Refused(why)) => Outcome::Wrong(format!("it is read, and PyArrow says: {why}")),
    }
}

/// True if PyArrow has read the same column. Missing numbers at the start and the end are ignored.
fn is_one_of(ours: &(String, Vec<Option<f64>>), theirs: &[(String, Vec<Option<f64>>)]) -> bool {
    let is_same = |a: &Option<f64>, b: &Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= ROUNDING * b.abs(),
        (a, b) => a == b,
    };
    let within = |numbers: &[Option<f64>]| {
        let start = numbers.iter().position(Option::is_some).unwrap_or(numbers.len());
        let end = numbers.iter().rposition(Option::is_some).map_or(start, |last| last + 1);
        numbers[start..end].to_vec()
    };
    let numbers = within(&ours.1);
    theirs.iter().filter(|(name, _)| *name == ours.0).map(|(_, theirs)| within(theirs)).any(|theirs| {
        theirs.len() == numbers.len() && theirs.iter().zip(&numbers).all(|(theirs, ours)| is_same(ours, theirs))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(columns: &[(&str, &[Option<f64>])]) -> Reading {
        Reading::Columns(columns.iter().map(|(name, numbers)| ((*name).to_owned(), numbers.to_vec())).collect())
    }

    #[test]
    fn other_numbers_are_wrong() {
        let theirs = said(&[("a", &[None, Some(1.0), None, Some(2.0)]), ("a", &[Some(5.0)])]);
        let outcome = |numbers: &[Option<f64>]| judge("f", said(&[("a", numbers)]), &theirs);
        assert!(matches!(outcome(&[Some(1.0), None, Some(2.0), None]), Outcome::Right));
        assert!(matches!(outcome(&[Some(5.0)]), Outcome::Right));
        for other in [&[Some(1.0), None, Some(2.1)][..], &[Some(1.0), Some(2.0)], &[Some(1.0)], &[]] {
            assert!(matches!(outcome(other), Outcome::Wrong(_)), "{other:?}");
        }
        assert!(matches!(judge("f", said(&[("b", &[])]), &theirs), Outcome::Wrong(_)));
    }

    #[test]
    fn a_reason_names_the_file() {
        let refused = |why: &str| Reading::Refused(why.to_owned());
        let theirs = refused("damaged");
        assert!(matches!(judge("a/f", refused("x/a/f: damaged"), &theirs), Outcome::Refused(_)));
        assert!(matches!(judge("a/f", refused("damaged"), &theirs), Outcome::Wrong(_)));
        assert!(matches!(judge("a/f", said(&[]), &theirs), Outcome::Wrong(_)));
    }
}
