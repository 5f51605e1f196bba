//! The parts that all readers of columns share: inputs, units, a memory budget, delimited text, and tables in Arrow
//! and Parquet.
//!
//! This crate never opens a file by name. The caller passes open bytes as [`Input`], so the same readers serve a
//! browser.

pub mod arrows;
pub mod catch_panic;
pub mod cells;
pub mod delimited;
mod error;
mod factor;
mod input;
pub mod limits;
pub mod messages;
mod not_built_in;
mod open_table;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod plain;
pub mod table;
mod unit;
mod warning;

pub use error::InputError;
pub use factor::{states_codes, states_factor};
pub use input::{Input, RemoteBytes};
pub use not_built_in::NotBuiltIn;
pub use open_table::{Opened, open_table};
pub use unit::{Quantity, STANDARD_GRAVITY, TimeUnit, Unit, is_celsius};
pub use warning::InputWarning;
