//! Plots for data sheets and reports: SVG, and PNG made from it. This module takes numbers and labels. It reads no
//! file and analyses nothing.
//!
//! Text stays text in the SVG, so it can be searched. The PNG is drawn with the program's own font and looks the same
//! on every machine.
//!
//! We draw the plots ourselves. Of the plotting crates, `plotters` was not tried. `kuva` draws no grid lines between
//! labels at 1, 2, 5, and its labels have neither colour nor anchor and do not look for a free position.

mod allan;
mod axes;
mod canvas;
mod correction;
mod curve;
mod label;
mod lines;
mod multiples;
mod over_time;
#[cfg(feature = "png")]
mod raster;
mod residuals;
mod scatter;
mod signal;
mod spectrum;
mod stack;
#[cfg(test)]
mod tests;

pub use allan::{Curve, Mark, Minimum, Options, Point, PowerLaw, allan, an1042};
pub use axes::number;
pub(crate) use axes::{minus, range, round_step, superscript};
pub use canvas::stacked;
pub use correction::{CorrectionCurve, CorrectionPoint, correction};
pub use lines::{Lines, Panel, lines};
pub use multiples::allan_multiples;
pub use over_time::{Series, over_time};
#[cfg(feature = "png")]
pub use raster::png;
pub use residuals::{ResidualPoint, residuals};
pub use scatter::{Dot, Scatter, ScatterPanel, scatter};
pub use signal::{Signal, signals};
pub use spectrum::{Spectrum, Tone, spectra};
