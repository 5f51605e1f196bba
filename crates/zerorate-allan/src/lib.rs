#![doc = include_str!("../README.md")]
#![no_std]

extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

#[cfg(feature = "std")]
mod advice;
mod analysis;
mod chi2;
mod coefficient;
#[cfg(all(feature = "file", feature = "std"))]
pub mod datasheet;
mod detrend;
mod edf;
#[cfg(feature = "file")]
#[doc(hidden)]
pub mod entry;
mod envelope;
#[cfg(feature = "std")]
mod fit;
#[cfg(feature = "std")]
mod fitted_record;
mod input;
mod interval;
#[cfg(feature = "std")]
mod jumps;
mod kernel;
mod kernels;
mod lag1;
#[doc(hidden)]
pub mod linear;
mod misfit;
mod noise_id;
mod phase_points;
mod rows;
mod setting_name;
mod stat;
mod stream;
mod taus;
mod text;
mod warning;
#[cfg(feature = "std")]
mod welch;

#[cfg(feature = "std")]
pub use advice::{AN1042_TAUS_S, Advice, Averaging, advice};
pub use analysis::{Analysis, AnalysisError, Options, Point, Unavailable, analyse};
pub use chi2::chi2_quantile;
pub use coefficient::Coefficient;
#[cfg(all(feature = "file", feature = "std"))]
pub use datasheet::{DataSheet, DataSheetError};
pub use detrend::{DetrendError, DetrendedRate, Follows, MOST_ORDER, detrend, follows_temperature};
pub use edf::{edf, finite_difference_edf};
pub use envelope::Envelope;
#[cfg(feature = "std")]
pub use fit::{
    Cleaning, Corner, Covering, Differs, Estimate, FEWEST_SAMPLES, Fit, FitError, FitOptions, Line, MOST_ERROR, Model,
    Motion, MotionKind, Outlier, PREDICTS, Pool, PoolError, PoolRecord, Prediction, Spread, Step, Term, Usage, fit,
    fit_pool, motion,
};
#[cfg(feature = "std")]
pub use fitted_record::{FittedRecord, Preparation};
pub use input::{Gap, Input};
pub use interval::interval;
#[cfg(feature = "std")]
pub use jumps::{Jumps, jumps};
pub use kernel::{Difference, Reason};
pub use kernels::{Deviation, deviations};
pub use misfit::{Cause, Misfit};
pub use noise_id::noise_types;
pub use setting_name::SettingName;
pub use stat::{Stat, UnknownStat};
pub use stream::{NotAdjacent, Stream};
pub use taus::{Taus, TausError, longest};
pub use text::{hertz, span};
pub use warning::{AllanWarning, LONGEST_RECORD_S, Noise};
#[cfg(feature = "std")]
pub use welch::{Density, welch};

/// √(2 ln 2/π) = 0.664: the floor of an Allan deviation divided by the bias instability B (IEEE Std 952-1997 C.1.3).
pub const FLOOR_PER_B: f64 = 0.664_282_470_267_960_1;

/// The averaging lengths 1, 2, 4 … samples, up to the longest for which a record of `len` samples holds two
/// adjacent averages. This is [`Taus::Octave`] of [`Stat::Oadev`].
pub fn octaves(len: usize) -> alloc::vec::Vec<u64> {
    Taus::Octave.lengths(longest(Stat::Oadev, len as u64 + 1))
}
