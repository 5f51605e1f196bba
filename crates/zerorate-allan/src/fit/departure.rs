//! The distance u of a held parameter from its best value, for the statistic r* (Skovgaard, Bernoulli 2, 1996).

use super::scoring::Local;
use crate::linear::Square;
use alloc::vec::Vec;

/// u = |s_q|·(|i|·|i′_λλ|)^(−½), signed like the distance from the held value to the best.
///
/// A prime marks quantities at the held parameters. i = ½Σν ∂S∂Sᵀ/S² at the best parameters, and i′ is the same at the
/// held ones. i′_λλ has all parameters except the held one. s = ½Σν ∂S∂S′ᵀ/S′². s_q is s with q = ½Σν ∂S(1/S′ − 1/S)
/// in the column of the held parameter (Cramer's rule for s⁻¹q). For a single scale parameter u is √(ν/2)(S/S′ − 1).
/// `free` are the parameters that can move, and `held` is one of them.
pub(super) fn departure(nu: &[f64], best: &Local, there: &Local, free: &[usize], held: usize) -> Option<f64> {
    let n = free.len();
    let column = free.iter().position(|&place| place == held)?;
    let sum = |term: &dyn Fn(usize) -> f64| nu.iter().enumerate().map(|(row, nu)| nu / 2.0 * term(row)).sum::<f64>();
    let of = |a: &Local, b: &Local, over: &Local| {
        Square::from_fn(n, |i, j| {
            let (a, b) = (&a.slopes[free[i]], &b.slopes[free[j]]);
            sum(&|row| a[row] * b[row] / (over.density[row] * over.density[row]))
        })
    };
    let own = of(best, best, best);
    let scale: Vec<f64> = (0..n).map(|i| 1.0 / libm::sqrt(own.at(i, i))).collect();
    let scaled = |square: &Square| Square::from_fn(n, |i, j| square.at(i, j) * scale[i] * scale[j]);
    let (own, across, beside) = (scaled(&own), of(best, there, there), scaled(&of(there, there, there)));
    let q = |i: usize| {
        let slope = &best.slopes[free[i]];
        sum(&|row| slope[row] * (1.0 / there.density[row] - 1.0 / best.density[row]))
    };
    let with_q = |i: usize, j: usize| if j == column { q(i) } else { across.at(i, j) * scale[j] };
    let s_q = Square::from_fn(n, |i, j| with_q(i, j) * scale[i]);
    let skipped = |i: usize| if i < column { i } else { i + 1 };
    let others = Square::from_fn(n - 1, |i, j| beside.at(skipped(i), skipped(j)));
    let half = (own.cholesky()?.ln_determinant() + others.cholesky()?.ln_determinant()) / 2.0;
    Some(s_q.determinant() * libm::exp(-half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    /// One scale parameter with ν = 5. A second parameter has a row of its own.
    #[test]
    fn the_departure_of_one_scale_is_its_score() {
        let nu = [5.0, 9.0];
        let local = |a: f64, b: f64| Local { density: vec![a, b], slopes: vec![vec![1.0, 0.0], vec![0.0, 1.0]] };
        for held in [0.2, 0.9, 3.0] {
            let found = departure(&nu, &local(1.0, 2.0), &local(held, 2.0), &[0, 1], 0).unwrap();
            let expected = (5.0f64 / 2.0).sqrt() * (1.0 / held - 1.0);
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// The level of white noise takes one degree of freedom from its variance, and r* must allow for that. Here the
    /// level is a second parameter that only the last row has, and it takes all of that row.
    #[test]
    fn a_parameter_that_is_fitted_takes_its_freedom() {
        let nu = [4.0, 1.0];
        let local = |scale: f64, rest: f64| Local {
            density: vec![scale, scale + rest],
            slopes: vec![vec![1.0, 1.0], vec![0.0, 1.0]],
        };
        let found = departure(&nu, &local(1.0, 0.5), &local(2.0, -0.5), &[0, 1], 0).unwrap();
        let alone = (4.0f64 / 2.0).sqrt() * (1.0 / 2.0 - 1.0);
        assert!((found - alone).abs() < 1e-12, "{found} {alone}");
    }
}
