//! `probe`, `capture` and `stream`: reading a part, and stopping.

use super::zerorate;
use crate::harness::{Bench, Run, SHORT, calibration, calibration_of, send, start, wait_until};
use std::io::{BufRead, BufReader};

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("unit.toml", calibration_of("A1", 0.5, -0.04, 31.5));
    bench
}

#[test]
fn capture_ends_by_count_or_by_time_in_the_form_that_the_name_says() {
    let bench = Bench::new();
    for (name, starts_with) in [
        ("a.arrows", &b"\xff\xff\xff\xff"[..]),
        #[cfg(feature = "parquet")]
        ("a.parquet", b"PAR1"),
        ("a.csv", b"# zerorate"),
    ] {
        let summary = bench.zerorate(&format!("capture --samples 1000 -o {name} --json")).ended_with(0).json();
        assert_eq!(summary["samples"], 1000, "{summary}");
        assert!(std::fs::read(bench.path(name)).expect("a capture").starts_with(starts_with), "{name}");
        let again = format!("capture --device replay:{name} --duration 100ms -o again-{name} --json");
        let samples = bench.zerorate(&again).ended_with(0).json()["samples"].as_u64().expect("a count");
        assert!((560..=580).contains(&samples), "0.1 s at 5.7 kSPS: {samples}");
    }
}

/// The recording of a frozen part is completed first, then refused with exit code 3. Invalid readings are counted.
#[test]
fn a_recording_of_a_frozen_part_is_whole_and_refused() {
    let bench = Bench::new();
    let device = "--device twin:fault=frozen,fault_at_s=2,rotation_dps=360";
    let run = bench.zerorate(&format!("capture {device} --duration 4s -o f.arrows --json"));
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
    let bench = bench();
    let line = "stream --cal unit.toml --duration 1s --rate 4";
    let rows = bench.zerorate(line).ended_with(0).saying(&["warning: no-checksum: "]).stdout;
    assert!(rows.starts_with("t_s,rate_dps,temp_c,lost,calibration,flags\n") && rows.lines().count() == 5, "{rows}");
    let lines = bench.zerorate(&format!("{line} --format jsonl")).ended_with(0).stdout;
    for line in lines.lines() {
        let row: serde_json::Value = serde_json::from_str(line).expect("an object");
        assert!(["t_s", "rate_dps", "temp_c", "lost"].iter().all(|key| row[*key].is_number()), "{row}");
    }
    assert_eq!(lines.lines().count(), 4);
    let frozen = bench.zerorate(&format!("{line} --device twin:seed=3,fault=frozen,fault_at_s=0.5"));
    let frozen = frozen.ended_with(3).saying(&["refused: ", "frozen"]).stdout;
    assert!(frozen.trim_end().ends_with("frozen"), "{frozen}");
}

#[test]
fn stream_refuses_what_does_not_fit() {
    let bench = bench();
    let stream = |more: &str| bench.zerorate(&format!("stream --duration 10ms --cal {more}"));
    stream("unit.toml --serial B2").ended_with(1).saying(&["A1", "B2"]);
    stream("unit.toml --serial A1").ended_with(0);
    stream("unit.toml").ended_with(0).saying(&["unknown-serial", "part A1", "--serial SN"]);
    stream("none.toml").ended_with(1).saying(&["none.toml"]);
    stream("unit.toml --rate 0").ended_with(2).saying(&["--rate"]);
}

/// Every part has its own bias, so each needs its own calibration. If a serial number is unknown, there is a warning.
#[test]
fn stream_knows_the_part_of_a_recording() {
    let bench = bench();
    let with_mark = format!("\u{feff}{}", calibration(0.5, -0.04, 31.5));
    bench.write("nameless.toml", with_mark);
    for (serial, code, said) in [("A1", 0, "no checksum"), ("B2", 1, "is part B2, ")] {
        bench.zerorate(&format!("capture --samples 100 --serial {serial} -o {serial}.arrows")).ended_with(0);
        let stream = |more: &str| bench.zerorate(&format!("stream --device replay:{serial}.arrows --cal {more}"));
        let run = stream("unit.toml").ended_with(code).saying(&[said]);
        assert!(!run.stderr.contains("unknown-serial"), "{}", run.stderr);
        let said = [&*format!("the recording is of part {serial}"), "part C3"];
        stream("unit.toml --serial C3").ended_with(1).saying(&said);
        stream("nameless.toml").ended_with(0).saying(&["unknown-serial", "calibrate with one next time"]);
    }
}

#[test]
fn a_reader_that_goes_away_ends_a_stream_quietly() {
    let bench = bench();
    let mut child = start(&mut bench.command("stream --cal unit.toml"));
    let mut first = String::new();
    let mut rows = BufReader::new(child.stdout.take().expect("a pipe"));
    rows.read_line(&mut first).expect("a row");
    drop(rows);
    let run = Run::ended(child).ended_with(0);
    assert!(!run.stderr.contains("error") && !run.stderr.contains("panicked"), "{}", run.stderr);
}

#[test]
fn an_interrupted_capture_is_whole_and_a_stream_ends_well() {
    let bench = bench();
    let capture = start(&mut bench.command("capture --realtime -o long.arrows"));
    let mut stream = start(&mut bench.command("stream --realtime --rate 20 --cal unit.toml"));
    let mut rows = BufReader::new(stream.stdout.take().expect("a pipe")).lines();
    // the header and two rows come before the stream ends, so rows are not held back until a buffer is full
    assert!(rows.by_ref().take(3).all(|row| row.is_ok()));
    has_samples(&bench, "long.arrows");
    send("INT", &stream);
    send("INT", &capture);
    Run::ended(stream).ended_with(0);
    let run = Run::ended(capture).ended_with(0);
    assert!(run.stdout.contains("interrupted"), "{}", run.stdout);
    let found = bench.zerorate("probe --device replay:long.arrows --json").ended_with(0);
    assert!(!found.stderr.contains("warning"), "the file has its end: {}", found.stderr);
    assert!(found.json()["samples"].as_u64().is_some_and(|samples| samples > 100), "{}", found.stdout);
}

#[test]
fn a_measured_calibration_streams() {
    let bench = Bench::new();
    let told = bench.zerorate(&format!("calibrate {SHORT} --device twin:seed=2 -o two.toml")).ok();
    assert!(told.contains("Next: zerorate stream --device twin:seed=2 --cal two.toml, "), "{told}");
    bench.zerorate(&format!("calibrate {SHORT} -o unit.toml --serial A1")).ended_with(0);
    let run = bench.zerorate("stream --cal unit.toml --serial A1 --duration 10ms").ended_with(0);
    assert_eq!(run.stderr, "SIMULATED: these are rates of twin:\n", "a whole calibration needs no warning");
}

/// Waits for samples in the file. The first batch is written within a second of sample time.
fn has_samples(bench: &Bench, name: &str) {
    wait_until("samples", || std::fs::metadata(bench.path(name)).is_ok_and(|file| file.len() >= 10_000));
}
