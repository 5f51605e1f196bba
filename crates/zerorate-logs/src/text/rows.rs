//! Reads the rows of a text: the wanted cells of each line of a block, as numbers.

use super::super::number::{Number, Numerals};
use super::blocks::Block;
use super::dates::{self, DateFormat};
use super::head::{Head, is_comment};
use super::{header, sentence};
use crate::options::MAX_BAD;
use crate::sample::{Cell, ROWS, Sampled};
use memchr::{memchr, memchr_iter};
use std::mem::take;
use std::path::Path;
use zerorate_allan::SettingName;
use zerorate_input::InputError;

/// Number of characters of a byte in hexadecimal digits, as in `0x68`.
const BYTE: usize = 4;

/// The places of the wanted cells in each line of a file.
pub struct Cut<'a> {
    pub path: &'a Path,
    head: &'a Head,
    /// The places of the wanted cells in a line, in order, each with its index among the wanted cells.
    pub wanted: Vec<(usize, usize)>,
    /// The index of the time among the wanted cells; `None` if no time is read.
    pub time: Option<usize>,
    pub format: DateFormat,
    pub names: Vec<String>,
    /// The places of cells, and their values in the rows to read; empty reads all rows.
    pub only: Vec<(usize, String)>,
}

/// The wanted numbers and the findings from one block of lines.
#[derive(Default)]
pub struct Piece {
    /// The numbers of each wanted cell, NaN where one is missing, and whether all of them are codes.
    pub columns: Vec<(Vec<f64>, bool)>,
    /// Times of the rows, if they are wanted.
    pub times: Vec<Time>,
    /// Number of lines of any kind.
    pub lines: u64,
    /// Number of rows, including broken lines.
    pub rows: u64,
    /// Number of broken lines.
    pub bad: u64,
    /// The first broken line, counted from 1 in this block, and the error in it.
    pub first_bad: Option<Wrong>,
    /// The first line, counted from 1 in this block, that is the header again.
    pub again: Option<u64>,
    /// The first infinite value, or the header of another log. It is an error, and not a broken line that may be
    /// skipped.
    pub fatal: Option<Wrong>,
    /// The error in the last line, which lacks its end.
    pub cut: Option<Wrong>,
    /// The decimal mark that the block shows, or an ambiguous cell.
    pub numerals: Numerals,
    /// The first rows in all columns, if this is the first piece; otherwise empty.
    pub sample: Vec<Sampled>,
}

/// The number of a line, and the error in it.
pub type Wrong = (u64, String);

#[derive(Clone, Copy)]
pub enum Time {
    /// An integer in the unit of the column.
    Integer(i64),
    /// A number in the unit of the column.
    Number(f64),
    /// A date with a time of day, in ns since 1970, or a time of day alone, in ns since midnight.
    Date(i64),
}

impl Piece {
    pub fn new(columns: usize) -> Self {
        Self { columns: vec![(Vec::new(), true); columns], ..Self::default() }
    }

    /// Empties the piece but keeps its memory. To allocate new memory would take as long as to read into it.
    pub fn clear(&mut self, numerals: Numerals) {
        self.columns.iter_mut().for_each(|(column, are_codes)| {
            column.clear();
            *are_codes = true;
        });
        self.times.clear();
        let (columns, times) = (take(&mut self.columns), take(&mut self.times));
        *self = Self { columns, times, numerals, ..Self::default() };
    }
}

impl Cut<'_> {
    pub fn read(&self, block: &Block, is_first: bool, piece: &mut Piece) {
        let text = block.text();
        let has_quotes = memchr(b'"', text.as_bytes()).is_some();
        if is_first {
            piece.sample = self.head.names.iter().map(|name| Sampled::new(name)).collect();
        }
        let mut reading = Reading {
            cut: self,
            plain: self.head.delimiter.byte().filter(|_| !has_quotes),
            cells: vec![""; self.names.len()],
            values: vec![Number::Missing; piece.columns.len()],
            piece,
        };
        let mut start = 0;
        for end in memchr_iter(b'\n', text.as_bytes()) {
            reading.line(&text[start..end], is_first, true);
            start = end + 1;
        }
        if start < text.len() {
            reading.line(&text[start..], is_first, !block.is_last);
        }
    }
}

struct Reading<'a, 't> {
    cut: &'a Cut<'a>,
    /// The delimiter, if it is a single byte and no cell is in quotes.
    plain: Option<u8>,
    cells: Vec<&'t str>,
    values: Vec<Number>,
    piece: &'a mut Piece,
}

impl<'t> Reading<'_, 't> {
    fn line(&mut self, line: &'t str, is_first: bool, ended: bool) {
        self.piece.lines += 1;
        let line = line.trim_ascii();
        let Head { lines, delimiter, sentence, header, .. } = self.cut.head;
        let is_head = is_first && self.piece.lines <= *lines;
        if is_head || line.is_empty() || is_comment(line) || sentence::is_other(line, sentence.as_deref()) {
            return;
        }
        if self.is_left_out(line) {
            return;
        }
        self.piece.rows += 1;
        let number = self.piece.lines;
        let wrong = match sentence::checked(line).and_then(|line| self.row(line, number)) {
            Ok(()) => return,
            Err(wrong) => (number, wrong),
        };
        let names = sentence::without_end(line);
        if header::is_again(names, header, *delimiter) {
            self.piece.rows -= 1;
            self.piece.again.get_or_insert(number);
            return;
        }
        if !ended {
            self.piece.rows -= 1;
            self.piece.cut = Some(wrong);
            return;
        }
        if let Some(what) = header::other(names, header, *delimiter) {
            self.piece.fatal.get_or_insert((number, what));
        }
        self.piece.bad += 1;
        self.piece.first_bad.get_or_insert(wrong);
        if self.cut.time.is_none() {
            // a lost line is a lost sample
            self.piece.columns.iter_mut().for_each(|(column, _)| column.push(f64::NAN));
            self.sample("");
        }
    }

    fn row(&mut self, line: &'t str, number: u64) -> Result<(), String> {
        let (width, expected) = (self.split(line), self.cut.head.width);
        let named = |at: usize, what: &str| format!("column {}: {what}", self.cut.names[at]);
        if let Some((_, at)) = self.cut.wanted.iter().find(|(place, _)| *place >= width) {
            return Err(named(*at, "the line ends before this cell"));
        }
        // if a line was cut off, its last cell may be cut as well
        let is_half = width < expected && self.cut.wanted.last().is_some_and(|(place, _)| place + 1 == width);
        if width > expected || is_half {
            return Err(format!("it has {width} cells, and the others have {expected}"));
        }
        // in a table of several sensors side by side, another sensor may have more rows than this one
        if self.cut.time.is_some_and(|time| self.cells[time].is_empty())
            && self.cells.iter().all(|cell| cell.is_empty())
        {
            self.piece.rows -= 1;
            return Ok(());
        }
        let mut time = None;
        for (at, cell) in self.cells.iter().enumerate() {
            if self.cut.time == Some(at) {
                let found = read_time(&mut self.piece.numerals, cell, number, self.cut.format);
                time = Some(found.map_err(|what| named(at, &what))?);
                continue;
            }
            let value = self.piece.numerals.read(cell, number).map_err(|what| named(at, &what))?;
            if matches!(value, Number::Decimal(value) if value.is_infinite()) {
                let what = named(at, "it is infinite, which cannot be averaged");
                self.piece.fatal.get_or_insert((number, what.clone()));
                return Err(what);
            }
            self.values[at] = value;
        }
        for ((column, codes), value) in self.piece.columns.iter_mut().zip(&self.values) {
            match *value {
                Number::Missing => column.push(f64::NAN),
                Number::Integer(value) => {
                    *codes &= i32::try_from(value).is_ok();
                    column.push(value as f64);
                }
                Number::Decimal(value) => {
                    *codes = false;
                    column.push(value);
                }
            }
        }
        self.piece.times.extend(time);
        self.sample(line);
        Ok(())
    }

    fn is_left_out(&self, line: &str) -> bool {
        let mut wanted = self.cut.only.iter();
        wanted.any(|(place, value)| {
            self.cut.head.delimiter.cells(line).nth(*place).is_some_and(|cell| !self.cell(cell).is(value))
        })
    }

    fn cell(&self, cell: &str) -> Cell {
        match Numerals::new(self.piece.numerals.decimal()).read(cell, 0) {
            // a byte such as `0x68` is the address of a sensor, and stays a word
            Ok(_) if cell.starts_with("0x") && cell.len() <= BYTE => Cell::Word(cell.to_owned()),
            Ok(Number::Integer(integer)) => Cell::Number(integer as f64),
            Ok(Number::Decimal(number)) => Cell::number(number),
            Ok(Number::Missing) => Cell::Missing,
            Err(_) => Cell::Word(cell.to_owned()),
        }
    }

    /// Adds all cells of a row to the sample, unless the sample has [`ROWS`] rows already.
    fn sample(&mut self, line: &str) {
        if self.piece.sample.first().is_none_or(|column| column.cells.len() >= ROWS) {
            return;
        }
        let cells = self.cut.head.delimiter.cells(line).skip(self.cut.head.index.into());
        let cells: Vec<Cell> = cells.take(self.piece.sample.len()).map(|cell| self.cell(cell)).collect();
        let cells = cells.into_iter().chain(std::iter::repeat(Cell::Missing));
        self.piece.sample.iter_mut().zip(cells).for_each(|(column, cell)| column.cells.push(cell));
    }

    /// Finds the wanted cells. Returns the number of all cells of the line.
    fn split(&mut self, line: &'t str) -> usize {
        match self.plain {
            Some(delimiter) => self.split_plain(line, delimiter),
            None => self.split_quoted(line),
        }
    }

    fn split_plain(&mut self, line: &'t str, delimiter: u8) -> usize {
        let mut ends = memchr_iter(delimiter, line.as_bytes());
        let (mut width, mut start, mut is_whole) = (0, 0, false);
        for (place, at) in &self.cut.wanted {
            while width <= *place && !is_whole {
                let end = ends.next();
                if width == *place {
                    self.cells[*at] = trimmed(&line[start..end.unwrap_or(line.len())]);
                }
                width += 1;
                (start, is_whole) = end.map_or((start, true), |end| (end + 1, false));
            }
        }
        // the rest is counted, which is faster than to examine each cell
        let width = if is_whole { width } else { width + ends.count() + 1 };
        // a line that ends with a delimiter has no further cell
        let ends_empty = line.as_bytes().last() == Some(&delimiter);
        if ends_empty && width == self.cut.head.width + 1 { width - 1 } else { width }
    }

    fn split_quoted(&mut self, line: &'t str) -> usize {
        let mut wanted = self.cut.wanted.iter();
        let mut next = wanted.next();
        let (mut width, mut is_empty) = (0, false);
        for cell in self.cut.head.delimiter.cells(line) {
            if let Some((_, at)) = next.filter(|(place, _)| *place == width) {
                self.cells[*at] = cell;
                next = wanted.next();
            }
            (width, is_empty) = (width + 1, cell.is_empty());
        }
        if is_empty && width == self.cut.head.width + 1 { width - 1 } else { width }
    }
}

/// A cell without blanks around it. Most cells have none.
fn trimmed(cell: &str) -> &str {
    match cell.as_bytes() {
        [b'!'..=b'~', .., b'!'..=b'~'] | [b'!'..=b'~'] => cell,
        _ => cell.trim(),
    }
}

/// Reads a time: a number, or a time of day with or without a date.
fn read_time(numerals: &mut Numerals, cell: &str, line: u64, format: DateFormat) -> Result<Time, String> {
    let unreadable = match numerals.read(cell, line) {
        Ok(Number::Integer(time)) => return Ok(Time::Integer(time)),
        Ok(Number::Decimal(time)) if time.is_finite() => return Ok(Time::Number(time)),
        Ok(_) => return Err("no time; every row must have one".to_owned()),
        Err(unreadable) => unreadable,
    };
    let no_time = || match dates::reason(cell) {
        Some(why) => format!("`{cell}` {why}"),
        None => format!("{unreadable}, and no time such as 2026-03-01 12:00:00.25 or 12:00:00.25"),
    };
    dates::nanoseconds(cell, format).map(Time::Date).ok_or_else(no_time)
}

/// The number of broken lines of a text so far, and the first one.
#[derive(Default)]
pub struct Broken {
    /// Number of rows, including broken lines.
    pub rows: u64,
    pub bad: u64,
    pub first: Option<Wrong>,
    /// The first line that is the header again. Such lines are not broken.
    pub again: Option<u64>,
}

impl Broken {
    /// The text of a warning about broken lines, or an error if more lines are broken than may be skipped.
    ///
    /// `most` is the share of rows that may be skipped, [`MAX_BAD`] by default, and `option` the name of its setting.
    pub fn judge(self, path: &Path, most: Option<f64>, option: SettingName) -> Result<Option<String>, InputError> {
        let Self { rows, bad, first, .. } = self;
        let Some((line, what)) = first else { return Ok(None) };
        let most = most.unwrap_or(MAX_BAD);
        if bad as f64 > most * rows as f64 {
            let share = 100.0 * most;
            let why = match bad {
                1 if rows < 100 => String::new(),
                _ => format!("; {bad} of {rows} lines are broken, and {share} % may be ({option})"),
            };
            return Err(at_line(path, line, &format!("{what}{why}")));
        }
        let are = if bad == 1 { "is" } else { "are" };
        Ok(Some(format!(
            "{}: {bad} of {rows} lines {are} broken and skipped (the first: line {line}, {what})",
            path.display()
        )))
    }
}

/// An error in a line. If `what` names a column, the column becomes part of the place.
pub fn at_line(path: &Path, line: u64, what: &str) -> InputError {
    match what.strip_prefix("column ").and_then(|rest| rest.split_once(": ")) {
        Some((column, what)) => InputError::damaged(path, format!("line {line}, column {column}"), what),
        None => InputError::damaged(path, format!("line {line}"), what),
    }
}

pub fn cut<'a>(path: &'a Path, head: &'a Head, chosen: &[usize], time: Option<usize>) -> Cut<'a> {
    let shift = usize::from(head.index);
    let mut wanted: Vec<(usize, usize)> =
        chosen.iter().chain(&time).enumerate().map(|(at, index)| (index + shift, at)).collect();
    wanted.sort_unstable();
    Cut {
        path,
        head,
        wanted,
        time: time.map(|_| chosen.len()),
        format: time.map(|index| head.dates[index].format).unwrap_or_default(),
        names: chosen.iter().chain(&time).map(|index| head.names[*index].clone()).collect(),
        only: Vec::new(),
    }
}
