//! Turns results into plots and pages: it takes numbers and texts, and returns SVG, PNG and HTML.

pub mod duration;
pub mod export;
mod interval;
pub mod noise;
pub mod plot;
mod printable;
mod remark;
pub mod report;
mod session_warning;
pub mod tempcal;

pub use duration::Seconds;
pub use interval::{Interval, PlusMinus};
pub use remark::{remark, remarks_apart};
pub use session_warning::SessionWarning;
