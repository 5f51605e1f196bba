//! Allan deviation and its relatives: how much the mean over τ moves from one stretch to the next.

mod advice;
mod analysis;
mod chi2;
mod edf;
mod fit;
mod input;
mod interval;
mod kernels;
mod lag1;
mod noise_id;
mod phase_points;
mod stat;
mod stream;
mod taus;

pub use advice::{AN1042_TAUS_S, Advice, AllanWarning, Averaging, advice};
pub use analysis::{Analysis, AnalysisError, Options, Point, Unavailable, analyse};
pub use chi2::chi2_quantile;
pub use edf::{Difference, edf, finite_difference_edf};
pub use fit::{Coefficient, Fit, FitError, Noise, fit};
pub use input::{Gap, Input};
pub use interval::interval;
pub use kernels::{Deviation, Reason, deviations};
pub use noise_id::noise_types;
pub use stat::{Stat, UnknownStat};
pub use stream::{NotAdjacent, Stream};
pub use taus::{Taus, TausError, longest};

/// Averages of 1, 2, 4 … samples, as long as at least one difference of two adjacent averages fits into `len` samples:
/// [`Taus::Octave`] of [`Stat::Oadev`].
pub fn octaves(len: usize) -> alloc::vec::Vec<u64> {
    Taus::Octave.lengths(longest(Stat::Oadev, len as u64 + 1))
}
