//! Confidence limits of a deviation.

use super::chi2::chi2_quantile;

/// Two-sided limits `(lo, hi)` of a deviation with `edf` equivalent degrees of freedom. Of all records of the same
/// noise, the share `confidence` (0.683 for one sigma) has limits that enclose the true deviation.
///
/// `lo = dev √(edf / χ²(½ + c/2))` and `hi = dev √(edf / χ²(½ − c/2))`, since edf·σ̂²/σ² follows χ² with edf degrees
/// of freedom (NIST SP 1065 section 5.3.2, equations 45 and 46). The limits have the unit of `dev`. For a deviation of
/// 0 both are 0. If `edf` is NaN or not positive, the limits are 0 and infinity.
///
/// ```
/// // NIST SP 1065 table 32: σ = 9.159953e-2, edf 146.177, 95 %; its χ² is an approximation
/// let (lo, hi) = zerorate_allan::interval(9.159953e-2, 146.177, 0.95);
/// assert!((lo / 8.223942e-2 - 1.0).abs() < 2e-3 && (hi / 1.035201e-1 - 1.0).abs() < 2e-3);
/// ```
#[must_use]
pub fn interval(dev: f64, edf: f64, confidence: f64) -> (f64, f64) {
    if dev == 0.0 {
        return (0.0, 0.0);
    }
    if edf.is_nan() || edf <= 0.0 {
        return (0.0, f64::INFINITY);
    }
    let tail = (1.0 - confidence.clamp(1e-9, 1.0 - 1e-9)) / 2.0;
    let limit = |p: f64| dev * libm::sqrt(edf / chi2_quantile(p, edf));
    (limit(1.0 - tail), limit(tail))
}
