//! A chamber that fails, in each way and at each moment: it is left safe, or the user reads that nobody knows.

use crate::harness::fake_chamber::{FAULTS, FakeChamber, Fault, Onset, SPEECHES, Speech};
use crate::harness::{Bench, Run};
use rustix::process::{Pid, Signal, kill_process};
use std::iter;
use std::process::{Child, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

/// A unit that warms itself in a minute, seen 225 times a second.
const UNIT: &str = "--device twin:seed=4,warmup_s=10 --divider 50";
/// Two soak points, in part time of four minutes.
const QUICK: &str = "schema = 1\nwindow_s = 20\naverage_s = 30\nsettle_timeout_s = 600\ndrift_c_per_min = 0.2\n\
    [[step]]\nto_c = 15\n[[step]]\nto_c = 45\n";
/// No run takes longer, on a machine however busy.
const MOST: Duration = Duration::from_secs(120);

/// How the measurement ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ending {
    /// By itself, and the fault comes before.
    Running,
    /// By itself, and the fault comes with the safe set point.
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

/// One cell of the table.
struct Cell {
    speech: Speech,
    fault: Fault,
    ending: Ending,
}

impl Cell {
    fn all() -> Vec<Self> {
        let of = |speech| FAULTS.iter().flat_map(move |fault| ENDINGS.map(|ending| (speech, *fault, ending)));
        let cell = |(speech, fault, ending)| Self { speech, fault, ending };
        SPEECHES.into_iter().flat_map(of).map(cell).collect()
    }

    fn from(&self) -> Onset {
        match (self.ending, self.fault) {
            (Ending::Ended, _) => Onset::End,
            // obeyed, and not acknowledged, from the very start
            (_, Fault::Unheard) => Onset::Start,
            _ => Onset::Question(20),
        }
    }

    /// What comes back is waited for as long as it takes on a busy machine.
    fn patience_s(&self) -> u32 {
        let is_for_good = matches!(self.fault, Fault::Silent | Fault::Closes | Fault::Unheard);
        if is_for_good && self.ending == Ending::Running { 1 } else { 60 }
    }

    /// Drives the program through it; what is wrong with how it ended.
    fn complaint(&self) -> Option<String> {
        let Self { speech, fault, ending } = *self;
        let chamber = FakeChamber::new(speech, fault, self.from()).expect("a port");
        let bench = Bench::new();
        bench.write("quick.toml", QUICK);
        let run = driven(&bench, &chamber, self.patience_s(), ending.signals());
        // what was sent last may still be on its way
        wait_for(|| !self.must_be_safe() || chamber.world().is_safe());
        let is_hot = matches!(fault, Fault::Hot | Fault::Stuck) && ending == Ending::Running;
        let wrong = match () {
            () if is_hot && run.code != Some(3) => Some("air beyond all limits is not refused".to_owned()),
            () if is_hot && bench.path("u.toml").exists() => Some("it gave a calibration".to_owned()),
            () if self.must_be_safe() && !chamber.world().is_safe() => {
                Some(format!("not safe: {:?}", chamber.world()))
            }
            () => chamber.complaint(&run.stderr),
        };
        wrong.map(|wrong| format!("{speech:?}, {fault:?}, {ending:?}: {wrong}\n{:?} {}", run.code, run.stderr))
    }

    /// Whether saying that nobody knows is not enough, however busy the machine is.
    fn must_be_safe(&self) -> bool {
        let obeys = match self.fault {
            Fault::Hot | Fault::Stuck | Fault::AcceptsAgain | Fault::Unheard => true,
            Fault::Refuses => self.speech == Speech::Espec,
            Fault::Silent | Fault::Closes => false,
        };
        obeys && self.ending != Ending::CtrlCTwice
    }
}

/// A measurement in this chamber, with these signals once its fault is there.
fn driven(bench: &Bench, chamber: &FakeChamber, patience_s: u32, signals: &[Signal]) -> Run {
    let line = format!("chamber quick.toml {UNIT} --chamber {} -o u.toml", chamber.argument(patience_s));
    let mut command = bench.command(&line);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    wait_for(|| signals.is_empty() || chamber.world().is_faulty || has_ended(&mut child));
    for signal in signals {
        thread::sleep(Duration::from_millis(100));
        // one that has ended needs none
        let _ = kill_process(Pid::from_child(&child), *signal);
    }
    wait_for(|| has_ended(&mut child));
    let _ = child.kill();
    Run::from(child.wait_with_output().expect("it ends"))
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

/// Most cells wait for answers that do not come, and need no processor for that. No lock is held meanwhile.
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

/// A connection that is made anew for an hour.
#[test]
fn the_first_ctrl_c_is_heeded_while_a_connection_is_made_anew() {
    for fault in [Fault::Closes, Fault::Silent] {
        let chamber = FakeChamber::new(Speech::Espec, fault, Onset::Question(20)).expect("a port");
        let bench = Bench::new();
        bench.write("quick.toml", QUICK);
        let began = Instant::now();
        let run = driven(&bench, &chamber, 3600, &[Signal::INT]).ended_with(1);
        assert!(began.elapsed() < Duration::from_secs(60), "{:?}", began.elapsed());
        let run = run.saying(&["sending the chamber to 25.0 °C", "interrupted after"]);
        let last = run.stderr.lines().last().unwrap_or_default();
        assert!(last.starts_with("warning: chamber-left: ") && last.contains("last told 15.0 °C"), "{last}");
    }
}

/// Each new connection begins with all that the chamber has to know.
#[test]
fn a_new_connection_is_told_the_set_point_again() {
    for speech in SPEECHES {
        let chamber = FakeChamber::new(speech, Fault::AcceptsAgain, Onset::Question(20)).expect("a port");
        let bench = Bench::new();
        bench.write("quick.toml", QUICK);
        driven(&bench, &chamber, 60, &[]).ended_with(0);
        let heard = chamber.world().heard.clone();
        let told = heard.iter().filter(|line| line.ends_with("15.0") && !line.ends_with('?')).count();
        assert!(told >= 2, "{heard:?}");
    }
}

#[test]
fn a_plan_beyond_the_limits_of_the_part_heats_nothing() {
    let chamber = FakeChamber::new(Speech::Espec, Fault::Stuck, Onset::End).expect("a port");
    let bench = Bench::new();
    bench.write("quick.toml", QUICK.replace("to_c = 45", "to_c = 250"));
    let why = bench.zerorate(&format!("chamber quick.toml {UNIT} --chamber {}", chamber.argument(1))).fails(2);
    assert!(why.contains("to_c of step 2 is 250 °C, and the ADIS16130 may be at -40 to 85 °C"), "{why}");
    assert!(chamber.world().is_safe() && !chamber.world().heard.iter().any(|line| line.contains("15.0")));
    let far = bench.zerorate("capture --device twin:ambient_c=150 --samples 100 -o far.csv").ended_with(0);
    far.saying(&["warning: beyond-limits: the simulated part is in air of 150 °C"]);
}
