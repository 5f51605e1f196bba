//! Sums of squared differences over short runs: what the compiler turns into vector instructions, for the best of them that the
//! machine has. The lanes are independent sums and their number is fixed, so every machine rounds alike.

#![allow(clippy::needless_range_loop)]

use super::exact::ExactSum;

const LANES: usize = 16;

/// Second differences of f64.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn second_f64(a: &[f64], b: &[f64], c: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let ((a, a_rest), (b, b_rest), (c, c_rest)) = (a.as_chunks(), b.as_chunks(), c.as_chunks());
    for ((a, b), c) in a.iter().zip(b).zip(c) {
        let (a, b, c): (&[f64; LANES], &[f64; LANES], &[f64; LANES]) = (a, b, c);
        for l in 0..LANES {
            let d = (c[l] - b[l]) - (b[l] - a[l]);
            sums[l] += d * d;
        }
    }
    for (((a, b), c), sum) in a_rest.iter().zip(b_rest).zip(c_rest).zip(&mut sums) {
        let d = (c - b) - (b - a);
        *sum += d * d;
    }
    sums.iter().sum()
}

/// Third differences of f64.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn third_f64(a: &[f64], b: &[f64], c: &[f64], d: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let ((a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)) =
        (a.as_chunks(), b.as_chunks(), c.as_chunks(), d.as_chunks());
    for (((a, b), c), d) in a.iter().zip(b).zip(c).zip(d) {
        let (a, b, c, d): (&[f64; LANES], &[f64; LANES], &[f64; LANES], &[f64; LANES]) = (a, b, c, d);
        for l in 0..LANES {
            let third = ((d[l] - c[l]) - (c[l] - b[l])) - ((c[l] - b[l]) - (b[l] - a[l]));
            sums[l] += third * third;
        }
    }
    for ((((a, b), c), d), sum) in a_rest.iter().zip(b_rest).zip(c_rest).zip(d_rest).zip(&mut sums) {
        let third = ((d - c) - (c - b)) - ((c - b) - (b - a));
        *sum += third * third;
    }
    sums.iter().sum()
}

/// Chunks whose squares, each below 2^60, fit into a lane.
const RUN: usize = 16;

/// Second differences of i32 modulo 2^32, all of which are below 2^30.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn second_i32(a: &[i32], b: &[i32], c: &[i32]) -> ExactSum {
    let (mut high, mut low) = ([0u64; LANES], [0u64; LANES]);
    let ((a, a_rest), (b, b_rest), (c, c_rest)) = (a.as_chunks(), b.as_chunks(), c.as_chunks());
    for ((a, b), c) in a.chunks(RUN).zip(b.chunks(RUN)).zip(c.chunks(RUN)) {
        let mut sums = [0u64; LANES];
        for ((a, b), c) in a.iter().zip(b).zip(c) {
            let (a, b, c): (&[i32; LANES], &[i32; LANES], &[i32; LANES]) = (a, b, c);
            for l in 0..LANES {
                let d = i64::from(c[l].wrapping_add(a[l]).wrapping_sub(b[l].wrapping_add(b[l])));
                sums[l] = sums[l].wrapping_add((d * d) as u64);
            }
        }
        for l in 0..LANES {
            high[l] += sums[l] >> 32;
            low[l] += sums[l] & 0xffff_ffff;
        }
    }
    for ((a, b), c) in a_rest.iter().zip(b_rest).zip(c_rest) {
        let d = i64::from(c.wrapping_add(*a).wrapping_sub(b.wrapping_add(*b)));
        high[0] += (d * d) as u64 >> 32;
        low[0] += (d * d) as u64 & 0xffff_ffff;
    }
    joined(&high, &low)
}

/// Third differences of i32 modulo 2^32, all of which are below 2^30.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn third_i32(a: &[i32], b: &[i32], c: &[i32], d: &[i32]) -> ExactSum {
    let (mut high, mut low) = ([0u64; LANES], [0u64; LANES]);
    let ((a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)) =
        (a.as_chunks(), b.as_chunks(), c.as_chunks(), d.as_chunks());
    for (((a, b), c), d) in a.chunks(RUN).zip(b.chunks(RUN)).zip(c.chunks(RUN)).zip(d.chunks(RUN)) {
        let mut sums = [0u64; LANES];
        for (((a, b), c), d) in a.iter().zip(b).zip(c).zip(d) {
            let (a, b, c, d): (&[i32; LANES], &[i32; LANES], &[i32; LANES], &[i32; LANES]) = (a, b, c, d);
            for l in 0..LANES {
                let middle = c[l].wrapping_sub(b[l]);
                let third = i64::from(d[l].wrapping_sub(a[l]).wrapping_sub(middle.wrapping_mul(3)));
                sums[l] = sums[l].wrapping_add((third * third) as u64);
            }
        }
        for l in 0..LANES {
            high[l] += sums[l] >> 32;
            low[l] += sums[l] & 0xffff_ffff;
        }
    }
    for (((a, b), c), d) in a_rest.iter().zip(b_rest).zip(c_rest).zip(d_rest) {
        let third = i64::from(d.wrapping_sub(*a).wrapping_sub(c.wrapping_sub(*b).wrapping_mul(3)));
        high[0] += (third * third) as u64 >> 32;
        low[0] += (third * third) as u64 & 0xffff_ffff;
    }
    joined(&high, &low)
}

fn joined(high: &[u64], low: &[u64]) -> ExactSum {
    let mut sum = ExactSum::default();
    let total = |lanes: &[u64]| lanes.iter().map(|&lane| u128::from(lane)).sum::<u128>();
    sum.add(total(high), 32);
    sum.add(total(low), 0);
    sum
}

/// Second differences of i64 modulo 2^64, all of which are below 2^57; at most 2^14 of them.
pub(super) fn second_i64(a: &[i64], b: &[i64], c: &[i64]) -> ExactSum {
    let squares = a.iter().zip(b).zip(c).map(|((a, b), c)| {
        let d = c.wrapping_add(*a).wrapping_sub(b.wrapping_add(*b)).unsigned_abs();
        u128::from(d) * u128::from(d)
    });
    let mut sum = ExactSum::default();
    sum.add(squares.sum(), 0);
    sum
}

/// Third differences of i64 modulo 2^64, all of which are below 2^57; at most 2^14 of them.
pub(super) fn third_i64(a: &[i64], b: &[i64], c: &[i64], d: &[i64]) -> ExactSum {
    let squares = a.iter().zip(b).zip(c).zip(d).map(|(((a, b), c), d)| {
        let third = d.wrapping_sub(*a).wrapping_sub(c.wrapping_sub(*b).wrapping_mul(3)).unsigned_abs();
        u128::from(third) * u128::from(third)
    });
    let mut sum = ExactSum::default();
    sum.add(squares.sum(), 0);
    sum
}
