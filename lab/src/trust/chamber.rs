//! A chamber fails at a random moment of a measurement, or the saved state of an interrupted measurement is edited.

use super::bench::{Bench, Folder, random};
use super::faults::WRONG_U;
use super::{Class, Verdict};
use anyhow::{Context, Result};
use rand::RngExt;
use rand::rngs::StdRng;
use script_chamber::{AT_END, FAULTS, ScriptChamber};
use serde_json::Value;
use std::fs;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

#[path = "../../../crates/zerorate-cli/tests/harness/script_chamber.rs"]
mod script_chamber;

pub const CLASSES: &[Class] = &[
    Class {
        name: "chamber commands",
        what: "a chamber behind two commands fails in one of eleven ways; the run ends by itself, by Ctrl-C, by two, \
               or by SIGTERM",
        quick: 8,
        run: failing,
    },
    Class {
        name: "edit chamber state",
        what: "one digit of `unit.toml.chamber` is edited, from which a measurement goes on",
        quick: 10,
        run: edited_steps,
    },
];

/// A unit whose self-heating has a time constant of 10 s, and a plan of two soak points: 4 min of the part's time.
const UNIT: &str = "warmup_s=10";
const PLAN: &str = "schema = 1\nwindow_s = 20\naverage_s = 30\nsettle_timeout_s = 600\ndrift_c_per_min = 0.2\n\
    [[step]]\nto_c = 15\n[[step]]\nto_c = 45\n";
/// Approximate number of chamber readings in a measurement.
const READINGS: usize = 250;
/// Time limit of a run, even on a busy machine.
const MOST: Duration = Duration::from_secs(120);
const SIGNALS: [&[&str]; 4] = [&[], &["-INT"], &["-INT", "-INT"], &["-TERM"]];

/// Makes the chamber fail. Checks that the run ends, that its result is right, and that its last line is right about
/// whether the chamber is at its safe temperature.
fn failing(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let mut random = random(class, seed);
    let fault = FAULTS[random.random_range(0..FAULTS.len())];
    let onset = match random.random_range(0..10) {
        0 => "0".to_owned(),
        1..=3 => AT_END.to_owned(),
        _ => random.random_range(1..READINGS).to_string(),
    };
    let signals = SIGNALS[random.random_range(0..SIGNALS.len())];
    let pause = Duration::from_micros(random.random_range(0..300_000));
    let folder = Folder::new(&format!("chamber-{seed}"))?;
    let chamber = ScriptChamber::new(folder.path().to_owned(), fault, &onset)?;
    let (plan, output) = (folder.file("plan.toml"), folder.file("unit.toml"));
    fs::write(&plan, PLAN)?;
    let device = format!("twin:seed={seed},{UNIT}");
    let args = ["chamber", &plan, "--device", &device, "--divider", "50", "--json", "-o", &output];
    let mut child =
        bench.command(&args).args(chamber.arguments(1)).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    if !signals.is_empty() {
        wait_for(&mut child, || chamber.is_faulty())?;
    }
    for signal in signals {
        sleep(pause);
        Command::new("kill").args([*signal, &child.id().to_string()]).stderr(Stdio::null()).status()?;
    }
    wait_for(&mut child, || false)?;
    let has_ended = child.try_wait()?.is_some();
    child.kill()?;
    let run = super::bench::Run::from(child.wait_with_output()?);
    if !has_ended {
        return Ok(Verdict::Silent(format!("{fault}, {onset}, {signals:?}: it does not end\n{}", run.stderr)));
    }
    if let Some(complaint) = chamber.complaint(&run.stderr) {
        return Ok(Verdict::Silent(format!("{fault}, {onset}, {signals:?}: {complaint}\n{}", run.stderr)));
    }
    let is_safe = chamber.is_safe();
    Ok(match run.code {
        Some(0) if off_u(&run.json()?["truth"], &run.json()?)? > WRONG_U => {
            Verdict::Silent(format!("{fault}, {onset}: {}", run.stdout))
        }
        Some(0) if is_safe => Verdict::Right,
        _ if is_safe => Verdict::Refused,
        _ => Verdict::Warned,
    })
}

/// Waits until the condition is true, the program has ended, or the time limit is over.
fn wait_for(child: &mut Child, is_so: impl Fn() -> bool) -> Result<()> {
    let until = Instant::now() + MOST;
    while !is_so() && child.try_wait()?.is_none() && Instant::now() < until {
        sleep(Duration::from_millis(2));
    }
    Ok(())
}

/// The largest difference between the curves of two results, in multiples of the standard uncertainty of `result`.
fn off_u(other: &Value, result: &Value) -> Result<f64> {
    let number = |value: &Value| value.as_f64().context("a number");
    let (curve, other) = (&result["curve"], &other["curve"]);
    let (curve, other) = (curve.as_array().context("a curve")?, other.as_array().context("another")?);
    let mut worst: f64 = 0.0;
    for (one, other) in curve.iter().zip(other) {
        let off_dps = number(&one["correction_dps"])? - number(&other["correction_dps"])?;
        worst = worst.max((off_dps / number(&one["u_dps"])?).abs());
    }
    Ok(worst)
}

/// The arguments of a measurement whose part is unplugged in the second step. A resumed measurement ends before the
/// part is unplugged again.
fn going_on<'a>(plan: &'a str, output: &'a str) -> [&'a str; 11] {
    const DEVICE: &str = "twin:seed=4,warmup_s=10,fault=unplug,fault_at_s=220";
    ["chamber", plan, "--device", DEVICE, "--divider", "50", "--chamber", "sim:lag_s=15", "--json", "-o", output]
}

/// The saved state of an interrupted measurement, and its result if the state is not edited.
fn interrupted(bench: &Bench) -> Result<&'static (String, Value)> {
    static INTERRUPTED: OnceLock<(String, Value)> = OnceLock::new();
    if let Some(interrupted) = INTERRUPTED.get() {
        return Ok(interrupted);
    }
    let folder = Folder::new(&format!("interrupted-{:?}", std::thread::current().id()))?;
    let (plan, output) = (folder.file("plan.toml"), folder.file("unit.toml"));
    fs::write(&plan, PLAN)?;
    bench.run(&going_on(&plan, &output))?;
    let state = fs::read_to_string(format!("{output}.chamber")).context("finished steps")?;
    let result = bench.must(&going_on(&plan, &output))?.json()?;
    Ok(INTERRUPTED.get_or_init(|| (state, result)))
}

pub fn with_another_digit(text: &str, random: &mut StdRng) -> String {
    let digits: Vec<usize> = text.bytes().enumerate().filter(|(_, b)| b.is_ascii_digit()).map(|(at, _)| at).collect();
    let at = digits[random.random_range(0..digits.len())];
    let mut bytes = text.as_bytes().to_vec();
    bytes[at] = b'0' + (bytes[at] - b'0' + random.random_range(1..10)) % 10;
    String::from_utf8_lossy(&bytes).into_owned()
}

fn edited_steps(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let (state, result) = interrupted(bench)?;
    let folder = Folder::new(&format!("steps-{seed}"))?;
    let (plan, output) = (folder.file("plan.toml"), folder.file("unit.toml"));
    fs::write(&plan, PLAN)?;
    fs::write(format!("{output}.chamber"), with_another_digit(state, &mut random(class, seed)))?;
    let run = bench.run(&going_on(&plan, &output))?;
    Ok(match run.code {
        Some(2) if run.says(&["does not go on with this measurement"]) => Verdict::Refused,
        Some(0) if off_u(&run.json()?, result)? <= WRONG_U => Verdict::Right,
        code => Verdict::Silent(format!("it ended with {code:?}: {}{}", run.stdout, run.stderr)),
    })
}
