//! Polynomials over temperature that are orthogonal over the blocks of a recording.

use super::{Block, TERMS};
use alloc::vec::Vec;

/// Polynomials of degree 0 to 3 in the temperature, with the leading coefficient 1 in x = (T − centre)/half span.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    centre_c: f64,
    pub(super) half_span_c: f64,
    /// Coefficients in x, the constant first.
    polynomials: [[f64; TERMS]; TERMS],
}

/// Half span below which the temperature counts as constant, °C.
const LEAST_HALF_SPAN_C: f64 = 1e-6;

impl Basis {
    /// Makes polynomials that are orthogonal over these blocks, about their mean temperature.
    pub(super) fn over(blocks: &[Block]) -> Self {
        let temps = || blocks.iter().map(|block| block.temp_c);
        let (low_c, high_c) = temps().fold((f64::MAX, f64::MIN), |(low, high), c| (low.min(c), high.max(c)));
        let centre_c = temps().sum::<f64>() / blocks.len() as f64;
        let half_span_c = ((high_c - low_c) / 2.0).max(LEAST_HALF_SPAN_C);
        let xs: Vec<f64> = temps().map(|temp_c| (temp_c - centre_c) / half_span_c).collect();
        let mut polynomials = [[0.0; TERMS]; TERMS];
        for degree in 0..TERMS {
            polynomials[degree][degree] = 1.0;
            for lower in 0..degree {
                let [mine, other] = [polynomials[degree], polynomials[lower]];
                let product: f64 = xs.iter().map(|x| at(&mine, *x) * at(&other, *x)).sum();
                let square: f64 = xs.iter().map(|x| at(&other, *x) * at(&other, *x)).sum();
                let share = if square > 0.0 { product / square } else { 0.0 };
                (0..TERMS).for_each(|k| polynomials[degree][k] -= share * other[k]);
            }
        }
        Self { centre_c, half_span_c, polynomials }
    }

    pub(super) fn at(&self, degree: usize, temp_c: f64) -> f64 {
        at(&self.polynomials[degree], (temp_c - self.centre_c) / self.half_span_c)
    }

    /// The coefficients of the polynomial of a degree in powers of T − `reference_c`.
    pub(super) fn about(&self, degree: usize, reference_c: f64) -> [f64; TERMS] {
        let (slope, offset) = (1.0 / self.half_span_c, (reference_c - self.centre_c) / self.half_span_c);
        self.polynomials[degree].iter().rev().fold([0.0; TERMS], |sum, coefficient| {
            // sum · (slope · d + offset) + coefficient
            let mut next = [0.0; TERMS];
            for (k, value) in sum.iter().enumerate() {
                next[k] += offset * value;
                if k + 1 < TERMS {
                    next[k + 1] += slope * value;
                }
            }
            next[0] += coefficient;
            next
        })
    }
}

fn at(polynomial: &[f64; TERMS], x: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}
