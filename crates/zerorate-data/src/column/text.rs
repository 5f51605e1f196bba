//! Columns of delimited text, with or without a header.

use super::choice::{Choice, Columns};
use super::clock::Times;
use super::number::{Number, Numerals};
use super::series::SeriesBuilder;
use super::unit::TimeUnit;
use super::{Asked, Clock, Decimal, Found, FoundColumn, Result, wrong};
use crate::Input;
use crate::capture::CaptureError;
use crate::capture::delimited::{Delimiter, Line, Lines};
use crate::limits::Room;
use std::path::Path;

/// Reads columns of text.
pub fn read(path: &Path, input: Input, room: Room, asked: &Asked<'_>) -> Result<Found> {
    let mut lines = Lines::new(path, input);
    let head = Head::read(&mut lines)?;
    let mut reading = TextColumns::start(path, &head, room, asked)?;
    let mut warning = None;
    for (number, text, ended) in head.lines.iter().skip(usize::from(reading.has_header)) {
        reading.append_or_drop(Line { number: *number, text, ended: *ended }, &mut warning)?;
    }
    while let Some(line) = lines.next_where(|text| !is_comment(text))? {
        reading.append_or_drop(line, &mut warning)?;
    }
    reading.finish(warning)
}

fn is_comment(text: &str) -> bool {
    text.starts_with(['#', '%'])
}

/// How a file starts.
struct Head {
    /// The last comment above the first line.
    comment: Option<String>,
    /// Two lines, if there are as many: number, text, whether a line feed ended it.
    lines: Vec<(u64, String, bool)>,
}

impl Head {
    fn read(lines: &mut Lines) -> Result<Self, CaptureError> {
        let mut head = Self { comment: None, lines: Vec::new() };
        while head.lines.len() < 2 {
            match lines.next()? {
                Some(line) if !is_comment(line.text) => {
                    head.lines.push((line.number, line.text.to_owned(), line.ended));
                }
                Some(line) if head.lines.is_empty() => head.comment = Some(line.text.to_owned()),
                Some(_) => {}
                None => break,
            }
        }
        Ok(head)
    }
}

/// Columns of a text being read.
struct TextColumns<'a> {
    path: &'a Path,
    delimiter: Delimiter,
    has_header: bool,
    /// In the order in which they stand in a line.
    columns: Vec<TextColumn>,
    time: Option<(usize, String)>,
    numerals: Numerals,
    /// The numbers of a line.
    line: Vec<Number>,
    times: Option<Times>,
}

/// One of them.
struct TextColumn {
    index: usize,
    /// Place among those that were asked for.
    place: usize,
    name: String,
    values: SeriesBuilder,
}

impl<'a> TextColumns<'a> {
    /// The second line is data if there is any, so it shows the delimiter. The first is a header if it holds a word
    /// where the second holds a number; if there is none, the comment above the data may be one.
    fn start(path: &'a Path, head: &Head, room: Room, asked: &Asked<'_>) -> Result<Self> {
        let args = asked.args;
        let (Some((_, first, _)), Some((_, data, _))) = (head.lines.first(), head.lines.last()) else {
            return Err(CaptureError::damaged(path, "as a text file", "it holds no line of data").into());
        };
        let delimiter = delimiter(data, args.decimal);
        let [first, data]: [Vec<&str>; 2] = [first, data].map(|line| delimiter.cells(line).collect());
        let read = |cell: &str| Numerals::new(args.decimal).read(cell, 0);
        let is_number = |cell: &&str| matches!(read(cell), Ok(Number::Integer(_) | Number::Decimal(_)));
        let is_word = |cell: &&str| read(cell).is_err();
        let has_header = match head.lines.len() {
            1 => first.iter().all(is_word),
            _ => first.iter().zip(&data).any(|(above, below)| is_word(above) && is_number(below)),
        };
        let comment = head.comment.as_deref().unwrap_or_default().trim_start_matches(['#', '%', ' ']);
        let above: Vec<&str> = delimiter.cells(comment).collect();
        let numbers: Vec<String> = (0..first.len()).map(|number| number.to_string()).collect();
        let names = if has_header {
            first
        } else if above.len() == first.len() && above.iter().all(is_word) && above.len() > 1 {
            above
        } else {
            numbers.iter().map(String::as_str).collect()
        };
        let numeric = names
            .iter()
            .enumerate()
            .map(|(at, _)| head.lines.len() < 2 || data.get(at).is_none_or(|cell| !is_word(cell)));
        let columns = Columns { path, numeric: numeric.collect(), names: names.clone() };
        let Choice { values, time } = columns.choose(asked.wanted, args, &[])?;
        let column = |(place, index): (usize, &usize)| TextColumn {
            index: *index,
            place,
            name: names[*index].to_owned(),
            values: SeriesBuilder::sharing(room, values.len()),
        };
        let mut columns: Vec<TextColumn> = values.iter().enumerate().map(column).collect();
        columns.sort_by_key(|column| column.index);
        Ok(Self {
            path,
            delimiter,
            has_header,
            line: Vec::with_capacity(columns.len()),
            columns,
            time: time.map(|time| (time, names[time].to_owned())),
            numerals: Numerals::new(args.decimal),
            times: time.map(|_| Times::new()),
        })
    }

    fn rows(&self) -> u64 {
        self.columns.first().map_or(0, |first| first.values.rows())
    }

    /// A last line that no line feed ended may have been cut short, so that an error in it is none of the log.
    fn append_or_drop(&mut self, line: Line<'_>, warning: &mut Option<String>) -> Result<(), CaptureError> {
        match self.append(line) {
            Err(error) if !line.ended && self.rows() > 0 => {
                *warning = Some(format!("{error}: the file was cut short, so this line is dropped"));
                Ok(())
            }
            done => done,
        }
    }

    fn append(&mut self, line: Line<'_>) -> Result<(), CaptureError> {
        let number = line.number;
        let room = self.columns.first().map_or(Ok(()), |first| first.values.check_room(1));
        room.map_err(|why| CaptureError::no_room(self.path, why))?;
        let at = |name: &str, what: String| wrong(self.path, format_args!("line {number}, column {name}"), what);
        let ends = |name: &str| at(name, "the line ends before this cell".to_owned());
        let mut cells = self.delimiter.cells(line.text);
        let mut next = 0;
        self.line.clear();
        for TextColumn { index, name, .. } in &self.columns {
            let cell = cells.nth(*index - next).ok_or_else(|| ends(name))?;
            next = index + 1;
            let value = self.numerals.read(cell, number).map_err(|what| at(name, what))?;
            if matches!(value, Number::Decimal(value) if value.is_infinite()) {
                return Err(at(name, "it is infinite, which cannot be averaged".to_owned()));
            }
            self.line.push(value);
        }
        if let (Some(times), Some((index, name))) = (&mut self.times, &self.time) {
            let time = self.delimiter.cells(line.text).nth(*index).ok_or_else(|| ends(name))?;
            push_time(times, &mut self.numerals, time, number).map_err(|what| at(name, what))?;
        }
        for (column, value) in self.columns.iter_mut().zip(&self.line) {
            match *value {
                Number::Missing => column.values.push_missing(),
                Number::Integer(integer) => column.values.push_integer(integer),
                // it is finite
                Number::Decimal(value) => drop(column.values.push_number(value)),
            }
        }
        Ok(())
    }

    fn finish(self, warning: Option<String>) -> Result<Found> {
        let Self { path, time, numerals, mut columns, times, .. } = self;
        if let Some((line, what)) = numerals.doubt() {
            return Err(wrong(path, format_args!("line {line}"), what).into());
        }
        let clock = time.zip(times).map_or(Clock::Silent, |((_, name), times)| Clock::Column(name, times));
        columns.sort_by_key(|column| column.place);
        let columns = columns.into_iter().map(|column| FoundColumn::new(column.name, column.values)).collect();
        Ok(Found { columns, clock, warning })
    }
}

/// A time is a number, or a date with a time of day.
fn push_time(times: &mut Times, numerals: &mut Numerals, cell: &str, line: u64) -> Result<(), String> {
    let unreadable = match numerals.read(cell, line) {
        Ok(Number::Integer(time)) => return times.push_integer(time),
        Ok(Number::Decimal(time)) => return times.push_number(time),
        Ok(Number::Missing) => return Err("no time; every row must have one".to_owned()),
        Err(unreadable) => unreadable,
    };
    let stamp: Option<jiff::Timestamp> = cell.parse().ok().or_else(|| {
        let local: jiff::civil::DateTime = cell.parse().ok()?;
        Some(local.to_zoned(jiff::tz::TimeZone::UTC).ok()?.timestamp())
    });
    let ns = stamp.and_then(|stamp| i64::try_from(stamp.as_nanosecond()).ok()).ok_or(unreadable)?;
    times.unit = Some(TimeUnit::Ns);
    times.push_integer(ns)
}

/// What separates the cells of this line. A comma between numbers that stand in blanks is a decimal comma.
fn delimiter(line: &str, decimal: Option<Decimal>) -> Delimiter {
    let several = |cell: &str| cell.split(' ').filter(|part| part.parse::<f64>().is_ok()).count() > 1;
    let found = match decimal {
        Some(Decimal::Comma) => Delimiter::detect(&line.replace(',', "")),
        _ => Delimiter::detect(line),
    };
    match found {
        Delimiter::Comma if decimal == Some(Decimal::Comma) => Delimiter::Semicolon,
        Delimiter::Comma if Delimiter::Comma.cells(line).any(several) => Delimiter::Blanks,
        found => found,
    }
}
