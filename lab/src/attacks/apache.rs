//! The files of arrow-testing and parquet-testing: valid files of other writers, and files that crashed a reader.
//! PyArrow's results are the reference.

use super::reader::{self, Reader};
use super::tally::Tally;
use anyhow::{Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};

const OF_ARROW: [&str; 2] = ["data/arrow-ipc-stream", "data/arrow-ipc-file"];
const OF_PARQUET: [&str; 3] = ["data", "bad_data", "shredded_variant"];

pub fn arrow(program: &Path, folder: &Path) -> Result<Option<Tally>> {
    run(program, folder, "arrow", &OF_ARROW, |name| !name.ends_with(".md") && !name.ends_with(".json.gz"))
}

pub fn parquet(program: &Path, folder: &Path) -> Result<Option<Tally>> {
    run(program, folder, "parquet", &OF_PARQUET, |name| name.ends_with(".parquet") || name.ends_with(".encrypted"))
}

fn run(
    program: &Path,
    folder: &Path,
    form: &str,
    parts: &[&str],
    is_one: impl Fn(&str) -> bool,
) -> Result<Option<Tally>> {
    let Some(python) = reader::python() else { return Ok(None) };
    let mut files = Vec::new();
    for part in parts {
        collect(&folder.join(part), &mut files)?;
    }
    files.retain(|file| file.file_name().and_then(|name| name.to_str()).is_some_and(&is_one));
    ensure!(!files.is_empty(), "{}: no file of {form}", folder.display());
    let theirs = reader::theirs(&python, form, &files)?;
    Ok(Some(Reader::new(program)?.compare(&files, &theirs, folder)))
}

/// Adds all files below a folder to `files`, in the order of their names.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let mut entries = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
    entries.sort();
    for entry in entries {
        if entry.is_dir() { collect(&entry, files)? } else { files.push(entry) }
    }
    Ok(())
}
