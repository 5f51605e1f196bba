//! The polynomials that PX4 and ArduPilot fit.

use zerorate::Correction;
use zerorate_allan::linear::Cholesky;

/// The correction by an unweighted cubic fit to temperatures and rates, about a reference temperature.
pub fn cubic(points: &[(f64, f64)], reference_c: f64) -> Option<Correction> {
    let bias = polynomial(points, 3, |temp_c| temp_c - reference_c)?;
    Some(Correction {
        pbc_dps: -bias[0],
        btc_dps_per_c: -bias[1],
        t3_c: reference_c,
        btc2_dps_per_c2: -bias[2],
        btc3_dps_per_c3: -bias[3],
    })
}

/// The coefficients of the least-squares polynomial of this order, in powers of `x` of the temperature.
pub fn polynomial(points: &[(f64, f64)], order: usize, x: impl Fn(f64) -> f64) -> Option<Vec<f64>> {
    let powers = |temp_c: f64| -> Vec<f64> { (0..=order).map(|k| x(temp_c).powi(k as i32)).collect() };
    let all: Vec<(Vec<f64>, f64)> = points.iter().map(|(temp_c, rate)| (powers(*temp_c), *rate)).collect();
    let product = |i: usize, j: usize| all.iter().map(|(powers, _)| powers[i] * powers[j]).sum::<f64>();
    let rows = (0..=order).map(|i| (0..=i).map(|j| product(i, j)).collect()).collect();
    let right = (0..=order).map(|i| all.iter().map(|(powers, rate)| powers[i] * rate).sum::<f64>());
    Some(Cholesky::new(rows, 0.0)?.solve(right))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_found_from_any_reference() {
        let bias = |temp_c: f64| 0.3 - 0.04 * temp_c + 0.002 * temp_c * temp_c - 1e-5 * temp_c.powi(3);
        let points: Vec<(f64, f64)> =
            (0..40).map(|k| 25.0 + 0.2 * f64::from(k)).map(|temp_c| (temp_c, bias(temp_c))).collect();
        for reference_c in [29.0, 35.0] {
            let found = cubic(&points, reference_c).unwrap();
            assert!((25..33).all(|temp_c| (found.at(temp_c.into()) + bias(temp_c.into())).abs() < 1e-6), "{found:?}");
        }
        assert!(cubic(&points[..3], 29.0).is_none(), "three points have no cubic");
    }
}
