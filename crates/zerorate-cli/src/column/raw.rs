//! A file that is nothing but numbers, little endian.

use super::{Column, Series};
use crate::capture::CaptureError;
use anyhow::Result;
use std::fs;
use std::path::Path;

/// The type of each number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
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

/// Reads the whole file as one column.
pub fn read(path: &Path, raw: RawType) -> Result<Column> {
    let bytes = fs::read(path).map_err(|error| CaptureError::io("read", path, error))?;
    let series = match raw {
        RawType::I16 => Series::Codes(numbers(path, &bytes, |bytes| i16::from_le_bytes(bytes).into())?),
        RawType::I32 => Series::Codes(numbers(path, &bytes, i32::from_le_bytes)?),
        RawType::F32 => {
            Series::Numbers(finite(path, numbers(path, &bytes, |bytes| f32::from_le_bytes(bytes).into())?)?)
        }
        RawType::F64 => Series::Numbers(finite(path, numbers(path, &bytes, f64::from_le_bytes)?)?),
    };
    Ok(Column { name: "raw".to_owned(), series, scale: 1.0, timing: None, warning: None })
}

fn numbers<const N: usize, T>(
    path: &Path,
    bytes: &[u8],
    decode: impl Fn([u8; N]) -> T,
) -> Result<Vec<T>, CaptureError> {
    let (numbers, rest) = bytes.as_chunks::<N>();
    if rest.is_empty() {
        return Ok(numbers.iter().map(|number| decode(*number)).collect());
    }
    let what = format!("{} bytes are no whole number of {N}-byte numbers: is --raw right?", bytes.len());
    Err(CaptureError::damaged(path, "as raw numbers", what))
}

fn finite(path: &Path, numbers: Vec<f64>) -> Result<Vec<f64>, CaptureError> {
    match numbers.iter().position(|number| !number.is_finite()) {
        Some(at) => {
            Err(CaptureError::damaged(path, format!("number {at}"), format!("{} cannot be averaged", numbers[at])))
        }
        None => Ok(numbers),
    }
}
