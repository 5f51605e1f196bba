//! Reads columns of numbers from the log of any gyroscope, with their rate, gaps and units. All wanted columns are
//! read together.
//!
//! Facts that a file does not state must be given as options, or are reported as unknown. A fact that is inferred,
//! such as a time unit from dates, gives a warning. A format is recognised by its content, not by its name. The caller
//! opens the files ([`Input`]).
//!
//! Text, raw numbers, Arrow, captures, and logs of PX4 and ArduPilot are always read. Cargo features add the others.
//! The error for a format that is not built in names its feature ([`NotBuiltIn`](zerorate_input::NotBuiltIn)).

mod alternating;
mod arrow_file;
mod binary;
#[cfg(all(test, feature = "full"))]
mod checks;
mod choice;
mod clock;
mod clock_digits;
mod column;
mod column_checks;
mod cut;
mod cutting;
mod dataflash;
mod error;
mod finish;
#[cfg(all(test, feature = "full"))]
mod foreign;
mod forms;
#[cfg(test)]
mod fuzz;
mod given_rate;
#[cfg(feature = "hdf5")]
mod hdf5;
#[cfg(feature = "hdf5")]
mod hdf5_index;
#[cfg(any(feature = "mcap", feature = "ros", feature = "sqlite"))]
mod imu_messages;
mod in_memory;
#[cfg(all(test, feature = "full"))]
mod joined;
mod late_rows;
mod lost_digits;
#[cfg(feature = "hdf5")]
mod lzf;
#[cfg(feature = "matlab")]
mod mat;
#[cfg(feature = "mcap")]
mod mcap_bag;
mod merged_rows;
#[cfg(any(feature = "mcap", feature = "ros", feature = "sqlite"))]
mod message;
mod middle;
#[cfg(all(test, not(feature = "full")))]
mod missing;
mod mixed_rows;
#[cfg(any(feature = "mcap", feature = "ros", feature = "sqlite"))]
mod nested;
#[cfg(feature = "numpy")]
mod npy;
#[cfg(feature = "npz")]
mod npz;
mod number;
mod only;
mod open;
mod options;
mod order;
mod parameters;
#[cfg(feature = "parquet")]
mod parquet;
mod parts;
mod query;
mod rate_changes;
mod rate_question;
mod raw;
mod raw_columns;
mod raw_type;
mod read;
#[cfg(feature = "ros")]
mod rosbag;
mod sample;
mod series;
mod setting;
#[cfg(all(test, feature = "full"))]
mod several;
#[cfg(feature = "sqlite")]
mod sqlite_bag;
mod stated_rate;
mod tabular;
mod temperature;
#[cfg(test)]
mod tests;
mod text;
mod time_names;
mod time_unit;
mod timed;
mod topics;
mod ulog;
mod unsigned;
mod warning;
mod wide;

pub use choice::{ColumnSelection, ColumnSpec, TEMPERATURE_COLUMN};
pub use column::Column;
pub use column_checks::stopped;
pub use cut::{Cut, CutTime};
pub use error::{LogError, Result};
pub use forms::kind;
pub use in_memory::check_record;
pub use number::Decimal;
pub use only::{Condition, RowFilter};
pub use options::{ColumnOptions, MAX_BAD};
pub use parameters::{changed_parameter, parameters};
pub use parts::{Parts, read_parts, read_with_temperature, read_without_rate};
pub use raw_type::{RawNumber, RawType};
pub use read::{read, read_all, read_table};
pub use series::Series;
pub use setting::{Names, Setting, quoted};
pub use temperature::{TEMPERATURE_NAMES, temperature};
pub use timed::{TimedColumn, TimedColumns, read_timed};
pub use warning::LogWarning;
pub use zerorate_input::{Input, InputError, InputWarning, Quantity, STANDARD_GRAVITY, TimeUnit, Unit};
pub use zerorate_input::{states_codes, states_factor};
