//! `chamber`: its result, the saved steps of an interrupted measurement, and the reports of failures.

use crate::harness::{Bench, PROGRAM, Run, SOAK, send, start, wait_until};
use serde_json::Value;
use std::process::Command;

/// A twin whose self-heating has a slow time constant of 10 s, with 223 samples per second (F-56).
pub const UNIT: &str = "--device twin:seed=4,warmup_s=10 --divider 50";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("quick.toml", SOAK);
    bench
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
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
    let page = bench.text("u.html");
    for said in ["SIMULATED: the software twin", "What the correction leaves over temperature", "Soak points"] {
        assert!(page.contains(said), "{said}");
    }

    bench.zerorate("chamber quick.toml --device replay:u.arrows -o again.toml").ok();
    assert_eq!(bench.text("u.toml"), bench.text("again.toml"));

    let away = "stream --cal u.toml --device twin:seed=4,ambient_c=70 --divider 50 --duration 1s --rate 1";
    bench.zerorate(away).ended_with(0).saying(&["extrapolated"]);
}

#[test]
fn each_step_by_hand_is_announced() {
    let bench = bench();
    let line = format!("chamber quick.toml {UNIT} --chamber hand");
    let said = [
        "step 1 of 2: set the chamber to 15.0 °C",
        "step 2 of 2: set the chamber to 45.0 °C",
        "set the chamber to 25.0 °C, or",
    ];
    bench.zerorate(&line).ended_with(0).saying(&said);
}

/// The cable is pulled after 220 s, in the second step. The same command then runs only that step, in less time.
#[test]
fn an_interrupted_measurement_goes_on_after_its_last_finished_step() {
    let bench = bench();
    let unit = UNIT.replace("warmup_s=10", "warmup_s=10,fault=unplug,fault_at_s=220");
    let line = format!("chamber quick.toml {unit} --chamber sim:lag_s=15 --json -o u.toml");
    bench.zerorate(&line).fails(1, &[]);
    let kept = bench.text("u.toml.chamber");
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
    bench.zerorate(&line).fails(2, &["u.toml.chamber does not go on with this measurement", "--restart"]);
    assert_eq!(bench.text("u.toml.chamber"), "nonsense");
    bench.zerorate(&format!("{line} --restart")).ended_with(0);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_finished_steps() {
    let bench = bench();
    bench.write("long.toml", format!("{SOAK}[[step]]\nto_c = 20\nhold_s = 86400\n"));
    let line = format!("chamber long.toml {UNIT} --chamber sim:lag_s=15 -o u.toml");
    let child = start(&mut bench.command(&line));
    wait_until("a finished step", || bench.path("u.toml.chamber").exists());
    send("INT", &child);
    let said = ["interrupted after", "kept in u.toml.chamber: the same command goes on"];
    let run = Run::ended(child).ended_with(1).saying(&said);
    assert_eq!(run.stdout, "");
    assert!(!bench.path("u.toml").exists());
}

#[test]
fn plans_and_chambers_that_make_no_sense_are_named() {
    let bench = bench();
    let cases = [
        ("chamber quick.toml --device replay:x.arrows --chamber hand", "leave out --chamber and the commands"),
        ("chamber quick.toml --device bridge:/dev/null --chamber sim:", "--chamber sim: is for twin:"),
        ("chamber quick.toml --set-temperature set --read-temperature read", "`set` has no {temp_c}"),
        ("chamber quick.toml --set-temperature {temp_c}", "--read-temperature <COMMAND>"),
        ("chamber quick.toml --read-temperature read", "--set-temperature <COMMAND>"),
        (
            "chamber quick.toml --chamber hand --set-temperature {temp_c} --read-temperature read",
            "cannot be used with",
        ),
        ("chamber quick.toml --chamber oven", "no such kind of chamber"),
        ("chamber quick.toml --max-lost 2", "give a share from 0 to 1"),
    ];
    for (line, why) in cases {
        bench.zerorate(line).fails(2, &[why]);
    }
    let several = "chamber quick.toml --device twin:axes=3 --report u.svg";
    bench.zerorate(several).fails(2, &["a picture shows one axis"]);
}

/// A run whose log fails writes neither `u.toml` nor `u.html`. The next run continues from the finished steps.
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
