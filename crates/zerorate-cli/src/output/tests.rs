//! What a command reads is known to [`super::Outputs`], because nothing else opens a file; and what killed runs leave
//! is removed.

use super::*;
use std::fs;

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
const EXCEPTIONS: [(&str, &str); 9] = [
    ("api.rs", "for Python, where whoever writes is another call"),
    ("column.rs", "logs, which `allan` and `imu` have named to `reading`"),
    ("commands/allan/temperature.rs", "the same logs"),
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
            Some("output" | "fuzz" | "tests.rs") => {}
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

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}

/// Locks are those of the kernel: a process that is killed has none, and a file that is open here has one.
#[cfg(unix)]
#[test]
fn what_killed_runs_left_is_removed_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let users = ["unit.toml.abcdef.part", "unit.toml.backup", "zerorate.part", "other.zerorate.part.txt"];
    let left = ["unit.toml.Ab3dEf.zerorate.part", "other.csv.xyzxyz.zerorate.part"];
    for name in users.iter().chain(&left) {
        fs::write(path(name), name).unwrap();
    }
    let other = Outputs::new(false).derived(&path("unit.toml.chamber")).unwrap();
    let in_use = names(folder.path()).into_iter().find(|name| name.starts_with("unit.toml.chamber.")).unwrap();
    let mut outputs = Outputs::new(false);
    let own = outputs.derived(&path("unit.toml")).unwrap();
    let there = names(folder.path());
    assert!(left.iter().all(|name| !there.contains(&(*name).to_owned())), "{there:?}");
    assert!(users.iter().chain(&[&*in_use]).all(|name| there.contains(&(*name).to_owned())), "{there:?}");
    assert!(matches!(Outputs::new(true).derived(&path("unit.toml")), Err(OutputError::Busy { .. })));
    other.fill(b"steps").unwrap();
    own.fill(b"unit").unwrap();
    let all = names(folder.path());
    assert_eq!(all.len(), users.len() + 2, "{all:?}");
}

#[test]
fn a_slot_has_one_owner_and_is_written_again_and_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.toml");
    let mut slot = Outputs::without_force().slot(&path).unwrap();
    let most = Bytes(8);
    assert_eq!(slot.content(most).unwrap(), None);
    for content in ["one", "two"] {
        slot.put(content.as_bytes()).unwrap();
        assert_eq!(slot.content(most).unwrap().as_deref(), Some(content));
        if cfg!(unix) {
            assert!(matches!(Outputs::without_force().slot(&path), Err(OutputError::Busy { .. })), "{content}");
        }
    }
    fs::write(&path, "more than eight").unwrap();
    assert_eq!(slot.content(most).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    // somebody puts another file there: theirs
    fs::rename(&path, folder.path().join("away")).unwrap();
    fs::write(&path, "theirs").unwrap();
    assert!(matches!(slot.put(b"three"), Err(OutputError::TakenMeanwhile { .. })));
    slot.clear();
    assert_eq!(fs::read_to_string(&path).unwrap(), "theirs");
    drop(slot);
    assert_eq!(names(folder.path()), ["away", "state.toml"]);
    assert!(Outputs::without_force().slot(&path).is_ok());
}

#[test]
fn an_input_is_known_whether_it_was_read_before_or_after() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("in"), "text").unwrap();
    let mut before = Outputs::new(true);
    assert_eq!(before.text(&path("in"), Bytes(4)).unwrap(), "text");
    assert!(matches!(before.derived(&path("in")), Err(OutputError::IsInput { .. })));
    assert!(matches!(before.slot(&path("in")), Err(OutputError::IsInput { .. })));
    let mut after = Outputs::new(true);
    let _claimed = after.derived(&path("in")).unwrap();
    assert!(matches!(after.reads(&path("in")), Err(OutputError::IsInput { .. })));
    // of a folder, every file
    let mut of_folder = Outputs::new(true);
    of_folder.reads(folder.path()).unwrap();
    assert!(matches!(of_folder.recording(&path("in")), Err(OutputError::IsInput { .. })));
    assert_eq!(fs::read_to_string(path("in")).unwrap(), "text");
}

#[test]
fn force_is_advised_where_there_is_such_an_option() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("there");
    fs::write(&path, "").unwrap();
    let said = |mut outputs: Outputs| outputs.recording(&path).unwrap_err().to_string();
    assert!(said(Outputs::new(false)).ends_with("choose another name, or give --force"));
    assert!(said(Outputs::without_force()).ends_with("choose another name"));
}
