//! The meaning of every warning and refusal, as docs/codes.md states it.

use serde::Serialize;

const PAGE: &str = include_str!("../../../docs/codes.md");

/// Codes that belong together, under a heading.
#[derive(Clone, Debug)]
pub struct Group {
    /// The heading of the group in docs/codes.md.
    pub title: &'static str,
    /// The codes of the group, in the order of docs/codes.md.
    pub codes: Vec<Explanation>,
}

/// The explanation of a code, which holds for any values in the message.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Explanation {
    /// The code at the start of a warning, or in a refusal.
    pub code: &'static str,
    /// The severity: `warning`, `refusal` or `remark`, or two of them as in `warning or refusal`.
    pub says: String,
    /// The commands of `zerorate` that print the code.
    pub by: Vec<String>,
    /// What the program observed.
    pub seen: String,
    /// The consequence for the result.
    pub matters: String,
    /// The action that solves or avoids the problem.
    pub remedy: String,
    /// An example command that helps or investigates further; empty if there is none.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub command: &'static str,
}

/// Returns the groups of codes, in the order of docs/codes.md.
#[must_use]
pub fn groups() -> Vec<Group> {
    let groups = PAGE.split("\n## ").skip(1).filter_map(|group| group.split_once('\n'));
    let sections = |text: &'static str| text.split("\n### ").skip(1).filter_map(Explanation::parse).collect();
    groups.map(|(title, text)| Group { title, codes: sections(text) }).collect()
}

/// The explanations of all codes, in the order of docs/codes.md.
pub fn all() -> impl Iterator<Item = Explanation> {
    groups().into_iter().flat_map(|group| group.codes)
}

/// Explains a code, or a whole message that begins with it: `aliased: 228 samples/s …`. `None` if the code is unknown.
#[must_use]
pub fn explain(code: &str) -> Option<Explanation> {
    let line = code.trim();
    let line = line.strip_prefix("warning: ").or(line.strip_prefix("code: ")).unwrap_or(line);
    let word = line.split([':', ' ']).next()?.to_lowercase().replace('_', "-");
    all().find(|one| one.code == word)
}

/// Returns up to three codes that resemble `word`, the most similar first.
#[must_use]
pub fn nearest(word: &str) -> Vec<&'static str> {
    let word = word.trim().to_lowercase().replace('_', "-");
    let mut near: Vec<(usize, &str)> = all().map(|one| (strsim::levenshtein(&word, one.code), one.code)).collect();
    near.retain(|&(distance, code)| distance <= code.len() / 3 || (word.len() > 2 && code.contains(&*word)));
    near.sort_unstable();
    near.into_iter().map(|(_, code)| code).take(3).collect()
}

impl Explanation {
    /// Parses a section of docs/codes.md: the code; `*A warning of `a`, `b`.*` with the observation; why it matters;
    /// the remedy; and in most sections a command block.
    fn parse(section: &'static str) -> Option<Self> {
        let mut paragraphs = section.trim_end().split("\n\n");
        let code = paragraphs.next()?;
        let first = one_line(paragraphs.next()?);
        let (kind, seen) = first.strip_prefix("*A ")?.split_once(".* ")?;
        let (says, by) = kind.split_once(" of ")?;
        Some(Self {
            code,
            says: says.to_owned(),
            by: by.split(", ").map(|name| name.trim_matches('`').to_owned()).collect(),
            seen: seen.to_owned(),
            matters: one_line(paragraphs.next()?.strip_prefix("**Why it matters.** ")?),
            remedy: one_line(paragraphs.next()?.strip_prefix("**What to do.** ")?),
            command: match paragraphs.next() {
                Some(block) => block.strip_prefix("```sh,untried\n")?.strip_suffix("\n```")?,
                None => "",
            },
        })
    }
}

fn one_line(paragraph: &str) -> String {
    paragraph.replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_section_of_the_page_is_understood() {
        let codes: BTreeSet<&str> = all().map(|one| one.code).collect();
        assert_eq!([all().count(), codes.len()], [PAGE.matches("\n### ").count(); 2], "{codes:?}");
        for one in all() {
            let is_word = one.code.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-');
            let kinds = one.says.split(" or ").all(|kind| ["warning", "refusal", "remark"].contains(&kind));
            assert!(is_word && kinds, "{one:?}");
            for text in [&one.seen, &one.matters, &one.remedy] {
                assert!(text.len() > 15 && text.ends_with(['.', ')']) && !text.contains("  "), "{one:?}");
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
        for (typo, meant) in [
            ("aliasd", "aliased"),
            ("earth-inlcuded", "earth-included"),
            ("realtime", "realtime"),
            ("Frosen ", "frozen"),
        ] {
            let near = nearest(typo);
            assert!(near.first().is_some_and(|code| code.contains(meant)), "{typo}: {near:?}");
        }
        for far in ["qqqqqqqq", "f", "glitchy-steps-and-gaps-of-lines"] {
            assert_eq!(nearest(far), [""; 0]);
        }
    }
}
