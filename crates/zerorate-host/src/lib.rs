//! Reads gyroscopes that are connected to a computer. `--device` names one, and the [`Hub`] reads it for all readers.
//!
//! This crate has no argument parser, no output and no global state. Messages are returned as values. A [`Stop`] ends
//! the work to which it was passed.

#![deny(clippy::print_stderr, clippy::print_stdout, reason = "what there is to say comes as values")]

mod address;
mod bridge;
mod chamber;
pub mod clock;
mod connected;
mod edges;
mod error;
pub mod files;
#[cfg(target_os = "linux")]
mod gpio;
mod hub;
#[cfg(target_os = "linux")]
mod iio;
pub mod iiod;
mod kinds;
mod live;
mod options;
mod pace;
mod part_log;
mod pin;
mod reader;
mod replay;
mod row_reader;
mod source;
#[cfg(target_os = "linux")]
mod spi;
mod stop;
#[cfg(all(test, target_os = "linux"))]
mod tests;
mod twin;
mod warning;
mod wire;

pub use chamber::{
    AmbientProfile, Chamber, ChamberCommands, ChamberSpec, ChamberThread, ProfileWriter, SafeEnd, SimulatedChamber,
};
pub use error::{Cause, DeviceError};
pub use hub::{Batch, Hub, LosslessReader, Poll, WatchedBatch, Watcher};
pub use kinds::{DeviceSpec, KINDS, Kind};
pub use pace::{Pace, Speed};
pub use part_log::PartLog;
pub use row_reader::RowReader;
pub use source::{Bus, DeviceInfo, Losses, Registers, Sampling, Setup, Source};
pub use stop::Stop;
pub use warning::SourceWarning;

/// The result of an operation with a device.
pub type Result<T, E = DeviceError> = std::result::Result<T, E>;
