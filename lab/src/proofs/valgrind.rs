//! Runs valgrind on tests of the Python package that call each native function. An error counts if one of its frames
//! is in the extension module, since valgrind also reports errors in Python and numpy.

use super::WORK;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::process::Command;
use xtask::tools::{Tool, available};
use xtask::venv::done;
use xtask::wheel;

const VALGRIND: Tool = Tool { program: "valgrind", package: "valgrind" };
/// The extension module's file name in a frame.
const OURS: &str = "_zerorate.abi3.so";

pub fn run() -> Result<()> {
    let python = match wheel::environment()? {
        Ok(python) if available(&[VALGRIND], "valgrind")? => python,
        Ok(_) => return Ok(()),
        Err(why) => {
            eprintln!("SKIPPED: valgrind: {why}");
            return Ok(());
        }
    };
    wheel::install_into(&python, &wheel::build(&python)?)?;
    let log = std::path::absolute(WORK)?.join("valgrind.log");
    fs::create_dir_all(WORK)?;
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--error-limit=no", "--num-callers=40"]);
    valgrind.arg(format!("--log-file={}", log.display())).arg(python);
    done(valgrind.args(["lab/src/proofs/natives.py", "bindings/python/tests"]).env("PYTHONMALLOC", "malloc"))?;
    let log = fs::read_to_string(&log).context("what valgrind found")?;
    let (all, ours) = errors(&log);
    println!("{all} errors, {} with a frame of {OURS}", ours.len());
    ensure!(ours.is_empty(), "{}", ours.join("\n"));
    Ok(())
}

/// The number of errors, and the errors with a frame in our module. An error is a block of lines that contains frames.
fn errors(log: &str) -> (usize, Vec<String>) {
    let text = |line: &str| line.split_once("== ").map_or("", |(_, text)| text).to_owned() + "\n";
    let lines: Vec<String> = log.lines().map(text).collect();
    let blocks = lines.split(|line| line.trim().is_empty()).map(<[String]>::concat);
    let errors: Vec<String> = blocks.filter(|block| block.contains("   at 0x")).collect();
    (errors.len(), errors.into_iter().filter(|error| error.contains(OURS)).collect())
}

#[cfg(test)]
mod tests {
    use super::errors;

    #[test]
    fn an_error_of_ours_counts() {
        let log = "\
==7== Invalid read of size 8
==7==    at 0x1: PyObject_Free (in /usr/bin/python3.11)
==7== 
==7== Conditional jump or move depends on uninitialised value(s)
==7==    at 0x2: memcpy (in /usr/libexec/valgrind/vgpreload_memcheck-amd64-linux.so)
==7==    by 0x3: _zerorate::allan::analyse (in /v/zerorate/_zerorate.abi3.so)
==7== 
";
        let (all, ours) = errors(log);
        assert_eq!((all, ours.len()), (2, 1));
        assert!(ours[0].starts_with("Conditional jump") && ours[0].contains("analyse"));
    }
}
