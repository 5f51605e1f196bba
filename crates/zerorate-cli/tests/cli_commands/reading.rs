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

/// Recorded to the end, and then told; readings that cannot be trusted are counted.
#[test]
fn a_recording_of_a_frozen_part_is_whole_and_3() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("f.arrows");
    let device = "twin:fault=frozen,fault_at_s=2,rotation_dps=360";
    let run = zerorate(&["capture", "--device", device, "--duration", "4s", "-o", path(&file), "--json"]);
    let run = run.ended_with(3).saying(&["refused: ", "frozen", "since 2.0 s", "raw codes"]);
    let summary = run.json();
    assert_eq!((&summary["frozen"], &summary["lost_samples"]), (&true.into(), &0.into()), "{summary}");
    assert!(summary["samples"].as_u64().is_some_and(|samples| samples > 22_000), "nothing is lost: {summary}");
    assert!(summary["out_of_range"].as_u64().is_some_and(|readings| readings > 11_000), "{summary}");
}

#[test]
fn probe_prints_what_it_found() {
    let args = ["probe", "--device", "twin:seed=7,framing=command", "--duration", "1s", "--self-test"];
    let text = zerorate(&[&args[..], &["--divider", "50"]].concat()).ended_with(0).saying(&["twice the bandwidth"]);
    let text = text.stdout;
    assert!(text.contains("framing       command") && text.contains("self-test     shifts the rate by"), "{text}");
    let found = zerorate(&["probe", "--device", "twin:fault=frozen", "--json"]).ended_with(0).json();
    assert!(found["warnings"][0].as_str().is_some_and(|text| text.starts_with("frozen: ")), "{found}");
    zerorate(&["probe", "--device", "twin:width=20"]).ended_with(2).saying(&["`width=20`", "width=24|16"]);
    zerorate(&["probe", "--device", "twin:", "--self-test", "7"]).ended_with(2).saying(&["takes no GPIO"]);
    zerorate(&["probe", "--device", "replay:none", "--self-test"]).ended_with(1);
}

#[test]
fn stream_prints_rows_as_csv_or_jsonl() {
    let (_folder, cal) = folder_with_calibration();
    let args = ["stream", "--cal", &cal, "--duration", "1s", "--rate", "4"];
    let rows = zerorate(&args).ended_with(0).saying(&["warning: no-checksum: "]).stdout;
    assert!(rows.starts_with("t_s,rate_dps,temp_c,lost,calibration,flags\n") && rows.lines().count() == 5, "{rows}");
    let lines = zerorate(&[&args[..], &["--format", "jsonl"]].concat()).ended_with(0).stdout;
    for line in lines.lines() {
        let row: serde_json::Value = serde_json::from_str(line).expect("an object");
        assert!(["t_s", "rate_dps", "temp_c", "lost"].iter().all(|key| row[*key].is_number()), "{row}");
    }
    assert_eq!(lines.lines().count(), 4);
    let frozen = ["--device", "twin:seed=3,fault=frozen,fault_at_s=0.5"];
    let frozen = zerorate(&[&args[..], &frozen].concat()).ended_with(3).saying(&["refused: ", "frozen"]).stdout;
    assert!(frozen.trim_end().ends_with("frozen"), "{frozen}");
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
