//! A file that is nothing but numbers, little endian.

use super::open::Log;
use super::series::SeriesBuilder;
use crate::error::{Result, wrong};
use crate::raw_columns::{RawColumn, RawColumns};
use crate::setting::{Names, Setting};
use std::io::{ErrorKind, Read};
use zerorate_input::InputError;

/// Bytes that are read at a time; a multiple of the size of every type. (To map the file into memory would take
/// `unsafe` code.)
const BLOCK: usize = 1 << 18;

/// The type of each number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum RawType {
    /// 16-bit integers.
    I16,
    /// 32-bit integers.
    I32,
    /// 32-bit floating point.
    F32,
    /// 64-bit floating point.
    F64,
}

impl RawType {
    fn bytes(self) -> usize {
        match self {
            Self::I16 => 2,
            Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Adds the numbers of a block; `Err` is the index of the first infinite number.
    fn append(self, values: &mut SeriesBuilder, block: &[u8]) -> Result<(), usize> {
        match self {
            Self::I16 => values.extend_codes(numbers(block, |bytes| i16::from_le_bytes(bytes).into())),
            Self::I32 => values.extend_codes(numbers(block, i32::from_le_bytes)),
            Self::F32 => return values.extend_numbers(numbers(block, |bytes| f32::from_le_bytes(bytes).into())),
            Self::F64 => return values.extend_numbers(numbers(block, f64::from_le_bytes)),
        }
        Ok(())
    }
}

/// Reads the whole file as one column.
pub fn read(log: Log<'_>, raw: RawType, names: Names) -> Result<RawColumns> {
    let setting = names.of(Setting::Raw);
    let failed = |error| InputError::io("read", log.path, error);
    let bytes = log.input.length().map_err(failed)?;
    let size = raw.bytes();
    if !bytes.is_multiple_of(size as u64) {
        let what = format!("{bytes} bytes are not a multiple of {size}-byte numbers; check {setting}");
        return Err(InputError::damaged(log.path, "as raw numbers", what).into());
    }
    let mut values = SeriesBuilder::new(log.room);
    values.reserve((bytes / size as u64) as usize, matches!(raw, RawType::I16 | RawType::I32));
    let mut input = log.input;
    let mut buffer = vec![0; BLOCK];
    loop {
        let mut filled = 0;
        while filled < BLOCK {
            match input.read(&mut buffer[filled..]) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(failed(error).into()),
            }
        }
        let block = &buffer[..filled];
        if block.is_empty() {
            break;
        }
        let first = values.rows();
        values.check_room((block.len() / size) as u64).map_err(|why| InputError::over_budget(log.path, why))?;
        raw.append(&mut values, block).map_err(|at| {
            let what = format!("it is infinite: is {setting} right?");
            wrong(log.path, format_args!("number {}", first + at as u64), what)
        })?;
    }
    Ok(RawColumns::new([RawColumn::new("raw".to_owned(), values)], None, []))
}

fn numbers<const N: usize, T>(block: &[u8], decode: impl Fn([u8; N]) -> T) -> impl ExactSizeIterator<Item = T> {
    block.as_chunks::<N>().0.iter().map(move |number| decode(*number))
}
