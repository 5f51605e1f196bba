//! A noise coefficient and its interval.

/// A noise coefficient with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// Best value, never NaN. N, B, Q and R have the most likely value, which is zero where the best fit has none of
    /// this noise. K rests on few independent differences and has the mean of its confidence distribution, which has
    /// less error and no zeros.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub lo: f64,
    /// Upper end of the 95 % interval.
    pub hi: f64,
    /// Zero is outside the interval.
    pub identified: bool,
    /// Length of a record, s, in which a coefficient of `value` or `hi / 2`, whichever is more, would be identified in
    /// four of five cases. None where it is identified.
    pub needed_s: Option<f64>,
}
