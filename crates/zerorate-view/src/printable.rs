//! Makes foreign text printable in pages and plots. A browser ignores most control characters, but a terminal that
//! prints the file obeys them, and XML forbids them.

/// Replaces all control characters, U+FFFE and U+FFFF.
pub fn line(text: &str) -> String {
    text.chars().map(|c| if is_known(c) { c } else { UNKNOWN }).collect()
}

/// Replaces the same characters as [`line`], except line breaks, which our pages contain.
pub fn page(text: &str) -> String {
    text.chars().map(|c| if c == '\n' || is_known(c) { c } else { UNKNOWN }).collect()
}

/// The replacement for a character that is not printable.
const UNKNOWN: char = char::REPLACEMENT_CHARACTER;

fn is_known(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_seen_and_do_not_act() {
        assert_eq!(line("a\x1b[31mb\x07\u{9b}2J\nc"), "a\u{fffd}[31mb\u{fffd}\u{fffd}2J\u{fffd}c");
        assert_eq!(page("<p>°/s\n\x1b]0;x\x07\r</p>\n"), "<p>°/s\n\u{fffd}]0;x\u{fffd}\u{fffd}</p>\n");
        assert_eq!(line("ä · … − 漢字 \u{1F600}"), "ä · … − 漢字 \u{1F600}");
    }
}
