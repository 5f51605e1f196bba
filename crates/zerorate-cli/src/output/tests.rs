//! What a command reads is known to [`super::Outputs`], because nothing else opens a file.

use std::fs;
use std::path::{Path, PathBuf};

/// Ways to open a file that the rest of the crate leaves alone.
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

/// Files of the crate that do so all the same, and why that can be.
const EXCEPTIONS: [(&str, &str); 7] = [
    ("column.rs", "logs, which `allan` and `imu` have named to `reading`"),
    ("commands/imu/mod.rs", "the same logs"),
    ("commands/repair.rs", "its capture, which it has named to `reading`"),
    ("commands/verify.rs", "it writes no file"),
    ("interrupt.rs", "/proc"),
    ("memory.rs", "/sys"),
    ("serve/page.rs", "the page, which is in the program"),
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
fn nothing_else_opens_a_file() {
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
