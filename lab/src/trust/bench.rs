//! The program under test, and the files that runs start from.

use anyhow::{Context, Result, ensure};
use rand::SeedableRng;
use rand::rngs::StdRng;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Options of a calibration that takes 205 s of the part's time and accepts the resulting poor BTC.
pub const SHORT: [&str; 10] =
    ["--average", "2s", "--warmup", "60s", "--settle", "120s", "--offset", "20s", "--max-u-btc", "0.2"];
/// Duration of that calibration in the part's time, s.
pub const SHORT_S: f64 = 205.0;

/// The program, and a folder with input files that no run changes.
pub struct Bench {
    pub program: PathBuf,
    folder: Folder,
    /// The rows that `correct` writes for the undamaged recording `rest`. They are the same for every file format.
    pub rest_rows: String,
    /// Number of lines on stderr when it writes them.
    pub rest_words: usize,
}

/// A folder below `target/` that is removed on drop.
pub struct Folder(PathBuf);

impl Folder {
    /// Makes an empty folder for this process.
    pub fn new(name: &str) -> Result<Self> {
        let path = std::path::absolute(Path::new("target/trust").join(format!("{}-{name}", std::process::id())))?;
        std::fs::create_dir_all(&path).with_context(|| path.display().to_string())?;
        Ok(Self(path))
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn file(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    pub fn names(&self) -> Result<Vec<String>> {
        let entries = std::fs::read_dir(&self.0)?;
        let mut names: Vec<String> =
            entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect::<Result<_>>()?;
        names.sort();
        Ok(names)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // a failure does not matter, since a folder that remains does no harm
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Self { code: output.status.code(), stdout: text(&output.stdout), stderr: text(&output.stderr) }
    }
}

impl Run {
    pub fn json(&self) -> Result<Value> {
        serde_json::from_str(&self.stdout).with_context(|| format!("no JSON: {:?}", self.stdout))
    }

    /// The last line of stderr, with placeholders for numbers and paths, so that equal errors have equal texts.
    pub fn complaint(&self) -> String {
        let line = self.stderr.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("nothing on stderr");
        let words: Vec<&str> = line.split(' ').map(|word| if word.starts_with('/') { "FILE" } else { word }).collect();
        words.join(" ").chars().map(|c| if c.is_ascii_digit() { '#' } else { c }).take(160).collect()
    }

    pub fn says(&self, causes: &[&str]) -> bool {
        causes.iter().any(|cause| self.stderr.contains(cause) || self.stdout.contains(cause))
    }

    /// The verdict on a run that must end with an error. The error must name one of the `causes`.
    pub fn refusal(&self, causes: &[&str]) -> super::Verdict {
        match self.code {
            Some(1 | 3) if self.says(causes) => super::Verdict::Refused,
            Some(1 | 3) => super::Verdict::Misjudged(self.complaint()),
            code => super::Verdict::Silent(format!("it ended with {code:?}: {}", self.stderr)),
        }
    }
}

impl Bench {
    pub fn new(program: PathBuf) -> Result<Self> {
        let folder = Folder::new("bench")?;
        let mut bench = Self { program, folder, rest_rows: String::new(), rest_words: 0 };
        let (log, unit) = (bench.file("unit.arrows"), bench.file("unit.toml"));
        bench.must(&[&["calibrate", "--log", &log, "-o", &unit], &SHORT[..]].concat())?;
        for form in ["arrows", "parquet", "csv"] {
            bench.must(&["capture", "--samples", "20000", "-o", &bench.file(&format!("rest.{form}"))])?;
        }
        let (run, rows) = bench.corrected(&bench.file("rest.csv"), &bench.file("corrected.csv"))?;
        ensure!(run.code == Some(0), "{}", run.stderr);
        (bench.rest_rows, bench.rest_words) = (rows, run.stderr.lines().count());
        Ok(bench)
    }

    /// Runs `correct`. Also returns the corrected rows, without metadata.
    pub fn corrected(&self, capture: &str, output: &str) -> Result<(Run, String)> {
        let run = self.run(&["correct", capture, "--cal", &self.file("unit.toml"), "-o", output])?;
        let text = std::fs::read_to_string(output).unwrap_or_default();
        let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        Ok((run, rows.join("\n")))
    }

    /// The path of an input file for all runs.
    pub fn file(&self, name: &str) -> String {
        self.folder.file(name)
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.args(args).stdin(Stdio::null());
        command
    }

    pub fn run(&self, args: &[&str]) -> Result<Run> {
        Ok(self.command(args).output().with_context(|| self.program.display().to_string())?.into())
    }

    /// Runs the program. Returns an error unless it succeeds.
    pub fn must(&self, args: &[&str]) -> Result<Run> {
        let run = self.run(args)?;
        ensure!(run.code == Some(0), "{args:?} ended with {:?}: {}", run.code, run.stderr);
        Ok(run)
    }
}

/// The random generator of a run, from the name of the class and the seed.
pub fn random(class: &str, seed: u64) -> StdRng {
    let salt = class
        .bytes()
        .fold(0xCBF2_9CE4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3));
    StdRng::seed_from_u64(salt ^ seed)
}
