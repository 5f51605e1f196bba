//! Names of settings in messages.

use core::fmt::{self, Write as _};

/// The name of a setting in a front end: a word between two affixes, such as `--max-u-btc` or `max_u_btc=`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SettingName {
    /// Text before the word.
    pub prefix: &'static str,
    /// The word.
    pub word: &'static str,
    /// Character that replaces `_` in the word.
    pub joint: char,
    /// Text after the word.
    pub suffix: &'static str,
}

impl SettingName {
    /// A name without affixes.
    #[must_use]
    pub const fn text(text: &'static str) -> Self {
        Self { prefix: "", word: text, joint: '_', suffix: "" }
    }
}

impl fmt::Display for SettingName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.prefix)?;
        for letter in self.word.chars() {
            f.write_char(if letter == '_' { self.joint } else { letter })?;
        }
        f.write_str(self.suffix)
    }
}
