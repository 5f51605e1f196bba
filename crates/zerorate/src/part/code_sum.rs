//! Exact sums of codes.

use super::Scale;

/// The exact sum of fewer than 2³² codes of one channel, each less the zero code, and their number.
///
/// ```
/// use zerorate::{Axis, CodeSum};
/// let scale = Axis::ADIS16130.rate;
/// let mut rates = CodeSum::default();
/// rates.push(23_488);
/// rates.push(0);
/// assert_eq!(rates.mean(&scale), Some(0.5)); // °/s
/// assert_eq!(CodeSum::default().mean(&scale), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CodeSum {
    from_zero: i64,
    count: u32,
}

impl CodeSum {
    /// Adds a code less the zero code.
    #[inline]
    pub fn push(&mut self, from_zero: i32) {
        self.from_zero += i64::from(from_zero);
        self.count += 1;
    }

    /// Adds two sums.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { from_zero: self.from_zero + other.from_zero, count: self.count + other.count }
    }

    #[must_use]
    pub(crate) fn without(self, part: Self) -> Self {
        Self { from_zero: self.from_zero - part.from_zero, count: self.count - part.count }
    }

    /// Number of codes in the sum.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Mean of the codes as a value, by a single division. `None` without codes.
    #[must_use]
    pub fn mean(&self, scale: &Scale) -> Option<f64> {
        let lsb = f64::from(self.count) * scale.lsb_per_unit;
        (self.count > 0).then(|| self.from_zero as f64 / lsb + scale.zero_value)
    }
}
