//! `cargo xtask`: the tasks of developers and CI that take more than one command.
//!
//! xtask builds in seconds, because it has almost no dependencies. Tasks that need the libraries of the project are in
//! `lab/`. To add a task here, write a module with `HELP` and `run`, and give the task a row in [`TASKS`].

mod build_time;
mod check;
mod ci;
mod code_coverage;
mod codegen;
mod deny;
mod instructions;
mod mutants;
mod night;
mod python;
mod steps;
mod test;

use anyhow::{Result, bail};
use std::process::ExitCode;
use xtask::arguments::Arguments;
use xtask::{lab, web};

/// A task that this program runs itself, without the lab.
struct Task {
    name: &'static str,
    /// The arguments, as a usage line shows them.
    usage: &'static str,
    about: &'static str,
    help: fn() -> String,
    run: fn(Arguments) -> Result<()>,
}

const TASKS: [Task; 13] = [
    Task::new("test", "[--full]", test::help, test::run).about("Run the tests; they need Rust and a C compiler"),
    Task::new("check", "[STEP…]", check::help, check::run)
        .about("Check formatting, lints, documentation and bare targets, while you work"),
    Task::new("ci", "[--list] [STEP…]", ci::help, ci::run).about("Run the gate: everything that a change must pass"),
    Task::new("night", "[--seed N] [--list] [STEP…]", night::help, night::run)
        .about("Run campaigns with fresh seeds, and the steps that need not run before each change"),
    Task::new("codegen", "[--check]", || codegen::HELP.to_owned(), codegen::run)
        .about("Write the generated files: C header, the examples' unit, two pictures"),
    Task::new("web", "[--site DIR] [--check] [--live] [--pictures] [--small]", || web::HELP.to_owned(), web::run)
        .about("Build the page for the program, or as a static site, and test it"),
    Task::new("python", "[PART…]", python::help, python::run)
        .about("Build the Python wheel, install it below target/ and test it there"),
    Task::new("bench-fleet", "[--captures N]", || python::BENCH_HELP.to_owned(), python::bench_fleet)
        .about("Time captures through zerorate.fleet beside a plain loop of the program, and print ratios"),
    Task::new("deny", "[--advisories DIR]", || deny::HELP.to_owned(), deny::run)
        .about("Check the dependencies: advisories, licences, sources"),
    Task::new("mutants", "[--share N] [--seed N] [CRATE…]", mutants::help, mutants::run)
        .about("Make the code wrong at one place at a time, and count the mutants that no test kills"),
    Task::new(
        "code-coverage",
        "[--at-least SHARE] [--missed CRATE] [CRATE…]",
        || code_coverage::HELP.to_owned(),
        code_coverage::run,
    )
    .about("Count the lines of each crate that a test reaches"),
    Task::new("instructions", "", || instructions::HELP.to_owned(), instructions::run)
        .about("Compare the cost of reading and checking a log with the cost of its deviations, in instructions"),
    Task::new("build-time", "", || build_time::HELP.to_owned(), build_time::run)
        .about("Time the two commands of the README from an empty target folder, and print sizes"),
];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match run(&words) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(words: &[String]) -> Result<ExitCode> {
    let asks_for_help = words.iter().any(|word| matches!(word.as_str(), "-h" | "--help"));
    let Some((name, arguments)) = words.split_first() else { bail!("which task?\n\n{}", help()) };
    if let Some(task) = TASKS.iter().find(|task| task.name == name) {
        if asks_for_help {
            println!("{}", task.help());
        } else {
            (task.run)(Arguments::new(arguments.to_vec()))?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    if lab::TASKS.iter().any(|(task, _)| task == name) {
        return in_lab(name, arguments);
    }
    if asks_for_help || name == "help" {
        println!("{}", help());
        return Ok(ExitCode::SUCCESS);
    }
    bail!("unknown task {name}; `cargo xtask --help` lists all")
}

/// Runs a task of the lab, and passes on its error and exit code.
fn in_lab(name: &str, arguments: &[String]) -> Result<ExitCode> {
    let status = lab::task(name)?.args(arguments).status()?;
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}

impl Task {
    const fn new(
        name: &'static str,
        usage: &'static str,
        help: fn() -> String,
        run: fn(Arguments) -> Result<()>,
    ) -> Self {
        Self { name, usage, about: "", help, run }
    }

    const fn about(mut self, what: &'static str) -> Self {
        self.about = what;
        self
    }

    fn help(&self) -> String {
        let text = format!("{}\n\nUsage: cargo xtask {} {}\n\n{}", self.about, self.name, self.usage, (self.help)());
        text.trim_end().to_owned()
    }
}

fn help() -> String {
    let mut text = String::from("Usage: cargo xtask TASK [ARGUMENTS]; TASK --help says more\n\nTasks:\n");
    let line = |(name, about): (&str, &str)| format!("  {name:14} {about}\n");
    text.extend(TASKS.iter().map(|task| line((task.name, task.about))));
    text += "\nTasks of the lab, which is built first; that takes some minutes once:\n";
    text.extend(lab::TASKS.into_iter().map(line));
    text.trim_end().to_owned()
}
