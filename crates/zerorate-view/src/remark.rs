//! Warnings that every measurement by the same plan has, as lines of its result.

use zerorate::standing_place;

/// A standing warning as a line of the result; none for any other warning.
#[must_use]
pub fn remark(code: &str, text: &str) -> Option<String> {
    standing_place(code).map(|place| format!("{place} ({code}): {text}"))
}

/// Separates the remarks from the warnings, which are lines `code: text`.
#[must_use]
pub fn remarks_apart<S: AsRef<str>>(lines: &[S]) -> (Vec<String>, Vec<String>) {
    let (mut remarks, mut warnings) = (Vec::new(), Vec::new());
    for line in lines.iter().map(AsRef::as_ref) {
        match line.split_once(": ").and_then(|(code, text)| remark(code, text)) {
            Some(remark) => remarks.push(remark),
            None => warnings.push(line.to_owned()),
        }
    }
    (remarks, warnings)
}
