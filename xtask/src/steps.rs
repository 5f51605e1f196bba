//! Runs steps: named cargo commands that must pass. The time of each is printed.

use std::env;
use std::fmt;
use std::io::{Write, stdout};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use xtask::targets;

#[derive(Clone, Copy)]
pub struct Step {
    pub name: &'static str,
    env: Option<(&'static str, &'static str)>,
    args: &'static str,
    /// True if the step runs at the same time as adjacent steps of this kind.
    is_beside: bool,
    /// Describes what the step checks, in one line.
    about: &'static str,
    /// Programs that the step installs if they are missing, besides Rust targets.
    installs: &'static str,
    /// The number that replaces `{seed}` in `args`.
    seed: u64,
}

impl Step {
    /// A step that uses all cores, or depends on real time.
    pub const fn new(name: &'static str, args: &'static str) -> Self {
        Self { name, env: None, args, is_beside: false, about: "", installs: "", seed: 0 }
    }

    /// A step that waits, uses one core, or has a target folder of its own.
    pub const fn beside(name: &'static str, args: &'static str) -> Self {
        Self { is_beside: true, ..Self::new(name, args) }
    }

    pub const fn about(mut self, what: &'static str) -> Self {
        self.about = what;
        self
    }

    pub const fn with_env(mut self, key: &'static str, value: &'static str) -> Self {
        self.env = Some((key, value));
        self
    }

    pub const fn installing(mut self, what: &'static str) -> Self {
        self.installs = what;
        self
    }

    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    fn arguments(&self) -> String {
        self.args.replace("{seed}", &self.seed.to_string())
    }

    /// The command, which is not started yet. This program runs a task of xtask itself, because `cargo xtask` would
    /// wait for any build in progress.
    pub fn command(&self) -> Result<Command> {
        let args = self.arguments();
        let (mut command, args) = match args.strip_prefix("xtask ") {
            Some(task) => (Command::new(env::current_exe()?), task),
            None => (Command::new("cargo"), args.as_str()),
        };
        command.args(args.split(' ')).envs(self.env);
        Ok(command)
    }

    /// Programs that the step installs if they are missing, including Rust targets.
    fn installs(&self) -> String {
        let targets = self.targets().map(|target| format!("Rust target {target}"));
        let rest = (!self.installs.is_empty()).then(|| self.installs.to_owned());
        targets.chain(rest).collect::<Vec<_>>().join(", ")
    }

    /// The Rust targets that the step builds for, except the host.
    fn targets(&self) -> impl Iterator<Item = &'static str> {
        let words = self.args.split(' ');
        words.clone().zip(words.skip(1)).filter(|(option, _)| *option == "--target").map(|(_, target)| target)
    }
}

/// The command as a user would type it.
impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((key, value)) = self.env {
            write!(f, "{key}={value} ")?;
        }
        write!(f, "cargo {}", self.arguments())
    }
}

/// The steps with these names, in the order of `steps`; all steps if no name is given.
pub fn chosen(steps: &[Step], names: &[String]) -> Result<Vec<Step>> {
    if let Some(unknown) = names.iter().find(|name| steps.iter().all(|step| step.name != **name)) {
        bail!("there is no step {unknown}; --help lists the steps");
    }
    let is_chosen = |step: &&Step| names.is_empty() || names.iter().any(|name| name == step.name);
    Ok(steps.iter().filter(is_chosen).copied().collect())
}

/// Lists the steps: what they check, their commands, and the programs that each installs if they are missing.
pub fn list(steps: &[Step]) -> String {
    let line = |step: &Step| {
        let installs = step.installs();
        let installs = if installs.is_empty() { installs } else { format!("installs: {installs}") };
        let rows = [step.about.to_owned(), step.to_string(), installs];
        let rows: Vec<String> = rows.into_iter().filter(|row| !row.is_empty()).collect();
        format!("  {:24} {}\n", step.name, rows.join(&format!("\n  {:24} ", "")))
    };
    format!("Steps:\n{}", steps.iter().map(line).collect::<String>())
}

/// What happens to the later steps after a failure.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum AtFailure {
    Stop,
    GoOn,
}

/// Runs the steps in order, and adjacent steps in parallel if they allow it. Fails at the end if one failed.
pub fn run(chosen: &[Step], at_failure: AtFailure) -> Result<()> {
    targets::add_missing(chosen.iter().flat_map(Step::targets))?;
    let start = Instant::now();
    let (mut times, mut failed) = (Vec::new(), Vec::new());
    for group in chosen.chunk_by(|a, b| a.is_beside && b.is_beside) {
        println!("\n=== {} of {}: {}", times.len() + 1, chosen.len(), names(group));
        for step in group.iter().filter(|step| !step.installs.is_empty()) {
            println!("{} installs, where it is missing: {}", step.name, step.installs);
        }
        let ended = match group {
            [step] => vec![watched(step)?],
            _ => side_by_side(group, at_failure)?,
        };
        failed.extend(ended.iter().filter(|ended| !ended.ok).map(|ended| *ended.step));
        times.extend(ended.iter().map(|ended| (ended.step.name, ended.time)));
        if at_failure == AtFailure::Stop && !failed.is_empty() {
            break;
        }
    }
    show_times(&times, start.elapsed());
    if failed.is_empty() {
        return Ok(());
    }
    let repeat: Vec<String> = failed.iter().map(|step| format!("  {}: {step}", step.name)).collect();
    bail!("failed; to repeat a step alone:\n{}", repeat.join("\n"))
}

fn names(steps: &[Step]) -> String {
    match steps {
        [step] => format!("{}: {step}", step.name),
        _ => steps.iter().map(|step| step.name).collect::<Vec<_>>().join(", "),
    }
}

struct StepResult<'a> {
    step: &'a Step,
    ok: bool,
    time: Duration,
}

/// Runs a step and shows its output live.
fn watched(step: &Step) -> Result<StepResult<'_>> {
    let start = Instant::now();
    let status = step.command()?.status().with_context(|| format!("cannot run `{step}`"))?;
    let ended = StepResult { step, ok: status.success(), time: start.elapsed() };
    announce(&ended);
    Ok(ended)
}

/// Runs steps in as many threads as there are cores, and shows the output of each when it ends. If a failure stops the
/// run, running steps continue to their end.
fn side_by_side(steps: &[Step], at_failure: AtFailure) -> Result<Vec<StepResult<'_>>> {
    let waiting = Mutex::new(steps.iter());
    let ended = Mutex::new(Vec::new());
    let threads = thread::available_parallelism().map_or(1, usize::from).min(steps.len());
    let work = || -> Result<()> {
        loop {
            let next = waiting.lock().expect("no thread panics").next();
            let failed = ended.lock().expect("no thread panics").iter().any(|ended: &StepResult| !ended.ok);
            let stops = failed && at_failure == AtFailure::Stop;
            let Some(step) = next.filter(|_| !stops) else { return Ok(()) };
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

/// Runs a step and then shows its output, stderr last.
fn unwatched(step: &Step) -> Result<StepResult<'_>> {
    let start = Instant::now();
    let output = step.command()?.stdin(Stdio::null()).output().with_context(|| format!("cannot run `{step}`"))?;
    let ended = StepResult { step, ok: output.status.success(), time: start.elapsed() };
    let mut out = stdout().lock();
    writeln!(out, "\n=== {}: {step}", step.name)?;
    out.write_all(&output.stdout)?;
    out.write_all(&output.stderr)?;
    drop(out);
    announce(&ended);
    Ok(ended)
}

fn announce(ended: &StepResult) {
    let verdict = if ended.ok { "passed" } else { "FAILED" };
    println!("=== {}: {verdict} in {}", ended.step.name, clock(ended.time));
}

fn show_times(times: &[(&str, Duration)], together: Duration) {
    let show = |times: &[(&str, Duration)]| {
        times.iter().for_each(|(name, time)| println!("  {name:24} {:>12}", clock(*time)));
    };
    println!("\nTimes:");
    show(times);
    let mut longest = times.to_vec();
    longest.sort_by_key(|(_, time)| std::cmp::Reverse(*time));
    longest.truncate(5);
    println!("The longest:");
    show(&longest);
    let sum = times.iter().map(|(_, time)| *time).sum();
    println!("Together: {} of steps in {}", clock(sum), clock(together));
}

/// Formats a time: `7 min 05 s`, or `5.3 s` below a minute.
pub fn clock(time: Duration) -> String {
    match time.as_secs() {
        0..60 => format!("{:.1} s", time.as_secs_f64()),
        s => format!("{} min {:02} s", s / 60, s % 60),
    }
}
