//! Erases marks that a serial monitor, a logger or a sketch writes between the numbers: an arrow behind the time of a
//! line, and a label in front of each value. Blanks replace the marks before lines are cut into cells.

use super::json_lines;
use super::stamp::{Stamp, is_value, preamble, without_colours};
use std::borrow::Cow;
use std::ops::Range;
use zerorate_input::delimited::Delimiter;
use zerorate_input::{Quantity, TimeUnit};

/// Number of lines that are examined, and least number of lines that must show a mark.
const LINES: usize = 1000;
const FEWEST: usize = 3;

/// The marks in most lines of a text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// True if the lines contain colour codes of a terminal.
    colours: bool,
    /// The delimiter that replaces the text behind the time of a line, and the name of the column of times. An example
    /// of such a text is the arrow in `15:23:45.000 -> 0.5,0.25`.
    stamp: Option<(Delimiter, &'static str)>,
    /// The labels of the values, in order, and the delimiter behind values: `gx:0.5,gy:0.25` or `gx=0.5 gy=0.25`.
    labels: Option<(Delimiter, Vec<String>)>,
    /// The words in front of all values of a row: `Raw:` in `Raw:1,2,3`.
    words: Option<String>,
    /// True if rows are in brackets: `(0.5, 0.25)`.
    brackets: bool,
    /// The names of the values, if lines are JSON objects.
    json: Option<Vec<String>>,
}

impl Marks {
    pub fn of(text: &str) -> Self {
        let colours = text.contains('\x1b');
        let text = if colours { Cow::Owned(plain(text)) } else { Cow::Borrowed(text) };
        let lines: Vec<&str> = text.lines().map(str::trim_ascii).filter(|line| !line.is_empty()).take(LINES).collect();
        let are_most = |count: usize| count * 2 > lines.len() && count >= FEWEST;
        let json = most(lines.iter().filter_map(|line| json_lines::names(line)));
        if let Some((names, _)) = json.filter(|(_, count)| are_most(*count)) {
            return Self { json: Some(names), ..Self::default() };
        }
        let stamps: Vec<(&str, Stamp)> = lines.iter().filter_map(|line| Some((*line, Stamp::of(line)?))).collect();
        let has_stamps = are_most(stamps.len());
        let rests: Vec<&str> = match has_stamps {
            true => stamps.iter().map(|(line, stamp)| &line[stamp.end..]).collect(),
            false => lines.clone(),
        };
        let labelled = |rests: &[&str]| {
            let labels = most(rests.iter().filter_map(|rest| {
                let delimiter = Delimiter::detect(rest);
                let labels = labels(rest, delimiter)?;
                Some((delimiter, labels.iter().map(|label| label.name(rest)).collect::<Vec<String>>()))
            }));
            labels.filter(|(_, count)| are_most(*count)).map(|(labels, _)| labels)
        };
        let words = most(rests.iter().filter_map(|rest| preamble(rest)));
        let words = words.filter(|(_, count)| are_most(*count)).map(|(words, _)| words);
        let without = |words: Option<&str>| -> Vec<&str> {
            rests.iter().map(|rest| words.and_then(|of| rest.strip_prefix(of)).unwrap_or(rest)).collect()
        };
        // words with a colon at their end may be the first label; words with a dash there are not
        let is_label = words.is_some_and(|words| words.trim_end().ends_with(':')) && labelled(&rests).is_some();
        let words = words.filter(|_| !is_label);
        let rests = without(words);
        let delimiter = most(rests.iter().map(|rest| Delimiter::detect(rest))).map(|(delimiter, _)| delimiter);
        let name = most(stamps.iter().map(|(_, stamp)| stamp.name)).filter(|_| has_stamps).map(|(name, _)| name);
        let brackets = are_most(lines.iter().filter(|line| are_in_brackets(line)).count());
        Self {
            colours,
            stamp: delimiter.zip(name),
            labels: labelled(&rests),
            words: words.map(str::to_owned),
            brackets,
            json: None,
        }
    }

    /// The names of the cells according to the labels or the JSON objects; `None` without them.
    pub fn names(&self) -> Option<Vec<String>> {
        if self.json.is_some() {
            return self.json.clone();
        }
        let (_, labels) = self.labels.as_ref()?;
        Some(self.first().map(str::to_owned).into_iter().chain(labels.iter().cloned()).collect())
    }

    /// The name of the first cell, if it is the time in front of a line.
    pub fn first(&self) -> Option<&'static str> {
        self.stamp.map(|(_, name)| name)
    }

    pub fn are_there(&self) -> bool {
        *self != Self::default()
    }

    /// Replaces the marks in whole lines by blanks. Labels that differ from the usual ones stay, so that their line
    /// counts as broken.
    pub fn erase(&self, lines: &mut [u8]) {
        if self.are_there() {
            lines.split_mut(|byte| *byte == b'\n').for_each(|line| self.erase_in(line));
        }
    }

    fn erase_in(&self, line: &mut [u8]) {
        if let Some(names) = &self.json {
            return json_lines::erase(line, names);
        }
        if self.colours {
            without_colours(line);
        }
        let start = line.len() - line.trim_ascii_start().len();
        let line = &mut line[start..];
        let Ok(text) = std::str::from_utf8(line) else { return };
        if self.brackets && are_in_brackets(text.trim_ascii()) {
            let end = text.trim_ascii_end().len();
            line[0] = b' ';
            line[end - 1] = b' ';
            return;
        }
        let stamp = self.stamp.and_then(|(delimiter, _)| Some((delimiter, Stamp::of(text)?)));
        let behind = stamp.as_ref().map_or(0, |(_, stamp)| stamp.end);
        let words = self.words.as_deref().filter(|words| text[behind..].starts_with(words));
        let start = behind + words.map_or(0, str::len);
        let rest = &text[start..];
        let labels = self.labels.as_ref().and_then(|(delimiter, wanted)| {
            let labels = labels(rest, *delimiter)?;
            labels.iter().map(|label| label.name(rest)).eq(wanted.iter().cloned()).then_some(labels)
        });
        let stamp = stamp.filter(|(delimiter, _)| has_cells(rest, *delimiter));
        line[behind..start].fill(b' ');
        if let Some((labels, (delimiter, _))) = labels.zip(self.labels.as_ref()) {
            erase_labels(&mut line[start..], &labels, *delimiter);
        }
        if let Some((delimiter, stamp)) = stamp {
            stamp.keep(line, delimiter);
        }
    }
}

fn plain(text: &str) -> String {
    let mut bytes = text.as_bytes().to_vec();
    without_colours(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

fn erase_labels(line: &mut [u8], labels: &[Label], delimiter: Delimiter) {
    for Label { name, unit } in labels {
        let mark = line[name.end..].iter().position(|byte| matches!(byte, b':' | b'='));
        line[name.start..=name.end + mark.unwrap_or_default()].fill(b' ');
        line[unit.clone()].fill(b' ');
    }
    let end = line.trim_ascii_end().len();
    if let Some(last) = line[..end].last_mut().filter(|last| Some(**last) == delimiter.byte()) {
        *last = b' ';
    }
}

fn are_in_brackets(line: &str) -> bool {
    line.len() > 1 && line.starts_with(['(', '[']) && line.ends_with([')', ']'])
}

/// True if a line may hold values. Most messages that a board prints when it starts cannot.
fn has_cells(line: &str, delimiter: Delimiter) -> bool {
    delimiter.byte().is_none_or(|byte| line.contains(char::from(byte))) || is_value(line)
}

/// The place of a label, and the place of the unit behind the value, which may be empty.
struct Label {
    name: Range<usize>,
    unit: Range<usize>,
}

impl Label {
    /// The name of the column: `gx [deg/s]` of `gx: 0.5 deg/s`.
    fn name(&self, line: &str) -> String {
        let name = line[self.name.clone()].to_owned();
        if self.unit.is_empty() { name } else { format!("{name} [{}]", &line[self.unit.clone()]) }
    }
}

/// The labels, if each value of a line has one.
fn labels(line: &str, delimiter: Delimiter) -> Option<Vec<Label>> {
    let is_end = |c: char| delimiter.byte().map_or(c.is_ascii_whitespace(), |byte| c == char::from(byte));
    let word = |from: usize| {
        let start = from + (line[from..].len() - line[from..].trim_start_matches(' ').len());
        start..start + line[start..].find(|c| is_end(c) || c == ' ').unwrap_or(line.len() - start)
    };
    let mut labels = Vec::new();
    let mut at = 0;
    while !line[at..].trim().is_empty() {
        let mark = at + line[at..].find([':', '='])?;
        let label = line[at..mark].trim();
        let start = at + line[at..].len() - line[at..].trim_start().len();
        let is_label =
            label.starts_with(char::is_alphabetic) && (delimiter == Delimiter::Blanks || !label.contains(is_end));
        let value = word(mark + 1);
        let unit = Some(word(value.end)).filter(|unit| is_unit(&line[unit.clone()])).unwrap_or(value.end..value.end);
        let end = unit.end + line[unit.end..].find(is_end).unwrap_or(line.len() - unit.end);
        if !is_label || !is_value(&line[value]) || !line[unit.end..end].trim().is_empty() {
            return None;
        }
        labels.push(Label { name: start..start + label.len(), unit });
        at = line.len().min(end + 1);
    }
    (!labels.is_empty()).then_some(labels)
}

fn is_unit(word: &str) -> bool {
    let named = format!("x [{word}]");
    Quantity::of_column(&named).is_some() || TimeUnit::of_column(&named).is_some()
}

fn most<T: PartialEq>(all: impl Iterator<Item = T>) -> Option<(T, usize)> {
    counts(all).into_iter().max_by_key(|(_, count)| *count)
}

/// Each different item with its number, in the order in which they first come.
pub fn counts<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<(T, usize)> {
    let mut counts: Vec<(T, usize)> = Vec::new();
    for one in all {
        match counts.iter_mut().find(|(other, _)| *other == one) {
            Some((_, count)) => *count += 1,
            None => counts.push((one, 1)),
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Erases marks from a text that repeats `line`. Returns the names in the labels, and a line of cells.
    fn erased(line: &str) -> (Option<Vec<String>>, String) {
        let mut bytes = format!("ready\n{line}\n{line}\n{line}\n{line}").into_bytes();
        let marks = Marks::of(std::str::from_utf8(&bytes).unwrap());
        marks.erase(&mut bytes);
        let text = String::from_utf8(bytes).unwrap();
        let line = text.lines().nth(1).unwrap();
        let cells: Vec<&str> = Delimiter::detect(line).cells(line.trim()).collect();
        (marks.names(), cells.join("|"))
    }

    #[test]
    fn arrows_and_labels_are_erased() {
        for (line, names, cells) in [
            ("15:23:45.000 -> 0.5,-0.25", "", "15:23:45.000|0.5|-0.25"),
            ("15:23:45.000 -> 0.5 -0.25", "", "15:23:45.000|0.5|-0.25"),
            ("15:23:45.000 -> 0.5", "", "15:23:45.000|0.5"),
            ("15:23:45.000 -> gx:0.5,gy:-.25", "clock gx gy", "15:23:45.000|0.5|-.25"),
            ("15:23:45.000 -> gx: 0.5 gy: -.25", "clock gx gy", "15:23:45.000|0.5|-.25"),
            ("gx:0.5,gy:-.25", "gx gy", "0.5|-.25"),
            ("t=1 gx=0.5 gy=-.25", "t gx gy", "1|0.5|-.25"),
            ("gx(°/s): 0.5\tgy(°/s): -.25", "gx(°/s) gy(°/s)", "0.5|-.25"),
            ("gx = 0.5; gy = -.25;", "gx gy", "0.5|-.25"),
            ("(0.5, -.25)", "", "0.5|-.25"),
            ("15:23:45.000 > 0.5,-0.25", "", "15:23:45.000|0.5|-0.25"),
            ("[15:23:45.000] 0.5,-0.25", "", "15:23:45.000|0.5|-0.25"),
            ("[2024-01-01 12:00:00.010] 0.5,-0.25", "", "2024-01-01 12:00:00.010|0.5|-0.25"),
            ("Raw:1,2,-3", "", "1|2|-3"),
            ("I (321) imu: gx: 0.5 gy: -.25", "clock [ms] gx gy", "321|0.5|-.25"),
            ("\x1b[0;32mI (321) imu: gx=0.5, gy=-.25\x1b[0m", "clock [ms] gx gy", "321|0.5|-.25"),
            ("I (321) imu: 0.5, -.25", "", "321|0.5|-.25"),
            ("[00:00:01.125,250] <inf> main: gx:0.5 gy:-.25", "clock gx gy", "00:00:01.125250|0.5|-.25"),
            ("<info> app: gx: 0.5, gy: -.25", "gx gy", "0.5|-.25"),
            ("[   12.345678] imu: gx=0.5 gy=-.25", "clock [s] gx gy", "12.345678|0.5|-.25"),
            ("2026-03-01 12:00:00,125 - INFO - gx=0.5 gy=-.25", "clock gx gy", "2026-03-01T12:00:00.125|0.5|-.25"),
            ("12:00:00.125 INFO: 0.5 -.25", "", "12:00:00.125|0.5|-.25"),
            ("[INFO] [1770000000.125] [imu]: gx: 0.5 gy: -.25", "clock [s] gx gy", "1770000000.125|0.5|-.25"),
            ("03-01 12:00:00.125  1234  1250 I IMU     : gx=0.5 gy=-.25", "clock gx gy", "12:00:00.125|0.5|-.25"),
            ("Gyro(dps): 0.5, 2", "", "0.5|2"),
            ("at: 15:23:45, gx: 1", "at gx", "15:23:45|1"),
        ] {
            let names = Some(names.replace("clock [", "clock_[")).filter(|names| !names.is_empty());
            let names = names.map(|names| names.split(' ').map(|name| name.replace('_', " ")).collect());
            assert_eq!(erased(line), (names, cells.to_owned()), "{line}");
        }
        for line in ["t: 10 ms gx: 0.5 °/s ax: -.25 g", "t: 10 ms, gx: 0.5 °/s, ax: -.25 g"] {
            let names = ["t [ms]", "gx [°/s]", "ax [g]"].map(str::to_owned).to_vec();
            assert_eq!(erased(line), (Some(names), "10|0.5|-.25".to_owned()), "{line}");
        }
        assert_eq!(erased("Gyro X: 1 Gyro Y: 2").0.unwrap(), ["Gyro X", "Gyro Y"]);
    }

    #[test]
    fn other_lines_are_left() {
        for line in ["0.5,-0.25", "a -> 1,2", "00:1B:44 -> x", "gx:0.5,-.25", "12:00:00,1", "note: x", "gx:,gy:2"] {
            let (names, _) = erased(line);
            assert!(names.is_none(), "{line}");
        }
        let marks = Marks::of("gx:1,gy:2\ngx:1,gy:2\ngx:1,gy:2\n");
        let mut other = b"gy:2,gx:1\ngx:1\ngx:3,gy:4".to_vec();
        marks.erase(&mut other);
        assert_eq!(other, b"gy:2,gx:1\ngx:1\n   3,   4");
    }
}
