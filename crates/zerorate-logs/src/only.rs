//! Selects rows of a table by the values of columns.

use crate::error::LogError;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// The value of a condition that every row meets.
pub const ANY: &str = "*";

/// Selects the rows of a table that meet all conditions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RowFilter {
    /// The conditions that each row must meet; one or more.
    pub conditions: Vec<Condition>,
}

/// A column of a table, and the value that it must have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Condition {
    /// The column, by its name or its number counted from 0.
    pub column: String,
    /// The value: a word as it stands in the table, or a number equal to the one there. `*` is any value, and states
    /// that the column does not tell sensors apart.
    pub value: String,
}

impl RowFilter {
    pub(crate) fn without_rows(&self, path: &Path) -> LogError {
        let all = self.conditions.iter().map(|Condition { column, value }| format!("`{column}` is `{value}`"));
        LogError::Ask(format!("{}: column {} in no row", path.display(), all.collect::<Vec<_>>().join(" and ")))
    }
}

impl fmt::Display for RowFilter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = self.conditions.iter().map(|Condition { column, value }| format!("{column}={value}"));
        f.write_str(&all.collect::<Vec<_>>().join(","))
    }
}

impl FromStr for RowFilter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // a value may contain a comma: `place=left, outside`
        let mut parts: Vec<String> = Vec::new();
        for part in text.split(',') {
            match parts.last_mut() {
                Some(last) if !part.contains('=') || !last.contains('=') => *last += &format!(",{part}"),
                _ => parts.push(part.to_owned()),
            }
        }
        let condition = |part: &String| {
            let parts = part.rsplit_once('=').filter(|(column, _)| !column.is_empty());
            let (column, value) = parts.ok_or("give a column and its value, as in SensorId=1")?;
            Ok(Condition { column: column.trim().to_owned(), value: value.trim().to_owned() })
        };
        Ok(Self { conditions: parts.iter().map(condition).collect::<Result<_, String>>()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_are_cut_at_commas() {
        for (text, expected) in [
            ("SensorId=1", &[("SensorId", "1")][..]),
            ("bus=0, sensor=1", &[("bus", "0"), ("sensor", "1")]),
            ("place=left, outside", &[("place", "left, outside")]),
            ("a,b=1", &[("a,b", "1")]),
        ] {
            let only: RowFilter = text.parse().unwrap();
            let found: Vec<_> = only.conditions.iter().map(|one| (&*one.column, &*one.value)).collect();
            assert_eq!(found, expected, "{text}");
        }
        assert!("SensorId".parse::<RowFilter>().is_err() && "=1".parse::<RowFilter>().is_err());
    }
}
