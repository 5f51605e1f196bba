/// A record at rest, sampled evenly.
#[derive(Clone, Copy, Debug)]
pub enum Input<'a> {
    /// Integer codes of the rate.
    Codes {
        /// One code for each sample that was taken.
        codes: &'a [i32],
        /// The places where samples were lost, sorted by `at`.
        gaps: &'a [Gap],
    },
    /// Rate; NaN is a missing sample.
    Rate(&'a [f64]),
    /// Phase, the integral of the rate over time (for a gyroscope: angle); NaN is a missing point.
    Phase(&'a [f64]),
}

/// A place in a record at which one or more adjacent samples were lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gap {
    /// Index of the first sample after the gap, among the samples that were taken.
    pub at: usize,
    /// Number of lost samples.
    pub missing: u64,
}

impl Input<'_> {
    /// Number of samples (for phase: points), missing ones included.
    pub fn len(&self) -> u64 {
        match self {
            Self::Codes { codes, gaps } => {
                gaps.iter().fold(codes.len() as u64, |sum, gap| sum.saturating_add(gap.missing))
            }
            Self::Rate(values) | Self::Phase(values) => values.len() as u64,
        }
    }

    /// Whether the record is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of missing samples (for phase: points).
    pub fn missing(&self) -> u64 {
        match self {
            Self::Codes { codes, .. } => self.len() - codes.len() as u64,
            Self::Rate(values) | Self::Phase(values) => values.iter().filter(|value| value.is_nan()).count() as u64,
        }
    }
}
