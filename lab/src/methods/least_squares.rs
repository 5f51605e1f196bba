//! The cubic polynomial that PX4 and ArduPilot fit.

use zerorate::Correction;
use zerorate_allan::linear::Cholesky;

/// The correction by an unweighted cubic fit to temperatures and rates, about a reference temperature.
pub fn cubic(points: &[(f64, f64)], reference_c: f64) -> Option<Correction> {
    let powers = |temp_c: f64| [0, 1, 2, 3].map(|k| (temp_c - reference_c).powi(k));
    let sum = |of: &dyn Fn(&[f64; 4], f64) -> f64| {
        points.iter().map(|(temp_c, rate_dps)| of(&powers(*temp_c), *rate_dps)).sum::<f64>()
    };
    let rows = (0..4).map(|i| (0..=i).map(|j| sum(&|powers, _| powers[i] * powers[j])).collect()).collect();
    let right = (0..4).map(|i| sum(&|powers, rate_dps| powers[i] * rate_dps));
    let bias = Cholesky::new(rows, 0.0)?.solve(right);
    Some(Correction {
        pbc_dps: -bias[0],
        btc_dps_per_c: -bias[1],
        t3_c: reference_c,
        btc2_dps_per_c2: -bias[2],
        btc3_dps_per_c3: -bias[3],
    })
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
