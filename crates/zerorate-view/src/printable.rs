//! Text from outside in pages and pictures. A browser ignores most control characters, but a terminal that prints the
//! file obeys them, and XML forbids them.

/// Makes one line of text printable.
pub fn line(text: &str) -> String {
    text.chars().map(|c| if is_known(c) { c } else { UNKNOWN }).collect()
}

/// Makes a whole page printable. Our pages have no control characters but line breaks.
pub fn page(text: &str) -> String {
    text.chars().map(|c| if c == '\n' || is_known(c) { c } else { UNKNOWN }).collect()
}

/// The replacement for a character that cannot be shown.
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
