//! The differences that statistics are made of, and their demands on a record.

use core::fmt;

/// The differences of the running sum that are squared and summed. Each has an arm in each of the functions here and
/// in each kind of record (`codes`, `float` and `gaps` in [`kernels`](super::kernels)). No `match` has a `_`, so that
/// the compiler asks for a new one everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kernel {
    /// Differences of the record as it is.
    Plain(Plain),
    /// Sums of m adjacent second differences.
    Modified,
    /// Second differences of the reflected record, around every point but the first and the last.
    Reflected,
}

/// Differences of one order, every m-th or every one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Plain {
    pub order: Order,
    pub overlapping: bool,
}

/// The number of averages in a difference, less one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    Second = 2,
    Third = 3,
}

impl Kernel {
    /// Whether averages of `m` fit into `samples` samples of the rate.
    pub fn check(self, samples: u64, m: u64, is_phase: bool) -> Result<usize, Reason> {
        if m == 0 {
            return Err(Reason::ZeroLength);
        }
        let needs = self.needs(m);
        let fits = usize::try_from(m).ok().filter(|_| needs <= samples);
        fits.ok_or(Reason::TooShort { needs: needs.saturating_add(u64::from(is_phase)) })
    }

    /// Samples of the rate for one term.
    fn needs(self, m: u64) -> u64 {
        match self {
            Self::Plain(plain) => m.saturating_mul(plain.order as u64),
            Self::Modified => m.saturating_mul(3) - 1,
            Self::Reflected => m.max(2),
        }
    }

    /// Longest averages about which `points` points of phase tell something new.
    pub fn longest(self, points: u64) -> u64 {
        let steps = points.saturating_sub(1);
        match self {
            Self::Plain(plain) => steps / plain.order as u64,
            Self::Modified => points / 3,
            Self::Reflected => steps / 2,
        }
    }

    /// Terms for averages of `m` in `points` points of phase.
    pub fn terms(self, points: u64, m: u64) -> u64 {
        match self {
            Self::Plain(plain) => plain.terms(points, m),
            Self::Modified => Plain::OF_SUMS.terms(points + 1, m),
            Self::Reflected => points.saturating_sub(2),
        }
    }

    /// The start of each term.
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

    /// The finite differences that form its terms or, beyond the ends of the record, that its terms repeat.
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
    /// Differences of the running sum of the running sum: the inner sums of [`Kernel::Modified`].
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

    /// The distance from one term to the next.
    pub fn stride(self, m: usize) -> usize {
        if self.overlapping { 1 } else { m }
    }
}

/// The differences of the phase that are squared and averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Order d of the difference: 2 for Allan, 3 for Hadamard, 1 for the variance of first differences.
    pub order: u32,
    /// A term at every sample (S = m) instead of at every τ (S = 1).
    pub overlapped: bool,
    /// The phase is averaged over τ first (F = 1), as MDEV does, instead of sampled (F = m).
    pub modified: bool,
}

/// The reasons why an averaging time has no deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The averages have no length.
    ZeroLength,
    /// The record is too short.
    TooShort {
        /// Samples (for phase: points) that would be enough.
        needs: u64,
    },
    /// Too much is missing: no term is left, or less than 1/16 of the record is there.
    Gaps,
    /// The time rounds to as many samples as another averaging time, which has the result.
    SameLength {
        /// Samples in each average.
        m: u64,
    },
    /// Infinite values, or squares beyond the range of f64.
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
