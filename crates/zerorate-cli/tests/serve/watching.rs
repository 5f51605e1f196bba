//! The server with viewers: recordings, requests, calibrations and a restart.

use super::{LONG, TestServer, Watch};
use crate::harness::{Bench, Run, calibration, calibration_of, command};
use serde_json::json;
use std::fs;
use std::io::BufRead;
use std::net::TcpListener;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

fn metric(served: &TestServer, name: &str) -> f64 {
    let text = served.get("/metrics");
    let line = text.lines().find_map(|line| line.strip_prefix(&format!("zerorate_{name} ")));
    line.unwrap_or_else(|| panic!("no {name}:\n{text}")).parse().expect("a number")
}

fn wait_until(mut is: impl FnMut() -> bool) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < LONG {
        if is() {
            return true;
        }
        thread::sleep(Duration::from_millis(100));
    }
    false
}

/// Number of frames that come until `over` is set.
fn follow(page: &mut Watch, over: &AtomicBool) -> usize {
    let mut frames = 0;
    while !over.load(Ordering::Relaxed) {
        page.frame();
        frames += 1;
    }
    frames
}

/// A recording is read in a child process. A signal to the parent alone must end both.
#[test]
fn a_recording_that_is_served_ends_when_the_program_is_asked_to() {
    let bench = Bench::new();
    bench.zerorate("capture --device twin:seed=3 --samples 6000 -o a.csv").ok();
    let served = TestServer::start(&bench, "--device replay:a.csv");
    assert_eq!(served.interrupt().code(), Some(0));
}

/// If the recording is removed, the page continues. The terminal and the exit code report the loss.
#[cfg(unix)]
#[test]
fn removing_the_recording_is_reported_and_fails() {
    let bench = Bench::new();
    let served = TestServer::start(&bench, "--device twin:seed=3 -o unit.arrows");
    let size = || fs::metadata(bench.path("unit.arrows")).map_or(0, |file| file.len());
    assert!(wait_until(|| size() > 10_000));
    fs::remove_file(bench.path("unit.arrows")).expect("a file");
    let removed = Instant::now();
    served.says("cannot record into unit.arrows: it was removed or moved while it was recorded into");
    assert!(removed.elapsed() < Duration::from_secs(10), "{:?}", removed.elapsed());
    assert_eq!(served.interrupt().code(), Some(1));
}

/// One of twenty viewers reads nothing, so its connection fills up and is dropped. The other viewers continue, and the
/// recording has every sample.
#[test]
fn viewers_do_not_slow_the_recording() {
    let bench = Bench::new();
    let served = TestServer::start(&bench, "--device twin:seed=3 -o unit.arrows");
    let mut pages: Vec<_> = (0..19).map(|_| served.watch()).collect();
    let stalled = served.watch();
    assert!(pages.iter_mut().all(|page| page.frame()["snapshot"] == true));
    assert_eq!(pages[0].ask(&json!({"id": 1, "do": "speed", "factor": 60}))["ok"], json!({}));
    assert_eq!(metric(&served, "watchers"), 20.0);
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let followers: Vec<_> = pages.iter_mut().map(|page| scope.spawn(|| follow(page, &over))).collect();
        let dropped = wait_until(|| metric(&served, "watchers") < 20.0);
        over.store(true, Ordering::Relaxed);
        assert!(dropped, "who takes nothing is dropped");
        for follower in followers {
            assert!(follower.join().expect("frames") > 10);
        }
    });
    assert_eq!((metric(&served, "watchers"), metric(&served, "up")), (19.0, 1.0));
    let samples = metric(&served, "samples_total");
    drop(stalled);
    assert_eq!(served.interrupt().code(), Some(0));
    let verified = bench.zerorate("verify unit.arrows --json").ended_with(0).json();
    let recorded = &verified["files"][0];
    assert!(recorded["rows"].as_f64().is_some_and(|rows| rows >= samples), "{samples} shown\n{verified}");
    assert_eq!(recorded["lost"], 0, "{verified}");
}

#[test]
fn requests_are_answered_and_calibrations_kept() {
    let bench = Bench::new();
    let unit = calibration(-0.25, -0.04, 31.5);
    bench.write("first.toml", &unit);
    fs::create_dir(bench.path("shelf")).expect("a folder");
    bench.write("shelf/old.toml", unit.replace("31.5", "30.5"));
    bench.write("shelf/broken.toml", "schema = 7");
    let served = TestServer::start(&bench, "--cal first.toml --folder shelf --device twin:seed=4");
    let mut page = served.watch();
    let first = page.until(|frame| frame["calibrations"].is_array());
    let all = first["calibrations"].as_array().expect("calibrations");
    let applied: Vec<_> = all.iter().filter(|one| one["applied"] == true).map(|one| &one["t3_c"]).collect();
    assert_eq!((all.len(), applied), (2, vec![&json!(31.5)]));
    assert!(first["device"]["registers"].as_array().is_some_and(|all| all.len() == 13), "{}", first["device"]);
    assert_eq!(first["device"]["checks"][0]["ok"], true);

    let added = page.ask(&json!({"id": 7, "do": "add-calibration", "toml": unit.replace("31.5", "29")}));
    let id = added["ok"]["id"].as_str().expect("an id").to_owned();
    assert_eq!((&added["id"], &added["ok"]["t3_c"]), (&json!(7), &json!(29.0)));
    let kept = bench.path(&format!("shelf/calibration-{id}.toml"));
    assert!(wait_until(|| kept.exists()), "{}", kept.display());
    assert_eq!(page.ask(&json!({"id": 8, "do": "apply", "calibration": id}))["ok"], json!({}));
    for wrong in [json!({"id": 9, "do": "fly"}), json!({"id": 9, "do": "apply", "calibration": "../../etc"})] {
        let refused = page.ask(&wrong);
        assert!(refused["id"] == 9 && refused["error"].is_string(), "{refused}");
    }
    // the checks need five seconds of samples
    page.ask(&json!({"id": 10, "do": "speed", "factor": 20}));
    let checked = page.until(|frame| frame["device"]["checks"].as_array().is_some_and(|all| all.len() == 3));
    let checks = &checked["device"]["checks"];
    assert!((0..3).all(|check| checks[check]["ok"] == true), "{checks}");
    assert_eq!(metric(&served, "samples_lost_total"), 0.0);
    assert!(served.get("/metrics").contains("zerorate_corrected_rate_dps{axis="));
}

/// The id of a calibration does not cover its [validity]. A file with the same id but other content is refused.
#[test]
fn a_calibration_that_differs_beside_its_coefficients_is_not_taken_for_the_same() {
    let bench = Bench::new();
    let unit = calibration(-0.25, -0.04, 31.5);
    let with = |max_c: u32| format!("{unit}[validity]\ntemp_min_c = 20.0\ntemp_max_c = {max_c}.0\n");
    fs::create_dir(bench.path("shelf")).expect("a folder");
    let served = TestServer::start(&bench, "--folder shelf --device twin:seed=4");
    let mut page = served.watch();
    let mut add = |max_c: u32| page.ask(&json!({"id": 7, "do": "add-calibration", "toml": with(max_c)}));
    let id = add(40)["ok"]["id"].as_str().expect("an id").to_owned();
    assert_eq!(add(40)["ok"]["id"], json!(id), "the same once more");
    let refused = add(60);
    assert!(refused["error"].as_str().is_some_and(|why| why.contains("[validity]") && why.contains(&id)), "{refused}");
    // removed files stay, each under its own name
    let kept = bench.path(&format!("shelf/calibration-{id}.toml"));
    let away = |ending: &str| bench.path(&format!("shelf/calibration-{id}.toml.removed-{id}{ending}"));
    for (max_c, ending) in [(40, ""), (60, "-2"), (80, "-3")] {
        let added = page.ask(&json!({"id": 8, "do": "add-calibration", "toml": with(max_c)}));
        assert_eq!(added["ok"]["range_c"], json!([20.0, f64::from(max_c)]), "{added}");
        assert!(wait_until(|| kept.exists()), "{}", kept.display());
        let removed = page.ask(&json!({"id": 9, "do": "remove-calibration", "calibration": id}));
        assert_eq!(removed["ok"], json!({}), "{removed}");
        assert!(wait_until(|| away(ending).exists()), "{}", away(ending).display());
    }
    for (max_c, ending) in [(40, ""), (60, "-2"), (80, "-3")] {
        let text = fs::read_to_string(away(ending)).expect("a file");
        assert!(text.contains(&format!("temp_max_c = {max_c}")), "{text}");
    }
}

#[test]
fn a_lost_device_is_reported_and_can_be_opened_again() {
    let bench = Bench::new();
    let served = TestServer::start(&bench, "--device twin:seed=5,fault=unplug,fault_at_s=1 -o unit.csv");
    let mut page = served.watch();
    let failed = page.until(|frame| frame["device"]["state"]["is"] == "failed");
    let why = failed["device"]["state"]["why"].as_str().expect("a reason");
    assert!(why.contains("unplugged"), "{why}");
    served.says("unit.csv: ");
    assert_eq!(metric(&served, "up"), 0.0);
    assert_eq!(page.ask(&json!({"id": 1, "do": "reopen"}))["ok"], json!({}));
    let again = page.until(|frame| frame["device"]["state"]["is"] == "reading" && frame["notices"].is_array());
    assert!(again["notices"].to_string().contains("not-kept"), "it holds on: {again}");
    page.until(|frame| frame["ledger"]["samples"].as_u64().is_some_and(|samples| samples > 0));
    assert_eq!(served.interrupt().code(), Some(0));
    for file in ["unit.csv", "unit-2.csv"] {
        bench.zerorate(&format!("verify {file}")).ended_with(0);
    }
}

/// Every part has its own bias, so a calibration of another part is refused. An unknown number gives a warning.
#[test]
fn a_calibration_of_another_part_is_refused() {
    let bench = Bench::new();
    bench.write("a1.toml", calibration_of("A1", -0.25, -0.04, 31.5));
    bench.write("b2.toml", calibration_of("B2", -0.25, -0.04, 31.5));
    bench.zerorate("capture --samples 100 --serial B2 -o b2.arrows").ended_with(0);
    bench
        .zerorate("serve --listen 127.0.0.1:0 --no-iio --device replay:b2.arrows --cal a1.toml")
        .fails(1, &["part A1", "part B2"]);
    bench.zerorate("serve --listen 127.0.0.1:0 --no-iio --cal a1.toml --serial B2").fails(1, &["part A1", "part B2"]);
    let given = TestServer::start(&bench, "--cal b2.toml --serial B2 -o given.arrows");
    let first = given.watch().frame();
    let codes: Vec<_> = first["notices"].as_array().expect("notices").iter().map(|one| &one["code"]).collect();
    assert!(codes.contains(&&json!("no-checksum")) && !codes.contains(&&json!("unknown-serial")), "{codes:?}");
    assert!(given.interrupt().success());
    bench.zerorate("correct given.arrows --cal a1.toml -o given.csv").fails(1, &["part A1", "part B2"]);
    let mut start = bench.command("serve --listen 127.0.0.1:0 --no-iio --cal a1.toml");
    let mut unknown = start.stderr(std::process::Stdio::piped()).spawn().expect("the program starts");
    let lines = std::io::BufReader::new(unknown.stderr.take().expect("stderr"));
    let said: Vec<String> =
        lines.lines().map_while(Result::ok).take_while(|line| !line.contains("open http")).collect();
    unknown.kill().and_then(|()| unknown.wait()).expect("an end");
    for code in ["no-checksum", "unknown-serial"] {
        assert!(said.iter().any(|line| line.starts_with(&format!("warning: {code}: "))), "{code}\n{said:?}");
    }
}

#[test]
fn a_calibration_that_was_removed_does_not_come_back() {
    let bench = Bench::new();
    let unit = calibration(-0.25, -0.04, 31.5);
    fs::create_dir(bench.path("shelf")).expect("a folder");
    bench.write("shelf/old.toml", &unit);
    let served = TestServer::start(&bench, "--folder shelf --device twin:seed=4");
    let mut page = served.watch();
    let id = page.until(|frame| frame["calibrations"].is_array())["calibrations"][0]["id"].clone();
    let remove = json!({"id": 1, "do": "remove-calibration", "calibration": id});
    assert_eq!(page.ask(&remove)["ok"], json!({}));
    let said = page.until(|frame| frame["notices"].as_array().is_some_and(|all| !all.is_empty()));
    assert!(said["notices"].to_string().contains("old.toml.removed-"), "{said}");
    let names: Vec<_> =
        fs::read_dir(bench.path("shelf")).expect("a folder").map(|file| file.expect("a file")).collect();
    let [removed] = &names[..] else { panic!("{names:?}") };
    assert_eq!(fs::read_to_string(removed.path()).expect("it is kept"), unit);
}

#[test]
fn it_says_what_to_do_where_it_cannot_begin() {
    let bench = Bench::new();
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("a port");
    Run::of(&mut command(&["serve", "--listen", &address.to_string()]))
        .fails(1, &["something serves there already", "--listen 127.0.0.1:"]);
    bench.zerorate("serve --listen 127.0.0.1:0 --device replay:nothing.arrows").fails(1, &["nothing.arrows"]);
    bench.write("unit.arrows", "");
    bench.zerorate("serve --listen 127.0.0.1:0 -o unit.arrows").fails(2, &["unit.arrows"]);
    bench.zerorate("serve --listen 127.0.0.1:0 --cal nothing.toml").fails(1, &["nothing.toml"]);
    bench.zerorate("serve --listen bench.local:80").fails(2, &["0.0.0.0:8130"]);
}

/// The restarted server can use its port at once, so a page that reconnects finds it.
#[test]
fn a_server_that_was_restarted_takes_its_port_again() {
    let bench = Bench::new();
    let served = TestServer::start(&bench, "");
    let (mut page, port) = (served.watch(), served.port);
    page.frame();
    assert_eq!(served.interrupt().code(), Some(0));
    while page.socket.read().is_ok() {}
    let again =
        bench.command(&format!("serve --listen 127.0.0.1:{port}")).stderr(std::process::Stdio::piped()).spawn();
    let mut again = again.expect("the program starts");
    assert!(wait_until(|| std::net::TcpStream::connect(("127.0.0.1", port)).is_ok()));
    again.kill().and_then(|()| again.wait()).expect("an end");
}
