//! Names that distinguish records from each other.

use zerorate_imu::Record;

/// Whether these are columns of one log.
pub fn are_axes(records: &[Record]) -> bool {
    records.len() > 1 && records.windows(2).all(|pair| pair[0].file == pair[1].file)
}

/// The name that distinguishes a record from the others.
pub fn name(is_of_one_log: bool, record: &Record) -> String {
    if is_of_one_log { record.column.clone() } else { record.label() }
}
