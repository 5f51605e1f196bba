//! `cargo xtask build-time`: measures the times of the README's two commands and the size of the program for
//! docs/reference/build.md.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;
use xtask::app::{emptied, target_folder};
use xtask::arguments::Arguments;
use xtask::venv::printed;

pub const HELP: &str = "\
Measures what docs/reference/build.md states, also a build after a change in the program. The sizes are those of the
programs in target/dist. To begin with an empty cargo home: CARGO_HOME=$(mktemp -d) cargo xtask build-time";

/// The two commands of the README.
const FIRST: &str = "run --release -- calibrate";
const SECOND: &str = "xtask test";
/// The source file that is changed before the last build. Only the program depends on it.
const TOUCHED: &str = "crates/zerorate-cli/src/lib.rs";

pub fn run(arguments: Arguments) -> Result<()> {
    arguments.end()?;
    let folder = emptied(target_folder()?.join("build-time"))?;
    println!("{}", machine()?);
    println!("{:44} {:>8} {:>14}", "", "wall, s", "processor, s");
    time("first command, cold", FIRST, &folder)?;
    time("second command, cold, after it", SECOND, &folder)?;
    fs::File::options().append(true).open(TOUCHED)?.set_modified(std::time::SystemTime::now())?;
    time("first command, after a change in the program", FIRST, &folder)?;
    let program = folder.join("release/zerorate");
    println!("{:44} {:8.1} MB", "the program, profile release", program.metadata()?.len() as f64 / 1e6);
    for entry in fs::read_dir(target_folder()?.join("dist")).into_iter().flatten() {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.ends_with("-linux") {
            println!("{name:44} {:8.1} MB", entry.metadata()?.len() as f64 / 1e6);
        }
    }
    Ok(fs::remove_dir_all(&folder)?)
}

/// Runs a command of cargo that builds into `folder`, and prints its times. A shell measures the processor time of its
/// children.
fn time(what: &str, command: &str, folder: &Path) -> Result<()> {
    let start = Instant::now();
    let line = format!("cargo {command} >&2 && times");
    let mut shell = Command::new("sh");
    shell.args(["-c", &line]).env("CARGO_TARGET_DIR", folder).stderr(Stdio::inherit());
    let output = shell.output()?;
    let wall_s = start.elapsed().as_secs_f64();
    ensure!(output.status.success(), "`cargo {command}` failed");
    let text = String::from_utf8(output.stdout)?;
    let children = text.lines().nth(1).context("`times` prints two lines")?;
    let processor_s = children.split_whitespace().map(seconds).sum::<Option<f64>>().context("`times` prints times")?;
    println!("{what:44} {wall_s:8.1} {processor_s:14.1}");
    Ok(())
}

/// Parses a time such as `2m3.45s`.
fn seconds(time: &str) -> Option<f64> {
    let (minutes, seconds) = time.strip_suffix('s')?.split_once('m')?;
    Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
}

/// Describes the number of cores and their load, since on a busy machine a build takes longer and more processor time.
fn machine() -> Result<String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().unwrap_or("unknown");
    let rustc = printed(Command::new("rustc").arg("--version"))?;
    Ok(format!("{cores} cores, load {load} before, {}", rustc.trim()))
}
