//! `cargo xtask test`: every check that a change must pass.
//!
//! Steps that use one core or wait run side by side. Each must pass on a busy machine; only the rig keeps the time,
//! and has the machine for itself.
//!
//! The steps share what they build: clippy and the documentation use the same checked dependencies; the tests, the
//! program that other steps run, and the Python package the same libraries. xtask is tested by itself, since its own
//! dependencies ask for features of shared ones, with which all of them would be built once more.

use std::fmt;
use std::io::{Write, stdout};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::targets;

/// Command line of `cargo xtask test`.
#[derive(clap::Args)]
pub struct Args {
    /// Run only these steps; default: all
    #[arg(value_name = "STEP", value_parser = clap::builder::PossibleValuesParser::new(STEPS.map(|step| step.name)))]
    only: Vec<String>,
    /// Leave out what takes longest and finds least while one works: bridge, python, serve, trust, web, rig. CI runs
    /// all
    #[arg(long, conflicts_with = "only")]
    quick: bool,
}

/// One cargo command.
struct Step {
    name: &'static str,
    env: Option<(&'static str, &'static str)>,
    args: &'static str,
    pace: Pace,
}

/// What a step does with the machine.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pace {
    /// Uses all cores, or keeps the time: nothing runs beside it.
    Alone,
    /// Uses one core, and that for less than half a minute: runs beside its neighbours.
    Beside,
    /// Waits, or uses one core, for longer: the same, and `--quick` leaves it out.
    Slow,
    /// Keeps the time and is slow: nothing runs beside it, and `--quick` leaves it out.
    SlowAlone,
}

impl Pace {
    fn is_slow(self) -> bool {
        matches!(self, Self::Slow | Self::SlowAlone)
    }

    fn has_company(self) -> bool {
        matches!(self, Self::Beside | Self::Slow)
    }
}

impl Step {
    const fn new(name: &'static str, args: &'static str) -> Self {
        Self { name, env: None, args, pace: Pace::Alone }
    }

    const fn at(mut self, pace: Pace) -> Self {
        self.pace = pace;
        self
    }

    const fn with_env(mut self, key: &'static str, value: &'static str) -> Self {
        self.env = Some((key, value));
        self
    }

    /// The Rust targets it builds for, the host left out.
    fn targets(&self) -> impl Iterator<Item = &'static str> {
        let words = self.args.split(' ');
        words.clone().zip(words.skip(1)).filter(|(option, _)| *option == "--target").map(|(_, target)| target)
    }
}

/// The command as one would type it.
impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((key, value)) = self.env {
            write!(f, "{key}={value} ")?;
        }
        write!(f, "cargo {}", self.args)
    }
}

/// All steps, in the order in which they fail most cheaply.
///
/// thumbv7em-none-eabihf is a Cortex-M4F. thumbv6m-none-eabi is a Cortex-M0: it has no compare-and-swap, which the
/// TOML parser behind the core's feature `file` needs. wasm32-unknown-unknown is the browser.
const STEPS: [Step; 40] = [
    Step::new("fmt", "fmt --all --check"),
    Step::new("clippy", "clippy --workspace --all-targets --all-features -- -D warnings"),
    Step::new("clippy-driver", "clippy -p adis16130 --all-targets -- -D warnings"),
    Step::new("fmt-firmware", "fmt --manifest-path firmware/Cargo.toml --all --check"),
    Step::new(
        "clippy-firmware",
        "clippy --manifest-path firmware/qemu/Cargo.toml --locked --target-dir target/firmware --target \
         thumbv7em-none-eabihf -- -D warnings",
    ),
    Step::new(
        "clippy-bridge-stm32f4",
        "clippy --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4 -- -D warnings",
    ),
    Step::new(
        "clippy-bridge-rp2040",
        "clippy --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040 -- -D warnings",
    ),
    Step::new(
        "clippy-examples-stm32f4",
        "clippy --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4 -- -D warnings",
    ),
    Step::new(
        "clippy-examples-rp2040",
        "clippy --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040 -- -D warnings",
    ),
    Step::new("fmt-c", "fmt --manifest-path bindings/c/Cargo.toml --all --check"),
    Step::new(
        "clippy-c",
        "clippy --manifest-path bindings/c/Cargo.toml --workspace --locked --target-dir target/c -- -D warnings",
    ),
    Step::new("fmt-web", "fmt --manifest-path xtask/web/Cargo.toml --check"),
    Step::new("fmt-book", "fmt --manifest-path xtask/book/Cargo.toml --check"),
    Step::new("clippy-core", "clippy -p zerorate --no-default-features --lib -- -D warnings"),
    Step::new("doc", "doc --workspace --no-deps --all-features").with_env("RUSTDOCFLAGS", "-Dwarnings"),
    Step::new(
        "m0",
        "build -p adis16130 -p zerorate --no-default-features --features adis16130/async --target thumbv6m-none-eabi",
    ),
    Step::new("m0-driver", "build -p adis16130 --target thumbv6m-none-eabi"),
    Step::new(
        "m4",
        "build -p adis16130 -p zerorate -p adis16130-twin --features adis16130/async,zerorate/file --target \
         thumbv7em-none-eabihf",
    ),
    Step::new(
        "wasm",
        "check -p zerorate-record -p zerorate-logs -p zerorate-view --no-default-features --target wasm32-unknown-unknown",
    ),
    Step::new(
        "clippy-wasm",
        "clippy -p zerorate-web --lib --features edge-first,edge-live --target wasm32-unknown-unknown -- -D warnings",
    ),
    Step::new("test", "test --workspace --all-features"),
    Step::new("test-driver", "test -p adis16130"),
    Step::new("test-bridge", "test --manifest-path firmware/bridge/Cargo.toml --locked --target-dir target/firmware"),
    Step::new(
        "bridge-stm32f4",
        "build --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4",
    ),
    Step::new(
        "bridge-rp2040",
        "build --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040",
    ),
    Step::new(
        "test-examples",
        "test --manifest-path firmware/examples/Cargo.toml --locked --target-dir target/firmware",
    ),
    Step::new(
        "examples-stm32f4",
        "build --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4",
    ),
    Step::new(
        "examples-rp2040",
        "build --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040",
    ),
    // the longest first, so that none is left alone at the end
    Step::new("python", "xtask python").at(Pace::Slow),
    Step::new("web", "xtask web --site target/site --check").at(Pace::Slow),
    Step::new("bridge", "xtask bridge").at(Pace::Slow),
    Step::new("trust", "xtask trust --quick").at(Pace::Slow),
    Step::new("serve", "xtask bench-serve --check").at(Pace::Slow),
    Step::new("firmware", "xtask firmware").at(Pace::Beside),
    Step::new("methods", "xtask methods --quick").at(Pace::Beside),
    Step::new("book", "xtask book --check").at(Pace::Beside),
    Step::new("iiod", "xtask iiod").at(Pace::Beside),
    Step::new("c", "xtask c").at(Pace::Beside),
    Step::new("deny", "xtask deny").at(Pace::Beside),
    Step::new("rig", "xtask rig").at(Pace::SlowAlone),
];

/// Runs the steps in order, those side by side that allow it, and stops at the first that fails.
pub fn run(args: &Args) -> Result<()> {
    let wanted = |step: &&Step| match args.only.as_slice() {
        [] => !(args.quick && step.pace.is_slow()),
        only => only.iter().any(|name| name == step.name),
    };
    let chosen: Vec<&Step> = STEPS.iter().filter(wanted).collect();
    targets::add_missing(chosen.iter().flat_map(|step| step.targets()))?;
    let start = Instant::now();
    let mut passed = Vec::new();
    for group in chosen.chunk_by(|a, b| a.pace.has_company() && b.pace.has_company()) {
        println!("\n=== {} of {}: {}", passed.len() + 1, chosen.len(), names(group));
        let ended = match group {
            [step] => vec![watched(step)?],
            _ => side_by_side(group)?,
        };
        let failed: Vec<&Step> = ended.iter().filter(|ended| !ended.ok).map(|ended| ended.step).collect();
        passed.extend(ended.iter().filter(|ended| ended.ok).map(|ended| (ended.step.name, ended.time)));
        if let Some(step) = failed.first() {
            summarise(&passed, start.elapsed());
            bail!("{} failed; to repeat it alone: {step}", names(&failed));
        }
    }
    summarise(&passed, start.elapsed());
    Ok(())
}

fn names(steps: &[&Step]) -> String {
    match steps {
        [step] => format!("{}: {step}", step.name),
        _ => steps.iter().map(|step| step.name).collect::<Vec<_>>().join(", "),
    }
}

/// A step that has run.
struct Ended<'a> {
    step: &'a Step,
    ok: bool,
    time: Duration,
}

/// Runs a step whose output is seen as it comes.
fn watched(step: &Step) -> Result<Ended<'_>> {
    let start = Instant::now();
    let status = command(step).status().with_context(|| format!("cannot run `{step}`"))?;
    let ended = Ended { step, ok: status.success(), time: start.elapsed() };
    announce(&ended);
    Ok(ended)
}

/// Runs steps in as many threads as there are cores; the output of each is shown when it ends. What is under way when
/// one fails runs to its end, and nothing is begun.
fn side_by_side<'a>(steps: &[&'a Step]) -> Result<Vec<Ended<'a>>> {
    let waiting = Mutex::new(steps.iter().copied());
    let ended = Mutex::new(Vec::new());
    let threads = thread::available_parallelism().map_or(1, usize::from).min(steps.len());
    let work = || -> Result<()> {
        loop {
            let next = waiting.lock().expect("no thread panics").next();
            let failed = ended.lock().expect("no thread panics").iter().any(|ended: &Ended| !ended.ok);
            let Some(step) = next.filter(|_| !failed) else { return Ok(()) };
            let done = unwatched(step)?;
            ended.lock().expect("no thread panics").push(done);
        }
    };
    thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| thread.join().expect("no thread panics"))
    })?;
    Ok(ended.into_inner().expect("no thread panics"))
}

/// Runs a step and shows what it printed, errors after the rest.
fn unwatched(step: &Step) -> Result<Ended<'_>> {
    let start = Instant::now();
    let output = command(step).stdin(Stdio::null()).output().with_context(|| format!("cannot run `{step}`"))?;
    let ended = Ended { step, ok: output.status.success(), time: start.elapsed() };
    let mut out = stdout().lock();
    writeln!(out, "\n=== {}: {step}", step.name)?;
    out.write_all(&output.stdout)?;
    out.write_all(&output.stderr)?;
    drop(out);
    announce(&ended);
    Ok(ended)
}

fn announce(ended: &Ended) {
    let verdict = if ended.ok { "passed" } else { "FAILED" };
    println!("=== {}: {verdict} in {}", ended.step.name, clock(ended.time));
}

fn command(step: &Step) -> Command {
    let mut command = Command::new("cargo");
    command.args(step.args.split(' ')).envs(step.env);
    command
}

fn summarise(passed: &[(&str, Duration)], together: Duration) {
    println!("\nPassed {} of the steps:", passed.len());
    for (name, time) in passed {
        println!("  {name:24} {:>12}", clock(*time));
    }
    println!("  {:24} {:>12}", "from first to last", clock(together));
}

/// `7 min 05 s`, or `5.3 s` below a minute.
fn clock(time: Duration) -> String {
    match time.as_secs() {
        0..60 => format!("{:.1} s", time.as_secs_f64()),
        s => format!("{} min {:02} s", s / 60, s % 60),
    }
}
