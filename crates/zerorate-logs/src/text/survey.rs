//! Answers questions about a whole text: whether its first column is an index, and whether its commas mark decimals.

use super::super::number::Numerals;
use super::blocks::Blocks;
use super::head::{Head, Open, is_comment};
use super::sentence;
use crate::error::{LogError, Result};
use crate::number::Decimal;
use crate::options::ColumnOptions;
use crate::setting::Setting;
use std::path::Path;
use zerorate_input::delimited::Delimiter;
use zerorate_input::{Input, InputError};

/// The facts that the rows of a whole text show.
struct Survey {
    rows: u64,
    /// True if the first cell counts the rows, from 0 or from 1.
    is_index: bool,
    start: i64,
    /// True if each row is one number, with or without a decimal comma.
    is_decimal: bool,
    /// True if each row ends with a delimiter.
    ends_empty: bool,
    /// True if the first cell never falls from row to row. `falls` is true if the first cell never rises.
    rises: bool,
    falls: bool,
    last: i64,
    /// True if a cell shows that the commas mark decimals: `-0,25` or `1,05`.
    shows_decimals: bool,
    /// True if some row does not have two cells.
    uneven: bool,
}

/// Answers the question that the head of a text left open; `input` is the text from its start.
pub fn settle(path: &Path, input: Input, head: &mut Head, args: &ColumnOptions) -> Result<()> {
    let survey = Survey::of(path, input, head)?;
    let ask = |why: String| LogError::Ask(format!("{}: {why}", path.display()));
    let decimal = args.names.of(Setting::Decimal);
    match head.open {
        Open::Nothing => {}
        Open::OneNameLess if survey.ends_empty => head.width -= 1,
        Open::OneNameLess if head.has_clash() => return Err(head.miscounted(path, head.lines, head.names.len())),
        Open::OneNameLess => match (survey.is_index, survey.is_decimal) {
            (true, false) => head.drop_index(),
            (false, true) => head.read_as_decimals(),
            (true, true) => {
                let name = &head.names[0];
                return Err(ask(format!(
                    "the header has one name, `{name}`, and each row has one comma. Give {decimal} comma if 1,5 is \
                     1.5; otherwise give the first column a name"
                )));
            }
            (false, false) => return Err(head.miscounted(path, head.lines, head.names.len())),
        },
        Open::TwoOrDecimals if !survey.is_decimal || args.decimal.is_some() => {}
        Open::TwoOrDecimals if survey.shows_decimals => head.read_as_decimals(),
        Open::TwoOrDecimals if survey.uneven || !survey.rises && !survey.falls => {
            return Err(ask(format!(
                "its lines may be one column with decimal commas or two columns of integers; give {decimal} comma or \
                 {decimal} point"
            )));
        }
        Open::TwoOrDecimals => {}
    }
    Ok(())
}

impl Head {
    /// Reads the first cell of each row as an index without a name.
    fn drop_index(&mut self) {
        self.index = true;
        self.numeric.remove(0);
        self.dates.remove(0);
    }

    /// Reads the text as one column with decimal commas.
    fn read_as_decimals(&mut self) {
        (self.delimiter, self.width, self.numeric) = (Delimiter::Semicolon, 1, vec![true]);
        (self.names.len() > 1).then(|| self.names.truncate(1));
        self.decimal = None;
    }
}

impl Survey {
    fn of(path: &Path, input: Input, head: &Head) -> Result<Self, InputError> {
        let mut survey = Self {
            rows: 0,
            is_index: true,
            start: 0,
            is_decimal: true,
            ends_empty: true,
            rises: true,
            falls: true,
            last: 0,
            shows_decimals: false,
            uneven: false,
        };
        let mut blocks = Blocks::new(path, input).with_stamps(head.stamps).without_marks(&head.marks);
        let mut line_number = 0;
        while let Some(block) = blocks.next()? {
            for line in block.text().lines() {
                line_number += 1;
                let line = line.trim_ascii();
                let is_other = is_comment(line) || sentence::is_other(line, head.sentence.as_deref());
                if line_number > head.lines && !line.is_empty() && !is_other {
                    survey.take(sentence::without_end(line), head);
                }
            }
        }
        survey.is_index &= survey.rows > 1;
        Ok(survey)
    }

    fn take(&mut self, line: &str, head: &Head) {
        let cells: Vec<&str> = head.delimiter.cells(line).collect();
        let first = cells[0].parse::<i64>().ok();
        if self.rows == 0 {
            (self.start, self.last) = (first.unwrap_or(-1), first.unwrap_or_default());
            self.is_index = (0..=1).contains(&self.start);
        }
        self.is_index &= first == i64::try_from(self.rows).ok().map(|row| row + self.start);
        let is_one = Numerals::new(Some(Decimal::Comma)).read(line, 0).is_ok();
        self.is_decimal &= is_one && head.delimiter == Delimiter::Comma;
        self.ends_empty &= cells.last().is_some_and(|last| last.is_empty());
        let now = first.unwrap_or(self.last);
        (self.rises, self.falls) = (self.rises && now >= self.last, self.falls && now <= self.last);
        self.last = now;
        let has_decimals = |cell: &&str| cell.len() > 1 && cell.starts_with('0');
        self.shows_decimals |= cells.len() == 2 && (cells[0] == "-0" || cells.get(1).is_some_and(has_decimals));
        self.uneven |= cells.len() != 2;
        self.rows += 1;
    }
}
