//! `stream --track`: its rows and its state file.

use crate::harness::{Bench, Run, calibration, calibration_of, start};
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout};

/// A part at rest whose bias is 0.004 °/s larger than calibrated.
const DEVICE: &str = "twin:seed=7,bias_dps=0.804,tempco_dps_per_c=0.04,curvature=0,hysteresis=0,warmup_c=0";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("unit.toml", calibration_of("A1", -0.8, -0.04, 25.0));
    bench
}

fn track(bench: &Bench, duration: &str, more: &str) -> Run {
    let line = format!("stream --device {DEVICE} --cal unit.toml --serial A1 --rate 0.2 --duration {duration}");
    bench.zerorate(format!("{line} --track --state state.toml {more}").trim_end())
}

/// A stream whose rows the test reads step by step. Its pipe lets the stream run at most a few thousand rows ahead.
struct HaltedRun {
    child: Child,
    rows: BufReader<ChildStdout>,
}

impl HaltedRun {
    fn start(bench: &Bench, state: &str) -> Self {
        let line = format!("stream --device {DEVICE} --cal unit.toml --serial A1 --rate 50 --duration 10m");
        let mut child = start(&mut bench.command(&format!("{line} --track --state {state}")));
        let mut halted = Self { rows: BufReader::new(child.stdout.take().expect("stdout")), child };
        halted.read(1);
        halted
    }

    fn read(&mut self, rows: usize) {
        for _ in 0..rows {
            assert!(self.rows.read_line(&mut String::new()).expect("a row") > 0, "the rows ended");
        }
    }

    /// Reads the rest. Returns the number of remaining rows, the exit code and stderr.
    fn end(mut self) -> (usize, Option<i32>, String) {
        let rows = self.rows.lines().collect::<Result<Vec<String>, _>>().expect("rows").len();
        let mut said = String::new();
        self.child.stderr.take().expect("stderr").read_to_string(&mut said).expect("text");
        (rows, self.child.wait().expect("an end").code(), said)
    }
}

/// Number of rows of ten minutes at 50 Hz, without the last row, whose interval is incomplete.
const ROWS: usize = 29_999;

/// The state of a killed stream is not locked, and its temporary file is removed.
#[cfg(unix)]
#[test]
fn a_stream_that_was_killed_leaves_its_state_free() {
    let bench = bench();
    let mut first = HaltedRun::start(&bench, "state.toml");
    first.child.kill().expect("a process");
    first.child.wait().expect("an end");
    assert_eq!(bench.names().len(), 3, "it left its claim");
    track(&bench, "1s", "").ended_with(0);
    assert_eq!(bench.names().len(), 2);
}

/// The folder of the state is renamed, so that the state cannot be written. No row is lost. If the folder comes back,
/// the state is written and the run succeeds.
#[cfg(unix)]
#[test]
fn a_state_that_cannot_be_written_ends_no_stream() {
    for comes_back in [true, false] {
        let bench = bench();
        fs::create_dir(bench.path("disk")).expect("a folder");
        let mut stream = HaltedRun::start(&bench, "disk/state.toml");
        fs::rename(bench.path("disk"), bench.path("gone")).expect("renamed");
        let read = 15_000;
        stream.read(read);
        if comes_back {
            fs::rename(bench.path("gone"), bench.path("disk")).expect("renamed");
        }
        let (rows, code, said) = stream.end();
        assert!((rows + read).abs_diff(ROWS) <= 1, "{rows} rows: {said}");
        assert_eq!(said.matches("warning: not-kept: the state cannot be written").count(), 1, "{said}");
        assert_eq!(said.contains("what was learned is in"), comes_back, "{said}");
        assert_eq!(code, Some(if comes_back { 0 } else { 1 }), "{said}");
        assert!(said.contains("s of rest learned from"), "{said}");
        assert_eq!(said.contains("error: cannot write"), !comes_back, "{said}");
    }
}

fn columns(csv: &str) -> Vec<Vec<&str>> {
    csv.lines().map(|line| line.split(',').collect()).collect()
}

#[test]
fn rows_tell_bias_uncertainty_and_rest_and_the_state_is_taken_up() {
    let bench = bench();
    let first =
        track(&bench, "60s", "").ended_with(0).saying(&["tracked rate: ", "s of rest learned from", "°/s (95 %)"]);
    let rows = columns(&first.stdout);
    assert_eq!(rows[0][6..], ["bias_dps", "u_bias_dps", "phase"], "{}", first.stdout);
    let number = |row: &[&str], at: usize| row[at].parse::<f64>().expect("a number");
    let (early, late) = (&rows[1], rows.last().expect("rows"));
    assert_eq!((early[8], late[8]), ("moving", "rest"), "{}", first.stdout);
    assert!(number(late, 7) < 0.7 * number(early, 7), "{}", first.stdout);
    assert!((number(late, 6) - 0.804).abs() < 3.0 * number(late, 7) + 0.03, "sensitivity too: {}", first.stdout);
    assert!(number(late, 1).abs() < 0.02, "what is left: {}", first.stdout);

    let state = bench.text("state.toml");
    assert!(state.contains("line_checks") && state.contains("learned_s"), "{state}");
    let again = track(&bench, "20s", "--format jsonl").ended_with(0).saying(&["state-age-unknown"]);
    let row: serde_json::Value = serde_json::from_str(again.stdout.lines().next().expect("a row")).expect("JSON");
    let (bias, u) = (row["bias_dps"].as_f64().expect("a bias"), row["u_bias_dps"].as_f64().expect("its u"));
    assert!((bias - number(late, 6)).abs() < 0.02 && u < 0.04, "{row}");
    assert_eq!(row["phase"], "moving");
    assert_eq!(row["calibration"].as_str().map(str::len), Some(12));
}

#[test]
fn a_state_that_cannot_be_taken_up_is_refused_and_kept() {
    let bench = bench();
    track(&bench, "20s", "").ended_with(0);
    let good = bench.text("state.toml");
    let unchecked: String =
        good.lines().filter(|line| !line.contains("check")).map(|line| format!("{line}\n")).collect();
    let shorter = good.lines().take(good.lines().count() - 2).collect::<Vec<_>>().join("\n");
    for (bad, why) in [
        (good.replace("at_c = ", "at_c = 1"), "is not what was written"),
        (shorter, "but more was written"),
        (unchecked, "no check lines"),
        ("\u{1}\u{2}".to_owned(), "line 1"),
        (String::new(), "missing field"),
        (calibration(-0.8, -0.04, 25.0), "unknown field"),
    ] {
        bench.write("state.toml", &bad);
        track(&bench, "1s", "").ended_with(1).saying(&[why, "delete it to begin from the calibration"]);
        assert_eq!(bench.text("state.toml"), bad, "{why}");
    }
    bench.write("state.toml", &good);
    bench.write("unit.toml", calibration_of("A1", -0.7, -0.04, 25.0));
    track(&bench, "1s", "").ended_with(1).saying(&["it continues calibration", "delete it"]);
    assert_eq!(bench.text("state.toml"), good);
}

#[test]
fn contradictory_options_are_a_usage_error() {
    let bench = bench();
    bench.zerorate("stream --cal unit.toml --state x.toml").ended_with(2).saying(&["--track"]);
    track(&bench, "1s", "--earth-dps 0.1").ended_with(2).saying(&["0.0042", "F-16"]);
    track(&bench, "1s", "--earth-dps 0.002").ended_with(2).saying(&["calibrate with --earth-dps"]);
    assert!(!bench.path("state.toml").exists(), "nothing was written");
}
