//! The book of codes: what every warning and refusal means, for `zerorate explain` and docs/codes.md.
//!
//! A code has one row. It stands beside the enum of its warning, or, where the code is raised as a text, in
//! `texts.rs`. `tests/codes.rs` compares the rows with all that can be said.

mod texts;

use crate::warning::JobWarning;
use std::fmt::Write;
use zerorate::calibration::FileWarning;
use zerorate::chamber::ChamberRefusal;
use zerorate::{Deviation, Refusal, Warning};
use zerorate_allan::AllanWarning;
pub use zerorate_allan::{Explanation, Says};
use zerorate_host::SourceWarning;
use zerorate_logs::LogWarning;
use zerorate_logs::imu::ImuWarning;
use zerorate_record::CaptureWarning;
use zerorate_view::SessionWarning;
use zerorate_view::export::ExportWarning;

/// Codes that belong together, under a heading.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// The heading.
    pub title: &'static str,
    /// The codes below it, in the order of the book.
    codes: &'static str,
}

/// All rows.
const ROWS: [&[Explanation]; 14] = [
    AllanWarning::EXPLANATIONS,
    CaptureWarning::EXPLANATIONS,
    ChamberRefusal::EXPLANATIONS,
    Deviation::EXPLANATIONS,
    ExportWarning::EXPLANATIONS,
    FileWarning::EXPLANATIONS,
    ImuWarning::EXPLANATIONS,
    JobWarning::EXPLANATIONS,
    LogWarning::EXPLANATIONS,
    Refusal::EXPLANATIONS,
    SessionWarning::EXPLANATIONS,
    SourceWarning::EXPLANATIONS,
    Warning::EXPLANATIONS,
    texts::ROWS,
];

/// The order of the book.
pub const GROUPS: [Group; 6] = [
    Group {
        title: "Of the measurement",
        codes: "earth-included earth-subtracted curvature-unseen temperature-drifting step curved lagging hysteresis \
            swaying restless flat-bias hour-unchecked short-average unsteady-offset wandering-bias rest-unjudged \
            curvature-unknown one-branch target-missed extrapolated moving turning small-span one-way too-few-samples",
    },
    Group {
        title: "Of the samples",
        codes: "aliased resonance lost-samples queue-overflow damaged-frames data-ready-stutters rate no-temperature \
            noisy quiet impossible-readings bit-errors out-of-range frozen unjudged clock-stands clock-jump \
            no-realtime-priority memory-not-locked unknown-serial slow-turn state-age-unknown not-kept not-recorded",
    },
    Group {
        title: "Of a chamber",
        codes: "silent not-settled not-reached overshoot beyond-limits limits-unknown chamber-left disturbed \
            uncertain no-curve resumed",
    },
    Group {
        title: "Of noise",
        codes: "quantisation-limited periodic-disturbance misfit drift short-end-excluded glitches many-glitches \
            many-steps gaps lines warm-up memory-or-flicker memory-or-filter drift-or-walk unsteady short-record \
            leakage off-curve model-rejected no-model no-common-model not-alike follows-temperature \
            not-identified motion",
    },
    Group {
        title: "Of logs and recordings",
        codes: "times-disordered times-uneven mostly-missing rows-incomplete beyond-codes torn-tail \
            messages-miscounted no-index bytes-behind-end not-checked edges-misplaced times-mended times-jitter \
            rate-changes lines-skipped lines-broken resampled clipped coarse-codes implausible unit-unknown \
            columns-left-out several-imus kind-absent off-codes log-failed no-checksum no-validity table-short \
            before-temperature not-believed",
    },
    Group {
        title: "Of the live page",
        codes: "samples-missed not-applied calibration-left-out not-removed libiio-unserved libiio-uncorrected \
            libiio-ended no-page",
    },
];

impl Group {
    /// The explanations of its codes.
    pub fn all(&self) -> impl Iterator<Item = &'static Explanation> {
        self.codes.split_whitespace().filter_map(row)
    }
}

fn row(code: &str) -> Option<&'static Explanation> {
    ROWS.into_iter().flatten().find(|row| row.code == code)
}

/// All of them, without headings.
pub fn all() -> impl Iterator<Item = &'static Explanation> {
    GROUPS.iter().flat_map(Group::all)
}

/// The explanation of `code`. A whole line that begins with the code does as well: `aliased: 228 samples/s …`.
#[must_use]
pub fn explain(code: &str) -> Option<&'static Explanation> {
    let line = code.trim();
    let line = line.strip_prefix("warning: ").or(line.strip_prefix("code: ")).unwrap_or(line);
    let word = line.split([':', ' ']).next()?.to_lowercase().replace('_', "-");
    row(&word)
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
    for group in GROUPS {
        write!(page, "\n## {}\n", group.title).expect("a String takes everything");
        for one in group.all() {
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

<!-- Made by `cargo xtask codegen` out of the rows that crates/zerorate-jobs/src/codes names; change them. -->

A warning begins with its code, and its result stands: `warning: aliased: 228 samples/s are below …`. A refusal
(exit code 3) is followed by a line with its code, and there is no result. The lines have the numbers of the case.
This page says what is true of every case. In the terminal:

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
        let mut in_order: Vec<&str> = GROUPS.iter().flat_map(|group| group.codes.split_whitespace()).collect();
        let mut rows: Vec<&str> = ROWS.into_iter().flatten().map(|row| row.code).collect();
        in_order.sort_unstable();
        rows.sort_unstable();
        assert_eq!(in_order, rows, "GROUPS and the rows do not have the same codes, each once");
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
