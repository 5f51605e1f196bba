//! What cannot be calibrated: the reason on stderr, the exit code, and no file.

use super::{SHORT, calibrate, zerorate};
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

/// The columns of the data rows of a CSV file.
fn rows(text: &str) -> Vec<Vec<&str>> {
    text.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(',').collect()).collect()
}

fn with_calibration() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("unit.toml");
    let text = "schema = 1\npart = \"ADIS16130\"\n[correction]\npbc_dps = 0.5\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n";
    std::fs::write(&file, text).expect("written");
    let file = path(&file).to_owned();
    (folder, file)
}

/// Recorded to the end, and then told; `correct` flags it, `allan` and `stream` stop.
#[test]
fn a_frozen_part_is_believed_by_nobody() {
    let (folder, cal) = with_calibration();
    let device = "twin:seed=3,fault=frozen,fault_at_s=2";
    let [file, done] = ["f.arrows", "done.csv"].map(|name| folder.path().join(name));
    let capture = zerorate(&["capture", "--device", device, "--duration", "4s", "-o", path(&file), "--json"]);
    let capture = capture.ended_with(3).saying(&["refused: ", "frozen", "since 2.0 s", "raw codes"]);
    let summary = capture.json();
    assert_eq!(summary["frozen"], true, "{summary}");
    assert!(summary["samples"].as_u64().is_some_and(|samples| samples > 22_000), "nothing is lost: {summary}");
    zerorate(&["correct", path(&file), "--cal", &cal, "-o", path(&done)]).ended_with(0).saying(&["frozen"]);
    let text = std::fs::read_to_string(&done).expect("a corrected capture");
    let rows = rows(&text);
    let flagged = rows.iter().filter(|row| row[9] == "4").count();
    assert!((10_500..11_500).contains(&flagged), "{flagged} of {} rows", rows.len());
    assert!(rows.iter().all(|row| (row[9] == "0") != row[8].is_empty()), "flagged rows have no corrected rate");
    let stream = zerorate(&["stream", "--cal", &cal, "--device", device, "--duration", "10s", "--rate", "10"]);
    let stream = stream.ended_with(3).saying(&["refused: ", "frozen"]);
    let last = stream.stdout.lines().last().expect("rows");
    assert!(last.ends_with("frozen"), "{last}");
    assert!(stream.stdout.lines().count() < 25, "it ends soon after");
    zerorate(&["allan", path(&file)]).ended_with(3).saying(&["refused: ", "frozen"]);
}

/// F-35: with CLAMP = 0 a code wraps at 357 °/s, and 360 °/s reads as −354 °/s.
#[test]
fn out_of_range_means_the_same_everywhere() {
    let (folder, cal) = with_calibration();
    let device = "twin:rotation_dps=360";
    let [file, done] = ["f.arrows", "done.csv"].map(|name| folder.path().join(name));
    let capture = ["capture", "--device", device, "--samples", "1000", "-o", path(&file), "--json"];
    let summary = zerorate(&capture).ended_with(0).json();
    assert_eq!(summary["out_of_range"], 1000, "{summary}");
    zerorate(&["correct", path(&file), "--cal", &cal, "-o", path(&done)])
        .ended_with(0)
        .saying(&["out-of-range: ", ": 1000 readings"]);
    let text = std::fs::read_to_string(&done).expect("a corrected capture");
    assert!(rows(&text).iter().all(|row| row[8].is_empty() && row[9] == "2"));
    let stream = zerorate(&["stream", "--cal", &cal, "--device", device, "--duration", "100ms"]).ended_with(0);
    assert!(rows(&stream.stdout).iter().all(|row| row[1].is_empty() && row[5] == "out-of-range"), "{}", stream.stdout);
    stream.saying(&["out-of-range"]);
    let probe = zerorate(&["probe", "--device", device, "--duration", "1s", "--json"]).ended_with(0).json();
    assert!(probe["warnings"][0].as_str().is_some_and(|text| text.starts_with("out-of-range: ")), "{probe}");
    refused(device, 3, &["refused: ", "out of range"]);
}

#[test]
fn bit_errors_are_marked_and_named() {
    let (folder, cal) = with_calibration();
    let device = "twin:seed=4,bit_error_rate=0.00002,fault_at_s=0.5";
    let [file, done] = ["f.arrows", "done.csv"].map(|name| folder.path().join(name));
    let capture = ["capture", "--device", device, "--duration", "20s", "-o", path(&file), "--json"];
    let summary = zerorate(&capture).ended_with(0).json();
    let impossible = summary["impossible_readings"].as_u64().expect("a count");
    assert!(impossible > 5, "{summary}");
    assert!(summary["warnings"].to_string().contains("impossible-readings: "), "{summary}");
    zerorate(&["correct", path(&file), "--cal", &cal, "-o", path(&done)]).ended_with(0).saying(&["impossible"]);
    let text = std::fs::read_to_string(&done).expect("a corrected capture");
    let rows_ = rows(&text);
    let flagged = rows_.iter().filter(|row| row[9].parse::<u8>().expect("a number") & 1 == 1).count() as u64;
    assert_eq!(flagged, impossible, "the same judge over the capture");
    let believed = |row: &&Vec<&str>| !row[8].is_empty();
    assert!(rows_.iter().filter(believed).all(|row| row[6].parse::<f64>().expect("a rate").abs() < 7.0));
    let stream = zerorate(&["stream", "--cal", &cal, "--device", device, "--duration", "20s"]).ended_with(0);
    let live = rows(&stream.stdout).iter().filter(|row| row[5].contains("impossible") && row[1].is_empty()).count();
    assert_eq!(live as u64, impossible, "and over the live part");
    let allan = zerorate(&["allan", path(&file), "--json"]).ended_with(0).json();
    assert!(allan["missing"].as_u64().is_some_and(|missing| missing >= impossible), "gaps, not values");
    assert!(allan["points"][0]["dev"].as_f64().is_some_and(|dev| dev < 0.3), "{}", allan["points"][0]);
}

/// The same readings are left out again: the capture is the truth, and its raw codes are as they were read.
#[test]
fn a_calibration_over_a_bad_line_is_repeated_from_its_log() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log.arrows");
    let device = "twin:seed=5,bit_error_rate=0.000002,fault_at_s=0.5";
    let live = calibrate(&["--device", device, "--log", path(&log), "--json"]).ended_with(0).json();
    assert!(live["impossible_readings"].as_u64().is_some_and(|count| count > 0), "{live}");
    assert!(live["warnings"].to_string().contains("impossible-readings: "), "{live}");
    let again = zerorate(&[&["recalibrate", path(&log), "--json"], SHORT].concat()).ended_with(0).json();
    for key in ["pbc_dps", "btc_dps_per_c", "t3_c", "impossible_readings", "capture_sha256", "calibration_id"] {
        assert_eq!(live[key], again[key], "{key}");
    }
}

/// In any log: zeros all over are not noise. One that stops is said.
#[test]
fn allan_believes_no_constant_column() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("log.csv");
    let log = |rate: &dyn Fn(u32) -> u32| {
        let rows: String = (0..5000).map(|k| format!("{}\n", rate(k))).collect();
        std::fs::write(&file, format!("gz_dps\n{rows}")).expect("written");
        zerorate(&["allan", path(&file), "--rate", "100"])
    };
    log(&|_| 7).ended_with(3).saying(&["refused: ", "all 5000 samples", "the same"]);
    let noise = |k: u32| k.wrapping_mul(2_654_435_761) >> 20;
    log(&|k| noise(k.min(3000))).ended_with(0).saying(&["frozen: ", "the last 2000 of 5000 samples"]);
    let said = "2000 of 5000 samples of column gz_dps are the same, from 15.0 s on";
    log(&|k| noise(if (1500..3500).contains(&k) { 1500 } else { k })).ended_with(0).saying(&["frozen: ", said]);
    assert!(!log(&noise).ended_with(0).stderr.contains("frozen"));
}

#[test]
fn a_stuttering_line_is_not_blamed_on_the_host() {
    let probe = zerorate(&["probe", "--device", "twin:fault=rdy_stutter", "--duration", "1s", "--json"]).ended_with(0);
    let warnings = probe.json()["warnings"].to_string();
    assert!(warnings.contains("data-ready-stutters: ") && !warnings.contains("lost-samples: "), "{warnings}");
    refused("twin:fault=rdy_stutter", 3, &["refused: ", "data ready stutters"]);
}

/// 100 pairs a second fold 14.3 kHz (F-07) to zero: 2 · 527 cycles at 105.4 kHz. 220 samples do as well.
#[test]
fn a_rate_that_folds_the_resonance_to_zero_is_warned_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("slow.arrows");
    let device = "twin:mclk_hz=105400";
    let probe = zerorate(&["probe", "--device", device, "--json"]).ended_with(0).json();
    let capture = zerorate(&["capture", "--device", device, "--duration", "5s", "-o", path(&file), "--json"]);
    let capture = capture.ended_with(0).json();
    let calibrated = calibrate(&["--device", "twin:mclk_hz=231880", "--json"]).ended_with(0).json();
    for (found, rate) in [(&probe, "at 100.0/s"), (&capture, "at 100.0/s"), (&calibrated, "at 220.0/s")] {
        let warnings = found["warnings"].to_string();
        let wanted = ["resonance: ", rate, "none at 2"];
        assert!(wanted.iter().all(|text| warnings.contains(text)), "{warnings}");
    }
    let good = zerorate(&["probe", "--device", "twin:mclk_hz=6000000", "--json"]).ended_with(0).json();
    assert!(!good["warnings"].to_string().contains("resonance"), "{good}");
}
