#![doc = include_str!("../README.md")]

mod axes;
mod coefficients;
mod consumer;
mod doubt;
pub mod increments;
mod kind;
mod noise_file;
mod numbers;
mod plausible;
mod record;
mod settling;
#[cfg(test)]
mod tests;
mod warning;

pub use axes::{Axes, ImuOptions, Said};
pub use coefficients::{B, Named, Units, coefficients, span};
pub use consumer::Format;
pub use doubt::{Doubt, Doubts};
pub use kind::Kind;
pub use noise_file::NoNoiseFile;
pub use numbers::{Axis, Choice, Combine, Rule};
pub use record::{AnalysisOptions, Look, Record, RecordError};
pub use settling::{Settling, SettlingError};
pub use warning::{ImuWarning, Moment};
