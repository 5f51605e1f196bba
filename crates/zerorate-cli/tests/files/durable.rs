//! A successful run has synced its files to the disk, both content and name.
#![cfg(target_os = "linux")]

use super::{Bench, FORMS, PROGRAM, SHORT, calibration, capture, skip};
use std::process::Command;

/// Runs the program under strace. Returns its system calls on files in order, or `None` if it cannot be traced.
fn traced(bench: &Bench, line: &str) -> Option<Vec<String>> {
    let trace = bench.path("trace");
    let mut strace = Command::new("strace");
    strace.args("-f -y -s 8 -e trace=write,fsync,fdatasync,rename,renameat,renameat2,link,linkat -o".split(' '));
    let run = strace.arg(&trace).arg(PROGRAM).args(line.split(' ')).current_dir(bench.dir.path());
    let Ok(output) = run.output() else {
        skip("it needs `strace`, which is not installed");
        return None;
    };
    let said = String::from_utf8_lossy(&output.stderr);
    if said.contains("ptrace") {
        skip("processes cannot be traced here");
        return None;
    }
    assert!(output.status.success(), "{line}: {said}");
    Some(std::fs::read_to_string(trace).unwrap().lines().map(str::to_owned).collect())
}

/// Index of the last call whose line has all of these texts.
#[track_caller]
fn last(calls: &[String], parts: &[&str]) -> usize {
    let found = calls.iter().rposition(|call| parts.iter().all(|part| call.contains(part)));
    found.unwrap_or_else(|| panic!("no call with {parts:?} in\n{}", calls.join("\n")))
}

/// Checks the order: write the content, fsync, rename, fsync the folder.
#[track_caller]
fn is_durable(bench: &Bench, calls: &[String], name: &str) {
    let folder = format!("<{}>", bench.dir.path().canonicalize().unwrap().display());
    let unfinished = format!("/{name}.");
    let written = last(calls, &["write(", &unfinished, ".part>"]);
    let synced = last(calls, &["fsync(", &unfinished, ".part>"]);
    let named = last(calls, &["rename", &format!("/{name}\"")]);
    let listed = last(calls, &["fsync(", &folder]);
    assert!(written < synced && synced < named && named < listed, "{name}:\n{}", calls.join("\n"));
}

#[test]
fn computed_files_are_on_the_disk_before_they_have_their_name() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", "1000,1,8623488,8,8402701,0\n2000,2,8388608,8,,0\n"));
    bench.write("log.csv", "gz\n1\n2\n1\n3\n2\n1\n2\n3\n");
    bench.write("older.h", "older");
    for (line, name) in [
        ("export unit.toml --format c -o unit.h", "unit.h"),
        ("export unit.toml --format c -o older.h --force", "older.h"),
        ("report unit.toml -o unit.html", "unit.html"),
        #[cfg(feature = "parquet")]
        ("correct rest.csv --cal unit.toml -o done.parquet", "done.parquet"),
        ("correct rest.csv --cal unit.toml -o done.csv", "done.csv"),
        ("allan log.csv --rate 10 --unit dps --plot a.svg", "a.svg"),
    ] {
        let Some(calls) = traced(&bench, line) else { return };
        is_durable(&bench, &calls, name);
    }
}

#[test]
fn a_calibration_and_its_log_are_on_the_disk() {
    let bench = Bench::new();
    let line = format!("calibrate {SHORT} -o unit.toml --log log.arrows");
    let Some(calls) = traced(&bench, &line) else { return };
    is_durable(&bench, &calls, "unit.toml");
    assert!(last(&calls, &["write(", "/log.arrows>"]) < last(&calls, &["fsync(", "/log.arrows>"]));
}

/// A recording is synced once a second and at its end (docs/formats/capture.md). It has its name from the start.
#[test]
fn a_capture_is_on_the_disk_in_every_form() {
    for form in FORMS {
        let bench = Bench::new();
        let Some(calls) = traced(&bench, &format!("capture --realtime --duration 1500ms -o run.{form}")) else {
            return;
        };
        let folder = format!("<{}>", bench.dir.path().canonicalize().unwrap().display());
        let file = format!("/run.{form}>");
        assert!(last(&calls, &["fsync(", &folder]) < last(&calls, &["write(", &file]), "{form}: the name first");
        assert!(last(&calls, &["fdatasync(", &file]) < last(&calls, &["fsync(", &file]), "{form}: meanwhile");
        assert!(last(&calls, &["write(", &file]) < last(&calls, &["fsync(", &file]), "{form}: at the end");
    }
}
