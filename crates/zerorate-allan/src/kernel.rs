//! The differences from which statistics are computed, and the record lengths that they need.

use core::fmt;

/// The differences of the running sum that are squared and summed. Each function here has an arm for each variant, and
/// so has each kind of record (`codes`, `float` and `gaps` in [`kernels`](super::kernels)). No `match` has a `_`, so
/// the compiler reports every place that lacks a new variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kernel {
    /// Differences of the record as it is.
    Plain(Plain),
    /// Sums of m adjacent second differences.
    Modified,
    /// Second differences of the reflected record, around every point but the first and the last.
    Reflected,
}

/// Differences of one order that start at every sample or at every m-th sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Plain {
    pub order: Order,
    pub overlapping: bool,
}

/// The order of a difference of the phase, and the number of averages in the difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    Second = 2,
    Third = 3,
}

impl Kernel {
    /// Returns `m` if a term of averages of `m` samples fits into `samples` samples of the rate.
    pub fn check(self, samples: u64, m: u64, is_phase: bool) -> Result<usize, Reason> {
        if m == 0 {
            return Err(Reason::ZeroLength);
        }
        let needs = self.needs(m);
        let fits = usize::try_from(m).ok().filter(|_| needs <= samples);
        fits.ok_or(Reason::TooShort { needs: needs.saturating_add(u64::from(is_phase)) })
    }

    /// Number of rate samples for one term.
    fn needs(self, m: u64) -> u64 {
        match self {
            Self::Plain(plain) => m.saturating_mul(plain.order as u64),
            Self::Modified => m.saturating_mul(3) - 1,
            Self::Reflected => m.max(2),
        }
    }

    /// Longest averaging length, in samples, that `points` phase points can determine.
    pub fn longest(self, points: u64) -> u64 {
        let steps = points.saturating_sub(1);
        match self {
            Self::Plain(plain) => steps / plain.order as u64,
            Self::Modified => points / 3,
            Self::Reflected => steps / 2,
        }
    }

    /// Number of terms for averages of `m` samples in `points` phase points.
    pub fn terms(self, points: u64, m: u64) -> u64 {
        match self {
            Self::Plain(plain) => plain.terms(points, m),
            Self::Modified => Plain::OF_SUMS.terms(points + 1, m),
            Self::Reflected => points.saturating_sub(2),
        }
    }

    /// Index of the first point of each term (for a reflected term, of the point before its middle).
    pub fn starts(self, points: usize, m: usize) -> impl Iterator<Item = usize> {
        let stride = match self {
            Self::Plain(plain) => plain.stride(m),
            Self::Modified | Self::Reflected => 1,
        };
        (0..self.terms(points as u64, m as u64) as usize).map(move |term| term * stride)
    }

    /// The factor from a difference of averages to a difference of the phase.
    pub fn per(self, m: usize) -> f64 {
        let m = m as f64;
        match self {
            Self::Plain(_) | Self::Reflected => m,
            Self::Modified => m * m,
        }
    }

    /// The finite differences that form the terms. Reflected terms beyond the ends of the record repeat these.
    pub const fn difference(self) -> Difference {
        match self {
            Self::Plain(plain) => {
                Difference { order: plain.order as u32, overlapped: plain.overlapping, modified: false }
            }
            Self::Modified => Difference { order: 2, overlapped: true, modified: true },
            Self::Reflected => Difference { order: 2, overlapped: true, modified: false },
        }
    }
}

impl Plain {
    /// Differences of the twice summed rate: the inner sums of [`Kernel::Modified`].
    pub const OF_SUMS: Self = Self { order: Order::Third, overlapping: true };
    /// The differences of [`Kernel::Reflected`] that stay within the record.
    pub const WITHIN: Self = Self { order: Order::Second, overlapping: true };

    fn terms(self, points: u64, m: u64) -> u64 {
        let overlapping = points.saturating_sub(m.saturating_mul(self.order as u64));
        if self.overlapping { overlapping } else { overlapping.div_ceil(m) }
    }

    /// The index after the last point at which a term may start.
    pub fn starts_end(self, points: usize, m: usize) -> usize {
        let terms = self.terms(points as u64, m as u64) as usize;
        terms.checked_sub(1).map_or(0, |last| last * self.stride(m) + 1)
    }

    pub fn stride(self, m: usize) -> usize {
        if self.overlapping { 1 } else { m }
    }
}

/// The differences of the phase that are squared and averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Order d of the difference: 2 for Allan, 3 for Hadamard, 1 for the variance of first differences.
    pub order: u32,
    /// Whether a term starts at every sample (stride factor S = m) instead of at every τ (S = 1).
    pub overlapped: bool,
    /// Whether the phase is averaged over τ first (filter factor F = 1), as in MDEV, instead of sampled (F = m).
    pub modified: bool,
}

/// The reasons why an averaging time has no deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The averaging time rounds to zero samples.
    ZeroLength,
    /// The record is too short.
    TooShort {
        /// Samples (for phase: points) that would be enough.
        needs: u64,
    },
    /// Too many samples are missing: no term is left, the correction for the losses exceeds the squares, or less than
    /// 1/16 of the record is present.
    Gaps,
    /// The time rounds to the same number of samples as another averaging time, which has the result.
    SameLength {
        /// Samples in each average.
        m: u64,
    },
    /// The record has infinite values, or squares are beyond the range of f64.
    NotFinite,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ZeroLength => f.write_str("an average needs at least one sample"),
            Self::TooShort { needs } => write!(f, "the record is too short, {needs} samples are needed"),
            Self::Gaps => f.write_str("too many samples are missing"),
            Self::SameLength { m } => write!(f, "it rounds to {m} samples, as another averaging time does"),
            Self::NotFinite => f.write_str("the numbers are too large"),
        }
    }
}
