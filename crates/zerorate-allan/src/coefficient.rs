//! A noise coefficient and its interval.

/// A noise coefficient with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// Best value, never NaN. For N, B, Q and R it is the most likely value, zero if the best fit has none of this
    /// noise. K rests on few independent differences; its value is the mean of its confidence distribution, which has
    /// less error and no zeros.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub lo: f64,
    /// Upper end of the 95 % interval.
    pub hi: f64,
    /// Whether zero is outside the interval.
    pub identified: bool,
    /// Record length, s, that would identify a coefficient of `value` or `hi / 2`, whichever is larger, in four of
    /// five cases. `None` if the coefficient is identified.
    pub needed_s: Option<f64>,
}
