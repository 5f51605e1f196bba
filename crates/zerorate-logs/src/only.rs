//! The choice of the rows of a table.

use crate::error::LogError;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// The rows of a table in which a column has this value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Only {
    /// The column, by its name or its number counted from 0.
    pub column: String,
    /// The value, as the table has it.
    pub value: String,
}

impl Only {
    /// The error for a value that no row has.
    pub(crate) fn without_rows(&self, path: &Path) -> LogError {
        LogError::Ask(format!("{}: column `{}` is `{}` in no row", path.display(), self.column, self.value))
    }
}

impl fmt::Display for Only {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.column, self.value)
    }
}

impl FromStr for Only {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.rsplit_once('=').filter(|(column, _)| !column.is_empty());
        let (column, value) = parts.ok_or("give a column and its value, as in SensorId=1")?;
        Ok(Self { column: column.trim().to_owned(), value: value.trim().to_owned() })
    }
}
