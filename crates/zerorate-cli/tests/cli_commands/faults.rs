//! What cannot be calibrated: the reason on stderr, the exit code, and no file.

use crate::{calibrate, zerorate};
use std::path::Path;

/// Calibrates that device into a file of a folder of its own, and expects that nothing is left there.
#[track_caller]
fn refused(device: &str, code: i32, reasons: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("unit.toml");
    let run = calibrate(&["--device", device, "-o", path(&file), "--json"]).ended_with(code).saying(reasons);
    assert_eq!(run.stdout, "", "{device}: nothing for scripts to take for a result");
    let left: Vec<_> = std::fs::read_dir(folder.path()).expect("the folder").collect();
    assert!(left.is_empty(), "{device}: {left:?}");
}

fn path(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

#[test]
fn what_was_measured_but_must_not_be_used_is_3() {
    refused("twin:motion=sway", 3, &["refused: ", "moves", "first average"]);
    refused("twin:ambient_c=-40,warmup_c=0", 3, &["refused: ", "temperature hardly changed"]);
    refused("twin:fault=frozen,fault_at_s=30", 3, &["refused: ", "frozen"]);
    refused("twin:fault=rdy_stutter", 3, &["refused: ", "lost"]);
}

#[test]
fn a_dead_bus_or_a_part_that_does_not_answer_is_1() {
    refused("twin:fault=sdo_low", 1, &["stuck at zeros", "pin 12", "alive"]);
    refused("twin:fault=sdo_high", 1, &["stuck at ones", "pin 12", "alive"]);
    refused("twin:fault=unplug", 1, &["unplugged", "pin 10", "pins 11, 13, 15"]);
}

#[test]
fn the_same_later_on_says_when() {
    refused("twin:fault=sdo_low,fault_at_s=30", 1, &["30.0 s after power-on", "stuck at zeros", "pin 12"]);
    refused("twin:fault=sdo_high,fault_at_s=30", 1, &["stuck at ones", "pin 12"]);
    refused("twin:fault=brownout,fault_at_s=30", 1, &["lost its configuration", "5 V supply"]);
    refused("twin:fault=unplug,fault_at_s=30", 1, &["unplugged", "pin 10"]);
    refused("twin:fault=rdy_lost,fault_at_s=30", 1, &["no data ready", "RDY (pin 10)"]);
}

#[test]
fn a_refusal_leaves_an_older_calibration_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("unit.toml");
    std::fs::write(&file, "older").expect("written");
    calibrate(&["--device", "twin:motion=sway", "-o", path(&file), "--force"]).ended_with(3);
    assert_eq!(std::fs::read_to_string(&file).expect("still there"), "older");
}

#[test]
fn a_place_that_cannot_be_written_is_known_before_the_hour_is_spent() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("missing/unit.toml");
    for place in [folder.path(), &missing] {
        // full length: it would take long if it started
        zerorate(&["calibrate", "-o", path(place)]).ended_with(1).saying(&["cannot write"]);
    }
}

#[test]
fn probe_says_what_is_wired_wrong() {
    zerorate(&["probe", "--device", "twin:fault=sdo_low"]).ended_with(1).saying(&["pin 12"]);
    zerorate(&["probe", "--device", "twin:fault=rdy_lost"]).ended_with(1).saying(&["pin 10"]);
    zerorate(&["probe", "--device", "twin:fault=unplug"]).ended_with(1).saying(&["cable"]);
    let frozen = zerorate(&["probe", "--device", "twin:fault=frozen", "--json"]).ended_with(0).json();
    assert!(frozen["warnings"][0].as_str().is_some_and(|text| text.starts_with("frozen: ")), "{frozen}");
}
