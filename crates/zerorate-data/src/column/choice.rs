//! Which of a file's columns are meant.

use super::{ColumnOptions, LogError, Result};
use std::path::Path;

/// The columns of a file, as there are to choose from.
pub struct Columns<'a> {
    /// The file.
    pub path: &'a Path,
    /// Their names, or their numbers.
    pub names: Vec<&'a str>,
    /// Whether each holds numbers.
    pub numeric: Vec<bool>,
}

/// The columns that were chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The one with the numbers.
    pub value: usize,
    /// The one with the time.
    pub time: Option<usize>,
}

impl Columns<'_> {
    /// The columns that were asked for; without a name the column in `default`, or else the only one that there is.
    pub fn choose(&self, args: &ColumnOptions, default: Option<usize>) -> Result<Choice> {
        let time = args.time_column.as_deref().map(|wanted| self.position(wanted, "--time-column")).transpose()?;
        let value = match (args.column.as_deref(), default) {
            (Some(wanted), _) => self.position(wanted, "--column")?,
            (None, Some(default)) => default,
            (None, None) => self.only(time)?,
        };
        if !self.numeric[value] {
            return Err(self.ambiguous(&format!("holds no numbers in `{}`", self.names[value]), "--column"));
        }
        if time == Some(value) {
            return Err(
                self.ambiguous(&format!("cannot have both time and rate in `{}`", self.names[value]), "--column")
            );
        }
        Ok(Choice { value, time })
    }

    /// The only column with numbers that is not the time.
    fn only(&self, time: Option<usize>) -> Result<usize> {
        let candidates = (0..self.names.len()).filter(|index| self.numeric[*index] && Some(*index) != time);
        match candidates.collect::<Vec<_>>()[..] {
            [only] => Ok(only),
            [] => Err(self.ambiguous("has no column of numbers", "--column")),
            _ => Err(self.ambiguous("has several columns", "--column")),
        }
    }

    /// A name goes before a number.
    fn position(&self, wanted: &str, option: &str) -> Result<usize> {
        let mut named = self.names.iter().enumerate().filter(|(_, name)| **name == wanted).map(|(at, _)| at);
        match (named.next(), named.next()) {
            (Some(at), None) => Ok(at),
            (Some(_), Some(_)) => {
                Err(self.ambiguous(&format!("has several columns `{wanted}`, so it takes their number"), option))
            }
            (None, _) => {
                let number = wanted.parse().ok().filter(|number| *number < self.names.len());
                number.ok_or_else(|| self.ambiguous(&format!("has no column `{wanted}`"), option))
            }
        }
    }

    /// Says which columns there are to choose from.
    fn ambiguous(&self, why: &str, option: &str) -> LogError {
        let listed: Vec<String> =
            self.names.iter().enumerate().map(|(number, name)| format!("{number} `{name}`")).collect();
        LogError::Ask(format!("{} {why}; choose with {option} one of: {}", self.path.display(), listed.join(", ")))
    }
}
