//! What is to be said of a file, beside what is in it.

use std::fmt;

/// A warning of a file: its code, and a text that names the file. For people and scripts `code: text`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// As `zerorate explain` knows it.
    pub code: &'static str,
    /// The rest.
    pub text: String,
}

impl Note {
    /// With its code.
    #[must_use]
    pub fn new(code: &'static str, text: String) -> Self {
        Self { code, text }
    }

    /// Of a file whose end is missing, if it is.
    pub fn torn(text: Option<String>) -> Vec<Self> {
        text.map(|text| Self::new("torn-tail", text)).into_iter().collect()
    }

    /// The texts alone, as one; none where nothing is to be said.
    #[must_use]
    pub fn texts(notes: &[Self]) -> Option<String> {
        let texts: Vec<&str> = notes.iter().map(|note| note.text.as_str()).collect();
        (!texts.is_empty()).then(|| texts.join("; "))
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.code, self.text)
    }
}
