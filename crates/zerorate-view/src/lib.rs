//! Results as pictures and pages: numbers and words come in, SVG, PNG and HTML go out.

pub mod codes;
pub mod duration;
pub mod export;
pub mod plot;
mod printable;
pub mod report;

pub use duration::Seconds;
