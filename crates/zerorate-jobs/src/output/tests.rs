//! Tests of the outputs of a run: leftovers of killed runs, slots, inputs, links, and the advice in errors.

use super::*;
use std::fs;

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}

/// A leftover of a killed process has no lock. A file that this process has open is locked.
#[cfg(unix)]
#[test]
fn only_files_of_killed_runs_are_removed() {
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
    // another program puts its own file at the path of the slot, and that file stays
    fs::rename(&path, folder.path().join("away")).unwrap();
    fs::write(&path, "theirs").unwrap();
    assert!(matches!(slot.put(b"three"), Err(OutputError::TakenMeanwhile { .. })));
    slot.clear();
    assert_eq!(fs::read_to_string(&path).unwrap(), "theirs");
    drop(slot);
    assert_eq!(names(folder.path()), ["away", "state.toml"]);
    assert!(Outputs::without_force().slot(&path).is_ok());
}

/// A folder of mode 0300 can be written to, but not opened to synchronise it, unless by a thread with the rights of
/// root. The thread of this test gives them up.
#[cfg(target_os = "linux")]
#[test]
fn a_slot_is_written_again_after_its_folder_could_not_be_synchronised() {
    use rustix::thread::{CapabilitySet, CapabilitySets, set_capabilities};
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.toml");
    let set_mode = |mode| fs::set_permissions(folder.path(), fs::Permissions::from_mode(mode)).unwrap();
    let mut slot = Outputs::without_force().slot(&path).unwrap();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let none = CapabilitySet::empty();
            set_capabilities(None, CapabilitySets { effective: none, permitted: none, inheritable: none }).unwrap();
            set_mode(0o300);
            assert!(matches!(slot.put(b"one"), Err(OutputError::Io { .. })));
            set_mode(0o700);
            slot.put(b"two").unwrap();
        });
    });
    assert_eq!(fs::read_to_string(&path).unwrap(), "two");
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
    // every file of a folder is an input
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

#[cfg(unix)]
#[test]
fn a_file_is_known_by_any_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("sub")).unwrap();
    fs::write(path("in"), "text").unwrap();
    fs::hard_link(path("in"), path("hard")).unwrap();
    std::os::unix::fs::symlink("in", path("link")).unwrap();
    for name in ["in", "./in", "sub/../in", "hard", "link"] {
        for force in [false, true] {
            let mut outputs = Outputs::new(force).reading([&*path("in")]).unwrap();
            assert!(matches!(outputs.derived(&path(name)), Err(OutputError::IsInput { .. })), "{name}");
        }
        let mut outputs = Outputs::new(true);
        let _first = outputs.derived(&path("in")).unwrap();
        assert!(matches!(outputs.derived(&path(name)), Err(OutputError::Twice { .. })), "{name}");
    }
}

/// A capture is protected even if its last row is torn, its description is damaged, or its end is missing.
#[test]
fn only_a_recording_replaces_a_capture() {
    let folder = tempfile::tempdir().unwrap();
    let head = "# zerorate.capture_schema = 1\n# zerorate.width_bits = 24\n# zerorate.rate_conversion = 5\n\
        # zerorate.temp_conversion = 5\nt_ns,edge_seq,rate_code,status,temp_code,lost\n";
    let row = "1000,1,8623488,8,8402701,0\n";
    for (name, content) in [
        ("whole", format!("{head}{row}")),
        ("torn", format!("{head}{row}2000,")),
        ("damaged", head.replace("capture_schema", "kapture_schema") + row),
        ("without-its-end", "PAR1 and no index of zerorate.".to_owned()),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, &content).unwrap();
        for refused in [Outputs::new(true).derived(&path).map(drop), Outputs::new(true).slot(&path).map(drop)] {
            assert!(matches!(refused, Err(OutputError::IsCapture { .. })), "{content}");
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), content);
        Outputs::new(true).recording(&path).unwrap();
    }
}

/// A hard link keeps the older recording: a new recording does not write through it.
#[test]
fn a_recording_that_replaces_another_leaves_its_hard_links() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("run"), "older").unwrap();
    fs::hard_link(path("run"), path("backup")).unwrap();
    let recording = Outputs::new(true).recording(&path("run")).unwrap();
    io::Write::write_all(&mut recording.writer().unwrap(), b"newer").unwrap();
    recording.finish().unwrap();
    assert_eq!([path("backup"), path("run")].map(|path| fs::read_to_string(path).unwrap()), ["older", "newer"]);
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link_and_leads_nowhere_new() {
    use std::os::unix::fs::{lchown, symlink};
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let fill = |name: &str, force| Outputs::new(force).derived(&path(name))?.fill(b"new");
    for (target, link) in
        [("victim", "planted"), ("victim", "out.csv.part"), ("dated", "latest"), ("b", "a"), ("a", "b")]
    {
        symlink(target, path(link)).unwrap();
    }
    for force in [false, true] {
        assert!(matches!(fill("planted", force), Err(OutputError::Dangling { .. })));
    }
    // an unfinished file does not go through the planted link `out.csv.part`
    fill("out.csv", false).unwrap();
    assert!(!path("victim").exists());
    // a link to a file stays; without force the file is not replaced, with force it is
    fs::write(path("dated"), "older").unwrap();
    assert!(matches!(fill("latest", false), Err(OutputError::Exists { .. })));
    fill("latest", true).unwrap();
    assert_eq!(fs::read_link(path("latest")).unwrap(), Path::new("dated"));
    assert_eq!(fs::read_to_string(path("dated")).unwrap(), "new");
    assert!(fill("a", true).is_err(), "round and round");
    // the link of another user is not followed (only root can make such a link for this test)
    if lchown(path("latest"), Some(4711), None).is_ok() {
        assert!(matches!(fill("latest", true), Err(OutputError::ForeignLink { uid: 4711, .. })));
    }
}
