//! A noise coefficient and its interval.

/// A noise coefficient with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// Best value, never NaN. For N, B, Q and R it is the most likely value, zero if the best fit has none of this
    /// noise. K rests on few coefficients of the spectrum, so K² is the mean of its confidence distribution. This mean
    /// has a smaller error and is never zero.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub lo: f64,
    /// Upper end of the 95 % interval.
    pub hi: f64,
    /// Whether zero is outside the interval, the model is accepted and no other explanation fits as well.
    pub identified: bool,
    /// Record length, s, that would identify a coefficient of `value` or `hi / 2`, whichever is larger, in four of
    /// five cases. Infinite if no record would identify it. `None` if the coefficient is identified, the model is
    /// rejected, a second explanation fits as well, or for R.
    pub needed_s: Option<f64>,
}
