//! The types of numbers in a file of raw numbers.

use crate::clock::Times;
use crate::series::SeriesBuilder;
use std::str::FromStr;

/// Largest number of numbers in a record.
const MAX_CHANNELS: usize = 256;

/// The records of a file of raw numbers: `i16`, or `6xi16be` for six big-endian integers in each record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawType {
    /// Number of channels, which is how many numbers a record holds.
    pub channels: usize,
    /// The type that all numbers in the file have.
    pub number: RawNumber,
    /// True if the first byte of a number is the most significant one.
    pub is_big_endian: bool,
}

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RawNumber {
    /// 16-bit integers.
    I16,
    /// 32-bit integers.
    I32,
    /// 32-bit floating point.
    F32,
    /// 64-bit floating point.
    F64,
}

impl RawNumber {
    const NAMES: [(&str, Self); 4] = [("i16", Self::I16), ("i32", Self::I32), ("f32", Self::F32), ("f64", Self::F64)];

    fn bytes(self) -> usize {
        match self {
            Self::I16 => 2,
            Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// True if the numbers are integers.
    pub fn is_integer(self) -> bool {
        matches!(self, Self::I16 | Self::I32)
    }
}

impl FromStr for RawType {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let unknown =
            || "give i16, i32, f32 or f64; big endian as i16be, records of six as 6xi16 or 6xi16be".to_owned();
        let (channels, number) = match text.split_once('x') {
            Some((channels, number)) => (channels.parse().map_err(|_| unknown())?, number),
            None => (1, text),
        };
        if !(1..=MAX_CHANNELS).contains(&channels) {
            return Err(format!("a record has 1 to {MAX_CHANNELS} numbers"));
        }
        let (name, is_big_endian) = match number.strip_suffix("be") {
            Some(name) => (name, true),
            None => (number.strip_suffix("le").unwrap_or(number), false),
        };
        let number = RawNumber::NAMES.into_iter().find(|(known, _)| *known == name).map(|(_, number)| number);
        Ok(Self { channels, number: number.ok_or_else(unknown)?, is_big_endian })
    }
}

impl RawType {
    /// The size of a record in bytes.
    pub fn record(self) -> usize {
        self.channels * self.number.bytes()
    }

    /// The name of a column: its number counted from 0, or `raw` if it is the only one.
    pub fn name(self, channel: usize) -> String {
        if self.channels == 1 { "raw".to_owned() } else { channel.to_string() }
    }

    fn channel(self, block: &[u8], channel: usize) -> Vec<f64> {
        match self.number {
            RawNumber::I16 => self.numbers(block, channel, |bytes| i16::from_le_bytes(bytes).into()),
            RawNumber::I32 => self.numbers(block, channel, |bytes| i32::from_le_bytes(bytes).into()),
            RawNumber::F32 => self.numbers(block, channel, |bytes| f32::from_le_bytes(bytes).into()),
            RawNumber::F64 => self.numbers(block, channel, f64::from_le_bytes),
        }
    }

    /// Adds the numbers of a channel. The error is the index of the first infinite number.
    pub fn append(self, values: &mut SeriesBuilder, block: &[u8], channel: usize) -> Result<(), usize> {
        if self.channels == 1 && !self.is_big_endian {
            return self.append_all(values, block);
        }
        let numbers = self.channel(block, channel).into_iter();
        if !self.number.is_integer() {
            return values.extend_numbers(numbers);
        }
        values.extend_codes(numbers.map(|code| code as i32));
        Ok(())
    }

    /// Adds a block of little-endian numbers in one channel, the usual form, without a copy.
    fn append_all(self, values: &mut SeriesBuilder, block: &[u8]) -> Result<(), usize> {
        match self.number {
            RawNumber::I16 => {
                values.extend_codes(block.as_chunks().0.iter().map(|bytes| i16::from_le_bytes(*bytes).into()));
            }
            RawNumber::I32 => values.extend_codes(block.as_chunks().0.iter().map(|bytes| i32::from_le_bytes(*bytes))),
            RawNumber::F32 => {
                return values
                    .extend_numbers(block.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes).into()));
            }
            RawNumber::F64 => {
                return values.extend_numbers(block.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)));
            }
        }
        Ok(())
    }

    /// Adds the times in a channel. The error is the index of the first number that is not a time, and the reason.
    pub fn append_times(self, times: &mut Times, block: &[u8], channel: usize) -> Result<(), (usize, String)> {
        let mut rows = self.channel(block, channel).into_iter().enumerate();
        rows.try_for_each(|(row, time)| times.push_number(time).map_err(|why| (row, why)))
    }

    /// The numbers of a channel; `decode` takes little-endian bytes.
    fn numbers<const N: usize>(self, block: &[u8], channel: usize, decode: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        let number = |record: &[u8]| {
            let mut bytes = record[channel * N..].first_chunk().copied().unwrap_or([0; N]);
            if self.is_big_endian {
                bytes.reverse();
            }
            decode(bytes)
        };
        block.chunks_exact(self.record()).map(number).collect()
    }
}
