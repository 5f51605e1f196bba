//! The documents and the code agree: links lead to existing targets, cited facts, pages and tests exist, and examples
//! are tested code. Files and lines stay short.

mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use tree::{files_below, root};

#[test]
fn every_relative_link_leads_to_a_file_and_a_heading() {
    let mut broken = Vec::new();
    for (page, text) in files(&["md"]) {
        for link in links(&text) {
            let (path, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { page.clone() } else { page.parent().unwrap().join(path) };
            if !target.exists() || !has_heading(&target, heading) {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

#[test]
fn every_cited_fact_is_defined_in_facts_md() {
    let facts = fs::read_to_string(root().join("docs/facts.md")).unwrap();
    let defined: BTreeSet<&str> =
        facts.lines().filter_map(|line| line.strip_prefix("| ")).flat_map(fact_ids_at_start).collect();
    assert!(defined.contains("F-40") && defined.contains("M-01"), "the tables of docs/facts.md were not understood");
    let mut unknown = Vec::new();
    for (path, text) in files(&["md", "rs", "toml", "py", "pyi", "h"]) {
        for (number, line) in text.lines().enumerate() {
            let missing = fact_ids(line).filter(|id| !defined.contains(id));
            unknown.extend(missing.map(|id| format!("{}:{}: {id}", path.display(), number + 1)));
        }
    }
    assert!(unknown.is_empty(), "facts cited but not defined in docs/facts.md:\n{}", unknown.join("\n"));
}

/// Each row of docs/reference/stable.md names tests as `` `name` in `file` ``.
#[test]
fn every_test_that_holds_something_stable_exists() {
    let page = fs::read_to_string(root().join("docs/reference/stable.md")).unwrap();
    let parts: Vec<&str> = page.split("` in `").collect();
    for pair in parts.windows(2) {
        let name = pair[0].rsplit('`').next().unwrap();
        let file = pair[1].split('`').next().unwrap();
        let text = fs::read_to_string(root().join(file)).unwrap_or_else(|_| panic!("{file} does not exist"));
        let is_there = ["fn", "def"].iter().any(|word| text.contains(&format!("{word} {name}(")));
        assert!(is_there, "{file} has no test {name}");
    }
    assert!(parts.len() > 15, "the page was not understood");
}

#[test]
fn every_page_that_the_code_cites_is_in_the_project() {
    let pages: Vec<String> = files(&["md"]).iter().map(|(path, _)| path.display().to_string()).collect();
    let is_here = |cited: &str| {
        let cited = cited.trim_start_matches(['.', '/']);
        pages.iter().any(|page| page.strip_suffix(cited).is_some_and(|folder| folder.ends_with('/')))
    };
    let mut unknown = Vec::new();
    for (path, text) in files(&["rs", "py", "pyi", "toml", "h"]) {
        for (number, line) in text.lines().enumerate() {
            let missing = cited_pages(line).filter(|page| !page.starts_with("target/") && !is_here(page));
            unknown.extend(missing.map(|page| format!("{}:{}: {page}", path.display(), number + 1)));
        }
    }
    assert!(unknown.is_empty(), "pages cited but not there:\n{}", unknown.join("\n"));
}

/// Files whose lines may be long: generated ones (the C header, the unit of the firmware examples, calibrations of
/// `zerorate calibrate`), and the catalogue of parts, in which a source is one string.
const LONG: [&str; 5] = [
    "bindings/c/include/zerorate.h",
    "crates/zerorate-cli/tests/golden",
    "crates/zerorate/tests/core/golden",
    "extras/zerorate-certificate/tests/cycle.toml",
    "parts",
];

#[test]
fn lines_stay_below_120_characters() {
    let mut long = Vec::new();
    for (path, text) in files(&["rs", "py", "pyi", "c", "h", "toml", "sh"]) {
        let path = path.strip_prefix(root()).unwrap();
        if LONG.iter().any(|excepted| path.starts_with(excepted)) {
            continue;
        }
        let lines = text.lines().enumerate().filter(|(_, line)| line.chars().count() >= 120);
        long.extend(lines.map(|(number, _)| format!("{}:{}", path.display(), number + 1)));
    }
    assert!(long.is_empty(), "120 characters or more:\n{}", long.join("\n"));
}

#[test]
fn files_of_rust_stay_below_600_lines_and_ignore_no_test() {
    for (path, text) in files(&["rs"]) {
        assert!(text.lines().count() < 600, "{}: 600 lines or more", path.display());
        assert!(text.lines().all(|line| !line.trim_start().starts_with("#[ignore")), "{}: #[ignore]", path.display());
    }
}

const FIRMWARE_PAGE: &str = "docs/firmware.md";

#[test]
fn the_page_on_firmware_shows_examples_that_are_tested() {
    let page = fs::read_to_string(root().join(FIRMWARE_PAGE)).unwrap();
    // in the order in which the page shows them
    let tested = ["firmware/examples/src/polled.rs", "crates/adis16130/README.md"];
    assert_eq!(
        code_blocks(&page).count(),
        tested.len(),
        "each ```rust block of {FIRMWARE_PAGE} is a part of a tested file"
    );
    for (shown, path) in code_blocks(&page).zip(tested) {
        let source = fs::read_to_string(root().join(path)).unwrap();
        assert!(source.contains(shown), "this ```rust block of {FIRMWARE_PAGE} is not in {path}:\n{shown}");
    }
}

#[test]
fn the_readme_shows_no_rust_that_is_untested() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    assert_eq!(code_blocks(&readme).count(), 0, "Rust of README.md belongs on {FIRMWARE_PAGE}, which is compared");
}

/// All files of the project with one of these extensions.
fn files(extensions: &[&str]) -> Vec<(PathBuf, String)> {
    let mut paths = files_below(&root());
    paths.retain(|path| path.extension().is_some_and(|e| extensions.iter().any(|wanted| e == *wanted)));
    paths.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// The targets of links `[text](target)`, except external ones.
fn links(markdown: &str) -> impl Iterator<Item = &str> {
    let targets = markdown.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target);
    targets.filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
}

fn has_heading(page: &Path, anchor: &str) -> bool {
    anchor.is_empty()
        || fs::read_to_string(page)
            .unwrap()
            .lines()
            .any(|line| line.starts_with('#') && slug(line.trim_start_matches('#')) == anchor)
}

/// The anchor that GitHub gives a heading.
fn slug(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

/// Every word that ends in `.md`, with the folders before it.
fn cited_pages(line: &str) -> impl Iterator<Item = &str> {
    let in_a_path = |c: char| c.is_alphanumeric() || matches!(c, '.' | '/' | '-' | '_');
    line.split(move |c| !in_a_path(c))
        .map(|word| word.trim_end_matches('.'))
        .filter(|word| word.strip_suffix(".md").is_some_and(|name| !name.is_empty()))
}

/// Every `F-12` or `M-03` in a line, whole words only.
fn fact_ids(line: &str) -> impl Iterator<Item = &str> {
    line.match_indices(['F', 'M'])
        .filter(|(at, _)| !line[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '-'))
        .filter_map(|(at, _)| {
            let id = line.get(at..at + 4)?;
            let whole = !line[at + 4..].starts_with(|c: char| c.is_alphanumeric());
            let numbered = id[1..2] == *"-" && id[2..].bytes().all(|b| b.is_ascii_digit());
            (whole && numbered).then_some(id)
        })
}

fn fact_ids_at_start(row: &str) -> Option<&str> {
    fact_ids(row).next().filter(|id| row.starts_with(id))
}

/// The ```rust blocks, without their fences.
fn code_blocks(markdown: &str) -> impl Iterator<Item = &str> {
    let bodies = markdown.split("```rust").skip(1).filter_map(|rest| rest.split_once('\n'));
    bodies.filter_map(|(_, body)| body.split_once("```")).map(|(code, _)| code)
}
