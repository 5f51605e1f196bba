//! The temperatures at which a correction holds, and the warning about other temperatures.

use crate::notice::Warning;
use crate::part::UNKNOWN_MARGIN_C;

/// The span of temperatures at which a correction holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Validity {
    /// Lowest temperature seen while measuring, °C.
    pub temp_min_c: f64,
    /// Highest temperature seen while measuring, °C.
    pub temp_max_c: f64,
    /// Distance beyond the span up to which a temperature gives no warning, °C.
    pub margin_c: f64,
}

impl Validity {
    /// The margin if the noise of the temperature is not known, °C: ten times the noise of a single reading of the
    /// ADIS16130 (M-05).
    pub const MARGIN_C: f64 = UNKNOWN_MARGIN_C;

    /// Whether the correction holds at a temperature. Elsewhere it is an extrapolation.
    #[must_use]
    pub fn covers(&self, temp_c: f64) -> bool {
        (self.temp_min_c - self.margin_c..=self.temp_max_c + self.margin_c).contains(&temp_c)
    }

    /// Returns a warning if temperatures from `low_c` to `high_c` leave the span by more than the margin.
    #[must_use]
    pub fn warning(&self, low_c: f64, high_c: f64) -> Option<Warning> {
        let Self { temp_min_c, temp_max_c, .. } = *self;
        let inside = self.covers(low_c) && self.covers(high_c);
        (!inside).then_some(Warning::Extrapolated { low_c, high_c, temp_min_c, temp_max_c })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_end_may_leave_the_span() {
        let validity = Validity { temp_min_c: 25.0, temp_max_c: 33.0, margin_c: 0.5 };
        let warns = |low_c, high_c| validity.warning(low_c, high_c).is_some();
        assert!(!warns(24.6, 33.4));
        assert!(warns(24.4, 33.0) && warns(25.0, 33.6) && warns(40.0, 50.0));
    }
}
