//! The axes of an IMU: which columns of a log they are, and the files for the filters that take their noise.

mod axes;
mod coefficients;
mod consumer;
mod kind;
mod numbers;

pub use axes::{Axes, ImuOptions, Said};
pub use coefficients::{B, Named, Units, coefficients, span};
pub use consumer::Format;
pub use kind::Kind;
pub use numbers::{Axis, AxisNumbers, Choice, Chosen, Combine, Memory, Numbers, Sensor, doubt};
