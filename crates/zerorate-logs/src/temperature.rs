//! Finds the temperature column of a log.

use crate::column::Column;
use crate::error::Result;
use std::io::{Read, Seek, SeekFrom};
use zerorate_input::Input;

/// The usual names of a temperature column in logs.
pub const TEMPERATURE_NAMES: [&str; 4] = ["temp_code", "temp_c", "temp", "temperature"];

/// Number of bytes at each end of a file that are searched for column names.
const ENDS: u64 = 1 << 16;

/// The temperature of a log: the column `name` or, without a name, a column with a usual name. `None` if the log has
/// no such column. `read` reads columns by their names. `bytes` is the content of the file; `None` if it cannot be
/// read twice, such as a pipe, and then only `name` is looked for.
pub fn temperature(
    name: Option<&str>,
    bytes: Option<Input>,
    read: impl Fn(&[String]) -> Result<Vec<Column>>,
) -> Option<Column> {
    let read = |name: &str| read(&[name.to_owned()]).ok()?.pop();
    match name {
        Some(name) => read(name),
        None if bytes.is_some_and(speaks_of_temperature) => TEMPERATURE_NAMES.into_iter().find_map(read),
        None => None,
    }
}

/// True if `temp` occurs near the beginning or the end of a file. Only then is the file read for a temperature.
fn speaks_of_temperature(mut input: Input) -> bool {
    let mut ends = || -> std::io::Result<Vec<u8>> {
        let (mut bytes, len) = (Vec::new(), input.length()?);
        input.by_ref().take(ENDS).read_to_end(&mut bytes)?;
        if len > ENDS {
            input.seek(SeekFrom::Start((len - ENDS).max(ENDS)))?;
            input.by_ref().take(ENDS).read_to_end(&mut bytes)?;
        }
        Ok(bytes)
    };
    ends().is_ok_and(|bytes| bytes.windows(4).any(|word| word.eq_ignore_ascii_case(b"temp")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_a_file_are_searched() {
        for length in [10, 70_000, 100_000, 140_000, 1_000_000] {
            let with = |at: usize| {
                let mut bytes = vec![b'0'; length];
                bytes[at..at + 4].copy_from_slice(b"Temp");
                speaks_of_temperature(bytes.into())
            };
            assert!(with(0) && with(length - 4), "{length}");
        }
        assert!(!speaks_of_temperature(vec![b'0'; 100_000].into()));
    }
}
