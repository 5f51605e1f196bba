//! `probe`, `capture` and `stream`: reading a part, and stopping.

use super::{Run, calibrate, command, zerorate};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const CALIBRATION: &str = "schema = 1\npart = \"ADIS16130\"\nserial = \"A1\"\n[correction]\npbc_dps = \
    0.5\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n";

fn folder_with_calibration() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("unit.toml");
    std::fs::write(&file, CALIBRATION).expect("written");
    let file = path(&file).to_owned();
    (folder, file)
}

fn path(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

#[test]
fn probe_measures_rate_noise_and_losses() {
    let found = zerorate(&["probe", "--device", "twin:seed=9,mclk_hz=6000000", "--json"]).ended_with(0).json();
    let near = |key: &str, expected: f64, share: f64| {
        let value = found[key].as_f64().unwrap_or_else(|| panic!("{key} in {found}"));
        assert!((value / expected - 1.0).abs() < share, "{key}: {value}");
    };
    near("rate_hz", 5_692.6, 1e-4); // F-31
    near("rdy_hz", 5_692.6, 1e-4);
    near("white_dps_per_rt_hz", 0.0125, 0.25); // F-02
    assert_eq!(found["revision"], 0x24);
    assert_eq!(found["lost_samples"], 0);
    assert_eq!(found["warnings"].as_array().map(Vec::len), Some(0), "{found}");
}

#[test]
fn capture_ends_by_count_or_by_time_in_the_form_that_the_name_says() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, starts_with) in [
        ("a.arrows", &b"\xff\xff\xff\xff"[..]),
        #[cfg(feature = "parquet")]
        ("a.parquet", b"PAR1"),
        ("a.csv", b"# zerorate"),
    ] {
        let file = folder.path().join(name);
        let summary = zerorate(&["capture", "--samples", "1000", "-o", path(&file), "--json"]).ended_with(0).json();
        assert_eq!(summary["samples"], 1000, "{summary}");
        assert!(std::fs::read(&file).expect("a capture").starts_with(starts_with), "{name}");
        let replay = format!("replay:{}", path(&file));
        let again = folder.path().join(format!("again-{name}"));
        let timed = zerorate(&["capture", "--device", &replay, "--duration", "100ms", "-o", path(&again), "--json"]);
        let samples = timed.ended_with(0).json()["samples"].as_u64().expect("a count");
        assert!((560..=580).contains(&samples), "0.1 s at 5.7 kSPS: {samples}");
    }
}

/// F-56: f_conv/(N + 1), f_conv = 2 · 5692.6 Hz.
#[test]
fn a_divider_lowers_the_rate_and_warns_of_aliasing() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("slow.arrows");
    let args =
        ["capture", "--duration", "2s", "--divider", "50", "--device", "twin:mclk_hz=6000000", "-o", path(&file)];
    let summary = zerorate(&[&args[..], &["--json"]].concat()).ended_with(0).json();
    let rate_hz = summary["rate_hz"].as_f64().expect("a rate");
    assert!((rate_hz / (2.0 * 5_692.6 / 51.0) - 1.0).abs() < 0.005, "{rate_hz}");
    assert!(summary["warnings"][0].as_str().is_some_and(|text| text.starts_with("aliased: ")), "{summary}");
    zerorate(&[&args[..], &["--force"]].concat()).ended_with(0).saying(&["twice the bandwidth"]);
    zerorate(&args).ended_with(2).saying(&["--force"]);
}

/// F-56: the rate is as with a divider, and the edges that the counter keeps back are not losses.
#[test]
fn a_counter_in_the_line_is_told_of_in_the_address() {
    let device = "twin:mclk_hz=6000000,divided=50";
    let findings = zerorate(&["probe", "--device", device, "--duration", "3s", "--json"]).ended_with(0).json();
    let rate_hz = findings["rate_hz"].as_f64().expect("a rate");
    assert!((rate_hz / (2.0 * 5_692.6 / 51.0) - 1.0).abs() < 0.005, "{rate_hz}");
    assert_eq!(findings["lost_samples"], 0, "{findings}");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("divided.csv");
    for (divider, conversions) in [("1", 51.0), ("3", 151.0)] {
        let args =
            ["capture", "--device", device, "--divider", divider, "--duration", "3s", "--force", "--json", "-o"];
        let summary = zerorate(&[&args[..], &[path(&file)]].concat()).ended_with(0).json();
        let rate_hz = summary["rate_hz"].as_f64().expect("a rate");
        assert!((rate_hz / (2.0 * 5_692.6 / conversions) - 1.0).abs() < 0.005, "{rate_hz}");
        assert_eq!(summary["lost_samples"], 0, "{summary}");
        let text = std::fs::read_to_string(&file).expect("a capture");
        assert!(
            text.contains("zerorate.divided") && text.contains("50"),
            "{}",
            text.lines().next().unwrap_or_default()
        );
    }
    let replay = format!("replay:{}", path(&file));
    zerorate(&["probe", "--device", &replay]).ended_with(0);
    zerorate(&["probe", "--device", "twin:divided=0"]).ended_with(2).saying(&["from 1 to 65535"]);
}

#[test]
fn replays_have_decided_how_to_sample() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.arrows");
    zerorate(&["capture", "--samples", "100", "-o", path(&file)]).ended_with(0);
    let replay = format!("replay:{}", path(&file));
    zerorate(&["probe", "--device", &replay, "--divider", "2"]).ended_with(2).saying(&["--divider"]);
    zerorate(&["probe", "--device", &replay]).ended_with(0);
}

#[test]
fn stream_prints_corrected_rows() {
    let (_folder, cal) = folder_with_calibration();
    let unit = "twin:noise=0,bias_dps=0,tempco_dps_per_c=0,curvature=0,hysteresis=0,warmup_c=0";
    let args = ["stream", "--cal", &cal, "--device", unit, "--duration", "1s", "--rate", "4"];
    let rows = zerorate(&args).ended_with(0).saying(&["warning: no-checksum: "]).stdout;
    let rows: Vec<Vec<&str>> = rows.lines().map(|row| row.split(',').collect()).collect();
    assert_eq!(rows[0], ["t_s", "rate_dps", "temp_c", "lost", "calibration", "flags"]);
    assert_eq!(rows.len(), 1 + 4);
    for row in &rows[1..] {
        let [rate_dps, temp_c] = [row[1], row[2]].map(|cell| cell.parse::<f64>().expect("a number"));
        // F-50: 0.5 + (TEMP − 31.5) · −0.04
        assert!((rate_dps - (0.5 - 0.04 * (temp_c - 31.5))).abs() < 1e-4, "{row:?}");
        assert!((temp_c - 25.0).abs() < 0.01 && row[3] == "0", "{row:?}");
    }
    let lines = zerorate(&[&args[..], &["--format", "jsonl"]].concat()).ended_with(0).stdout;
    for line in lines.lines() {
        let row: serde_json::Value = serde_json::from_str(line).expect("an object");
        assert!(["t_s", "rate_dps", "temp_c", "lost"].iter().all(|key| row[*key].is_number()), "{row}");
    }
    assert_eq!(lines.lines().count(), 4);
    // and by a curve
    let curve =
        CALIBRATION.replace("schema = 1", "schema = 3") + "btc2_dps_per_c2 = 0.002\nbtc3_dps_per_c3 = -0.0001\n";
    std::fs::write(&cal, curve).expect("written");
    for row in zerorate(&args).ended_with(0).stdout.lines().skip(1) {
        let row: Vec<f64> = row.split(',').take(3).map(|cell| cell.parse().expect("a number")).collect();
        let d = row[2] - 31.5;
        assert!((row[1] - (0.5 - 0.04 * d + 0.002 * d * d - 0.0001 * d * d * d)).abs() < 1e-4, "{row:?}");
    }
}

#[test]
fn stream_refuses_what_does_not_fit() {
    let (_folder, cal) = folder_with_calibration();
    let stream = |more: &[&str]| zerorate(&[&["stream", "--duration", "10ms", "--cal"], more].concat());
    stream(&[&cal, "--serial", "B2"]).ended_with(1).saying(&["A1", "B2"]);
    stream(&[&cal, "--serial", "A1"]).ended_with(0);
    stream(&[&cal]).ended_with(0).saying(&["unknown-serial", "part A1", "--serial SN"]);
    stream(&["none.toml"]).ended_with(1).saying(&["none.toml"]);
    stream(&[&cal, "--rate", "0"]).ended_with(2).saying(&["--rate"]);
    stream(&[&cal, "--device", "twin:fault=sdo_low"]).ended_with(1).saying(&["pin 12"]);
}

/// Every part has its own bias, and the wrong one shows in nothing: where no number is known, that is said.
#[test]
fn stream_knows_the_part_of_a_recording() {
    let (folder, cal) = folder_with_calibration();
    let nameless = folder.path().join("nameless.toml");
    std::fs::write(&nameless, CALIBRATION.replace("serial = \"A1\"\n", "")).expect("written");
    for (serial, code, said) in [("A1", 0, "no checksum"), ("B2", 1, "is part B2, ")] {
        let file = folder.path().join(format!("{serial}.arrows"));
        zerorate(&["capture", "--samples", "100", "--serial", serial, "-o", path(&file)]).ended_with(0);
        let replay = format!("replay:{}", path(&file));
        let stream = |more: &[&str]| zerorate(&[&["stream", "--device", &replay, "--cal"], more].concat());
        let run = stream(&[&cal]).ended_with(code).saying(&[said]);
        assert!(!run.stderr.contains("unknown-serial"), "{}", run.stderr);
        stream(&[&cal, "--serial", "C3"])
            .ended_with(1)
            .saying(&[&format!("the recording is of part {serial}"), "part C3"]);
        stream(&[path(&nameless)]).ended_with(0).saying(&["unknown-serial", "calibrate with one next time"]);
    }
}

#[test]
fn stream_warns_outside_the_span_of_the_calibration() {
    let (_folder, cal) = folder_with_calibration();
    std::fs::write(&cal, format!("{CALIBRATION}[validity]\ntemp_min_c = 30.0\ntemp_max_c = 33.0\n")).expect("written");
    let run =
        zerorate(&["stream", "--cal", &cal, "--duration", "1s"]).ended_with(0).saying(&["leaves the 30.0 … 33.0 °C"]);
    assert_eq!(run.stderr.matches("leaves").count(), 1, "said once");
}

#[test]
fn a_reader_that_goes_away_ends_a_stream_quietly() {
    let (_folder, cal) = folder_with_calibration();
    let mut child = start(&["stream", "--cal", &cal]);
    let mut first = String::new();
    let mut rows = BufReader::new(child.stdout.take().expect("a pipe"));
    rows.read_line(&mut first).expect("a row");
    drop(rows);
    let run = ended(child).ended_with(0);
    assert!(!run.stderr.contains("error") && !run.stderr.contains("panicked"), "{}", run.stderr);
}

#[test]
fn interrupted_a_capture_is_whole_and_a_stream_ends_well() {
    let (folder, cal) = folder_with_calibration();
    let file = folder.path().join("long.arrows");
    let capture = start(&["capture", "--realtime", "-o", path(&file)]);
    let mut stream = start(&["stream", "--realtime", "--rate", "20", "--cal", &cal]);
    let mut rows = BufReader::new(stream.stdout.take().expect("a pipe")).lines();
    // Two rows: by now the samples come. Rows are not held back until a buffer is full.
    assert!(rows.by_ref().take(3).all(|row| row.is_ok()));
    wait_for(&file);
    interrupt(&stream);
    interrupt(&capture);
    ended(stream).ended_with(0);
    let run = ended(capture).ended_with(0);
    assert!(run.stdout.contains("interrupted"), "{}", run.stdout);
    let replay = format!("replay:{}", path(&file));
    let found = zerorate(&["probe", "--device", &replay, "--json"]).ended_with(0).saying(&[]);
    assert!(!found.stderr.contains("warning"), "the file has its end: {}", found.stderr);
    assert!(found.json()["samples"].as_u64().is_some_and(|samples| samples > 100), "{}", found.stdout);
}

#[test]
fn an_interrupted_calibration_writes_nothing_but_its_log() {
    let folder = tempfile::tempdir().expect("a folder");
    let [cal, log] = ["unit.toml", "log.arrows"].map(|name| folder.path().join(name));
    let child = start(&["calibrate", "--realtime", "-o", path(&cal), "--log", path(&log)]);
    wait_for(&log);
    interrupt(&child);
    ended(child).ended_with(1).saying(&["interrupted", "nothing written"]);
    let left: Vec<_> =
        std::fs::read_dir(folder.path()).expect("the folder").map(|e| e.expect("an entry").path()).collect();
    assert_eq!(left, [&*log]);
    zerorate(&["probe", "--device", &format!("replay:{}", path(&log))]).ended_with(0);
}

#[test]
fn a_measured_calibration_streams() {
    let (_folder, cal) = folder_with_calibration();
    calibrate(&["-o", &cal, "--serial", "A1", "--force"]).ended_with(0);
    let run = zerorate(&["stream", "--cal", &cal, "--serial", "A1", "--duration", "10ms"]).ended_with(0);
    assert_eq!(run.stderr, "", "a whole calibration needs no warning");
}

fn start(args: &[&str]) -> Child {
    command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

fn ended(child: Child) -> Run {
    child.wait_with_output().expect("it ends").into()
}

/// Ctrl-C.
fn interrupt(child: &Child) {
    let sent = Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status().expect("sh");
    assert!(sent.success());
}

/// Until samples are in the file: the first batch goes out within a second of part time.
fn wait_for(file: &Path) {
    let deadline = Instant::now() + Duration::from_secs(20);
    while std::fs::metadata(file).map_or(0, |meta| meta.len()) < 10_000 {
        assert!(Instant::now() < deadline, "{} stays empty", file.display());
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn probe_says_how_bytes_are_framed_and_what_the_self_test_does() {
    let probe = |device: &str, more: &[&str]| {
        zerorate(&[&["probe", "--device", device, "--duration", "1s", "--json"], more].concat()).ended_with(0).json()
    };
    let found = probe("twin:seed=7", &[]);
    assert_eq!((&found["framing"], &found["self_test"]), (&"byte".into(), &serde_json::Value::Null));
    let found = probe("twin:seed=7,framing=command,width=16,fw=9:5", &["--self-test"]);
    assert_eq!(found["framing"], "command");
    assert_eq!((&found["warnings"], &found["lost_samples"]), (&serde_json::json!([]), &0.into()));
    // 783 and 527 cycles (F-31)
    assert!((found["rate_hz"].as_f64().expect("a rate") / (6e6 / 1310.0) - 1.0).abs() < 0.02, "{found}");
    let tested = &found["self_test"];
    let (shift_dps, u_dps) = (tested["shift_dps"].as_f64().expect("a shift"), tested["u_dps"].as_f64().expect("u"));
    assert!((shift_dps - 20.0).abs() < 2.0 && u_dps < 0.1, "{found}");
    assert!(found["rate_dps"].as_f64().expect("a rate").abs() < 5.0, "the pin is released: {found}");
    let text = zerorate(&["probe", "--device", "twin:seed=7,framing=command", "--duration", "1s", "--self-test"]);
    let text = text.ended_with(0).stdout;
    assert!(text.contains("framing       command") && text.contains("self-test     shifts the rate by"), "{text}");
    zerorate(&["probe", "--device", "twin:width=20"]).ended_with(2).saying(&["`width=20`", "width=24|16"]);
    zerorate(&["probe", "--device", "twin:", "--self-test", "7"]).ended_with(2).saying(&["takes no GPIO"]);
    zerorate(&["probe", "--device", "replay:none", "--self-test"]).ended_with(1);
}

#[test]
fn the_other_edge_of_data_ready_works_where_the_line_is_other() {
    for device in ["twin:rdy=inverted,edge=rising", "twin:rdy=pulse,edge=rising", "twin:rdy=level,edge=falling"] {
        let found = zerorate(&["probe", "--device", device, "--duration", "1s", "--json"]).ended_with(0).json();
        assert_eq!((&found["lost_samples"], &found["warnings"]), (&0.into(), &serde_json::json!([])), "{device}");
    }
    // 26 µs before new data (F-32): each edge still finds the sample before
    for device in ["twin:rdy=level,edge=rising", "twin:rdy=pulse,edge=falling", "twin:rdy=inverted"] {
        zerorate(&["probe", "--device", device, "--duration", "1s"]).ended_with(0);
    }
    let hour = ["calibrate", "--device", "twin:rdy=pulse", "--method", "warmup"];
    zerorate(&hour).ended_with(3).saying(&["no-temperature", "use the other edge", "edge=rising"]);
}

/// Tip 2 of AN-1042: 0.01 µF between ROA1 and ROA2 give 50 Hz (F-04), and 223 samples a second are enough then.
#[test]
fn the_bandwidth_is_a_setting_that_stays_with_the_recording() {
    let warnings = |device: &str, options: &[&str]| {
        let args = [&["probe", "--device", device, "--duration", "1s", "--json"], options].concat();
        zerorate(&args).ended_with(0).json()["warnings"].to_string()
    };
    let divided = ["--divider", "50"];
    assert!(warnings("twin:", &divided).contains("aliased: "));
    assert!(!warnings("twin:roa=10nf", &divided).contains("aliased: "));
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("slow.csv");
    let file = capture.to_str().expect("a plain path");
    let args = ["capture", "--device", "twin:roa=10nf", "--divider", "50", "--duration", "2s", "-o", file];
    assert!(!zerorate(&args).ended_with(0).stderr.contains("aliased"));
    assert!(std::fs::read_to_string(&capture).expect("a capture").contains("# zerorate.bandwidth_hz = 50\n"));
    assert!(!warnings(&format!("replay:{file}"), &[]).contains("aliased: "));
}
