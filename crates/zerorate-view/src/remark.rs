//! Standing remarks: warnings that every measurement by the same plan has. They are shown as lines of the result.

use zerorate::standing_place;

/// A standing warning as a line of the result; `None` for any other warning.
#[must_use]
pub fn remark(code: &str, text: &str) -> Option<String> {
    standing_place(code).map(|place| format!("{place} ({code}): {text}"))
}

/// Separates lines `code: text` into standing remarks and other warnings. Returns the remarks first.
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
