//! Runs the commands of the chapters on the twin, as a reader would run them.
//!
//! Commands stand in fences, never indented. Every ```sh block whose first word is `zerorate` is run, line by line,
//! from the first chapter to the last, in one folder. A line ends with 0, or as it says: `# refused (exit 3)`. A block
//! that needs a part, the reader's files or hours is marked ```sh,untried, which the book shows.

use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// More than any command takes on a busy machine, s.
const LONGEST_S: &str = "300";

/// A line of a chapter, and how it must end.
#[derive(Debug, PartialEq)]
struct Line {
    command: String,
    exit: i32,
}

/// Runs all commands, with `program` as `zerorate`.
pub fn run(program: &Path) -> Result<()> {
    let program = program.canonicalize().with_context(|| format!("no program {}", program.display()))?;
    let (mut count, folder) = (0, tempfile::tempdir()?);
    for chapter in chapters(Path::new("docs"))? {
        let text = fs::read_to_string(&chapter)?;
        if let Some(line) = indented(&text) {
            bail!("{}: `{line}`: neither run nor marked: fence it as sh, or sh,untried", chapter.display());
        }
        let lines = lines(&text);
        if lines.is_empty() {
            continue;
        }
        let start = Instant::now();
        for line in &lines {
            try_line(line, &program, folder.path()).with_context(|| chapter.display().to_string())?;
        }
        count += lines.len();
        println!("{}: {} commands in {:.1} s", chapter.display(), lines.len(), start.elapsed().as_secs_f64());
    }
    ensure!(count > 0, "no command was found in docs/");
    println!("{count} commands of the book do what it says");
    Ok(())
}

fn try_line(line: &Line, program: &Path, folder: &Path) -> Result<()> {
    let path = std::env::var("PATH").unwrap_or_default();
    let beside = program.parent().context("a program in a folder")?;
    // a command that waits for somebody must not wait for ever
    let mut shell = Command::new("timeout");
    shell.args([LONGEST_S, "sh", "-c", &line.command]).current_dir(folder);
    let output = shell.env("PATH", format!("{}:{path}", beside.display())).output()?;
    if output.status.code() != Some(line.exit) {
        bail!(
            "`{}` ended with {}, not with {}:\n{}{}",
            line.command,
            output.status,
            line.exit,
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
    }
    Ok(())
}

/// The lines of a chapter that have to be run.
fn lines(text: &str) -> Vec<Line> {
    let blocks = text.split("\n```sh\n").skip(1).filter_map(|rest| rest.split_once("\n```")).map(|(block, _)| block);
    let ours = blocks.filter(|block| block.starts_with("zerorate"));
    let whole = ours.map(|block| block.replace("\\\n", " "));
    whole.flat_map(|block| block.lines().filter_map(line).collect::<Vec<_>>()).collect()
}

/// Finds a command of ours in a block that only its indent makes.
fn indented(text: &str) -> Option<&str> {
    let outside = text.split("```").step_by(2);
    outside.flat_map(str::lines).find(|line| line.starts_with("    zerorate "))
}

fn line(text: &str) -> Option<Line> {
    let command = text.trim();
    let exit = command.split_once("(exit ").and_then(|(_, rest)| rest.split(')').next()?.parse().ok()).unwrap_or(0);
    let is_command = !command.is_empty() && !command.starts_with('#');
    is_command.then(|| Line { command: command.to_owned(), exit })
}

/// The chapters in `docs`, in their order.
fn chapters(docs: &Path) -> Result<Vec<PathBuf>> {
    let summary = fs::read_to_string(docs.join("SUMMARY.md"))?;
    let targets = summary.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    Ok(targets.filter(|target| !target.starts_with("..")).map(|target| docs.join(target)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_marked_and_what_is_no_command_of_ours_is_left() {
        let text = "a\n```sh\nzerorate probe\nzerorate x \\\n  --y   # no (exit 3)\n# a word\n```\n\
            b\n```sh,untried\nzerorate serve\n\
            ```\n```sh\ncargo xtask test\n```\n";
        let expected = [("zerorate probe", 0), ("zerorate x    --y   # no (exit 3)", 3)];
        let expected: Vec<Line> =
            expected.iter().map(|(command, exit)| Line { command: (*command).to_owned(), exit: *exit }).collect();
        assert_eq!(lines(text), expected);
        assert_eq!(indented(text), None);
        assert_eq!(indented("a\n\n    zerorate probe\n\nb\n"), Some("    zerorate probe"));
    }
}
