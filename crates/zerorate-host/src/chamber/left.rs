//! The state in which a chamber is left.

/// The state that a chamber stated when it was left. Fields that it did not state are unknown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Left {
    /// The set point that it took, or said that it holds, °C.
    pub set_c: Option<f64>,
    /// It said that it stopped.
    pub is_stopped: bool,
    /// Temperature of its air, °C.
    pub air_c: Option<f64>,
    /// The error, if there was one.
    pub why: Option<String>,
}

/// Set points have one decimal.
const SAME_C: f64 = 0.06;

impl Left {
    /// Whether it said that it holds this set point.
    #[must_use]
    pub fn holds(&self, safe_c: f64) -> bool {
        self.set_c.is_some_and(|set_c| (set_c - safe_c).abs() < SAME_C)
    }

    /// Whether it heats and cools to no other set point than this.
    #[must_use]
    pub fn is_safe(&self, safe_c: f64) -> bool {
        self.is_stopped || self.holds(safe_c)
    }
}
