#![doc = include_str!("../README.md")]

mod axes;
mod codes;
mod coefficients;
mod consumer;
mod detrending;
mod in_turn;
mod increment_names;
pub mod increments;
mod jumps;
mod kalibr;
mod kind;
mod moving;
mod noise_file;
mod numbers;
mod plausible;
mod record;
mod rejection;
mod report;
#[cfg(test)]
mod tests;
mod triads;
mod warning;

pub use axes::{Axes, ImuOptions, KindOptions};
pub use codes::Codes;
pub use coefficients::{B, Named, Units, coefficients};
pub use consumer::Format;
pub use detrending::{Detrending, DetrendingError};
pub use kind::Kind;
pub use noise_file::NoNoiseFile;
pub use numbers::{Axis, Combine, NoiseFileOptions, Rule};
pub use plausible::implausible_rates;
pub use record::{AnalysisOptions, PlotData, Record, RecordError};
pub use rejection::{Rejection, Rejections};
pub use report::{
    AllanReport, AxisReport, CleanedReport, CoefficientReport, DetrendReport, FitReport, ImuReport, LineReport,
    MotionReport, PointReport, SheetReport, UnavailableReport, UnitReport,
};
pub use warning::{ImuWarning, Moment, Rest, coded};
