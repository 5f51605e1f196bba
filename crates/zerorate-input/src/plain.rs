//! Escapes text from outside for a terminal: names of files and columns, serial numbers, cells, firmware strings.
//! Characters that would move the cursor, change colours, set titles or change the writing direction are shown as Rust
//! escapes: `\u{1b}`.

use std::borrow::Cow;

/// Escapes text for one line, including line breaks, which would fake a second line.
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, acts)
}

/// Escapes several lines that contain text from outside. Line feeds are kept.
pub fn lines(text: &str) -> Cow<'_, str> {
    escaped(text, |character| character != '\n' && acts(character))
}

/// True if a character is a control character, a line separator or a mark of writing direction.
fn acts(character: char) -> bool {
    let is_mark = matches!(character, '\u{200E}' | '\u{200F}' | '\u{061C}');
    let is_separator_or_embedding = matches!(character, '\u{2028}'..='\u{202E}' | '\u{2066}'..='\u{2069}');
    character.is_control() || is_mark || is_separator_or_embedding
}

fn escaped(text: &str, wanted: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&wanted) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        match wanted(character) {
            true => shown.extend(character.escape_default()),
            false => shown.push(character),
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown() {
        for text in ["", "0.5 °/s ± 3 %", "ä · … − 漢字", "naïve \u{1F600}"] {
            assert_eq!(line(text), text);
        }
        assert_eq!(line("a\x1b[31mb\x07\u{9b}2J\r\u{202e}txt\n"), r"a\u{1b}[31mb\u{7}\u{9b}2J\r\u{202e}txt\n");
        assert_eq!(lines("one\ntwo\x1b[2J\n"), "one\ntwo\\u{1b}[2J\n");
    }
}
