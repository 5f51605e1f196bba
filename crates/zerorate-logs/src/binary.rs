//! Numbers as binary logs hold them: integers and floating point, in one to eight bytes.

use crate::series::SeriesBuilder;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BinaryNumber {
    Integer(i64),
    /// A number in floating point, or an unsigned integer beyond the range of `i64`.
    Float(f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coding {
    Signed,
    Unsigned,
    /// Floating point in four or eight bytes.
    Float,
}

impl BinaryNumber {
    #[inline]
    pub fn decode(coding: Coding, bytes: &[u8], is_big_endian: bool) -> Self {
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        if is_big_endian {
            wide[..bytes.len()].reverse();
        }
        let (bits, unused) = (u64::from_le_bytes(wide), 64 - 8 * bytes.len() as u32);
        match coding {
            Coding::Float if bytes.len() == 4 => Self::Float(f32::from_bits(bits as u32).into()),
            Coding::Float => Self::Float(f64::from_bits(bits)),
            Coding::Signed => Self::Integer((bits << unused) as i64 >> unused),
            Coding::Unsigned => i64::try_from(bits).map_or(Self::Float(bits as f64), Self::Integer),
        }
    }

    pub fn as_f64(self) -> f64 {
        match self {
            Self::Integer(integer) => integer as f64,
            Self::Float(number) => number,
        }
    }

    /// Adds the number to a column. Returns false and adds nothing if the number is infinite.
    #[inline]
    pub fn add_to(self, values: &mut SeriesBuilder) -> bool {
        match self {
            Self::Integer(integer) => values.push_integer(integer),
            Self::Float(number) => return values.push_number(number),
        }
        true
    }

    #[cfg(any(feature = "hdf5", feature = "matlab", feature = "numpy"))]
    pub fn add_to_times(self, times: &mut crate::clock::Times) -> Result<(), String> {
        match self {
            Self::Integer(time) => times.push_integer(time),
            Self::Float(time) => times.push_number(time)?,
        }
        Ok(())
    }
}
