//! Only [`super::Outputs`] and the exceptions below open files. So `Outputs` knows all inputs of the other commands.

use std::fs;
use std::path::{Path, PathBuf};

/// Calls that open a file. Only the files of [`EXCEPTIONS`] may make them.
const WAYS: [&str; 10] = [
    "fs::read(",
    "read_to_string",
    "read_to_end",
    "File::open",
    "OpenOptions",
    "files::open",
    "files::capture",
    "files::rows",
    "files::log(",
    "files::text",
];

/// Files of the crate that may make these calls, each with the reason.
const EXCEPTIONS: [(&str, &str); 8] = [
    ("column.rs", "logs, which `allan` and `imu` have passed to `reading`"),
    ("commands/imu/mod.rs", "the same logs"),
    ("commands/repair.rs", "its capture, which it has passed to `reading`"),
    ("commands/verify.rs", "it writes no file"),
    ("interrupt.rs", "/proc"),
    ("memory.rs", "/sys"),
    ("reference.rs", "a page of the book, in a test"),
    ("serve/page.rs", "the page, which is part of the program"),
];

fn sources(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_source = path.extension().is_some_and(|ending| ending == "rs");
        match path.file_name().and_then(|name| name.to_str()) {
            Some("fuzz" | "tests.rs") => {}
            _ if path.is_dir() => sources(&path, all),
            _ if is_source => all.push(path),
            _ => {}
        }
    }
}

#[test]
fn only_the_output_modules_open_files() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src"));
    let mut all = Vec::new();
    sources(root, &mut all);
    assert!(all.len() > 50, "{}", all.len());
    for path in all {
        let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
        let text = fs::read_to_string(&path).unwrap();
        let own = text.split("#[cfg(test)]").next().unwrap_or_default();
        let found = WAYS.iter().find(|way| own.contains(**way));
        let is_known = EXCEPTIONS.iter().any(|(exception, _)| *exception == name);
        assert!(found.is_none() || is_known, "{name} opens a file by {found:?}: let `Outputs` do it");
    }
}
