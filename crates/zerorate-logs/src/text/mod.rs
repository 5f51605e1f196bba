//! Reads columns of delimited text, with or without a header.

mod axes_in_name;
mod blocks;
mod candump;
pub mod dates;
mod head;
mod header;
mod json_lines;
mod marks;
mod rows;
mod scales;
mod sentence;
mod stamp;
mod survey;
#[cfg(test)]
mod tests;

use super::clock::Times;
use super::number::Numerals;
use super::sample::Sampled;
use super::series::SeriesBuilder;
use crate::choice::{Choice, ColumnSelection, Columns};
use crate::error::{LogError, Result};
use crate::options::ColumnOptions;
use crate::query::ColumnQuery;
use crate::raw_columns::{Clock, RawColumn, RawColumns};
use crate::setting::Setting;
use crate::warning::LogWarning;
use blocks::{Block, Blocks};
use head::{Head, Open};
use marks::Marks;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, IntoParallelRefMutIterator, ParallelIterator};
use rows::{Broken, Cut, Piece, Time, at_line};
use std::borrow::Cow;
use std::io::Seek;
use std::path::Path;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{Input, InputError, InputWarning, TimeUnit};

/// Number of blocks per thread. With one block each, all threads wait for the thread that also reads the next blocks.
const AT_ONCE: usize = 2;

pub fn read(path: &Path, mut input: Input, room: MemoryBudget, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let failed = |error| InputError::io("read", path, error);
    let head = head(path, &input, asked)?;
    input.rewind().map_err(failed)?;
    let names = head.names.iter().map(String::as_str).collect();
    let clocks = head.dates.iter().map(|dates| dates.are_times).collect();
    let columns = Columns { path, numeric: head.numeric.clone(), clocks, names, settings: asked.args.names };
    let choice = columns.choose(asked.wanted, &timed(asked.args, &head), &[]);
    let Choice { values, time, only } = choice.map_err(|question| head.with_reason(question))?;
    let left_out = columns.left_out(asked.wanted, time);
    let mut cut = rows::cut(path, &head, &values, time);
    let shift = usize::from(head.index);
    let conditions = asked.args.only.iter().flat_map(|only| &only.conditions);
    cut.only = conditions.zip(only).map(|(condition, at)| (at + shift, condition.value.clone())).collect();
    let mut reading = TextColumns::new(&cut, room, &head);
    let mut blocks = Blocks::new(path, input).with_stamps(head.stamps).without_marks(&head.marks);
    let at_once = AT_ONCE * rayon::current_num_threads();
    let mut several = blocks.several(at_once)?;
    let columns = reading.columns.len();
    let pieces = || (0..at_once).map(|_| Piece::new(columns)).collect::<Vec<Piece>>();
    let (mut pieces, mut before) = (pieces(), pieces());
    let mut is_first = true;
    while !several.is_empty() {
        pieces.iter_mut().for_each(|piece| piece.clear(Numerals::new(head.decimal)));
        let read = |(at, (block, piece)): (usize, (&Block, &mut Piece))| cut.read(block, is_first && at == 0, piece);
        // the next blocks are read, and the previous ones stored, while these are parsed
        let ((), (next, is_away)) = rayon::join(
            || several.par_iter().zip(&mut pieces).enumerate().for_each(read),
            || (blocks.several(at_once), reading.append(&before)),
        );
        is_away?;
        std::mem::swap(&mut pieces, &mut before);
        blocks.reuse(std::mem::replace(&mut several, next?));
        is_first = false;
    }
    reading.append(&before)?;
    let mut found = reading.finish(&head, asked)?;
    found.warnings.extend(left_out);
    Ok(found)
}

/// Reads the head of the text, and the whole text if the head leaves a question open.
fn head(path: &Path, input: &Input, asked: &ColumnQuery<'_>) -> Result<Head> {
    let again = || input.rewound().map_err(|error| InputError::io("read", path, error));
    let mut start = Blocks::new(path, again()?).next()?;
    if start.as_ref().is_some_and(Block::is_binary) {
        return Err(head::not_text(path, asked.args.names));
    }
    let text = start.as_ref().map(Block::legible).unwrap_or_default();
    if text.lines().find(|line| !line.trim().is_empty()).is_some_and(candump::is_message) {
        return Err(InputError::not_a_log(path, candump::CANDUMP).into());
    }
    let (stamps, marks) = (head::stamps(&text), Marks::of(&text));
    drop(text);
    if stamps.is_some() || marks.are_there() {
        start = Blocks::new(path, again()?).with_stamps(stamps).without_marks(&marks).next()?;
    }
    let mut head = Head::read(path, &start.as_ref().map(Block::legible).unwrap_or_default(), &marks, asked.args)?;
    head.stamps = stamps;
    // a caller that asks for a second column, or for a time, knows that there are two
    let one = match asked.wanted {
        ColumnSelection::One(name) => name.is_none_or(|name| name == "0") && asked.args.time_column.is_none(),
        _ => false,
    };
    if head.open == Open::OneNameLess || head.open == Open::TwoOrDecimals && one {
        survey::settle(path, again()?, &mut head, asked.args)?;
    }
    Ok(head)
}

/// Adds the time column whose step the header of the file states, unless the options give a rate or a time column.
fn timed<'a>(args: &'a ColumnOptions, head: &Head) -> Cow<'a, ColumnOptions> {
    match head.scales.time().filter(|_| args.rate.is_none() && args.time_column.is_none()) {
        Some(time) => Cow::Owned(ColumnOptions { time_column: Some(time.to_owned()), ..args.clone() }),
        None => Cow::Borrowed(args),
    }
}

/// The wanted columns of a text while their rows are added.
struct TextColumns<'a> {
    cut: &'a Cut<'a>,
    columns: Vec<SeriesBuilder>,
    times: Option<Times>,
    numerals: Numerals,
    lines: u64,
    broken: Broken,
    torn: Option<String>,
    sample: Vec<Sampled>,
}

impl<'a> TextColumns<'a> {
    fn new(cut: &'a Cut<'a>, room: MemoryBudget, head: &Head) -> Self {
        let count = cut.names.len() - usize::from(cut.time.is_some());
        Self {
            cut,
            columns: (0..count).map(|_| SeriesBuilder::sharing(room, count)).collect(),
            times: cut.time.map(|_| Times::new()),
            numerals: Numerals::new(head.decimal),
            lines: 0,
            broken: Broken::default(),
            torn: None,
            sample: Vec::new(),
        }
    }

    fn append(&mut self, pieces: &[Piece]) -> Result<(), InputError> {
        let path = self.cut.path;
        self.columns.par_iter_mut().enumerate().try_for_each(|(at, builder)| {
            pieces.iter().map(|piece| &piece.columns[at]).try_for_each(|(values, are_codes)| {
                builder.check_room(values.len() as u64).map_err(|why| InputError::over_budget(path, why))?;
                builder.extend_cells(values, *are_codes);
                Ok(())
            })
        })?;
        pieces.iter().try_for_each(|piece| self.learn(piece))
    }

    /// Adds the times, line counts and errors of a piece, and the decimal mark that it shows.
    fn learn(&mut self, piece: &Piece) -> Result<(), InputError> {
        let path = self.cut.path;
        let Piece { times, lines, rows, bad, first_bad, again, fatal, cut, numerals, .. } = piece;
        if let Some((line, what)) = fatal {
            return Err(at_line(path, self.lines + line, what));
        }
        if self.sample.is_empty() {
            self.sample.clone_from(&piece.sample);
        }
        self.broken.rows += rows;
        self.broken.bad += bad;
        if let (None, Some((line, what))) = (&self.broken.first, first_bad) {
            self.broken.first = Some((self.lines + line, what.clone()));
        }
        self.broken.again = self.broken.again.or(again.map(|line| self.lines + line));
        if let Some((line, what)) = cut {
            let error = at_line(path, self.lines + line, what);
            if self.rows() == 0 {
                return Err(error);
            }
            self.torn = Some(format!("{error}: the file was cut short, so this line is dropped"));
        }
        if !self.numerals.join(numerals.clone(), self.lines) {
            let what = "some numbers have a decimal point and others a decimal comma";
            return Err(InputError::damaged(path, "as a text file", what));
        }
        if let Some(all) = &mut self.times {
            times.iter().try_for_each(|time| push_time(all, *time)).map_err(|what| {
                InputError::damaged(path, format!("column {}", self.cut.names[self.columns.len()]), what)
            })?;
        }
        self.lines += lines;
        Ok(())
    }

    fn rows(&self) -> u64 {
        self.columns.first().map_or(0, SeriesBuilder::rows)
    }

    fn finish(self, head: &Head, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
        let rows = self.rows();
        let Self { cut, columns, times, numerals, broken, torn, sample, .. } = self;
        let (path, names) = (cut.path, asked.args.names);
        if let (0, Some(only)) = (rows, &asked.args.only) {
            return Err(only.without_rows(path));
        }
        if rows == 0 && broken.bad == 0 {
            return Err(InputError::not_a_log(path, "it has a header and no rows; was anything recorded?").into());
        }
        if let Some((line, what)) = numerals.doubt(names.of(Setting::Decimal)) {
            return Err(LogError::File(at_line(path, line, &what)));
        }
        let skipped = head.skipped.clone().map(|(lines, first)| LogWarning::LinesSkipped {
            path: path.display().to_string(),
            lines,
            first,
        });
        let restarted = broken.again.filter(|_| cut.time.is_none()).map(|line| {
            let why = "the header again: as no time column is read, nothing tells how long the log paused there";
            LogWarning::LinesBroken(format!("{}: line {line} is {why}", path.display()))
        });
        let broken = broken.judge(path, asked.args.max_bad, names.of(Setting::MaxBad))?;
        let broken = broken.map(LogWarning::LinesBroken);
        let unused = head.scales.unused.clone().filter(|_| asked.args.scale.is_none());
        let unused = unused.map(|line| LogWarning::ScaleUnused { path: path.display().to_string(), line });
        let warnings = skipped.into_iter().chain(unused).chain(broken).chain(restarted);
        let torn = torn.map(|text| LogWarning::File(InputWarning::Torn(text)));
        let warnings = warnings.chain(torn).collect();
        let time = cut.time.map(|time| cut.names[time].clone());
        let clock = time.zip(times).map_or(Clock::Silent, |(name, mut times)| {
            if asked.args.time_unit.is_none() {
                head.scales.give_unit(&name, &mut times);
            }
            Clock::Column(name, times)
        });
        let columns = cut.names.iter().zip(columns).map(|(name, values)| {
            let column = RawColumn::new(name.clone(), values);
            match head.scales.of_column(name) {
                Some((unit, step)) => column.in_steps(unit, step),
                None => column,
            }
        });
        Ok(RawColumns { columns: columns.collect(), clock, warnings, sample, stated_rate: None })
    }
}

fn push_time(times: &mut Times, time: Time) -> Result<(), String> {
    match time {
        Time::Integer(time) => times.push_integer(time),
        Time::Number(time) => return times.push_number(time),
        Time::Date(ns) => {
            times.unit = Some(TimeUnit::Ns);
            times.push_integer(ns);
        }
    }
    Ok(())
}
