//! Results as pictures and pages: numbers and words come in, SVG, PNG and HTML go out.

pub mod duration;
pub mod export;
mod interval;
pub mod plot;
mod printable;
pub mod report;
mod session_warning;

pub use duration::Seconds;
pub use interval::PlusMinus;
pub use session_warning::SessionWarning;
