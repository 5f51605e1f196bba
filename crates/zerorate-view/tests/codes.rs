//! The table of codes has everything that can be said, and nothing that cannot.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use zerorate::calibration::FileWarning;
use zerorate::chamber::ChamberRefusal;
use zerorate::{Deviation, Refusal, Warning};
use zerorate_allan::AllanWarning;
use zerorate_view::codes::{self, Says};
use zerorate_view::export::ExportWarning;

fn of_enums() -> (BTreeSet<&'static str>, BTreeSet<&'static str>) {
    let found = Deviation::codes().collect::<BTreeSet<_>>();
    let mut warnings: BTreeSet<_> = Warning::codes().chain(AllanWarning::codes()).collect();
    warnings.extend(FileWarning::codes().chain(ExportWarning::codes()).chain(found.iter().copied()));
    (warnings, Refusal::codes().chain(ChamberRefusal::codes()).chain(found).collect())
}

#[test]
fn all_that_can_be_said_is_explained() {
    let (warnings, refusals) = of_enums();
    let said = |code: &str| codes::all().find(|one| one.code == code).map(|one| one.says);
    for code in warnings.into_iter().chain(literals(&["\""], ": ").iter().map(String::as_str)) {
        assert!(matches!(said(code), Some(Says::Warning | Says::Either)), "no warning {code:?} in the table");
    }
    for code in made_with(&["Note::new("], &["torn-tail", "rows-incomplete"]) {
        assert!(matches!(said(&code), Some(Says::Warning | Says::Either)), "no warning {code:?} in the table");
    }
    let refused = made_with(&["Refused::new(", "LogError::Refused("], &["no-model", "times-uneven"]);
    for code in refusals.into_iter().chain(refused.iter().map(String::as_str)) {
        assert!(matches!(said(code), Some(Says::Refusal | Says::Either)), "no refusal {code:?} in the table");
    }
}

#[test]
fn all_that_is_explained_can_be_said() {
    let (warnings, refusals) = of_enums();
    let sources: Vec<String> = sources().into_iter().map(|(_, text)| text).collect();
    for one in codes::all() {
        let [word, begins] = [format!("\"{}\"", one.code), format!("\"{}: ", one.code)];
        let is_written = || sources.iter().any(|text| text.contains(&word) || text.contains(&begins));
        assert!(
            warnings.contains(one.code) || refusals.contains(one.code) || is_written(),
            "nothing says {:?}",
            one.code
        );
    }
}

#[test]
fn the_chapter_is_that_of_the_table() {
    let chapter = fs::read_to_string(root().join("docs/codes.md")).unwrap();
    assert!(chapter == codes::page(), "docs/codes.md is an old one: cargo xtask codegen");
}

/// Texts that begin as a warning does, with a word of several parts.
fn literals(openings: &[&str], closing: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, text) in sources() {
        for opening in openings {
            for (at, _) in text.match_indices(opening) {
                let rest = &text[at + opening.len()..];
                let word = &rest[..rest.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(0)];
                let is_code = word.contains('-') && !word.starts_with('-') && !word.ends_with('-');
                if is_code && rest[word.len()..].starts_with(closing) {
                    found.insert(word.to_owned());
                }
            }
        }
    }
    assert!(found.contains("libiio-unserved"), "the sources were not understood: {found:?}");
    found
}

/// The codes that these make refusals or warnings of, some of which are `known`.
fn made_with(makers: &[&str], known: &[&str]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (path, text) in sources() {
        for (at, made) in makers.iter().flat_map(|maker| text.match_indices(maker)) {
            let argument = text[at + made.len()..].trim_start();
            let Some(literal) = argument.strip_prefix('"') else { continue };
            let (code, _) = literal.split_once('"').unwrap_or_else(|| panic!("{}", path.display()));
            found.insert(code.to_owned());
        }
    }
    assert!(known.iter().all(|code| found.contains(*code)), "the sources were not understood: {found:?}");
    found
}

/// All that the program is made of, without the table itself.
fn sources() -> Vec<(PathBuf, String)> {
    let (mut found, mut folders) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        folders.push(entry.unwrap().path().join("src"));
    }
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && !path.ends_with("zerorate-view/src/codes") {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                found.push((path, text));
            }
        }
    }
    found
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}
