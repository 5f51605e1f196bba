//! `cargo xtask bench-peers`: compares the speed of zerorate's Allan deviation with allantools and the crates `allan`
//! and `allan-tools` on one array, and the speed of the program with Python programs on files.

use crate::venv::{self, done, printed};
use anyhow::{Context, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use xtask::lab;

const DATA: &str = "target/bench-peers.f64";
const CAPTURE: &str = "target/bench-peers.parquet";
const LOGS: &str = "target/bench-peers";
const PROGRAM: &str = "target/peers/dist/zerorate";
const AXES: &str = "gx,gy,gz,ax,ay,az";

#[derive(clap::Args)]
pub struct BenchPeersArgs {
    /// Samples; the default is an hour at 5.7 kSPS
    #[arg(long, default_value_t = 20_500_000, value_parser = clap::value_parser!(u64).range(10_000..))]
    samples: u64,
    /// Leave the program out: from a Parquet file to the table
    #[arg(long)]
    no_cli: bool,
}

#[derive(Deserialize)]
pub struct Line {
    pub who: String,
    pub work: String,
    pub seconds: Option<f64>,
    memory: Option<f64>,
    pub dev: Option<Vec<Option<f64>>>,
}

pub fn run(args: &BenchPeersArgs) -> Result<()> {
    let python = venv::python("peers", "lab/tools/peers/requirements.txt")?;
    let peers = peers()?;
    let peers = || Command::new(&peers);
    let allantools = || script(&python, "peers.py");
    done(peers().args(["generate", DATA]).arg(args.samples.to_string()))?;
    println!("{} samples, {}", args.samples, machine());
    let mut lines = parse(&printed(allantools().arg(DATA))?)?;
    lines.extend(parse(&printed(peers().args(["time", DATA]))?)?);
    print_times(&lines);
    print_goals(&lines);
    print_agreement(&lines);
    let memory =
        parse(&(printed(allantools().args([DATA, "--memory"]))? + &printed(peers().args(["memory", DATA]))?))?;
    for Line { who, memory, .. } in &memory {
        println!("peak memory, oadev: {who} {:.2} x the input", memory.unwrap_or(f64::NAN));
    }
    std::fs::remove_file(DATA)?;
    if args.no_cli {
        return Ok(());
    }
    time_program()?;
    time_files(args.samples, &python)
}

/// Builds the program that times zerorate and the two crates, and returns its path.
pub fn peers() -> Result<PathBuf> {
    done(&mut lab::cargo("build", "peers", "peers")?)?;
    Ok(lab::folder()?.join("peers/peers"))
}

pub fn parse(text: &str) -> Result<Vec<Line>> {
    text.lines().map(|line| serde_json::from_str(line).with_context(|| format!("a peer printed `{line}`"))).collect()
}

/// Prints the time of each run, and for zerorate its speed relative to the fastest peer for the same work.
fn print_times(lines: &[Line]) {
    let copy = lines.iter().find(|line| line.work == "copy").and_then(|line| line.seconds).unwrap_or(f64::NAN);
    println!("{:22} {:22} {:>10} {:>12} {:>16}", "work", "who", "seconds", "numpy copies", "times as fast as");
    for line in lines {
        let seconds = line.seconds.unwrap_or(f64::NAN);
        let faster = peer_of(lines, line)
            .map_or(String::new(), |(peer, peer_seconds)| format!("{:>8.1} {peer}", peer_seconds / seconds));
        println!("{:22} {:22} {seconds:>10.4} {:>12.1} {faster}", line.work, line.who, seconds / copy);
    }
}

/// Goals for each kind of work: the speed on two threads as a multiple of the speed of allantools.
const GOALS: [(&str, f64); 5] =
    [("oadev", 45.0), ("oadev, fine", 60.0), ("mdev", 40.0), ("ohdev", 40.0), ("totdev", 40.0)];

fn print_goals(lines: &[Line]) {
    for (work, goal) in GOALS {
        let seconds = |who: &str| {
            let line = lines.iter().find(|line| line.who.starts_with(who) && line.work == work);
            line.and_then(|line| line.seconds).unwrap_or(f64::NAN)
        };
        let times = seconds("allantools") / seconds("zerorate, 2");
        println!("{work}: {times:.0} times as fast as allantools (goal {goal}{})", missed(times >= goal));
    }
}

pub fn missed(is_met: bool) -> &'static str {
    if is_met { "" } else { ", MISSED" }
}

/// Name and time, s, of the fastest peer for the work of `ours`, a line of zerorate. Codes are compared with rates.
fn peer_of<'a>(lines: &'a [Line], ours: &Line) -> Option<(&'a str, f64)> {
    let work = ours.work.trim_end_matches(" of codes");
    let is_ours = |line: &Line| line.who.starts_with("zerorate");
    let peers = lines.iter().filter(|line| is_ours(ours) && !is_ours(line) && line.work == work);
    let times = peers.filter_map(|line| Some((line.who.as_str(), line.seconds?)));
    times.min_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// Prints the largest relative difference from allantools for each kind of work, to detect fast wrong results.
fn print_agreement(lines: &[Line]) {
    for theirs in lines.iter().filter(|line| line.who == "allantools") {
        for ours in lines.iter().filter(|line| line.who.starts_with("zerorate, 2") && line.work == theirs.work) {
            let (Some(a), Some(b)) = (&ours.dev, &theirs.dev) else { continue };
            let pairs = a.iter().zip(b).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
            let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            println!("{}: at most {worst:.1e} from allantools, relative, in {} points", ours.work, b.len());
        }
    }
}

/// Times the whole program, from a capture of an hour in Parquet to the table on stdout.
fn time_program() -> Result<()> {
    let build = ["build", "--profile", "dist", "--quiet", "-p", "zerorate-cli", "--target-dir", "target/peers"];
    done(Command::new("cargo").args(build).args(["--features", "full"]))?;
    done(Command::new(PROGRAM).args(["capture", "--duration", "60m", "--force", "-o", CAPTURE]))?;
    let best = best_of(5, Command::new(PROGRAM).args(["allan", CAPTURE]))?;
    println!("zerorate allan FILE.parquet, an hour of the twin, from file to text: {best:.2} s, best of 5");
    Ok(std::fs::remove_file(CAPTURE)?)
}

/// The files, each with its goal: the speed as a multiple of a Python program with polars or NumPy and allantools.
const FILES: [(&str, f64); 4] = [("one.csv", 6.0), ("seven.csv", 6.0), ("seven.parquet", 15.0), ("one.npy", 15.0)];

/// Times the whole program from a log of noise to the table, and a comparable Python program. The best of three
/// counts.
fn time_files(samples: u64, python: &Path) -> Result<()> {
    std::fs::create_dir_all(LOGS)?;
    let peers = || script(python, "files.py");
    done(peers().args(["make", LOGS]).arg(samples.to_string()))?;
    for (file, goal) in FILES {
        let path = format!("{LOGS}/{file}");
        let theirs = |columns| best_of(3, peers().args([path.as_str(), columns]));
        let in_python = theirs("gx")?;
        let column = if file == "one.npy" { "0" } else { "gx" };
        let zerorate = |columns| best_of(3, Command::new(PROGRAM).args(analysis(&path, columns)));
        let ours = zerorate(column)?;
        let times = in_python / ours;
        println!(
            "zerorate allan {file}, {samples} rows, from file to text: {ours:.2} s; in Python {in_python:.2} s, \
             {times:.1} times (goal {goal}{})",
            missed(times >= goal)
        );
        print_peak(python, &path, column, samples)?;
        if file == "one.npy" {
            time_fit(python, &path, ours, samples)?;
        }
        if file.starts_with("seven") {
            let six = zerorate(AXES)?;
            let (times, in_python) = (six / ours, theirs(AXES)?);
            println!(
                "  all six axes: {six:.2} s, {times:.2} times one (goal 2{}); in Python {in_python:.2} s, {:.1} times",
                missed(times < 2.0),
                in_python / six
            );
            print_peak(python, &path, AXES, samples)?;
        }
    }
    Ok(std::fs::remove_dir_all(LOGS)?)
}

/// Times the deviations together with a noise model. The deviations alone took `seconds`.
fn time_fit(python: &Path, path: &str, seconds: f64, samples: u64) -> Result<()> {
    const MOST_TIMES: f64 = 4.0;
    const MOST_COLUMNS: f64 = 1.5;
    let line: Vec<&str> = analysis(path, "0").into_iter().chain(["--fit"]).collect();
    let fit = best_of(3, Command::new(PROGRAM).args(&line))?;
    let times = fit / seconds;
    let columns = peak(python, &line)? / (samples as f64 * 8.0);
    println!(
        "  with --fit: {fit:.2} s, {times:.1} times the deviations alone (goal {MOST_TIMES}{}); \
         peak memory {columns:.2} times the column (goal {MOST_COLUMNS}{})",
        missed(times <= MOST_TIMES),
        missed(columns <= MOST_COLUMNS)
    );
    Ok(())
}

/// Peak memory of the program, bytes.
fn peak(python: &Path, line: &[&str]) -> Result<f64> {
    Ok(printed(script(python, "files.py").args(["peak", PROGRAM]).args(line))?.trim().parse()?)
}

fn analysis<'a>(path: &'a str, columns: &'a str) -> [&'a str; 8] {
    ["allan", path, "--column", columns, "--rate", "1", "--unit", "dps"]
}

/// Prints the program's peak memory as a multiple of the columns' size as f64.
fn print_peak(python: &Path, path: &str, columns: &str, samples: u64) -> Result<()> {
    let peak = peak(python, &analysis(path, columns))?;
    let asked = columns.split(',').count() as f64 * samples as f64 * 8.0;
    let times = peak / asked;
    println!("  peak memory: {times:.2} times the columns that were asked for (goal 1.1{})", missed(times <= 1.1));
    Ok(())
}

/// A command that runs a script of `lab/tools/peers`.
fn script(python: &Path, name: &str) -> Command {
    let mut command = Command::new(python);
    command.arg(Path::new("lab/tools/peers").join(name));
    command
}

/// Time of the fastest of some runs, s.
fn best_of(runs: usize, command: &mut Command) -> Result<f64> {
    let mut best = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        done(command.stdout(Stdio::null()).stderr(Stdio::null()))?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(best)
}

fn machine() -> String {
    let cpus = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name\t: ")).unwrap_or("unknown processor");
    format!("{cpus} cores, {model}")
}
