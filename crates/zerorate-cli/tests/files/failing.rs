//! Failures are reported, measurements are not lost, and unfinished files are removed.
#![cfg(target_os = "linux")]

use super::{Bench, PROGRAM, Run, calibration, imu};
use crate::harness::{self, SOAK, names, send, wait_until};
use std::fs::{self, File, OpenOptions};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A calibration that takes 205 s of simulated time.
const CALIBRATE: &str =
    "calibrate --device twin:seed=7 --average 2s --warmup 60s --settle 120s --offset 20s --max-u-btc 0.2";

/// The program in the test's folder, with its own folder for temporary files.
fn command(bench: &Bench, line: &str) -> Command {
    let temporary = bench.path("tmp");
    fs::create_dir_all(&temporary).unwrap();
    let mut command = bench.command(line);
    command.env("TMPDIR", temporary);
    command
}

fn start(bench: &Bench, line: &str) -> Child {
    harness::start(&mut command(bench, line))
}

fn fifo(bench: &Bench, name: &str) -> PathBuf {
    let path = bench.path(name);
    assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
    path
}

/// The only file in the folder whose name begins with `start`.
#[track_caller]
fn only(folder: &Path, start: &str) -> PathBuf {
    let found: Vec<String> = names(folder).into_iter().filter(|name| name.starts_with(start)).collect();
    assert_eq!(found.len(), 1, "{start}… in {:?}", names(folder));
    folder.join(&found[0])
}

/// Waits until the program catches SIGTERM or has ended. A program that reads files in a child process catches signals
/// a moment after the child has started.
fn wait_until_it_listens(child: &Child) {
    const SIGTERM: u64 = 1 << 14;
    wait_until("SIGTERM is caught", || {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let field = |name| status.lines().find_map(|line| line.strip_prefix(name)).unwrap().trim();
        u64::from_str_radix(field("SigCgt:"), 16).unwrap() & SIGTERM != 0 || field("State:").starts_with('Z')
    });
}

/// Checks that the run failed with 1, printed the calibration, and saved it in a rescue file.
#[track_caller]
fn rescued(bench: &Bench, run: &Run, folder: &Path) {
    let said = &run.stderr;
    assert_eq!(run.code, Some(1), "{said}");
    let kept = only(folder, "unit.rescue-");
    let place = kept.file_name().unwrap().to_string_lossy();
    assert!(said.contains("not lost") && said.contains(&*place) && !said.contains("/./"), "{said}");
    assert_eq!(fs::read_to_string(&kept).unwrap(), run.stdout, "{said}");
    let export = bench.zerorate(&format!("export {} --format csv", kept.display()));
    assert_eq!(export.stderr, "", "it is whole, with its checksum");
    assert!(export.ok().starts_with("delta_c"));
}

#[test]
fn a_log_whose_reader_leaves_is_a_failure_and_the_result_is_kept() {
    let bench = Bench::new();
    let log = fifo(&bench, "log");
    let child = start(&bench, &format!("{CALIBRATE} -o unit.toml --log log"));
    let mut reader = File::open(log).unwrap();
    reader.read_exact(&mut [0; 2000]).unwrap();
    drop(reader);
    let run = Run::ended(child);
    rescued(&bench, &run, bench.dir.path());
    assert!(run.stderr.contains("the measurement goes on") && run.stderr.contains("Broken pipe"));
    assert!(!bench.path("unit.toml").exists(), "a run that fails leaves no calibration under the name");
}

#[test]
fn a_log_that_outgrows_its_disk_is_a_failure_and_the_object_has_the_calibration() {
    let bench = Bench::new();
    let line = format!("ulimit -f 200; trap '' XFSZ; exec {PROGRAM} {CALIBRATE} -o unit.toml --log log.arrows --json");
    let run = Run::of(Command::new("sh").args(["-c", &line]).current_dir(bench.dir.path()));
    let object = run.ended_with(1).saying(&["warning: log-failed: "]).json();
    let kept = fs::read_to_string(only(bench.dir.path(), "unit.rescue-")).unwrap();
    assert_eq!(object["rescued"]["calibration"], kept);
    assert!(object["rescued"]["file"].as_str().unwrap().contains("unit.rescue-"), "{object}");
    let begun = "warning: torn-tail: log.arrows was not closed";
    bench.zerorate("probe --device replay:log.arrows").saying(&[begun]);
}

#[test]
fn a_capture_that_outgrows_its_disk_says_how_to_keep_what_it_holds() {
    let bench = Bench::new();
    let line = format!("ulimit -f 2000; trap '' XFSZ; exec {PROGRAM} capture --duration 60s -o cut.arrows");
    let run = Run::of(Command::new("sh").args(["-c", &line]).current_dir(bench.dir.path()));
    run.ended_with(1).saying(&["`zerorate repair cut.arrows -o NEW.arrows`", "cannot write cut.arrows: "]);
    bench.zerorate("repair cut.arrows -o NEW.arrows").ended_with(0);
}

#[test]
fn a_full_device_costs_no_result() {
    let bench = Bench::new();
    let run = Run::of(&mut command(&bench, &format!("{CALIBRATE} -o /dev/full")));
    assert_eq!(run.code, Some(1));
    assert_eq!(fs::read_to_string(only(&bench.path("tmp"), "calibration.rescue-")).unwrap(), run.stdout);
    // an unusable log is detected before the measurement, so nothing is printed
    let run = Run::of(&mut command(&bench, &format!("{CALIBRATE} --log /dev/full")));
    assert_eq!((run.code, &*run.stdout), (Some(1), ""));
    // stdout is the only output, and is full
    let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
    fs::remove_dir_all(bench.path("tmp")).unwrap();
    let run = Run::of(command(&bench, CALIBRATE).stdout(full)).ended_with(1);
    run.saying(&[only(&bench.path("tmp"), "calibration.rescue-").to_str().unwrap()]);
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    for form in ["csv", "jsonl"] {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let line = format!("stream --cal unit.toml --duration 1s --rate 4 --format {form}");
        let run = Run::of(command(&bench, &line).stdout(full)).ended_with(1);
        run.saying(&["cannot write to stdout: "]);
    }
}

/// Starts a run that has claimed its output and waits for a reader of its log, a named pipe.
fn waiting(bench: &Bench, line: &str) -> (Child, PathBuf) {
    let log = fifo(bench, "log");
    let child = start(bench, &format!("{line} --log log"));
    let folder = bench.dir.path().to_owned();
    wait_until("an unfinished file", || {
        [folder.clone(), folder.join("sub")]
            .iter()
            .filter(|folder| folder.exists())
            .any(|folder| names(folder).iter().any(|name| name.starts_with("unit.toml.") && name.ends_with(".part")))
    });
    (child, log)
}

fn let_it_run(child: Child, log: &Path) -> Run {
    std::io::copy(&mut File::open(log).unwrap(), &mut std::io::sink()).unwrap();
    Run::ended(child)
}

#[test]
fn a_folder_that_vanishes_costs_no_result() {
    let bench = Bench::new();
    fs::create_dir(bench.path("sub")).unwrap();
    let (child, log) = waiting(&bench, &format!("{CALIBRATE} -o sub/unit.toml"));
    // the run has claimed its output before it waits for the reader of its log
    std::thread::sleep(Duration::from_secs(1));
    fs::remove_dir_all(bench.path("sub")).unwrap();
    let run = let_it_run(child, &log);
    rescued(&bench, &run, &bench.path("tmp"));
}

#[test]
fn a_name_that_is_taken_meanwhile_stays_as_it_is() {
    for force in ["", " --force"] {
        let bench = Bench::new();
        let (child, log) = waiting(&bench, &format!("{CALIBRATE} -o unit.toml{force}"));
        bench.write("unit.toml", "mine");
        let run = let_it_run(child, &log);
        rescued(&bench, &run, bench.dir.path());
        assert_eq!(fs::read(bench.path("unit.toml")).unwrap(), b"mine");
    }
}

#[test]
fn a_second_writer_of_a_calibration_refuses() {
    let bench = Bench::new();
    let (child, log) = waiting(&bench, &format!("{CALIBRATE} -o unit.toml"));
    for force in ["", " --force"] {
        bench.zerorate(&format!("{CALIBRATE} -o unit.toml{force}")).fails(2, &["another zerorate"]);
    }
    let_it_run(child, &log).ended_with(0);
    assert_eq!(bench.names(), ["log", "tmp", "unit.toml"]);
}

#[test]
fn a_second_recorder_of_a_capture_refuses() {
    let bench = Bench::new();
    let child = start(&bench, "capture --realtime -o run.arrows");
    wait_until("samples in the file", || fs::metadata(bench.path("run.arrows")).is_ok_and(|file| file.len() > 10_000));
    bench.zerorate("capture --samples 10 -o run.arrows").fails(2, &["--force"]);
    bench.zerorate("capture --samples 10 -o run.arrows --force").fails(2, &["another zerorate"]);
    send("TERM", &child);
    assert_eq!(Run::ended(child).code, Some(0));
    let whole = bench.zerorate("probe --device replay:run.arrows --json");
    assert!(!whole.stderr.contains("not closed"), "{}", whole.stderr);
    // after the recording, its name can be overwritten
    bench.zerorate("capture --samples 10 -o run.arrows --force").ok();
}

#[test]
fn of_many_that_start_at_once_one_writes() {
    let bench = Bench::new();
    let starts: Vec<Child> = (0..6).map(|_| start(&bench, "capture --samples 20000 -o run.arrows")).collect();
    let codes: Vec<Option<i32>> = starts.into_iter().map(|child| Run::ended(child).code).collect();
    assert_eq!(codes.iter().filter(|code| **code == Some(0)).count(), 1, "{codes:?}");
    assert_eq!(codes.iter().filter(|code| **code == Some(2)).count(), 5, "{codes:?}");
    bench.zerorate("probe --device replay:run.arrows").ok();
    assert_eq!(bench.names(), ["run.arrows", "tmp"]);
}

#[test]
fn a_full_stderr_does_not_end_a_stream() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    for line in ["stream --cal unit.toml --duration 1s --rate 4", "capture --samples 10 --divider 50 -o run.arrows"] {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let run = Run::of(command(&bench, line).stderr(full));
        assert_eq!(run.code, Some(0), "{line}");
        assert!(!run.stdout.is_empty());
    }
}

#[test]
fn a_broken_pipe_is_a_success_on_stdout_only() {
    let bench = Bench::new();
    let path = fifo(&bench, "pipe");
    let child = start(&bench, "capture --samples 2000000 -o pipe");
    File::open(path).unwrap().read_exact(&mut [0; 100]).unwrap();
    Run::ended(child).ended_with(1).saying(&["Broken pipe"]);
}

/// `zerorate … | head -1`: the reader of stdout leaves, and the program may end at once. All files must be complete.
#[test]
fn every_file_stands_before_the_first_word_is_printed() {
    let bench = imu::bench();
    bench.write("soak.toml", SOAK);
    fs::copy(bench.path("imu.csv"), bench.path("again.csv")).unwrap();
    let column = "imu.csv --time-column t_s --column gyro_x_dps";
    let again = CALIBRATE.split_once(" --average").unwrap().1;
    let chamber = "--device twin:seed=4,warmup_s=10 --divider 50 --chamber sim:lag_s=15";
    for (line, files) in [
        ("imu imu.csv -o imu.yaml --report imu.html", "imu.yaml imu.html"),
        ("imu imu.csv --json -o json.yaml", "json.yaml"),
        (&*format!("allan {column} --plot a.svg --report a.html"), "a.svg a.html"),
        (&*format!("allan {column} --json --imu-yaml a.yaml"), "a.yaml"),
        (&*format!("allan again.csv {column} --pool --csv --plot pool.svg"), "pool.svg"),
        ("capture --device twin:seed=7 --samples 5000 -o some.csv", "some.csv"),
        (&*format!("{CALIBRATE} -o unit.toml --log log.arrows"), "unit.toml log.arrows"),
        (&*format!("recalibrate log.arrows --average{again} -o again.toml"), "again.toml"),
        ("correct log.arrows --cal unit.toml -o corrected.arrows", "corrected.arrows"),
        ("repair log.arrows -o repaired.arrows", "repaired.arrows"),
        ("export unit.toml --format c -o unit.h", "unit.h"),
        ("report unit.toml -o unit.html", "unit.html"),
        ("stream --device replay:log.arrows --cal unit.toml --track --state state.toml", "state.toml"),
        (&*format!("chamber soak.toml {chamber} -o u.toml --log u.arrows --report u.html"), "u.toml u.arrows u.html"),
    ] {
        let (reader, gone) = std::io::pipe().unwrap();
        drop(reader);
        let run = Run::of(bench.command(line).stdout(gone)).ended_with(0);
        for file in files.split(' ') {
            let length = fs::metadata(bench.path(file)).map_or(0, |file| file.len());
            assert!(length > 0, "{line}: no {file}\n{}", run.stderr);
        }
        assert!(!line.contains("--track") || run.stderr.contains("s of rest learned from"), "{}", run.stderr);
    }
}

/// The file is removed, replaced, or truncated as by `logrotate` with `copytruncate`.
#[test]
fn the_file_of_a_running_recording_is_missed_within_a_second() {
    type Attack = fn(&Path);
    let remove: Attack = |file| fs::remove_file(file).unwrap();
    let cut: Attack = |file| OpenOptions::new().write(true).open(file).unwrap().set_len(100).unwrap();
    let replace: Attack = |file| {
        fs::write(file.with_extension("new"), vec![0; 1 << 20]).unwrap();
        fs::rename(file.with_extension("new"), file).unwrap();
    };
    for (name, attack, what) in [
        ("run.arrows", remove, "removed or moved"),
        ("run.csv", remove, "removed or moved"),
        ("run.arrows", replace, "replaced by another file"),
        ("run.arrows", cut, "cut short, from"),
        ("run.csv", cut, "cut short, from"),
        #[cfg(feature = "parquet")]
        ("run.parquet", remove, "removed or moved"),
    ] {
        let bench = Bench::new();
        let child = start(&bench, &format!("capture --realtime --duration 1h -o {name}"));
        let least = if name.ends_with("parquet") { 0 } else { 10_000 };
        wait_until("a file", || fs::metadata(bench.path(name)).is_ok_and(|file| file.len() >= least));
        attack(&bench.path(name));
        let began = Instant::now();
        Run::ended(child).fails(1, &[&format!("error: cannot record into {name}: it was {what}")]);
        assert!(began.elapsed() < Duration::from_secs(10), "{name}: {what}: {:?}", began.elapsed());
    }
}

#[test]
fn a_log_that_is_removed_costs_no_result() {
    let bench = Bench::new();
    let child = start(&bench, &format!("{CALIBRATE} -o unit.toml --log log.arrows"));
    wait_until("samples", || fs::metadata(bench.path("log.arrows")).is_ok_and(|file| file.len() > 10_000));
    fs::remove_file(bench.path("log.arrows")).unwrap();
    let said = ["warning: log-failed: ", "it was removed or moved", "not lost"];
    Run::ended(child).ended_with(1).saying(&said);
    only(bench.dir.path(), "unit.rescue-");
}

/// Starts the program through `starter`, which sets how signals are handled.
fn unbiased(bench: &Bench, starter: &[&str], line: &str) -> Child {
    let mut command = Command::new(starter[0]);
    command.args(&starter[1..]).arg(PROGRAM).args(line.split(' '));
    harness::start(command.current_dir(bench.dir.path()))
}

#[test]
fn signals_close_what_is_recorded_and_clear_away_what_is_not_finished() {
    for signal in ["TERM", "HUP", "INT"] {
        let bench = Bench::new();
        let starter = ["env", "--default-signal=HUP,INT"];
        let child = unbiased(&bench, &starter, "calibrate --realtime -o unit.toml --log run.arrows");
        wait_until("samples", || fs::metadata(bench.path("run.arrows")).is_ok_and(|file| file.len() > 10_000));
        send(signal, &child);
        let said = ["interrupted", "no calibration written; the log stands whole"];
        Run::ended(child).ended_with(1).saying(&said);
        assert_eq!(bench.names(), ["run.arrows"], "{signal}");
        let whole = bench.zerorate("probe --device replay:run.arrows").ended_with(0);
        assert!(!whole.stderr.contains("not closed"), "{signal}: {}", whole.stderr);
    }
}

/// The fit of a recording takes a while and checks for no stop. The signal goes to the process that was started.
#[test]
fn a_signal_ends_a_calibration_from_a_recording_at_once() {
    for (signal, code) in [("TERM", 143), ("HUP", 129)] {
        let bench = Bench::new();
        bench.zerorate("capture --duration 5m -o rest.arrows").ok();
        let starter = ["env", "--default-signal=HUP"];
        let child = unbiased(&bench, &starter, "recalibrate rest.arrows --method warmup -o unit.toml");
        wait_until("an unfinished file", || bench.names().iter().any(|name| name.starts_with("unit.toml.")));
        wait_until_it_listens(&child);
        send(signal, &child);
        Run::ended(child).ended_with(code);
        assert_eq!(bench.names(), ["rest.arrows"], "{signal}");
    }
}

#[test]
fn an_interrupted_correction_leaves_nothing() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.zerorate("capture --duration 100s -o rest.arrows").ok();
    let child = start(&bench, "correct rest.arrows --cal unit.toml -o done.csv");
    wait_until("an unfinished file", || bench.names().iter().any(|name| name.starts_with("done.csv")));
    wait_until_it_listens(&child);
    send("TERM", &child);
    let run = Run::ended(child);
    let left = ["rest.arrows", "tmp", "unit.toml"];
    match run.code {
        Some(1) => assert_eq!(bench.names(), left, "{}", run.stderr),
        // the correction was finished before the signal
        Some(0) => assert_eq!(bench.names(), [&["done.csv"][..], &left].concat()),
        code => panic!("{code:?}: {}", run.stderr),
    }
}

/// `timeout` sends its signal to the program and to its process group. A Parquet file without its end would be lost.
#[cfg(feature = "parquet")]
#[test]
fn two_signals_at_once_are_one() {
    let bench = Bench::new();
    let child = start(&bench, "capture --realtime -o run.parquet");
    wait_until("a file", || bench.path("run.parquet").exists());
    wait_until_it_listens(&child);
    std::thread::sleep(Duration::from_millis(500));
    send("TERM", &child);
    send("TERM", &child);
    Run::ended(child).ended_with(0);
    bench.zerorate("probe --device replay:run.parquet --json").ok();
}

/// A capture that was started with `nohup` continues when its terminal closes.
#[test]
fn nohup_is_heeded() {
    let bench = Bench::new();
    let child = unbiased(&bench, &["nohup"], "capture --realtime -o run.arrows");
    let size = || fs::metadata(bench.path("run.arrows")).map_or(0, |file| file.len());
    wait_until("samples", || size() > 10_000);
    send("HUP", &child);
    let before = size();
    wait_until("more samples", || size() > before + 300_000);
    send("TERM", &child);
    assert_eq!(Run::ended(child).code, Some(0));
}

/// A run that waits for stdin, or for a reader of its log, cannot check for a stop. A signal ends it at once, and its
/// unfinished files are removed.
#[test]
fn a_signal_ends_a_run_that_waits() {
    let bench = Bench::new();
    let mut waits = command(&bench, "allan - --rate 10 --unit dps --report page.html --plot a.svg");
    let mut child = harness::start(waits.stdin(Stdio::piped()));
    let pipe = child.stdin.take();
    wait_until("unfinished files", || bench.names().iter().filter(|name| name.ends_with(".part")).count() == 2);
    wait_until_it_listens(&child);
    send("TERM", &child);
    assert_eq!(Run::ended(child).code, Some(143));
    drop(pipe);
    assert_eq!(bench.names(), ["tmp"]);
    let (child, _) = waiting(&bench, &format!("{CALIBRATE} -o unit.toml"));
    // by then the run waits for the reader
    std::thread::sleep(Duration::from_secs(1));
    send("TERM", &child);
    assert_eq!(Run::ended(child).code, Some(143));
    assert_eq!(bench.names(), ["log", "tmp"]);
}

/// The file that a command reads may be a pipe to which nothing is ever written.
#[test]
fn a_signal_ends_a_run_that_waits_for_a_pipe() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.zerorate("capture --device twin:seed=3 --samples 100 -o rest.csv").ok();
    fifo(&bench, "never");
    for line in [
        "export never --format c",
        "correct rest.csv --cal never -o out.csv",
        "stream --cal never",
        "recalibrate rest.csv --part never",
        "chamber never",
        #[cfg(feature = "serve")]
        "serve --listen 127.0.0.1:0 --cal never",
    ] {
        let child = start(&bench, line);
        wait_until_it_listens(&child);
        send("TERM", &child);
        assert_eq!(Run::ended(child).code, Some(143), "{line}");
    }
}
