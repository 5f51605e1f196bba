//! Reads the start of a text: lines printed before the data, a header of one or two lines, and the layout of the rows.

use super::super::number::{Number, Numerals};
use super::axes_in_name;
use super::dates::{DateColumn, DateFormat, nanoseconds};
use super::marks::{Marks, counts};
use super::scales::Scales;
use super::sentence;
use crate::error::{LogError, Result};
use crate::number::Decimal;
use crate::open::JSON;
use crate::options::ColumnOptions;
use crate::setting::{Names, Setting};
use std::path::Path;
use zerorate_input::delimited::Delimiter;
use zerorate_input::{InputError, TimeUnit, Unit};

/// Number of lines that are examined: more than a board prints while it starts.
const LINES: usize = 1000;

/// A line with its number, counted from 1.
type Numbered<'a> = (u64, &'a str);

#[derive(Clone, Debug, Default)]
pub struct Head {
    pub delimiter: Delimiter,
    pub width: usize,
    /// The names of the columns, or their numbers.
    pub names: Vec<String>,
    pub numeric: Vec<bool>,
    /// The facts about dates in each column without numbers.
    pub dates: Vec<DateColumn>,
    /// Number of lines before the first row.
    pub lines: u64,
    /// The lines of the header with their numbers: the names, and the units if they have a line of their own.
    pub header: Vec<(u64, String)>,
    /// The number of lines before the first row that are neither header nor comment, and the first of them.
    pub skipped: Option<(usize, String)>,
    /// The type of the sentences that are read, such as `$VNYMR`; `None` in a log without sentences.
    pub sentence: Option<String>,
    /// The delimiter of the lines between stamps; `None` if stamps have no lines of their own.
    pub stamps: Option<u8>,
    pub marks: Marks,
    /// The decimal mark, if it was given or the first lines of the text show it.
    pub decimal: Option<Decimal>,
    /// True if commas seem to be decimal marks as well as delimiters, because a cell is `-0` or looks like decimals
    /// (`05`).
    cuts_numbers: bool,
    /// True if the first cell of a row is an index, which has no name.
    pub index: bool,
    pub scales: Scales,
    /// The first cell that begins as a number does and is neither a number nor a time.
    unread: Option<String>,
    pub open: Open,
}

/// A question that the first lines leave open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Open {
    #[default]
    Nothing,
    /// The header has one name less than the rows have cells.
    OneNameLess,
    /// The rows may be two columns of integers without names, or one column with decimal commas.
    TwoOrDecimals,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    delimiter: Delimiter,
    width: usize,
}

/// True for a comment, and for a rule between the header and the rows of a table: `|---|---|`.
pub fn is_comment(line: &str) -> bool {
    let is_rule = || line.contains("---") && line.bytes().all(|byte| b"|-+: ".contains(&byte));
    line.starts_with(['#', '%']) || line.starts_with(['|', '+', '-']) && is_rule()
}

pub fn not_text(path: &Path, names: Names) -> LogError {
    let what = format!("it is not UTF-8 text; raw numbers need their type ({})", names.of(Setting::Raw));
    InputError::damaged(path, "as a text file", what).into()
}

impl Head {
    /// The head of a text that begins with its first row, and whose columns all hold numbers.
    fn new(delimiter: Delimiter, names: Vec<String>) -> Self {
        let (numeric, dates) = (vec![true; names.len()], vec![DateColumn::default(); names.len()]);
        Self { delimiter, width: names.len(), numeric, dates, names, ..Self::default() }
    }

    /// Reads the head from `text`, the lines with which the file begins.
    pub fn read(path: &Path, text: &str, marks: &Marks, args: &ColumnOptions) -> Result<Self> {
        check_line_ends(path, text)?;
        let lines = text.lines().zip(1..).map(|(line, number)| (number, line.trim_ascii()));
        let lines = lines.map(|(number, line)| (number, line.strip_prefix('\u{FEFF}').unwrap_or(line)));
        let lines: Vec<Numbered<'_>> = lines.filter(|(_, line)| !line.is_empty()).take(LINES).collect();
        let sentence = sentence::most(lines.iter().map(|(_, line)| *line));
        let lines = lines.into_iter().filter(|(_, line)| !sentence::is_other(line, sentence.as_deref()));
        let lines = lines.map(|(number, line)| (number, sentence::without_end(line)));
        let (comments, lines): (Vec<_>, Vec<_>) = lines.partition(|(_, line)| is_comment(line));
        if lines.is_empty() {
            return Err(InputError::damaged(path, "as a text file", "it holds no line of data").into());
        }
        let Some(shape) = Shape::most(&lines, args.decimal) else {
            return Self::without_rows(path, &lines, text.lines().count() as u64, args);
        };
        let rows = Rows::of(shape, &lines, args.decimal);
        let (above, data) = lines.split_at(rows.first);
        let start = data.first().map_or(0, |(number, _)| *number);
        let comments: Vec<&str> =
            comments.iter().take_while(|(number, _)| *number < start).map(|(_, line)| *line).collect();
        let mut head = Self {
            numeric: rows.numeric,
            dates: rows.dates,
            lines: start.saturating_sub(1),
            sentence,
            marks: marks.clone(),
            decimal: rows.decimal,
            cuts_numbers: rows.cuts_numbers,
            unread: rows.unread,
            ..Self::new(shape.delimiter, (0..shape.width).map(|number| number.to_string()).collect())
        };
        let end = head.names_end(above);
        let (used, is_named) = head.name_by_marks(path, &above[..end], &comments)?;
        axes_in_name::spread(&mut head.names);
        if !is_named && rows.all_are_cut {
            return Err(InputError::damaged(path, format!("line {start}"), CLASH).into());
        }
        head.header = above[end - used..end].iter().map(|(number, line)| (*number, (*line).to_owned())).collect();
        head.skip(&[&above[..end - used], &above[end..]].concat(), &comments);
        let undecided = args.decimal.is_none() && shape == Shape { delimiter: Delimiter::Comma, width: 2 };
        if !is_named && undecided && rows.all_integers {
            head.open = Open::TwoOrDecimals;
        }
        Ok(head)
    }

    /// Reads scales from the comments and from the lines above the data that are not a header. Counts the lines that
    /// are not comments as skipped, unless they are Gyroflow's.
    fn skip(&mut self, skipped: &[Numbered<'_>], comments: &[&str]) {
        let lines = skipped.iter().map(|(_, line)| *line).chain(comments.iter().copied());
        self.scales = Scales::of(lines, &self.names);
        if !self.scales.are_of_gyroflow() {
            self.skipped = skipped.first().map(|(_, line)| (skipped.len(), shortened(line)));
        }
    }

    /// The head of a file with a header and no rows, as in a log that was just begun. Returns an error for any other
    /// file.
    fn without_rows(path: &Path, seen: &[Numbered<'_>], lines: u64, args: &ColumnOptions) -> Result<Self> {
        let (first, some) = (seen[0].1, seen.len());
        let delimiter = delimiter(first, args.decimal);
        let names: Vec<String> = delimiter.cells(first).map(str::to_owned).collect();
        let is_text = !first.contains(['\0', '\u{FFFD}']);
        if some == 1 && is_text && delimiter != Delimiter::Blanks {
            return Ok(Self { lines, ..Self::new(delimiter, names) });
        }
        if args.decimal == Some(Decimal::Comma) && first.contains(',') {
            return Err(InputError::damaged(path, "as a text file", CLASH).into());
        }
        if !is_text {
            return Err(not_text(path, args.names));
        }
        if first.starts_with("{\"") {
            return Err(InputError::not_a_log(path, JSON).into());
        }
        let has_digit = |text: &&str| text.contains(|c: char| c.is_ascii_digit());
        let row = seen.iter().map(|(_, line)| *line).find(has_digit).unwrap_or(first);
        let cell = delimiter.cells(row).find(|cell| *cell != row && has_digit(cell));
        let remedy =
            cell.and_then(|cell| Numerals::new(None).read(cell, 0).err()?.split_once(';').map(|it| it.1.to_owned()));
        let remedy = remedy.map_or_else(String::new, |remedy| format!(";{remedy}"));
        let why = cell.map(|cell| format!(": `{}` is not one{remedy}", shortened(cell))).unwrap_or_default();
        let line = shortened(row);
        let what = format!("none of its first {some} lines has a cell that is a number (`{line}`{why}): is it a log?");
        Err(InputError::damaged(path, "as a text file", what).into())
    }

    /// Takes the names from the labels of the values, or else from the lines above the data, the comments, or the
    /// fields of a ROS message. Returns the number of lines used, and false if the names are from comments or are
    /// numbers.
    fn name_by_marks(&mut self, path: &Path, above: &[Numbered<'_>], comments: &[&str]) -> Result<(usize, bool)> {
        if let Some(labels) = self.marks.names().filter(|names| names.len() == self.width) {
            self.names = labels;
            return Ok((0, true));
        }
        let used = self.name(path, above, comments)?;
        let first = self.marks.first().filter(|first| used > 0 || TimeUnit::of_column(first).is_some());
        if let Some(first) = first {
            first.clone_into(&mut self.names[0]);
        } else if used == 0 && comments.is_empty() && self.are_of_ros() {
            self.names = ros_names();
            return Ok((0, true));
        }
        Ok((used, used > 0))
    }

    /// Number of lines above the data, without broken rows right below the names, and without the messages that a
    /// board may print between its header and first row.
    fn names_end(&self, above: &[Numbered<'_>]) -> usize {
        let cells = |line: &str| self.delimiter.cells(line).map(str::to_owned).collect::<Vec<_>>();
        let is_spoken = above.last().is_some_and(|(_, line)| cells(line).len() == 1);
        let are_names = |(_, line): &Numbered<'_>| are_names(&cells(line), self.width);
        let is_cut = self.delimiter != Delimiter::Blanks && self.width > 1;
        let is_row = |(_, line): &Numbered<'_>| starts_row(&cells(line));
        let rest = above.iter().rposition(|line| !is_row(line)).map_or(0, |at| at + 1);
        // a logger may put the time in front of its header as well
        if is_cut && rest > 0 && are_names(&above[rest - 1]) && self.marks.first().is_none() {
            return rest;
        }
        let names = above.iter().rposition(are_names).filter(|_| is_cut && is_spoken);
        names.map_or(above.len(), |names| names + 1)
    }

    /// True if the columns are those of `ros2 topic echo --csv` of a `sensor_msgs/Imu`: numbers, and the frame name.
    fn are_of_ros(&self) -> bool {
        let is_expected = |(at, is_numeric): (usize, &bool)| *is_numeric == (at != FRAME);
        self.delimiter == Delimiter::Comma
            && self.width == ros_names().len()
            && self.numeric.iter().enumerate().all(is_expected)
    }

    /// Takes the names from the lines above the data, or from the comments there. Returns the number of lines used.
    fn name(&mut self, path: &Path, above: &[Numbered<'_>], comments: &[&str]) -> Result<usize> {
        let cells = |line: &str| self.delimiter.cells(line).map(str::to_owned).collect::<Vec<_>>();
        let Some((number, last)) = above.last() else {
            let fit = |names: &Vec<String>| names.len() == self.width && names.iter().all(|cell| is_word(cell));
            // if blanks separate cells, a comment may be a sentence, so only the last comment may hold names
            let looked_at = if self.delimiter == Delimiter::Blanks { 1 } else { comments.len() };
            let comments = comments.iter().rev().take(looked_at);
            let mut named = comments.map(|line| cells(line.trim_start_matches(['#', '%', ' ']))).filter(fit);
            if let Some(names) = named.next().filter(|names| names.len() > 1) {
                self.names = names;
            }
            return Ok(0);
        };
        let cells = |line: &str| {
            let mut cells = cells(line);
            // a line that ends with a delimiter has no further name, and LabVIEW writes no cell for an empty comment
            let is_void = |cell: &String| cell.is_empty() || cell == "Comment";
            while cells.len() > self.width && cells.last().is_some_and(is_void) {
                cells.pop();
            }
            cells
        };
        let names = cells(last);
        let before = above.len().checked_sub(2).map(|at| cells(above[at].1));
        if names.len() == self.width && is_numbered(&names) {
            self.names = names;
            return Ok(1);
        }
        if !names.iter().all(|cell| is_word(cell) || cell.is_empty()) && names.len() != self.width {
            return Ok(0);
        }
        let is_cut = self.delimiter != Delimiter::Blanks && names.len() > 1;
        let is_name = names.len() > 1 || !names[0].contains(' ') || names[0].contains(['[', '(']);
        match names.len() {
            width if width == self.width => {
                let are_alike =
                    |above: &Vec<String>| above.iter().zip(&names).all(|(n, unit)| !n.is_empty() || unit.is_empty());
                let units =
                    before.filter(|above| are_names(above, self.width) && are_alike(above) && state_units(&names));
                let used = 1 + usize::from(units.is_some());
                self.names = units.map_or(names.clone(), |above| with_units(&above, &names));
                Ok(used)
            }
            width if width + 1 == self.width && is_name => {
                (self.names, self.open) = (names, Open::OneNameLess);
                Ok(1)
            }
            width if is_cut => Err(self.miscounted(path, *number, width)),
            _ => Ok(0),
        }
    }

    pub fn miscounted(&self, path: &Path, line: u64, names: usize) -> LogError {
        let Self { delimiter, width, decimal, cuts_numbers, .. } = *self;
        let is_cut = delimiter == Delimiter::Comma && decimal.is_none();
        let why = match is_cut && names > 1 && (cuts_numbers || width == 2 * names) {
            true => CLASH,
            false => "give each column a name, or remove the header",
        };
        let what = format!("the header has {names} names, and the rows below have {width} cells; {why}");
        InputError::damaged(path, format!("line {line}"), what).into()
    }

    /// Adds to a question about columns why the cells are not numbers, if at most one column, the time, holds numbers.
    pub fn with_reason(&self, question: LogError) -> LogError {
        let cell = self.unread.as_ref().filter(|_| self.numeric.iter().filter(|numeric| **numeric).count() < 2);
        match (question, cell.and_then(|cell| Numerals::new(None).read(cell, 0).err())) {
            (LogError::Ask(question), Some(why)) => LogError::Ask(format!("{why}. {question}")),
            (question, _) => question,
        }
    }

    /// True if commas seem to be decimal marks as well as delimiters, in a text whose header has one name too few.
    pub fn has_clash(&self) -> bool {
        self.cuts_numbers && self.names.len() > 1
    }
}

fn check_line_ends(path: &Path, text: &str) -> Result<(), InputError> {
    if text.contains('\r') && !text.contains('\n') {
        let what = "its lines end with a carriage return alone; convert it with `tr '\\r' '\\n' < FILE`";
        return Err(InputError::damaged(path, "as a text file", what));
    }
    Ok(())
}

/// The index of the frame name among the fields of a `sensor_msgs/Imu`.
const FRAME: usize = 2;

/// The fields of a `sensor_msgs/Imu` in their order.
fn ros_names() -> Vec<String> {
    let header = ["header.stamp.sec", "header.stamp.nanosec", "header.frame_id"].map(str::to_owned);
    let vector = |name: &str, axes: &[&str]| {
        let numbers = axes.iter().map(|axis| format!("{name}.{axis}")).collect::<Vec<String>>();
        numbers.into_iter().chain((0..9).map(|at| format!("{name}_covariance.{at}"))).collect::<Vec<String>>()
    };
    let orientation = vector("orientation", &["x", "y", "z", "w"]);
    let vectors = ["angular_velocity", "linear_acceleration"].map(|name| vector(name, &["x", "y", "z"]));
    header.into_iter().chain(orientation).chain(vectors.concat()).collect()
}

/// The delimiter of the other lines, if nearly every second line is a single number, the stamp of the line below it.
pub fn stamps(text: &str) -> Option<u8> {
    let lines = text.lines().map(str::trim_ascii).filter(|line| !line.is_empty() && !is_comment(line)).take(LINES);
    let shapes: Vec<Shape> = lines.filter_map(|line| Shape::of(line, None)).collect();
    let is_stamp = |shape: &Shape| shape.width == 1;
    let delimiter = shapes.iter().find(|shape| !is_stamp(shape))?.delimiter;
    let pairs = shapes.windows(2).filter(|pair| is_stamp(&pair[0]) != is_stamp(&pair[1])).count();
    let of_one = shapes.iter().all(|shape| is_stamp(shape) || shape.delimiter == delimiter);
    let alternate = shapes.len() >= 6 && pairs * 10 >= (shapes.len() - 1) * 9 && of_one;
    alternate.then(|| delimiter.byte().unwrap_or(b' '))
}

/// The error for a file whose commas are decimal marks as well as delimiters.
const CLASH: &str = "decimal commas and comma separators clash in this file. Export it with \";\" or with decimal \
                     points";

impl Shape {
    /// The shape of a line that holds a number.
    fn of(line: &str, decimal: Option<Decimal>) -> Option<Self> {
        let delimiter = delimiter(line, decimal);
        let cells: Vec<&str> = delimiter.cells(line).collect();
        cells.iter().any(|cell| is_number(cell)).then_some(Self { delimiter, width: cells.len() })
    }

    /// The most frequent shape of these lines; among equally frequent ones, the first.
    fn most(lines: &[Numbered<'_>], decimal: Option<Decimal>) -> Option<Self> {
        let votes = counts(lines.iter().filter_map(|(_, line)| Self::of(line, decimal)));
        let (shape, _) = votes.into_iter().rev().max_by_key(|(_, count)| *count)?;
        // a single column needs no separator, so a comma in it is a decimal comma
        let is_one = shape == Self { delimiter: Delimiter::Comma, width: 1 };
        Some(if is_one { Self { delimiter: Delimiter::Semicolon, ..shape } } else { shape })
    }
}

/// The facts from the lines of the most common shape: the first row, the columns of numbers, and the decimal mark.
struct Rows {
    /// Index of the first line that is not a header.
    first: usize,
    numeric: Vec<bool>,
    dates: Vec<DateColumn>,
    all_integers: bool,
    decimal: Option<Decimal>,
    /// True if commas delimit and may have cut numbers: no cell has a decimal mark, and one is `-0` or looks like
    /// decimals (`05`).
    cuts_numbers: bool,
    /// True if every second cell looks like the decimals of the cell before.
    all_are_cut: bool,
    unread: Option<String>,
}

impl Rows {
    fn of(shape: Shape, lines: &[Numbered<'_>], decimal: Option<Decimal>) -> Self {
        let rows: Vec<Vec<&str>> = lines.iter().map(|(_, line)| shape.delimiter.cells(line).collect()).collect();
        let fits = |row: &&Vec<&str>| row.len() == shape.width;
        let count = |at: usize, what: fn(&str) -> bool| rows.iter().filter(fits).filter(|row| what(row[at])).count();
        let there = rows.iter().filter(fits).count();
        let numeric = |at: usize| match (count(at, is_number), count(at, is_word)) {
            // a column that is empty, apart from a name, counts as numeric
            (0, words) => words == 0 || words == 1 && there > 1,
            (numbers, words) => words <= numbers,
        };
        let numeric: Vec<bool> = (0..shape.width).map(numeric).collect();
        let is_data = |row: &Vec<&str>| fits(&row) && row.iter().zip(&numeric).all(|(cell, n)| !n || !is_word(cell));
        let with_number = |row: &Vec<&str>| is_data(row) && row.iter().any(|cell| is_number(cell));
        // a row of words is a header, even if each column also holds words
        let is_title = |row: &[&str]| is_numbered(row) || row.len() > 1 && row.iter().all(|cell| is_word(cell));
        let found = rows.iter().position(with_number).unwrap_or_default();
        let above = rows[..found].iter().rev().take_while(|row| is_data(row) && !is_title(row)).count();
        let first = found - above;
        let mut learned = [0usize; 2];
        for cell in rows[first..].iter().filter(fits).flatten() {
            match mark(cell) {
                Some(Decimal::Point) => learned[0] += 1,
                Some(Decimal::Comma) => learned[1] += 1,
                None => {}
            }
        }
        let learned = match learned {
            [0, 0] => None,
            [points, commas] => Some(if points >= commas { Decimal::Point } else { Decimal::Comma }),
        };
        let integer = |cell: &&str| cell.parse::<i64>().is_ok();
        let first = first + usize::from(is_numbered(&rows[first]) && rows.len() > first + 1);
        let data = || rows[first..].iter().filter(fits);
        let dates = numeric.iter().enumerate().map(|(at, is_numeric)| match is_numeric {
            true => DateColumn::default(),
            false => DateColumn::of(data().map(|row| row[at])),
        });
        let dates = dates.collect();
        let all_integers = rows[first..].iter().flatten().all(integer);
        let is_cut = shape.delimiter == Delimiter::Comma && learned.is_none();
        let cuts_numbers = is_cut && data().flatten().any(|cell| is_rest_of_number(cell) || *cell == "-0");
        let are_pairs = |row: &Vec<&str>| {
            row.iter().enumerate().all(|(at, cell)| match at % 2 {
                0 => integer(cell) && !is_rest_of_number(cell),
                _ => !cell.is_empty() && cell.bytes().all(|byte| byte.is_ascii_digit()),
            })
        };
        let is_even = shape.width >= 4 && shape.width.is_multiple_of(2);
        let all_are_cut = is_even && cuts_numbers && data().all(are_pairs);
        let unread = data().flatten().find(|cell| is_unread(cell)).map(|cell| (*cell).to_owned());
        Self { first, numeric, dates, all_integers, decimal: decimal.or(learned), cuts_numbers, all_are_cut, unread }
    }
}

/// True if a cell begins as a number does, and is neither a number nor a time.
fn is_unread(cell: &str) -> bool {
    let begins = cell.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit());
    begins && is_word(cell) && nanoseconds(cell, DateFormat::default()).is_none()
}

/// True if the names are an empty one and then 0, 1, 2 …, as pandas writes them.
fn is_numbered<T: AsRef<str>>(row: &[T]) -> bool {
    let are_counted = || row[1..].iter().zip(0..).all(|(cell, at)| cell.as_ref().parse() == Ok(at));
    row.len() > 1 && row[0].as_ref().is_empty() && are_counted()
}

/// True if a cell may be the decimals of a number that was cut at its comma: `05` of `0,05`.
fn is_rest_of_number(cell: &str) -> bool {
    cell.len() > 1 && cell.starts_with('0') && cell.bytes().all(|byte| byte.is_ascii_digit())
}

fn mark(cell: &str) -> Option<Decimal> {
    let mut numerals = Numerals::new(None);
    numerals.read(cell, 0).ok().and(numerals.decimal())
}

fn is_number(cell: &str) -> bool {
    Numerals::new(None).read(cell, 0).is_ok_and(Number::is_there)
}

pub fn is_word(cell: &str) -> bool {
    Numerals::new(None).read(cell, 0).is_err()
}

fn are_names(cells: &[String], width: usize) -> bool {
    cells.len() == width && cells.iter().all(|cell| is_word(cell) || cell.is_empty())
}

/// True if cells begin as a row does, with a number or a time. A line of units may begin with a 1, too.
fn starts_row(cells: &[String]) -> bool {
    let is_time = |cell: &String| nanoseconds(cell, DateFormat::default()).is_some();
    cells.len() > 1
        && cells.first().is_some_and(|cell| is_number(cell) || is_time(cell))
        && !state_units(cells)
        && !cells.iter().any(|cell| Unit::of_column(cell).is_some())
}

/// True if these are the units under a line of names.
fn state_units(cells: &[String]) -> bool {
    cells.iter().any(|cell| {
        let named = format!("x [{}]", bare(cell));
        Unit::of_column(&named).is_some() || TimeUnit::of_column(&named).is_some()
    })
}

fn with_units(names: &[String], units: &[String]) -> Vec<String> {
    let named = |(name, unit): (&String, &String)| match bare(unit) {
        "" => name.clone(),
        unit => format!("{name} [{unit}]"),
    };
    names.iter().zip(units).map(named).collect()
}

fn bare(unit: &str) -> &str {
    let unit = unit.trim();
    let inner = |open, close| unit.strip_prefix(open)?.strip_suffix(close);
    inner('[', ']').or_else(|| inner('(', ')')).unwrap_or(unit).trim()
}

/// The first 60 characters of a line, escaped for a message.
pub fn shortened(line: &str) -> String {
    const MOST: usize = 60;
    match line.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", line[..end].escape_debug()),
        None => line.escape_debug().to_string(),
    }
}

/// The delimiter of the cells of this line. If commas leave several numbers in one cell, blanks are the delimiter and
/// commas are decimal.
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
