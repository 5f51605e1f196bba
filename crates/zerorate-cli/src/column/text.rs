//! A column of delimited text, with or without a header.

use super::{Column, Series, ambiguous, position};
use crate::capture::CaptureError;
use crate::capture::delimited::{Delimiter, Line, Lines};
use anyhow::Result;
use std::fs::File;
use std::path::Path;

/// Reads a column of text.
pub fn read(path: &Path, file: File, wanted: Option<&str>) -> Result<Column> {
    let mut lines = Lines::new(path, file);
    let mut head: Vec<(u64, String)> = Vec::new();
    while head.len() < 2 {
        match next_content(&mut lines)? {
            Some(line) => head.push((line.number, line.text.to_owned())),
            None => break,
        }
    }
    let layout = Layout::detect(path, &head, wanted)?;
    let mut series = Series::Codes(Vec::new());
    for (number, text) in head.iter().skip(usize::from(layout.has_header)) {
        layout.append(&mut series, *number, text)?;
    }
    while let Some(line) = next_content(&mut lines)? {
        layout.append(&mut series, line.number, line.text)?;
    }
    Ok(Column { name: layout.name.clone(), series, scale: 1.0, timing: None, warning: None })
}

/// The next line that is no comment.
fn next_content(lines: &mut Lines) -> Result<Option<Line<'_>>, CaptureError> {
    lines.next_where(|text| !text.starts_with(['#', '%']))
}

/// Where the column stands in each line.
struct Layout<'a> {
    path: &'a Path,
    delimiter: Delimiter,
    has_header: bool,
    index: usize,
    name: String,
}

impl<'a> Layout<'a> {
    /// From the first two lines: the second is data if there is any, so it shows the delimiter; a first line that is not all numbers is a header.
    fn detect(path: &'a Path, head: &[(u64, String)], wanted: Option<&str>) -> Result<Self> {
        let (Some((_, first)), Some((_, data))) = (head.first(), head.last()) else {
            return Err(CaptureError::damaged(path, "as a text file", "it holds no line of data").into());
        };
        let delimiter = Delimiter::detect(data);
        let cells: Vec<&str> = delimiter.cells(first).collect();
        let has_header = cells.iter().any(|cell| cell.parse::<f64>().is_err());
        let numbers: Vec<String> = (0..cells.len()).map(|number| number.to_string()).collect();
        let names = if has_header { cells } else { numbers.iter().map(String::as_str).collect() };
        let index = match (wanted, names.len()) {
            (Some(wanted), _) => position(path, &names, wanted)?,
            (None, 1) => 0,
            (None, _) => return Err(ambiguous(path, "has several columns", &names)),
        };
        Ok(Self { path, delimiter, has_header, index, name: names[index].to_owned() })
    }

    /// Integers are kept as such until the first number that is none.
    fn append(&self, series: &mut Series, line: u64, text: &str) -> Result<(), CaptureError> {
        let wrong = |what: &str| CaptureError::damaged(self.path, format!("line {line}, column {}", self.name), what);
        let cell = self.delimiter.cells(text).nth(self.index).ok_or_else(|| wrong("the line ends before this cell"))?;
        if let Series::Codes(codes) = series {
            if let Ok(code) = cell.parse() {
                codes.push(code);
                return Ok(());
            }
            *series = Series::Numbers(codes.iter().map(|code| f64::from(*code)).collect());
        }
        let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| wrong(&format!("`{cell}` is no number (with a decimal point)")))?;
        if let Series::Numbers(numbers) = series {
            numbers.push(number);
        }
        Ok(())
    }
}
