//! `cargo xtask trust`: searches for wrong results without a warning. Faults, damage and bad conditions are drawn from
//! seeds. Every run is compared with the twin's truth, or with a run without the fault.

mod bench;
mod capture;
mod chamber;
mod faults;
mod files;
mod logs;
mod page;
mod power;
mod process;
mod verdict;
mod world;

use crate::app;
use crate::seeds::for_each_seed;
use anyhow::{Context, Result, bail, ensure};
use bench::Bench;
use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;
use verdict::{Count, Verdict};

#[derive(clap::Args)]
pub struct TrustArgs {
    /// A few runs of each class, as in `cargo xtask night`
    #[arg(long)]
    quick: bool,
    /// Only the classes whose names begin with this
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Runs of each class [default: 500, or a few with --quick]
    #[arg(long, value_name = "N")]
    runs: Option<u64>,
    /// The first run's seed; the others follow. `--only NAME --seed N --runs 1` repeats one
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// The program to test, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Add each finished class to this file, and leave out those that it holds: a campaign may take days
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Write docs/reference/reliability.md
    #[arg(long, conflicts_with = "only")]
    update: bool,
}

/// Number of runs of each class in the whole campaign.
const RUNS: u64 = 500;

/// A class of runs: one kind of fault, damage or bad condition.
#[derive(Clone, Copy)]
struct Class {
    name: &'static str,
    /// Describes a run for the table.
    what: &'static str,
    /// Number of runs with `--quick`.
    quick: u64,
    /// Executes one run. The arguments are the bench, the name of the class and the seed.
    run: ClassRun,
}

type ClassRun = fn(&Bench, &'static str, u64) -> Result<Verdict>;

impl Class {
    const fn new(name: &'static str, what: &'static str, quick: u64, run: ClassRun) -> Self {
        Self { name, what, quick, run }
    }
}

/// All classes, in the order of docs/reference/reliability.md.
fn classes() -> Vec<Class> {
    let devices = [faults::CLASSES, capture::CLASSES, &world::classes(), chamber::CLASSES];
    let computers = [process::CLASSES, power::CLASSES, files::CLASSES, logs::CLASSES];
    [devices.concat(), computers.concat()].concat()
}

pub fn run(args: &TrustArgs) -> Result<()> {
    let bench = Bench::new(app::given_or_built(args.program.as_deref())?)?;
    let mut done = FinishedClasses::read(args.resume.clone())?;
    let mut counts = Vec::new();
    for class in
        classes().into_iter().filter(|class| args.only.as_deref().is_none_or(|only| class.name.starts_with(only)))
    {
        let started = Instant::now();
        let count = match done.counts.remove(class.name) {
            Some(count) => count,
            None => {
                try_class(args, &bench, &class).and_then(|count| done.keep(class.name, count)).context(class.name)?
            }
        };
        println!("{:28} {count}  ({:.1} s)", class.name, started.elapsed().as_secs_f64());
        counts.push((class, count));
    }
    ensure!(!counts.is_empty(), "no class begins with {}", args.only.as_deref().unwrap_or_default());
    if args.update {
        page::write(&counts)?;
    }
    let silent: u64 = counts.iter().map(|(_, count)| count.silent).sum();
    if silent > 0 {
        bail!("{silent} runs were wrong and silent; each is named above with the command that repeats it");
    }
    Ok(())
}

/// The counts of finished classes, saved as lines of JSON in a file.
struct FinishedClasses {
    path: Option<PathBuf>,
    counts: BTreeMap<String, Count>,
}

impl FinishedClasses {
    fn read(path: Option<PathBuf>) -> Result<Self> {
        let text = path.as_deref().filter(|path| path.exists()).map(std::fs::read_to_string).transpose()?;
        let lines = text.as_deref().unwrap_or_default().lines().map(serde_json::from_str);
        Ok(Self { path, counts: lines.collect::<Result<Vec<(String, Count)>, _>>()?.into_iter().collect() })
    }

    fn keep(&self, class: &str, count: Count) -> Result<Count> {
        if let Some(path) = &self.path {
            let mut file = OpenOptions::new().create(true).append(true).open(path)?;
            writeln!(file, "{}", serde_json::to_string(&(class, &count))?)?;
        }
        Ok(count)
    }
}

/// Runs a class on all cores. Their number has no influence on the counts.
fn try_class(args: &TrustArgs, bench: &Bench, class: &Class) -> Result<Count> {
    let runs = args.runs.unwrap_or(if args.quick { class.quick } else { RUNS });
    let verdicts = for_each_seed(args.seed..args.seed + runs, |seed| {
        let verdict = (class.run)(bench, class.name, seed)?;
        if let Verdict::Silent(why) = &verdict {
            println!("WRONG AND SILENT: {why}\n    cargo xtask trust --only {} --seed {seed} --runs 1", class.name);
        }
        Ok(verdict)
    })?;
    let mut count = Count::default();
    verdicts.iter().for_each(|verdict| count.add(verdict));
    Ok(count)
}
