//! The table of codes has everything that can be said, and nothing that cannot.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{env, fs};
use zerorate::calibration::FileWarning;
use zerorate::chamber::ChamberRefusal;
use zerorate::{Deviation, Refusal, Warning};
use zerorate_allan::{AllanWarning, PoolError};
use zerorate_host::SourceWarning;
use zerorate_jobs::JobWarning;
use zerorate_jobs::codes::{self, Says};
use zerorate_jobs::pool::NoPool;
use zerorate_logs::LogWarning;
use zerorate_logs::imu::{Doubt, ImuWarning};
use zerorate_record::CaptureWarning;
use zerorate_view::SessionWarning;
use zerorate_view::export::ExportWarning;

fn of_enums() -> (BTreeSet<&'static str>, BTreeSet<&'static str>) {
    let found = Deviation::codes().collect::<BTreeSet<_>>();
    let mut warnings: BTreeSet<_> = Warning::codes().chain(AllanWarning::codes()).collect();
    warnings.extend(FileWarning::codes().chain(ExportWarning::codes()).chain(found.iter().copied()));
    warnings.extend(JobWarning::codes().chain(SessionWarning::codes()).chain(SourceWarning::codes()));
    warnings.extend(CaptureWarning::codes().chain(LogWarning::codes()).chain(ImuWarning::codes()));
    (warnings, Refusal::codes().chain(ChamberRefusal::codes()).chain(found).collect())
}

#[test]
fn all_that_can_be_said_is_explained() {
    let (warnings, refusals) = of_enums();
    let said = |code: &str| codes::all().find(|one| one.code == code).map(|one| one.says);
    for code in warnings {
        assert!(matches!(said(code), Some(Says::Warning | Says::Either)), "no warning {code:?} in the table");
    }
    let refused = made_with(&["Refused::new(", "LogError::Refused("], &["moving", "times-uneven"]);
    for code in refusals.into_iter().chain(refused.iter().map(String::as_str)) {
        assert!(matches!(said(code), Some(Says::Refusal | Says::Either)), "no refusal {code:?} in the table");
    }
}

#[test]
fn what_is_refused_of_noise_is_explained() {
    let doubts = [Doubt::NoModel(String::new()), Doubt::Rejected(0.5)].map(|doubt| doubt.code());
    let no_pool = NoPool::NoCommonModel(PoolError::NothingInCommon).code().unwrap();
    let said = |code: &str| codes::all().find(|one| one.code == code).map(|one| one.says);
    for code in doubts.into_iter().chain([no_pool]) {
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
    let path = root().join("docs/codes.md");
    if env::var_os("ZERORATE_UPDATE").is_some() {
        fs::write(&path, codes::page()).unwrap();
    }
    let chapter = fs::read_to_string(path).unwrap();
    assert!(chapter == codes::page(), "docs/codes.md is an old one: cargo xtask codegen");
}

#[test]
fn no_text_begins_with_a_code() {
    for (path, text) in sources() {
        let text = text.split("#[cfg(test)]").next().unwrap();
        for one in codes::all().filter(|one| one.code.contains('-') && one.code != TERM) {
            assert!(!text.contains(&format!("\"{}: ", one.code)), "{}: {} in a text", path.display(), one.code);
        }
    }
}

/// A term of a model has the name of a warning.
const TERM: &str = "warm-up";

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
            if path.is_dir() && !path.ends_with("zerorate-jobs/src/codes") {
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

#[test]
fn a_word_is_near_a_code_by_its_letters() {
    for word in ["frozn", "frozenn", "frosen", "Frozen "] {
        assert_eq!(codes::nearest(word).first(), Some(&"frozen"), "{word}");
    }
    for far in ["xfxrxoxzxexn", "f", "glitchy-steps-and-gaps-of-lines"] {
        assert!(codes::nearest(far).is_empty(), "{far}: {:?}", codes::nearest(far));
    }
}
