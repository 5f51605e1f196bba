//! Finds the time that a serial monitor or a logger writes in front of each line, and the words behind the time.

use super::dates::{self, DateFormat};
use std::ops::Range;
use zerorate_input::delimited::Delimiter;

/// The texts that serial monitors write behind the time of a line: those of Arduino, PlatformIO, and Tera Term, which
/// puts the time in brackets.
const ARROWS: [&str; 3] = [" -> ", " > ", "] "];

/// An arrow must begin before this byte of a line, and words in front of the values must end before it.
const LONGEST: usize = 60;

/// Least number of decimals of seconds in brackets, as the Linux kernel and ROS write them.
const DECIMALS: usize = 3;

/// The time in front of a line.
pub struct Stamp {
    pub time: Range<usize>,
    /// Offset of the end of the marks behind the time.
    pub end: usize,
    /// The name of the column of these times.
    pub name: &'static str,
}

/// Names for the column of times: of dates and times of day, of milliseconds, and of seconds.
const CLOCK: &str = "clock";
const CLOCK_MS: &str = "clock [ms]";
const CLOCK_S: &str = "clock [s]";

impl Stamp {
    /// Finds the time in front of a line, or behind the severity level of a message such as `[INFO]`.
    pub fn of(line: &str) -> Option<Self> {
        let level = level(line);
        let Self { time, end, name } = Self::at_start(&line[level..])?;
        Some(Self { time: level + time.start..level + time.end, end: level + end, name })
    }

    fn at_start(line: &str) -> Option<Self> {
        ARROWS.iter().find_map(|arrow| Self::with_arrow(line, arrow)).or_else(|| Self::of_esp(line)).or_else(|| {
            let (time, end) = Self::of_logger(line)?;
            Some(Self { time, end, name: CLOCK })
        })
    }

    fn with_arrow(line: &str, arrow: &str) -> Option<Self> {
        let end = line.find(arrow).filter(|end| *end < LONGEST)?;
        let start = usize::from(arrow == "] ");
        if start == 1 && !line.starts_with('[') {
            return None;
        }
        let time = line[start..end].trim_start();
        let decimals = time.split_once('.').filter(|_| start == 1 && time.parse::<f64>().is_ok());
        let name = match decimals {
            Some((_, decimals)) if decimals.len() >= DECIMALS => CLOCK_S,
            _ => dates::nanoseconds(&plain(time), DateFormat::default()).map(|_| CLOCK)?,
        };
        Some(Self { time: end - time.len()..end, end: end + arrow.len(), name })
    }

    /// The milliseconds since the start of an ESP32: `I (321) imu: `.
    fn of_esp(line: &str) -> Option<Self> {
        let rest = line.strip_prefix(['E', 'W', 'I', 'D', 'V'])?.strip_prefix(" (")?;
        let digits = rest.find(|c: char| !c.is_ascii_digit()).filter(|digits| *digits > 0)?;
        let is_whole = rest[digits..].starts_with(") ");
        is_whole.then_some(Self { time: 3..3 + digits, end: 3 + digits + 2, name: CLOCK_MS })
    }

    /// A date with a time of day, or a time of day, in front of words: `2026-03-01 12:00:00,125 - INFO - `. A date
    /// without a year, as in Android's logs, is not part of the result.
    fn of_logger(line: &str) -> Option<(Range<usize>, usize)> {
        let mut blanks = line.match_indices(' ').map(|(at, _)| at);
        let (first, second) = (blanks.next()?, blanks.next().unwrap_or(line.len()));
        let is_time = |place: &Range<usize>| {
            let time = &line[place.clone()];
            !time.ends_with(',') && dates::nanoseconds(&plain(time), DateFormat::default()).is_some()
        };
        let is_date = line[..first].bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
        let behind_date = Some(first + 1..second).filter(|_| is_date);
        let time = [0..second, 0..first].into_iter().chain(behind_date).find(is_time)?;
        let rest = line[time.end..].trim_start_matches([' ', '-']);
        let end = line.len() - rest.len();
        preamble(rest).map(|_| (time, end))
    }

    /// Erases the marks around the time of a line, makes the time one cell, and puts `delimiter` behind it.
    pub fn keep(&self, line: &mut [u8], delimiter: Delimiter) {
        line[..self.time.start].fill(b' ');
        line[self.time.end..self.end].fill(b' ');
        let time = &mut line[self.time.clone()];
        let has_point = time.contains(&b'.');
        if let Some(comma) = time.iter().position(|byte| *byte == b',') {
            time[comma] = if has_point { b' ' } else { b'.' };
            if has_point {
                time[comma..].rotate_left(1);
            }
        }
        let blank = time.iter().position(|byte| *byte == b' ').filter(|at| time[at + 1..].contains(&b':'));
        if let Some(blank) = blank.filter(|_| delimiter == Delimiter::Blanks) {
            time[blank] = b'T';
        }
        line[self.end - 1] = delimiter.byte().unwrap_or(b' ');
    }
}

/// Length in bytes of the severity level in front of a line, with its brackets and the blank behind it: `[INFO] `.
fn level(line: &str) -> usize {
    let level = line.strip_prefix('[').and_then(|rest| rest.split_once("] "));
    let is_word = |word: &str| !word.is_empty() && word.chars().all(char::is_alphabetic);
    level.filter(|(word, _)| is_word(word)).map_or(0, |(word, _)| word.len() + 3)
}

/// A time without the comma in front of its decimals or within them: `12:00:00.125` of `12:00:00,125`, and
/// `12:00:00.125250` of `12:00:00.125,250`.
fn plain(time: &str) -> String {
    time.replace(',', if time.contains('.') { "" } else { "." })
}

/// The words in front of the values of a row, or of its labels, with the mark behind them: `imu: `, `<inf> main: `,
/// `INFO - `, `Raw:`.
pub fn preamble(line: &str) -> Option<&str> {
    let marks = [": ", " - ", "> ", "] ", ":"];
    let ends = |mark: &str| line.match_indices(mark).map(move |(at, _)| at + mark.len()).collect::<Vec<usize>>();
    let mut ends: Vec<usize> = marks.iter().flat_map(|mark| ends(mark)).filter(|end| *end < LONGEST).collect();
    ends.sort_unstable();
    let is_preamble = |end: &usize| {
        let (words, rest) = (&line[..*end], line[*end..].trim_start());
        let begins = words.starts_with(|c: char| c.is_alphabetic() || "<[".contains(c));
        !words.contains([',', ';', '\t', '=']) && (begins && is_value(rest) || begins_with_label(rest))
    };
    Some(&line[..ends.into_iter().find(is_preamble)?])
}

fn begins_with_label(rest: &str) -> bool {
    rest.split_once([':', '=']).is_some_and(|(label, value)| {
        let is_word = label.starts_with(char::is_alphabetic) && !label.trim_end().contains([' ', ',', ';', '\t']);
        is_word && is_value(value.trim_start())
    })
}

/// True if a text begins as a number, `nan` or `null` does.
pub fn is_value(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit() || "+-.nN".contains(c))
}

/// Replaces the colours of a terminal in a text by blanks: `ESC [ 0 ; 32 m`. Other control sequences stay.
pub fn without_colours(text: &mut [u8]) {
    let mut at = 0;
    while let Some(start) = memchr::memmem::find(&text[at..], b"\x1b[").map(|found| at + found) {
        let rest = &text[start + 2..];
        let length = rest.iter().take_while(|byte| byte.is_ascii_digit() || **byte == b';').count();
        at = start + 2 + length;
        if text.get(at) == Some(&b'm') {
            text[start..=at].fill(b' ');
        }
    }
}
