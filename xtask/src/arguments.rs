//! The arguments of a task: flags, options with a value, and other words.

use anyhow::{Context, Result, bail, ensure};

/// The arguments that have not been taken yet.
pub struct Arguments(Vec<String>);

impl Arguments {
    /// Makes the list from the words after the name of a task.
    pub fn new(words: impl IntoIterator<Item = String>) -> Self {
        Self(words.into_iter().collect())
    }

    /// Takes a flag such as `--check`; true if it is there.
    pub fn flag(&mut self, name: &str) -> bool {
        let before = self.0.len();
        self.0.retain(|word| word != name);
        self.0.len() < before
    }

    /// Takes an option with its value: `--site DIR` or `--site=DIR`.
    pub fn value(&mut self, name: &str) -> Result<Option<String>> {
        let joined = |word: &String| word.strip_prefix(name)?.strip_prefix('=').map(str::to_owned);
        let is_it = |word: &String| word == name || joined(word).is_some();
        let Some(at) = self.0.iter().position(is_it) else { return Ok(None) };
        let word = self.0.remove(at);
        if let Some(value) = joined(&word) {
            return Ok(Some(value));
        }
        let value = self.0.get(at).filter(|value| !value.starts_with('-'));
        value.with_context(|| format!("{name} needs a value"))?;
        Ok(Some(self.0.remove(at)))
    }

    /// The words that are left. Fails if one of them is an option, which is then unknown.
    pub fn words(self) -> Result<Vec<String>> {
        if let Some(option) = self.0.iter().find(|word| word.starts_with('-')) {
            bail!("unknown option {option}: --help lists the options");
        }
        Ok(self.0)
    }

    /// Refuses all arguments that are left.
    pub fn end(self) -> Result<()> {
        let words = self.words()?;
        ensure!(words.is_empty(), "unknown argument {}: --help lists the arguments", words.join(" "));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Arguments;

    fn arguments(line: &str) -> Arguments {
        Arguments::new(line.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn each_argument_is_taken_once() {
        let mut given = arguments("--site DIR --check a --of=x=y b");
        assert_eq!(given.value("--of").unwrap().as_deref(), Some("x=y"));
        assert_eq!(given.value("--site").unwrap().as_deref(), Some("DIR"));
        assert_eq!(given.value("--site").unwrap(), None);
        assert!(given.flag("--check") && !given.flag("--check"));
        assert_eq!(given.words().unwrap(), ["a", "b"]);
    }

    #[test]
    fn unknown_arguments_are_refused() {
        assert!(arguments("--chekc").words().is_err());
        assert!(arguments("word").end().is_err());
        assert!(arguments("--site").value("--site").is_err());
        assert!(arguments("--site --check").value("--site").is_err());
        assert!(arguments("").end().is_ok());
    }
}
