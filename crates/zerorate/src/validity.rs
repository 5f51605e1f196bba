//! Where a correction holds, and what to say elsewhere.

use crate::notice::Warning;
use crate::part::UNKNOWN_MARGIN_C;

/// Where a correction holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Validity {
    /// Lowest temperature seen while measuring, °C.
    pub temp_min_c: f64,
    /// Highest temperature seen while measuring, °C.
    pub temp_max_c: f64,
    /// How far a temperature may leave the span unremarked, °C.
    pub margin_c: f64,
}

impl Validity {
    /// The margin where nothing else is known, °C: what ten times the noise of a single reading is for the ADIS16130
    /// (M-05).
    pub const MARGIN_C: f64 = UNKNOWN_MARGIN_C;

    /// Whether the correction holds at a temperature; elsewhere it is an extrapolation.
    #[must_use]
    pub fn covers(&self, temp_c: f64) -> bool {
        (self.temp_min_c - self.margin_c..=self.temp_max_c + self.margin_c).contains(&temp_c)
    }

    /// What to say where temperatures from `low_c` to `high_c` leave the span.
    #[must_use]
    pub fn warning(&self, low_c: f64, high_c: f64) -> Option<Warning> {
        let Self { temp_min_c, temp_max_c, .. } = *self;
        let inside = self.covers(low_c) && self.covers(high_c);
        (!inside).then_some(Warning::Extrapolated { low_c, high_c, temp_min_c, temp_max_c })
    }
}
