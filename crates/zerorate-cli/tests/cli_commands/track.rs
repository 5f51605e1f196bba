//! `stream --track`: what it prints, and what becomes of its state.

use super::zerorate;
use std::path::Path;

const CALIBRATION: &str = "schema = 1\npart = \"ADIS16130\"\nserial = \"A1\"\n[correction]\npbc_dps = -0.8\n\
    btc_dps_per_c = -0.04\nt3_c = 25.0\n";
/// At rest, 0.004 °/s above its calibration.
const DEVICE: &str = "twin:seed=7,bias_dps=0.804,tempco_dps_per_c=0.04,curvature=0,hysteresis=0,warmup_c=0";

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder"));
        std::fs::write(folder.0.path().join("unit.toml"), CALIBRATION).expect("written");
        folder
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.path().join(name)).expect("a file")
    }

    fn track(&self, duration: &str, more: &[&str]) -> super::Run {
        let (cal, state) = (self.path("unit.toml"), self.path("state.toml"));
        let mut line = vec!["stream", "--device", DEVICE, "--cal", &cal, "--serial", "A1", "--rate", "0.2"];
        line.extend(["--duration", duration, "--track", "--state", &state]);
        line.extend(more);
        zerorate(&line)
    }
}

fn columns(csv: &str) -> Vec<Vec<&str>> {
    csv.lines().map(|line| line.split(',').collect()).collect()
}

#[test]
fn rows_tell_bias_uncertainty_and_rest_and_the_state_is_taken_up() {
    let folder = Folder::new();
    let first =
        folder.track("60s", &[]).ended_with(0).saying(&["tracked rate: ", "s of rest learned from", "°/s (95 %)"]);
    let rows = columns(&first.stdout);
    assert_eq!(rows[0][6..], ["bias_dps", "u_bias_dps", "phase"], "{}", first.stdout);
    let number = |row: &[&str], at: usize| row[at].parse::<f64>().expect("a number");
    let (early, late) = (&rows[1], rows.last().expect("rows"));
    assert_eq!((early[8], late[8]), ("moving", "rest"), "{}", first.stdout);
    assert!(number(late, 7) < 0.7 * number(early, 7), "{}", first.stdout);
    assert!((number(late, 6) - 0.804).abs() < 3.0 * number(late, 7) + 0.03, "sensitivity too: {}", first.stdout);
    assert!(number(late, 1).abs() < 0.02, "what is left: {}", first.stdout);

    let state = folder.read("state.toml");
    assert!(state.contains("line_checks") && state.contains("learned_s"), "{state}");
    let again = folder.track("20s", &["--format", "jsonl"]).ended_with(0).saying(&["state-age-unknown"]);
    let row: serde_json::Value = serde_json::from_str(again.stdout.lines().next().expect("a row")).expect("JSON");
    let (bias, u) = (row["bias_dps"].as_f64().expect("a bias"), row["u_bias_dps"].as_f64().expect("its u"));
    assert!((bias - number(late, 6)).abs() < 0.02 && u < 0.04, "{row}");
    assert_eq!(row["phase"], "moving");
    assert_eq!(row["calibration"].as_str().map(str::len), Some(12));
}

/// Damaged, cut short, written by hand, of another calibration, or no state at all: refused, said, and left as it is.
#[test]
fn a_state_that_cannot_be_taken_up_is_refused_and_kept() {
    let folder = Folder::new();
    folder.track("20s", &[]).ended_with(0);
    let good = folder.read("state.toml");
    let unchecked: String =
        good.lines().filter(|line| !line.contains("check")).map(|line| format!("{line}\n")).collect();
    let shorter = good.lines().take(good.lines().count() - 2).collect::<Vec<_>>().join("\n");
    for (bad, why) in [
        (good.replace("at_c = ", "at_c = 1"), "is not what was written"),
        (shorter, "but more was written"),
        (unchecked, "no check lines"),
        ("\u{1}\u{2}".to_owned(), "line 1"),
        (String::new(), "missing field"),
        (CALIBRATION.to_owned(), "unknown field"),
    ] {
        std::fs::write(folder.path("state.toml"), &bad).expect("written");
        folder.track("1s", &[]).ended_with(1).saying(&[why, "delete it to begin from the calibration"]);
        assert_eq!(folder.read("state.toml"), bad, "{why}");
    }
    std::fs::write(folder.path("state.toml"), &good).expect("written");
    let other = CALIBRATION.replace("-0.8", "-0.7");
    std::fs::write(folder.path("unit.toml"), other).expect("written");
    folder.track("1s", &[]).ended_with(1).saying(&["it continues calibration", "delete it"]);
    assert_eq!(folder.read("state.toml"), good);
}

#[test]
fn what_makes_no_sense_is_a_usage_error() {
    let folder = Folder::new();
    let cal = folder.path("unit.toml");
    zerorate(&["stream", "--cal", &cal, "--state", "x.toml"]).ended_with(2).saying(&["--track"]);
    folder.track("1s", &["--earth-dps", "0.1"]).ended_with(2).saying(&["0.0042", "F-16"]);
    folder.track("1s", &["--earth-dps", "0.002"]).ended_with(2).saying(&["calibrate with --earth-dps"]);
    folder.track("1s", &["--least-turn-dps", "-1"]).ended_with(2);
    assert!(!Path::new(&folder.path("state.toml")).exists(), "nothing was written");
}
