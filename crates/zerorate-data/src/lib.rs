//! Captures and logs of gyroscopes: bytes to columns, and back.
//!
//! Every form is known by what is in it, whatever a file is called. Nothing here opens a file: [`Input`] is bytes that
//! somebody else has opened, so that the same readers serve a browser.

pub mod believed;
pub mod capture;
mod cells;
pub mod column;
#[cfg(test)]
mod fuzz;
pub mod imu;
mod input;
pub mod limits;
mod mcap_messages;
mod note;
pub mod plain;
mod row_reader;
mod survive;
mod unit;

pub use capture::CaptureError;
pub use column::LogError;
pub use input::{Elsewhere, Input};
pub use note::Note;
pub use row_reader::RowReader;
