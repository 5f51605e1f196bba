//! The program as its users and their scripts see it: what it prints where, and how it ends.

mod bridge;
mod calibrate;
mod faults;
mod help;
mod reading;

use std::process::{Command, Output};

/// A calibration in four minutes of part time. Its BTC is poor, which `--max-u-btc` accepts.
const SHORT: &[&str] =
    &["--average", "2s", "--warmup", "60s", "--settle", "120s", "--offset", "20s", "--max-u-btc", "0.2"];

/// How a run ended.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("stdout is UTF-8"),
            stderr: String::from_utf8(output.stderr).expect("stderr is UTF-8"),
        }
    }
}

impl Run {
    /// The run, if it ended with this code.
    #[track_caller]
    fn ended_with(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        self
    }

    /// The run, if stderr says each of these.
    #[track_caller]
    fn saying(self, texts: &[&str]) -> Self {
        for text in texts {
            assert!(self.stderr.contains(text), "no {text:?} on stderr:\n{}", self.stderr);
        }
        self
    }

    /// Stdout as one JSON object.
    #[track_caller]
    fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).expect("one JSON object on stdout")
    }
}

fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_zerorate"));
    command.args(args);
    command
}

fn zerorate(args: &[&str]) -> Run {
    command(args).output().expect("the program starts").into()
}

/// `zerorate calibrate` with the short durations.
fn calibrate(args: &[&str]) -> Run {
    zerorate(&[&["calibrate"], SHORT, args].concat())
}
