//! Runs the commands in the chapters on the twin, as a reader would run them.
//!
//! Commands must be in fenced blocks, never indented. Every `sh` block whose first word is `zerorate` is run line by
//! line, from the first chapter to the last, in one folder. A line must exit with 0, or as its comment says: `#
//! refused (exit 3)`. A block that needs a part, the reader's files or hours is marked `sh,untried` and is not run.
//!
//! A `text` or `yaml` block after such commands shows what they print or write. Each of its lines must occur in the
//! output, in the same order; `…` stands for lines that the chapter omits.

use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Time limit of a command, s. No command takes that long, even on a busy machine.
const LONGEST_S: &str = "300";

/// Largest number of lines of output in an error.
const MOST_LINES: usize = 60;

/// What a chapter shows: a command, or lines of output.
#[derive(Debug, PartialEq)]
enum Step {
    /// A command and its expected exit code.
    Run { command: String, exit: i32 },
    /// Lines that the adjacent commands before it must print, or write to a file. Several `Shown` may follow them.
    Shown(Vec<String>),
}

pub fn run(program: &Path) -> Result<()> {
    let program = program.canonicalize().with_context(|| format!("no program {}", program.display()))?;
    let (mut count, folder) = (0, tempfile::tempdir()?);
    for chapter in chapters(Path::new("docs"))? {
        let text = fs::read_to_string(&chapter)?;
        if let Some(line) = indented(&text) {
            bail!("{}: `{line}`: neither run nor marked: fence it as sh, or sh,untried", chapter.display());
        }
        let start = Instant::now();
        let ran =
            try_chapter(&steps(&text), &program, folder.path()).with_context(|| chapter.display().to_string())?;
        if ran > 0 {
            println!("{}: {ran} commands in {:.1} s", chapter.display(), start.elapsed().as_secs_f64());
        }
        count += ran;
    }
    ensure!(count > 0, "no command was found in docs/");
    println!("{count} commands of the book do what it says");
    Ok(())
}

/// Runs the commands of a chapter and compares the shown output. Returns the number of commands.
fn try_chapter(steps: &[Step], program: &Path, folder: &Path) -> Result<usize> {
    let (mut ran, mut printed, mut is_shown) = (0, String::new(), false);
    for step in steps {
        match step {
            Step::Run { command, exit } => {
                if std::mem::take(&mut is_shown) {
                    printed.clear();
                }
                printed += &output(command, *exit, program, folder)?;
                ran += 1;
            }
            Step::Shown(lines) => {
                compare(lines, &printed)?;
                is_shown = true;
            }
        }
    }
    Ok(ran)
}

/// Runs a command. Returns its output and the content of the text files that it names.
fn output(command: &str, exit: i32, program: &Path, folder: &Path) -> Result<String> {
    let path = std::env::var("PATH").unwrap_or_default();
    let beside = program.parent().context("a program in a folder")?;
    // a time limit, because a command may wait for input
    let mut shell = Command::new("timeout");
    shell.args([LONGEST_S, "sh", "-c", command]).current_dir(folder);
    let output = shell.env("PATH", format!("{}:{path}", beside.display())).output()?;
    let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    let status = output.status;
    ensure!(status.code() == Some(exit), "`{command}` ended with {status}, not with {exit}:\n{printed}");
    let written = command.split_whitespace().filter_map(|word| fs::read_to_string(folder.join(word)).ok());
    Ok(written.fold(printed, |all, file| all + &file))
}

/// Checks that the output contains these lines in this order.
fn compare(lines: &[String], printed: &str) -> Result<()> {
    let mut rest = printed.lines();
    for line in lines.iter().filter(|line| !line.is_empty() && *line != "…") {
        let is_there = rest.any(|one| one.trim_end() == line);
        let most = printed.lines().take(MOST_LINES).collect::<Vec<_>>().join("\n");
        ensure!(is_there, "the chapter shows `{line}`, which is not here, or not in this order:\n{most}");
    }
    Ok(())
}

/// The commands of a chapter that must be run, and the outputs that it shows.
fn steps(text: &str) -> Vec<Step> {
    let (mut steps, mut is_ours) = (Vec::new(), false);
    for block in text.split("```").skip(1).step_by(2) {
        let (kind, body) = block.split_once('\n').unwrap_or((block, ""));
        match kind {
            "sh" => {
                is_ours = body.starts_with("zerorate");
                if is_ours {
                    steps.extend(body.replace("\\\n", " ").lines().filter_map(command));
                }
            }
            "text" | "yaml" if is_ours => steps.push(Step::Shown(body.lines().map(str::to_owned).collect())),
            _ => is_ours = false,
        }
    }
    steps
}

/// Finds a `zerorate` command in an indented block.
fn indented(text: &str) -> Option<&str> {
    let outside = text.split("```").step_by(2);
    outside.flat_map(str::lines).find(|line| line.starts_with("    zerorate "))
}

fn command(text: &str) -> Option<Step> {
    let command = text.trim();
    let exit = command.split_once("(exit ").and_then(|(_, rest)| rest.split(')').next()?.parse().ok()).unwrap_or(0);
    let is_command = !command.is_empty() && !command.starts_with('#');
    is_command.then(|| Step::Run { command: command.to_owned(), exit })
}

/// The chapters in `docs`, in order.
fn chapters(docs: &Path) -> Result<Vec<PathBuf>> {
    let summary = fs::read_to_string(docs.join("SUMMARY.md"))?;
    let targets = summary.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    Ok(targets.filter(|target| !target.starts_with("..")).map(|target| docs.join(target)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(command: &str, exit: i32) -> Step {
        Step::Run { command: command.to_owned(), exit }
    }

    #[test]
    fn marked_blocks_and_other_commands_are_skipped() {
        let text = "a\n```sh\nzerorate probe\nzerorate x \\\n  --y   # no (exit 3)\n# a word\n```\nso\n\n\
            ```text\n1\n…\n```\n\
            b\n```sh,untried\nzerorate serve\n\
            ```\n```sh\ncargo xtask test\n```\n```text\n2\n```\n";
        let shown = Step::Shown(vec!["1".to_owned(), "…".to_owned()]);
        assert_eq!(steps(text), [run("zerorate probe", 0), run("zerorate x    --y   # no (exit 3)", 3), shown]);
        assert_eq!(indented(text), None);
        assert_eq!(indented("a\n\n    zerorate probe\n\nb\n"), Some("    zerorate probe"));
    }

    #[test]
    fn shown_lines_are_there_in_their_order() {
        let shown = |lines: &[&str]| {
            let lines: Vec<String> = lines.iter().map(|&line| line.to_owned()).collect();
            compare(&lines, "a\nb  \nc\n")
        };
        assert!(shown(&["a", "…", "", "c"]).is_ok());
        assert!(shown(&["b", "c"]).is_ok());
        assert!(shown(&["c", "a"]).is_err());
        assert!(shown(&["d"]).is_err());
    }
}
