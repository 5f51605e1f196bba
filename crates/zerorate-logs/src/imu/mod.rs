//! The axes of an IMU: which columns of a log they are, and the files for the filters that take their noise.

mod axes;
mod coefficients;
mod consumer;
mod doubt;
mod kind;
mod noise_file;
mod numbers;
mod plausible;
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
pub use warning::{ImuWarning, Moment};
