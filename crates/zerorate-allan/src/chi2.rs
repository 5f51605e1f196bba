//! χ² quantiles for real degrees of freedom.

use core::f64::consts::SQRT_2;
use special::{Error as _, Gamma as _};

/// From this number of degrees of freedom on, the Cornish–Fisher expansion is as accurate as the incomplete gamma
/// function, and faster.
const ASYMPTOTIC_FROM: f64 = 10_000.0;
/// Bound on the iterations. Bisection alone would need about sixty.
const STEPS: usize = 200;

/// The value that a χ² variable with real `degrees` > 0 of freedom stays below with probability `p`, 0 < p < 1.
///
/// Solves P(ν/2, χ²/2) = p, P the regularised lower incomplete gamma function (NIST SP 1065 equation 45 uses it;
/// Abramowitz & Stegun 26.4.19). The first guess is the approximation of Wilson & Hilferty (26.4.17). Relative error
/// below 1e-9 for ν ≥ 0.1 and 1e-6 < p < 1 − 1e-6. NaN outside the range of `p` or `degrees`.
///
/// ```
/// // Abramowitz & Stegun table 26.8: 95 % point for 10 degrees of freedom
/// assert!((zerorate_allan::chi2_quantile(0.95, 10.0) - 18.307_038).abs() < 1e-6);
/// ```
#[must_use]
pub fn chi2_quantile(p: f64, degrees: f64) -> f64 {
    let in_range = p > 0.0 && p < 1.0 && degrees > 0.0 && degrees.is_finite();
    match in_range {
        false => f64::NAN,
        true if degrees >= ASYMPTOTIC_FROM => cornish_fisher(normal_quantile(p), degrees),
        true => solve(p, degrees),
    }
}

/// The probability that a χ² variable with `degrees` > 0 degrees of freedom is above `value`, to 12 places. Beyond
/// them the incomplete gamma function differs between machines.
#[cfg(feature = "std")]
pub(super) fn chi2_above(value: f64, degrees: f64) -> f64 {
    let above = (1.0 - (value / 2.0).max(0.0).inc_gamma(degrees / 2.0)).clamp(0.0, 1.0);
    libm::round(above * 1e12) / 1e12
}

pub(crate) fn normal_quantile(p: f64) -> f64 {
    SQRT_2 * (2.0 * p - 1.0).inv_error()
}

/// The χ² quantile for the normal quantile `z`: Abramowitz & Stegun 26.2.49 with the cumulants of χ², to order ν^−3/2.
fn cornish_fisher(z: f64, degrees: f64) -> f64 {
    let root = libm::sqrt(2.0 * degrees);
    let z2 = z * z;
    degrees + z * root + 2.0 / 3.0 * (z2 - 1.0) + z * (z2 - 7.0) / (9.0 * root)
        - (6.0 * z2 * z2 + 14.0 * z2 - 32.0) / (405.0 * degrees)
        + z * (9.0 * z2 * z2 + 256.0 * z2 - 433.0) / (4860.0 * degrees * root)
}

/// Newton's method between shrinking bounds. A step beyond the bounds is replaced by their midpoint, or by twice the
/// value while there is no upper bound.
fn solve(p: f64, degrees: f64) -> f64 {
    let shape = degrees / 2.0;
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut half = wilson_hilferty(p, degrees).max(smallest(p, shape)) / 2.0;
    for _ in 0..STEPS {
        let excess = half.inc_gamma(shape) - p;
        if excess > 0.0 {
            high = half;
        } else {
            low = half;
        }
        let density = libm::exp((shape - 1.0) * libm::log(half) - half - libm::lgamma(shape));
        let newton = half - excess / density;
        let next = match (newton > low && newton < high, high.is_finite()) {
            (true, _) => newton,
            (false, true) => f64::midpoint(low, high),
            (false, false) => 2.0 * half,
        };
        if (next - half).abs() <= 1e-14 * half {
            return 2.0 * next;
        }
        half = next;
    }
    2.0 * half
}

fn wilson_hilferty(p: f64, degrees: f64) -> f64 {
    let spread = 2.0 / (9.0 * degrees);
    let root = 1.0 - spread + normal_quantile(p) * libm::sqrt(spread);
    degrees * root * root * root
}

/// A value below the quantile: P(a, x) < x^a / Γ(a + 1), solved for 2x.
fn smallest(p: f64, shape: f64) -> f64 {
    2.0 * libm::exp((libm::log(p) + libm::lgamma(shape + 1.0)) / shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of Abramowitz & Stegun table 26.8: Q (upper tail), ν, χ², accuracy of its digits.
    #[test]
    fn quantiles_agree_with_the_published_table() {
        for (upper, degrees, published, digits) in [
            (0.995, 1.0, 0.000_039_270_4, 1e-9),
            (0.995, 5.0, 0.411_742, 1e-6),
            (0.975, 2.0, 0.050_635_6, 1e-7),
            (0.95, 30.0, 18.492_6, 1e-4),
            (0.9, 1.0, 0.015_790_8, 1e-7),
            (0.5, 1.0, 0.454_937, 1e-6),
            (0.05, 10.0, 18.307_0, 1e-4),
            (0.025, 100.0, 129.561, 1e-3),
            (0.005, 1.0, 7.879_44, 1e-5),
            (0.001, 5.0, 20.515, 1e-3),
        ] {
            let quantile = chi2_quantile(1.0 - upper, degrees);
            assert!((quantile - published).abs() < digits, "Q {upper}, nu {degrees}: {quantile}");
        }
    }

    /// With two degrees of freedom the quantile is −2 ln(1 − p), for every p.
    #[test]
    fn two_degrees_are_exponential() {
        for p in [1e-6, 0.01, 0.1585, 0.5, 0.8415, 0.99, 1.0 - 1e-6] {
            let exact = -2.0 * libm::log1p(-p);
            assert!((chi2_quantile(p, 2.0) / exact - 1.0).abs() < 1e-9, "p {p}");
        }
    }

    /// With four degrees: p = 1 − e^(−x) (1 + x), x = χ²/2.
    #[test]
    fn four_degrees_fulfil_the_closed_form() {
        for p in [1e-4, 0.1585, 0.5, 0.8415, 0.9999] {
            let half = chi2_quantile(p, 4.0) / 2.0;
            assert!((1.0 - libm::exp(-half) * (1.0 + half) - p).abs() < 1e-13, "p {p}");
        }
    }

    /// One degree is a squared normal: p = erf(√(χ²/2)).
    #[test]
    fn one_degree_is_a_squared_normal() {
        for p in [0.001, 0.1585, 0.5, 0.683, 0.999] {
            let root = libm::sqrt(chi2_quantile(p, 1.0) / 2.0);
            assert!((libm::erf(root) - p).abs() < 1e-13, "p {p}");
        }
    }

    /// `solve` and the expansion are independent computations and agree where one takes over from the other.
    #[test]
    fn the_expansion_meets_the_gamma_function() {
        for p in [1e-6, 0.1585, 0.5, 0.8415, 1.0 - 1e-6] {
            let (below, above) = (solve(p, ASYMPTOTIC_FROM), chi2_quantile(p, ASYMPTOTIC_FROM));
            assert!((above / below - 1.0).abs() < 1e-9, "p {p}: {above} {below}");
        }
    }

    #[test]
    fn fewer_than_one_degree_and_nonsense() {
        let quantile = chi2_quantile(0.1585, 0.1);
        assert!(quantile > 0.0 && (quantile / 2.0).inc_gamma(0.05) > 0.158, "{quantile:e}");
        for (p, degrees) in [(0.0, 1.0), (1.0, 1.0), (0.5, 0.0), (0.5, -1.0), (f64::NAN, 1.0), (0.5, f64::INFINITY)] {
            assert!(chi2_quantile(p, degrees).is_nan());
        }
    }
}
