//! Every fault of a chamber, with every ending of the measurement. The chamber must end at the safe temperature, or
//! the last line must tell the user that its temperature is unknown.

use super::chamber::UNIT;
use crate::harness::script_chamber::{AT_END, FAULTS, ScriptChamber};
use crate::harness::{Bench, Run, start};
use rustix::process::{Pid, Signal, kill_process_group};
use std::fs;
use std::iter;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

/// Two soak points, which take a few minutes of simulated time.
const QUICK: &str = "schema = 1\nwindow_s = 20\naverage_s = 30\nsettle_timeout_s = 300\ndrift_c_per_min = 0.2\n\
    [[step]]\nto_c = 15\n[[step]]\nto_c = 45\n";
/// Time limit of a run, for a busy machine.
const MOST: Duration = Duration::from_secs(120);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Ending {
    /// The measurement ends by itself. The fault begins before its end.
    Running,
    /// The measurement ends by itself. The fault begins with the command that sets the safe temperature.
    Ended,
    CtrlC,
    CtrlCTwice,
    Term,
}

const ENDINGS: [Ending; 5] = [Ending::Running, Ending::Ended, Ending::CtrlC, Ending::CtrlCTwice, Ending::Term];

impl Ending {
    fn signals(self) -> &'static [Signal] {
        match self {
            Self::Running | Self::Ended => &[],
            Self::CtrlC => &[Signal::INT],
            Self::CtrlCTwice => &[Signal::INT, Signal::INT],
            Self::Term => &[Signal::TERM],
        }
    }
}

struct Cell {
    fault: &'static str,
    ending: Ending,
}

impl Cell {
    fn all() -> Vec<Self> {
        let cells = FAULTS.iter().flat_map(|fault| ENDINGS.map(|ending| Self { fault: *fault, ending }));
        // a test of zerorate-host covers a dead chamber with shorter limits
        cells.filter(|cell| (cell.fault, cell.ending) != ("dead", Ending::Running)).collect()
    }

    fn onset(&self) -> &'static str {
        if self.ending == Ending::Ended { AT_END } else { "20" }
    }

    /// Time for retries, s. It is short for a lasting fault in the measurement, otherwise long, for a busy machine.
    fn retry_s(&self) -> u32 {
        let comes_back = self.fault == "fails-thrice";
        if self.ending == Ending::Running && !comes_back { 1 } else { 60 }
    }

    fn code(&self) -> i32 {
        match self.fault {
            _ if self.ending == Ending::Ended => 0,
            "hot" | "stuck" | "lazy" => 3,
            "fails-thrice" | "slow" => 0,
            _ => 1,
        }
    }

    /// Runs the program with this fault and ending. Returns what is wrong with the outcome.
    fn complaint(&self) -> Option<String> {
        let Self { fault, ending } = *self;
        let bench = Bench::new();
        let chamber = chamber(&bench, fault, self.onset());
        let run = measured(&bench, &chamber, self.retry_s(), ending.signals());
        // the last command to the chamber may still be running when the program has ended
        wait_for(|| !self.must_be_safe() || chamber.is_safe());
        let wrong = match () {
            () if ending.signals().is_empty() && run.code != Some(self.code()) => {
                Some(format!("the exit code is not {}", self.code()))
            }
            () if bench.path("u.toml").exists() != (run.code == Some(0)) => Some("a wrong calibration".to_owned()),
            () if self.must_be_safe() && !chamber.is_safe() => Some(format!("not safe: {:?}", chamber.heard())),
            () => chamber.complaint(&run.stderr),
        };
        wrong.map(|wrong| format!("{fault}, {ending:?}: {wrong}\n{:?} {}", run.code, run.stderr))
    }

    /// True if the chamber must end at its safe temperature. A message that the temperature is unknown is not enough.
    fn must_be_safe(&self) -> bool {
        !matches!(self.fault, "dead" | "fails" | "refuses") && self.ending != Ending::CtrlCTwice
    }
}

/// Makes a chamber in a subfolder of the test's folder, and writes the plan.
fn chamber(bench: &Bench, fault: &str, onset: &str) -> ScriptChamber {
    bench.write("quick.toml", QUICK);
    let folder = bench.path("a chamber");
    fs::create_dir(&folder).expect("a folder");
    ScriptChamber::new(folder, fault, onset).expect("files")
}

/// The program in its own process group, as a shell in a terminal starts it.
fn program(bench: &Bench, chamber: &ScriptChamber, retry_s: u32) -> Command {
    let mut command = bench.command(&format!("chamber quick.toml {UNIT} -o u.toml"));
    command.args(chamber.arguments(retry_s)).process_group(0);
    command
}

/// Runs a measurement, and sends these signals to its process group, as Ctrl-C does, once the fault has begun.
fn measured(bench: &Bench, chamber: &ScriptChamber, retry_s: u32, signals: &[Signal]) -> Run {
    let mut child = start(&mut program(bench, chamber, retry_s));
    wait_for(|| signals.is_empty() || chamber.is_faulty() || has_ended(&mut child));
    for signal in signals {
        // signals within half a second count as one
        thread::sleep(Duration::from_millis(600));
        // sending the signal fails if the program has ended
        let _ = kill_process_group(Pid::from_child(&child), *signal);
    }
    wait_for(|| has_ended(&mut child));
    let _ = child.kill();
    Run::ended(child)
}

fn has_ended(child: &mut Child) -> bool {
    child.try_wait().is_ok_and(|code| code.is_some())
}

fn wait_for(mut is_there: impl FnMut() -> bool) {
    let until = Instant::now() + MOST;
    while !is_there() && Instant::now() < until {
        thread::sleep(Duration::from_millis(5));
    }
}

/// Most cases wait for commands that hang or fail and need no processor time, so 24 cases run at once.
#[test]
fn whatever_fails_the_chamber_is_safe_or_the_user_knows() {
    const THREADS: usize = 24;
    let cells = Mutex::new(Cell::all());
    let next = || cells.lock().expect("no panic").pop();
    let work = || iter::from_fn(next).filter_map(|cell| cell.complaint()).collect::<Vec<_>>();
    let complaints: Vec<String> = thread::scope(|scope| {
        let workers: Vec<_> = (0..THREADS).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("no panic")).collect()
    });
    assert!(complaints.is_empty(), "{} of {}:\n{}", complaints.len(), Cell::all().len(), complaints.join("\n"));
}

#[test]
fn each_fault_is_reported_with_its_cause() {
    for (fault, code, why) in [
        ("hot", 3, "code: beyond-limits"),
        ("lazy", 3, "the chamber's air is only at "),
        ("fails", 1, "read`: exit status: 1: no route to the chamber"),
        ("garbage", 1, "its first line is \"23.4 C\", and not a number in °C alone"),
        ("refuses", 1, "set 45.0`: exit status: 2: out of range"),
    ] {
        let bench = Bench::new();
        let chamber = chamber(&bench, fault, "20");
        let run = measured(&bench, &chamber, 0, &[]).ended_with(code).saying(&[why]);
        let last = run.stderr.lines().last().unwrap_or_default();
        let is_left = !matches!(fault, "fails" | "refuses");
        let start =
            if is_left { "the chamber was left at 25.0 °C; its air was at " } else { "warning: chamber-left: " };
        assert!(last.starts_with(start), "{fault}: {last}");
    }
}

/// The command to the chamber fails and is repeated for an hour, or it hangs.
#[test]
fn the_first_ctrl_c_is_heeded_while_a_command_is_waited_for() {
    for fault in ["fails", "hangs"] {
        let bench = Bench::new();
        let chamber = chamber(&bench, fault, "20");
        let began = Instant::now();
        let run = measured(&bench, &chamber, 3600, &[Signal::INT]).ended_with(1);
        assert!(began.elapsed() < Duration::from_secs(60), "{:?}", began.elapsed());
        let run = run.saying(&["sending the chamber to 25.0 °C", "interrupted after"]);
        let last = run.stderr.lines().last().unwrap_or_default();
        match fault {
            "hangs" => assert!(last.starts_with("the chamber was left at 25.0 °C"), "{last}"),
            _ => assert!(last.starts_with("warning: chamber-left: ") && last.contains("set to 15.0 °C"), "{last}"),
        }
    }
}

#[test]
fn a_stop_before_the_first_set_point_sends_the_chamber_nowhere() {
    let bench = Bench::new();
    let chamber = chamber(&bench, "hangs", "0");
    let run = measured(&bench, &chamber, 60, &[Signal::INT]).ended_with(1);
    assert!(!run.stderr.contains("sending the chamber") && chamber.heard() == ["read"], "{}", run.stderr);
}

#[test]
fn a_chamber_that_cannot_be_read_costs_no_hour_and_is_not_set() {
    let bench = Bench::new();
    let chamber = chamber(&bench, "fails", "0");
    let run = measured(&bench, &chamber, 60, &[]).ended_with(1);
    let run = run.saying(&["the chamber cannot be read: `sh '", "no route to the chamber; try the command by itself"]);
    assert!(!run.stderr.contains("chamber-left") && chamber.heard() == ["read"], "{}", run.stderr);
}

#[test]
fn a_plan_beyond_the_limits_of_the_part_heats_nothing() {
    let bench = Bench::new();
    let chamber = chamber(&bench, "stuck", AT_END);
    bench.write("quick.toml", QUICK.replace("to_c = 45", "to_c = 250"));
    Run::of(&mut program(&bench, &chamber, 1))
        .fails(2, &["to_c of step 2 is 250 °C, and the ADIS16130 may be at -40 to 85 °C"]);
    assert!(!chamber.heard().iter().any(|line| line.starts_with("set ")), "{:?}", chamber.heard());
    let far = bench.zerorate("capture --device twin:ambient_c=150 --samples 100 -o far.csv").ended_with(0);
    far.saying(&["warning: beyond-limits: the simulated part is in air of 150 °C"]);
}
