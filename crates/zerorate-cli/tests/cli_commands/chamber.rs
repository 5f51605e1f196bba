//! `chamber`: what is measured, what is kept of an interrupted measurement, and each way in which a chamber fails.

use crate::harness::{Bench, PROGRAM, Run};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// A unit that warms itself in a minute, seen 225 times a second.
const UNIT: &str = "--device twin:seed=4,warmup_s=10 --divider 50";
/// Two soak points, in part time of four minutes.
const QUICK: &str = "schema = 1\nwindow_s = 20\naverage_s = 30\nsettle_timeout_s = 600\ndrift_c_per_min = 0.2\n\
    [[step]]\nto_c = 15\n[[step]]\nto_c = 45\n";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("quick.toml", QUICK);
    bench
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

fn text(bench: &Bench, name: &str) -> String {
    std::fs::read_to_string(bench.path(name)).expect("a file")
}

#[test]
fn soak_points_give_a_curve_within_its_uncertainty_and_the_log_gives_it_again() {
    let bench = bench();
    let line =
        format!("chamber quick.toml {UNIT} --chamber sim:lag_s=15 --json -o u.toml --log u.arrows --report u.html");
    let result = bench.zerorate(&line).ended_with(0).json();
    assert_eq!((&result["method"], result["points"].as_array().map(Vec::len)), (&"chamber".into(), Some(2)));
    for (point, truth) in result["curve"].as_array().unwrap().iter().zip(result["truth"]["curve"].as_array().unwrap())
    {
        let off_dps = number(&point["correction_dps"]) - number(&truth["correction_dps"]);
        assert!(off_dps.abs() < 4.0 * number(&point["u_dps"]), "{off_dps} at {point}");
    }
    for point in result["points"].as_array().unwrap() {
        assert!(number(&point["residual_dps"]).abs() < 0.01 && point["settled"] == true, "{point}");
    }
    assert!(number(&result["temp_max_c"]) - number(&result["temp_min_c"]) > 29.0);
    assert!(!bench.path("u.toml.chamber").exists(), "nothing is left to go on with");
    let page = text(&bench, "u.html");
    assert!(page.contains("What the correction leaves over temperature") && page.contains("Soak points"));

    bench.zerorate("chamber quick.toml --device replay:u.arrows -o again.toml").ok();
    assert_eq!(text(&bench, "u.toml"), text(&bench, "again.toml"));

    let away = "stream --cal u.toml --device twin:seed=4,ambient_c=70 --divider 50 --duration 1s --rate 1";
    bench.zerorate(away).ended_with(0).saying(&["extrapolated"]);
}

/// What a chamber did by itself, in a CSV beside the recording of the part.
#[test]
fn a_csv_of_what_the_chamber_did_is_a_plan_of_the_recording() {
    let bench = bench();
    let ramp = "schema = 1\n[[step]]\nto_c = 25\nhold_s = 300\n[[step]]\nto_c = 45\nc_per_min = 10\nhold_s = 300\n";
    bench.write("ramp.toml", ramp);
    let rows = (0..=72)
        .map(|k| f64::from(k) * 10.0)
        .map(|s| format!("{s},{}\n", 25.0 + ((s - 300.0) / 6.0).clamp(0.0, 20.0)));
    bench.write("did.csv", format!("t_s,temp_c\n{}", rows.collect::<String>()));
    let line = format!("chamber ramp.toml {UNIT} --chamber sim:lag_s=0 --log u.arrows --json");
    let live = bench.zerorate(&line).ended_with(0).json();
    let after = bench.zerorate("chamber did.csv --device replay:u.arrows --json").ended_with(0).json();
    for key in ["pbc_dps", "btc_dps_per_c"] {
        assert_eq!(live[key], after[key], "the same seconds");
    }
    assert_eq!(after["points"].as_array().map(Vec::len), Some(2));
    let why = bench.zerorate(&format!("chamber did.csv {UNIT}")).fails(2);
    assert!(why.contains("is the plan of a recording only"), "{why}");
}

#[test]
fn by_hand_each_step_is_said() {
    let bench = bench();
    let line = format!("chamber quick.toml {UNIT} --chamber hand");
    let said = [
        "step 1 of 2: set the chamber to 15.0 °C",
        "step 2 of 2: set the chamber to 45.0 °C",
        "set the chamber to 25.0 °C, or",
    ];
    bench.zerorate(&line).ended_with(0).saying(&said);
}

/// The cable is pulled in the second step; the same command goes on there, and the cable holds for long enough.
#[test]
fn an_interrupted_measurement_goes_on_after_its_last_finished_step() {
    let bench = bench();
    let unit = UNIT.replace("warmup_s=10", "warmup_s=10,fault=unplug,fault_at_s=220");
    let line = format!("chamber quick.toml {unit} --chamber sim:lag_s=15 --json -o u.toml");
    bench.zerorate(&line).fails(1);
    let kept = text(&bench, "u.toml.chamber");
    assert!(kept.contains("steps = 1") && !bench.path("u.toml").exists(), "{}", &kept[..200]);
    let run = bench.zerorate(&line).ended_with(0).saying(&["going on after step 1 of 2"]);
    let result = run.json();
    assert_eq!(result["points"].as_array().map(Vec::len), Some(2));
    assert!(result["warnings"].to_string().contains("resumed: ") && result["capture_sha256"].is_null());
    assert!(bench.path("u.toml").exists() && !bench.path("u.toml.chamber").exists());
}

#[test]
fn steps_of_another_plan_are_not_taken() {
    let bench = bench();
    bench.write("u.toml.chamber", "nonsense");
    let line = format!("chamber quick.toml {UNIT} --chamber sim:lag_s=15 -o u.toml");
    let why = bench.zerorate(&line).fails(2);
    assert!(why.contains("u.toml.chamber does not go on with this measurement") && why.contains("--restart"), "{why}");
    assert_eq!(text(&bench, "u.toml.chamber"), "nonsense");
    bench.zerorate(&format!("{line} --restart")).ended_with(0);
}

/// Ctrl-C in a step of a day.
#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_finished_steps() {
    let bench = bench();
    bench.write("long.toml", format!("{QUICK}[[step]]\nto_c = 20\nhold_s = 86400\n"));
    let line = format!("chamber long.toml {UNIT} --chamber sim:lag_s=15 -o u.toml");
    let mut command = bench.command(&line);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let until = Instant::now() + Duration::from_secs(120);
    while !bench.path("u.toml.chamber").exists() && Instant::now() < until {
        thread::sleep(Duration::from_millis(5));
    }
    let pid = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).expect("it runs");
    let run = Run::from(child.wait_with_output().expect("it ends"));
    let run = run.ended_with(1).saying(&["interrupted after", "kept in u.toml.chamber: the same command goes on"]);
    assert_eq!(run.stdout, "");
    assert!(!bench.path("u.toml").exists());
}

#[test]
fn a_door_left_open_and_an_overshoot_are_refused_with_their_cause() {
    let bench = bench();
    let door = format!("chamber quick.toml {UNIT} --chamber sim:lag_s=15,door_at_s=1,door_for_s=1000000 -o u.toml");
    let why = bench.zerorate(&door).fails(3);
    assert!(why.contains("close its door") || why.contains("Close its door"), "{why}");
    let overshoot = format!("chamber quick.toml {UNIT} --chamber sim:lag_s=15,overshoot=0.4 -o u.toml");
    let why = bench.zerorate(&overshoot).fails(3);
    assert!(why.contains("beyond the 10.0 to 50.0 °C of the plan"), "{why}");
    assert!(!bench.path("u.toml").exists());
}

#[test]
fn plans_and_chambers_that_make_no_sense_are_named() {
    let bench = bench();
    bench.write("bad.toml", "schema = 1\n[[step]]\nto_c = 15\nramp = 2\n");
    let cases = [
        ("chamber bad.toml", "line 4, `ramp = 2`: unknown field"),
        ("chamber quick.toml --device replay:x.arrows --chamber hand", "leave --chamber out"),
        ("chamber quick.toml --device bridge:/dev/null --chamber sim:", "--chamber sim: is for twin:"),
        ("chamber quick.toml --chamber tcp:localhost", "say which commands it takes: set=espec|f4t|simserv"),
        ("chamber quick.toml --chamber tcp:localhost?set=foo", "there are espec|f4t|simserv"),
        ("chamber quick.toml --chamber oven", "no such kind of chamber"),
        ("chamber quick.toml --max-lost 2", "give a share from 0 to 1"),
    ];
    for (line, why) in cases {
        let said = bench.zerorate(line).fails(2);
        assert!(said.contains(why), "{line}: {said}");
    }
    let several = "chamber quick.toml --device twin:axes=3 --report u.svg";
    let said = bench.zerorate(several).fails(2);
    assert!(said.contains("a picture shows one axis"), "{said}");
    let said = bench.zerorate("chamber none.toml").fails(1);
    assert!(said.contains("no plan none.toml; f57 and two-point come with the program"), "{said}");
}

#[test]
fn a_csv_that_is_no_course_of_a_chamber_is_refused_with_its_line() {
    let bench = bench();
    bench.zerorate(&format!("capture {UNIT} --duration 20s -o u.arrows")).ok();
    let cases: [(&[u8], &str); 7] = [
        (b"", "did.csv: columns t_s and temp_c are needed; it has none"),
        (b"time,temp\n0,25\n", "did.csv: columns t_s and temp_c are needed; it has time, temp"),
        (b"t_s,temp_c\n0,25\n10,x\n", "did.csv: line 3: t_s and temp_c must be numbers"),
        (b"t_s,temp_c\n0,25\n10\n", "did.csv: line 3: t_s and temp_c must be numbers"),
        (b"t_s,temp_c\n0,25\n", "did.csv: it has fewer than two rows"),
        (b"t_s,temp_c\n10,25\n0,25\n", "did.csv: row 2: its t_s is not after the one before"),
        (b"t_s,temp_c\n0,\xff\n", "did.csv is not a plan: it is not text in UTF-8"),
    ];
    for (text, why) in cases {
        bench.write("did.csv", text);
        let said = bench.zerorate("chamber did.csv --device replay:u.arrows").fails(2);
        assert!(said.contains(why), "{said}");
    }
}

/// A run that fails leaves nothing under the names that were asked for, and goes on from its steps.
#[test]
#[cfg(target_os = "linux")]
fn a_log_that_outgrows_its_disk_costs_neither_the_result_nor_the_steps() {
    let bench = bench();
    let chamber = format!("chamber quick.toml {UNIT} --chamber sim:lag_s=15 -o u.toml --report u.html");
    let line = format!("ulimit -f 200; trap '' XFSZ; exec {PROGRAM} {chamber} --log u.arrows");
    let run = Run::of(Command::new("sh").args(["-c", &line]).current_dir(bench.dir.path())).ended_with(1);
    run.saying(&["warning: log-failed: ", "not lost", "u.rescue-"]);
    assert!(!bench.path("u.toml").exists() && !bench.path("u.html").exists());
    bench.zerorate(&chamber).ended_with(0).saying(&["going on after step 1 of 2"]);
    assert!(bench.path("u.toml").exists() && bench.path("u.html").exists());
}

/// A chamber at a socket: its air is a second on with each question, and it hangs up as often as it is told to.
struct Socket {
    address: String,
    heard: Arc<Mutex<Vec<String>>>,
}

#[derive(Clone, Copy)]
enum Speech {
    Espec,
    F4t,
    SimServ,
}

impl Socket {
    /// Hangs up after so many questions, for good or for the next connection.
    fn open(speech: Speech, hang_up_after: Option<usize>, for_good: bool) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address").to_string();
        let heard = Arc::new(Mutex::new(Vec::new()));
        let (inner, mut air) = (heard.clone(), (25.0, 25.0));
        thread::spawn(move || {
            let mut patience = hang_up_after;
            for stream in listener.incoming() {
                serve(stream.expect("a connection"), speech, &mut air, &inner, patience.take());
                if for_good {
                    return;
                }
            }
        });
        Self { address, heard }
    }

    fn heard(&self) -> Vec<String> {
        self.heard.lock().expect("no panic").clone()
    }
}

fn serve(
    stream: TcpStream,
    speech: Speech,
    (set_c, air_c): &mut (f64, f64),
    heard: &Mutex<Vec<String>>,
    mut patience: Option<usize>,
) {
    let mut writer = stream.try_clone().expect("two ends");
    let ending = if matches!(speech, Speech::SimServ) { b'\r' } else { b'\n' };
    for line in BufReader::new(stream).split(ending) {
        let Ok(bytes) = line else { return };
        let line: String = bytes.iter().map(|byte| char::from(*byte)).collect::<String>().trim().to_owned();
        heard.lock().expect("no panic").push(line.clone());
        let set = ["TEMP, S", ":SOURCE:CLOOP1:SPOINT ", "11001¶1¶1¶"].iter().find_map(|head| line.strip_prefix(head));
        if let Some(text) = set {
            *set_c = text.parse().expect("a temperature");
        }
        let is_question = line.ends_with('?') || line.starts_with("11004");
        if is_question {
            *air_c += (*set_c - *air_c) / 15.0;
            if let Some(left) = &mut patience {
                *left -= 1;
                if *left == 0 {
                    return;
                }
            }
        }
        let answer = match (speech, is_question) {
            (Speech::Espec, true) => format!("{air_c:.1},{set_c:.1},150.0,-75.0\r\n"),
            (Speech::Espec, false) => format!("OK:{line}\r\n"),
            (Speech::F4t, true) if line.contains("SPOINT") => format!("{set_c:.3}\n"),
            (Speech::F4t, true) => format!("{air_c:.3}\n"),
            (Speech::F4t, false) => continue,
            (Speech::SimServ, true) => format!("1¶{air_c:.1}\r\n"),
            (Speech::SimServ, false) => "1\r\n".to_owned(),
        };
        let bytes: Vec<u8> = answer.chars().map(|c| c as u8).collect();
        if writer.write_all(&bytes).is_err() {
            return;
        }
    }
}

#[test]
fn each_kind_of_chamber_is_told_and_asked_and_left_where_it_is_safe() {
    let bench = bench();
    for (speech, name, first, last) in [
        (Speech::Espec, "espec", "MODE, CONSTANT", "MODE, STANDBY"),
        (Speech::F4t, "f4t", ":UNIT:TEMPERATURE C", ":SOURCE:CLOOP1:SPOINT 25.0"),
        (Speech::SimServ, "simserv", "14001¶1¶1¶1", "14001¶1¶1¶0"),
    ] {
        let socket = Socket::open(speech, None, false);
        let line = format!("chamber quick.toml {UNIT} --json --chamber tcp:{}?set={name}", socket.address);
        let result = bench.zerorate(&line).ended_with(0).json();
        let points = result["points"].as_array().expect("points");
        assert!(number(&points[1]["temp_c"]) - number(&points[0]["temp_c"]) > 29.0, "{name}: {points:?}");
        let heard = socket.heard();
        // what it was left at is asked after that
        let told = heard.iter().rfind(|line| !line.ends_with('?') && !line.starts_with("11004"));
        assert_eq!((heard.first().map(String::as_str), told.map(String::as_str)), (Some(first), Some(last)));
        assert!(heard.iter().any(|line| line.contains("25.0")), "the safe set point");
    }
}

#[test]
fn a_lost_connection_is_made_anew_and_one_that_stays_lost_ends_the_measurement() {
    let bench = bench();
    let socket = Socket::open(Speech::Espec, Some(60), false);
    let line = |socket: &Socket, wait: u32| {
        format!("chamber quick.toml {UNIT} --chamber tcp:{}?set=espec&patience_s={wait} -o u.toml", socket.address)
    };
    bench.zerorate(&line(&socket, 60)).ended_with(0);
    assert_eq!(socket.heard().iter().filter(|line| *line == "MODE, CONSTANT").count(), 2, "two connections");

    std::fs::remove_file(bench.path("u.toml")).expect("it is there");
    let socket = Socket::open(Speech::Espec, Some(150), true);
    let why = bench.zerorate(&line(&socket, 0)).fails(1);
    assert!(why.contains("is lost, and was not found again within 0 s"), "{why}");
    assert!(why.contains("chamber-left: the chamber could not be sent to 25.0 °C"), "{why}");
    assert!(!bench.path("u.toml").exists());
}

#[test]
fn a_chamber_that_does_not_answer_costs_no_hour() {
    let bench = bench();
    let line = format!("chamber quick.toml {UNIT} --chamber tcp:127.0.0.1:1?set=espec");
    let why = bench.zerorate(&line).fails(1);
    assert!(why.contains("no chamber answers at 127.0.0.1:1"), "{why}");
    assert!(Command::new(PROGRAM).arg("chamber").output().is_ok_and(|output| output.status.code() == Some(2)));
}
