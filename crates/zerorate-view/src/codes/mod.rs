//! Every warning and every refusal by its code: what was seen, why it matters, what to do.
//!
//! The core says them with their numbers; here stands what holds of all of a code. `zerorate explain` and the book
//! take it from this table. `tests/codes.rs` compares it with what can be said.

mod chamber;
mod logs;
mod measuring;
mod noise;
mod samples;
mod serving;

use std::fmt::{self, Write};

/// What stands behind a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// As warnings begin with it, and as a refusal names it.
    pub code: &'static str,
    /// How it is said.
    pub says: Says,
    /// The commands of the program that say it.
    pub by: &'static [&'static str],
    /// What was seen.
    pub seen: &'static str,
    /// Why it matters.
    pub matters: &'static str,
    /// What to do.
    pub remedy: &'static str,
    /// A command that does it or looks further, as an example; empty where there is none.
    pub command: &'static str,
}

/// How a code is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Says {
    /// The result stands.
    Warning,
    /// There is no result.
    Refusal,
    /// The one or the other, by how much it is.
    Either,
}

impl fmt::Display for Says {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Warning => "warning",
            Self::Refusal => "refusal",
            Self::Either => "warning or refusal",
        })
    }
}

/// Codes that belong together, under a heading.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// The heading.
    pub title: &'static str,
    /// What stands under it.
    pub all: &'static [Explanation],
}

/// All of them.
pub const GROUPS: [Group; 6] = [
    Group { title: "Of the measurement", all: measuring::ALL },
    Group { title: "Of the samples", all: samples::ALL },
    Group { title: "Of a chamber", all: chamber::ALL },
    Group { title: "Of noise", all: noise::ALL },
    Group { title: "Of logs and recordings", all: logs::ALL },
    Group { title: "Of the live page", all: serving::ALL },
];

/// All of them, without headings.
pub fn all() -> impl Iterator<Item = &'static Explanation> {
    GROUPS.iter().flat_map(|group| group.all)
}

/// What stands behind `code`. A whole line that begins with it does as well: `aliased: 228 rate samples …`.
#[must_use]
pub fn explain(code: &str) -> Option<&'static Explanation> {
    let line = code.trim();
    let line = line.strip_prefix("warning: ").or(line.strip_prefix("code: ")).unwrap_or(line);
    let word = line.split([':', ' ']).next()?.to_lowercase().replace('_', "-");
    all().find(|one| one.code == word)
}

/// The codes that are most like `word`, the nearest first; none where nothing is near.
#[must_use]
pub fn nearest(word: &str) -> Vec<&'static str> {
    let word = word.trim().to_lowercase().replace('_', "-");
    let mut near: Vec<(usize, &str)> = all().map(|one| (distance(&word, one.code), one.code)).collect();
    near.retain(|&(distance, code)| distance <= code.len() / 3 || (word.len() > 2 && code.contains(&*word)));
    near.sort_unstable();
    near.into_iter().map(|(_, code)| code).take(3).collect()
}

/// Letters to insert, to drop and to exchange, until one word is the other.
fn distance(one: &str, other: &str) -> usize {
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (i, a) in one.bytes().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, b) in other.bytes().enumerate() {
            let changed = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[other.len()]
}

/// The chapter of the book.
#[must_use]
pub fn page() -> String {
    let mut page = String::from(PREFACE);
    for Group { title, all } in GROUPS {
        write!(page, "\n## {title}\n").expect("a String takes everything");
        for one in all {
            let Explanation { code, says, by, seen, matters, remedy, command } = one;
            let by = by.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            write!(page, "\n### {code}\n\n*A {says} of {by}.* {seen}\n\n**Why it matters.** {matters}\n\n")
                .and_then(|()| writeln!(page, "**What to do.** {remedy}"))
                .expect("a String takes everything");
            if !command.is_empty() {
                write!(page, "\n```sh,untried\n{command}\n```\n").expect("a String takes everything");
            }
        }
    }
    page
}

const PREFACE: &str = "# Every warning and refusal

<!-- Made by `cargo xtask codegen` out of crates/zerorate-view/src/codes; change it there. -->

A warning begins with its code, and its result stands: `warning: aliased: 228 rate samples a second are
below …`. A refusal (exit code 3) is followed by a line with its code, and there is no result. The lines
have the numbers of the case; here stands what is true of every case. In the terminal:

```sh
zerorate explain                # all codes
zerorate explain aliased        # one of them
zerorate explain aliasd         # a typo: what is near (exit 2)
zerorate explain aliased --json
```
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_stands_there_once_and_says_everything() {
        let mut codes: Vec<&str> = all().map(|one| one.code).collect();
        let count = codes.len();
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), count);
        for one in all() {
            let is_word = one.code.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-');
            assert!(is_word && !one.by.is_empty(), "{one:?}");
            for text in [one.seen, one.matters, one.remedy] {
                assert!(
                    text.len() > 15 && text.ends_with(['.', ')']) && !text.contains("  "),
                    "{}: {text:?}",
                    one.code
                );
            }
        }
    }

    #[test]
    fn a_code_is_found_as_it_is_read_in_a_terminal() {
        for said in ["aliased", "warning: aliased: 228 rate samples", "Aliased:", "aliased: x", "code: aliased (`z`)"]
        {
            assert_eq!(explain(said).map(|one| one.code), Some("aliased"), "{said}");
        }
        assert_eq!(explain("lost_samples").map(|one| one.code), Some("lost-samples"));
        assert_eq!([explain(""), explain("xyzzy")], [None, None]);
    }

    #[test]
    fn a_typo_finds_what_was_meant() {
        for (typo, meant) in [("aliasd", "aliased"), ("earth-inlcuded", "earth-included"), ("realtime", "realtime")] {
            let near = nearest(typo);
            assert!(near.first().is_some_and(|code| code.contains(meant)), "{typo}: {near:?}");
        }
        assert_eq!(nearest("qqqqqqqq"), [""; 0]);
        assert_eq!((distance("", "abc"), distance("kitten", "sitting")), (3, 3));
    }
}
