//! Reads a file that consists of raw numbers: one column, or records of several numbers.

use super::open::Log;
use super::series::SeriesBuilder;
use crate::choice::{Choice, Columns};
use crate::clock::Times;
use crate::error::Result;
use crate::query::ColumnQuery;
use crate::raw_columns::{RawColumn, RawColumns};
use crate::raw_type::RawType;
use crate::setting::Setting;
use std::io::Read;
use zerorate_input::{Input, InputError};

/// Number of bytes that are read at once, rounded down to whole records. (To map the file into memory would take
/// `unsafe` code.)
const BLOCK: usize = 1 << 18;

pub fn read(log: Log<'_>, raw: RawType, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, mut input, room, .. } = log;
    let setting = asked.args.names.of(Setting::Raw);
    let failed = |error| InputError::io("read", path, error);
    let (bytes, size) = (input.length().map_err(failed)?, raw.record() as u64);
    if !bytes.is_multiple_of(size) {
        let what = format!("{bytes} bytes are not a multiple of {size}-byte records; check {setting}");
        return Err(InputError::damaged(path, "as raw numbers", what).into());
    }
    let names: Vec<String> = (0..raw.channels).map(|channel| raw.name(channel)).collect();
    let all = Columns {
        path,
        names: names.iter().map(String::as_str).collect(),
        numeric: vec![true; raw.channels],
        clocks: Vec::new(),
        settings: asked.args.names,
    };
    let Choice { values: chosen, time, .. } = all.choose(asked.wanted, asked.args, &[])?;
    let mut values: Vec<_> = chosen.iter().map(|_| SeriesBuilder::sharing(room, chosen.len())).collect();
    let rows = bytes / size;
    values.iter().try_for_each(|values| values.check_room(rows)).map_err(|why| InputError::over_budget(path, why))?;
    values.iter_mut().for_each(|values| values.reserve(rows as usize, raw.number.is_integer()));
    let (mut times, mut first) = (Times::new(), 0);
    let mut block = Vec::new();
    while next(&mut input, BLOCK - BLOCK % raw.record(), &mut block).map_err(failed)? {
        let wrong = |channel: usize, row: usize, what: String| {
            InputError::damaged(path, format!("column {}, row {}", names[channel], first + row as u64), what)
        };
        for (values, channel) in values.iter_mut().zip(&chosen) {
            let infinite = |row| wrong(*channel, row, format!("it is infinite: is {setting} right?"));
            raw.append(values, &block, *channel).map_err(infinite)?;
        }
        if let Some(channel) = time {
            raw.append_times(&mut times, &block, channel).map_err(|(row, what)| wrong(channel, row, what))?;
        }
        first += (block.len() / raw.record()) as u64;
    }
    let columns = chosen.iter().zip(values).map(|(channel, values)| RawColumn::new(names[*channel].clone(), values));
    Ok(RawColumns::new(columns, time.map(|channel| (names[channel].clone(), times)), []))
}

/// Fills `block` with the next bytes of the file; false at its end.
fn next(input: &mut Input, most: usize, block: &mut Vec<u8>) -> std::io::Result<bool> {
    block.clear();
    input.take(most as u64).read_to_end(block)?;
    Ok(!block.is_empty())
}
