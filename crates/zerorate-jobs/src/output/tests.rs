//! Files of a run: what killed runs leave, slots, inputs, and what is advised.

use super::*;
use std::fs;

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}

/// The kernel keeps the locks: a killed process has none, and a file that is open here has one.
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
    let error = |mut outputs: Outputs| anyhow::Error::from(outputs.recording(&path).unwrap_err());
    let (with, without) = (error(Outputs::new(false)), error(Outputs::without_force()));
    assert!([&with, &without].iter().all(|error| error.to_string().ends_with("choose another name")));
    assert!(could_be_forced(&with.context("saving")) && !could_be_forced(&without));
}
