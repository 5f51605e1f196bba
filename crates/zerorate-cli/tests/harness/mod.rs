//! The program as a process, and its result. Every test starts the program through this module.

#[cfg(unix)]
pub mod script_chamber;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The path of the program, for tests in which another program starts it.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_zerorate");

/// Options for a calibration in 205 s of simulated time. `--max-u-btc` accepts the large uncertainty of BTC.
pub const SHORT: &str = "--average 2s --warmup 60s --settle 120s --offset 20s --max-u-btc 0.2";

/// A plan of two soak points, which take five to six minutes of simulated time.
pub const SOAK: &str = "schema = 1\nwindow_s = 20\naverage_s = 30\nsettle_timeout_s = 600\ndrift_c_per_min = 0.2\n\
    [[step]]\nto_c = 15\n[[step]]\nto_c = 45\n";

/// A calibration file with only the required fields.
pub fn calibration(pbc_dps: f64, btc_dps_per_c: f64, t3_c: f64) -> String {
    format!(
        "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = {pbc_dps:?}\nbtc_dps_per_c = \
         {btc_dps_per_c:?}\nt3_c = {t3_c:?}\n"
    )
}

/// A calibration file with the required fields, and the serial number of the part.
pub fn calibration_of(serial: &str, pbc_dps: f64, btc_dps_per_c: f64, t3_c: f64) -> String {
    let head = format!("serial = {serial:?}\n[correction]");
    calibration(pbc_dps, btc_dps_per_c, t3_c).replace("[correction]", &head)
}

pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(args);
    command
}

pub fn start(command: &mut Command) -> Child {
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// Sends a signal, named without SIG.
pub fn send(signal: &str, child: &Child) {
    let sent = Command::new("sh").args(["-c", &format!("kill -{signal} {}", child.id())]).status().expect("sh");
    assert!(sent.success());
}

#[track_caller]
pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(120);
    while !is_so() {
        assert!(Instant::now() < deadline, "not within two minutes: {what}");
        thread::sleep(Duration::from_millis(10));
    }
}

pub struct Bench {
    pub dir: TempDir,
}

impl Bench {
    pub fn new() -> Self {
        Self { dir: TempDir::new().expect("a folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, content).expect("room for a file");
        path
    }

    #[track_caller]
    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect(name)
    }

    pub fn names(&self) -> Vec<String> {
        names(self.dir.path())
    }

    /// The program in this folder, with the words of `line` as arguments.
    pub fn command(&self, line: &str) -> Command {
        let mut command = command(&line.split(' ').collect::<Vec<_>>());
        command.current_dir(self.dir.path());
        command
    }

    pub fn zerorate(&self, line: &str) -> Run {
        Run::of(&mut self.command(line))
    }
}

/// The sorted names of the entries of a folder.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").file_name());
    let mut names: Vec<String> = entries.map(|name| name.into_string().expect("UTF-8")).collect();
    names.sort();
    names
}

#[derive(Debug)]
pub struct Run {
    /// The command line; empty for a process that was started elsewhere.
    pub line: String,
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            line: String::new(),
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("stdout is UTF-8"),
            stderr: String::from_utf8(output.stderr).expect("stderr is UTF-8"),
        }
    }
}

impl Run {
    /// Waits for the end of a process that is already running.
    pub fn ended(child: Child) -> Self {
        child.wait_with_output().expect("it ends").into()
    }

    pub fn of(command: &mut Command) -> Self {
        let output = command.output().expect("the program starts");
        Self { line: format!("{command:?}"), ..output.into() }
    }

    /// Checks the exit code. Returns the run.
    #[track_caller]
    pub fn ended_with(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}\nstdout:\n{}\nstderr:\n{}", self.line, self.stdout, self.stderr);
        self
    }

    /// Checks that stderr contains these texts. Returns the run.
    #[track_caller]
    pub fn saying(self, texts: &[&str]) -> Self {
        for text in texts {
            assert!(self.stderr.contains(text), "{}\nno {text:?} on stderr:\n{}", self.line, self.stderr);
        }
        self
    }

    /// Checks that the run succeeded. Returns stdout.
    #[track_caller]
    pub fn ok(self) -> String {
        self.ended_with(0).stdout
    }

    /// Checks that the run failed with this code, stated these reasons and printed no data. Returns stderr.
    #[track_caller]
    pub fn fails(self, code: i32, reasons: &[&str]) -> String {
        let run = self.ended_with(code).saying(reasons);
        assert_eq!(run.stdout, "", "{} printed data", run.line);
        run.stderr
    }

    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).expect("one JSON object on stdout")
    }
}
