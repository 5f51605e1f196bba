use super::{Reason, Stat};

/// How a statistic forms its differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// Second differences, every m-th or every one.
    Second { overlapping: bool },
    /// Third differences, every m-th or every one.
    Third { overlapping: bool },
    /// Sums of m adjacent second differences.
    Modified,
    /// Second differences of the reflected record.
    Total,
}

impl Shape {
    pub fn of(stat: Stat) -> Self {
        match stat {
            Stat::Adev => Self::Second { overlapping: false },
            Stat::Oadev => Self::Second { overlapping: true },
            Stat::Mdev | Stat::Tdev => Self::Modified,
            Stat::Hdev => Self::Third { overlapping: false },
            Stat::Ohdev => Self::Third { overlapping: true },
            Stat::Totdev => Self::Total,
        }
    }

    /// Whether averages of `m` fit into so many samples of the rate.
    pub fn check(self, samples: u64, m: u64, is_phase: bool) -> Result<usize, Reason> {
        let needs = match self {
            _ if m == 0 => return Err(Reason::ZeroLength),
            Self::Second { .. } => m.saturating_mul(2),
            Self::Third { .. } => m.saturating_mul(3),
            Self::Modified => m.saturating_mul(3) - 1,
            Self::Total => m.max(2),
        };
        let fits = usize::try_from(m).ok().filter(|_| needs <= samples);
        fits.ok_or(Reason::TooShort { needs: needs.saturating_add(u64::from(is_phase)) })
    }

    /// Terms for averages of `m` in so many points of phase.
    pub fn terms(self, points: usize, m: usize) -> usize {
        match self {
            Self::Second { overlapping: true } => points.saturating_sub(2 * m),
            Self::Second { overlapping: false } => points.saturating_sub(2 * m).div_ceil(m),
            Self::Third { overlapping: true } => points.saturating_sub(3 * m),
            Self::Third { overlapping: false } => points.saturating_sub(3 * m).div_ceil(m),
            Self::Modified => (points + 1).saturating_sub(3 * m),
            Self::Total => points - 2,
        }
    }

    /// Points at which a term may start: one more than the last of them.
    pub fn starts(self, points: usize, m: usize) -> usize {
        self.terms(points, m).checked_sub(1).map_or(0, |last| last * self.stride(m) + 1)
    }

    /// Whether every point starts a term and nothing is reflected or summed.
    pub fn is_overlapping(self) -> bool {
        matches!(self, Self::Second { overlapping: true } | Self::Third { overlapping: true })
    }

    /// From one term to the next.
    pub fn stride(self, m: usize) -> usize {
        match self {
            Self::Second { overlapping: false } | Self::Third { overlapping: false } => m,
            _ => 1,
        }
    }

    /// How many times the difference of averages that of the phase is.
    pub fn per(self, m: usize) -> f64 {
        let m = m as f64;
        if self == Self::Modified { m * m } else { m }
    }

    /// What the mean square is divided by, so that the statistic of white noise is that of its averages.
    pub fn divisor(self) -> f64 {
        if matches!(self, Self::Third { .. }) { 6.0 } else { 2.0 }
    }
}
