//! Allan deviation of a rate record at rest: how much the mean over τ moves from one stretch to the next.

/// One point of an Allan deviation curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Averaging time τ = m / rate, s.
    pub tau_s: f64,
    /// Samples per average.
    pub m: u64,
    /// Deviation, in the unit of the input times its scale (°/s for a rate in °/s).
    pub dev: f64,
    /// Differences that entered: `len − 2m + 1`.
    pub n: u64,
}

/// Averages of 1, 2, 4 … samples, as long as at least one difference of two adjacent averages fits into `len` samples.
pub fn octaves(len: usize) -> alloc::vec::Vec<u64> {
    let longest = len as u64 / 2;
    core::iter::successors(Some(1u64), |m| m.checked_mul(2)).take_while(|m| *m <= longest).collect()
}

/// Overlapping Allan deviation of integer codes, for each averaging length in `m` that fits into the record.
///
/// With x the running sum of the codes: `σ²(τ) = Σ (x[i+2m] − 2x[i+m] + x[i])² / (2 m² (len − 2m + 1))`, times `scale²`
/// (IEEE Std 952-1997 annex C; NIST SP 1065 equation 11 with phase x). The sum of squares is exact, so the result does not
/// depend on the machine; only the last division and the root round.
///
/// ```
/// let codes = [1, 3, 2, 4];
/// let at_one = zerorate::allan::oadev_codes(&codes, 100.0, 0.5, &[1])[0];
/// // differences +2, −1, +2: σ² = 9 / (2 · 3), times 0.5²
/// assert_eq!(at_one.dev, 0.5 * 1.5f64.sqrt());
/// ```
pub fn oadev_codes(codes: &[i32], rate_hz: f64, scale: f64, m: &[u64]) -> alloc::vec::Vec<Point> {
    let x = running_sum(codes.iter().map(|&code| i64::from(code)), |sum, code| sum + code);
    points(&x, rate_hz, m, |x, m| scale * root_mean(sum_of_squares(x, m), x, m))
}

/// Overlapping Allan deviation of a rate in physical units; the mean is removed before the running sum is formed.
///
/// Same formula as [`oadev_codes`], in f64.
pub fn oadev(rate: &[f64], rate_hz: f64, m: &[u64]) -> alloc::vec::Vec<Point> {
    let mean = rate.iter().sum::<f64>() / rate.len().max(1) as f64;
    let x = running_sum(rate.iter().map(|&value| value - mean), |sum, value| sum + value);
    points(&x, rate_hz, m, |x, m| {
        let squares = differences(x, m)
            .map(|(a, b, c)| {
                let d = (c - b) - (b - a);
                d * d
            })
            .sum();
        root_mean(squares, x, m)
    })
}

fn running_sum<T: Copy + Default>(values: impl Iterator<Item = T>, add: impl Fn(T, T) -> T) -> alloc::vec::Vec<T> {
    let mut sum = T::default();
    let sums = values.map(|value| {
        sum = add(sum, value);
        sum
    });
    core::iter::once(T::default()).chain(sums).collect()
}

fn points<T>(x: &[T], rate_hz: f64, m: &[u64], dev: impl Fn(&[T], usize) -> f64) -> alloc::vec::Vec<Point> {
    let fits = |m: &&u64| **m >= 1 && (2 * **m as usize) < x.len();
    m.iter()
        .filter(fits)
        .map(|&m| Point { tau_s: m as f64 / rate_hz, m, dev: dev(x, m as usize), n: (x.len() - 2 * m as usize) as u64 })
        .collect()
}

fn differences<T: Copy>(x: &[T], m: usize) -> impl Iterator<Item = (T, T, T)> {
    x.iter().zip(&x[m..]).zip(&x[2 * m..]).map(|((&a, &b), &c)| (a, b, c))
}

/// Exact, whatever the codes: the halves of each 128-bit square are summed apart, and neither sum can overflow.
fn sum_of_squares(x: &[i64], m: usize) -> f64 {
    let (mut high, mut low) = (0u128, 0u128);
    for (a, b, c) in differences(x, m) {
        let d = i128::from(c - b) - i128::from(b - a);
        let square = d.unsigned_abs() * d.unsigned_abs();
        high += square >> 64;
        low += square & u128::from(u64::MAX);
    }
    (high as f64) * 18_446_744_073_709_551_616.0 + low as f64
}

fn root_mean<T>(sum_of_squares: f64, x: &[T], m: usize) -> f64 {
    let n = (x.len() - 2 * m) as f64;
    libm::sqrt(sum_of_squares / (2.0 * n)) / m as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition, without running sums: means of m, differences of adjacent means.
    fn by_definition(rate: &[f64], m: usize) -> f64 {
        let mean = |i: usize| rate[i..i + m].iter().sum::<f64>() / m as f64;
        let n = rate.len() - 2 * m + 1;
        let squares: f64 = (0..n).map(|i| (mean(i + m) - mean(i)).powi(2)).sum();
        (squares / (2 * n) as f64).sqrt()
    }

    /// NIST SP 1065 section 12.4: the 1000-point test suite, σ(τ) of its overlapping Allan deviation.
    #[test]
    fn nbs14_1000_points() {
        let mut n = 1234567890u64;
        let rate: alloc::vec::Vec<f64> = core::iter::repeat_with(|| {
            let value = n as f64 / 2147483647.0;
            n = (16807 * n) % 2147483647;
            value
        })
        .take(1000)
        .collect();
        for (m, published) in [(1, 2.922319e-1), (10, 9.159953e-2), (100, 3.241343e-2)] {
            let dev = oadev(&rate, 1.0, &[m])[0].dev;
            assert!((dev / published - 1.0).abs() < 3e-7, "m = {m}: {dev}");
        }
    }

    #[test]
    fn codes_and_floats_follow_the_definition() {
        let codes: alloc::vec::Vec<i32> = (0..257).map(|i: i32| (i * i * 7919) % 10_007 - 5_000).collect();
        let rate: alloc::vec::Vec<f64> = codes.iter().map(|&c| f64::from(c)).collect();
        for m in octaves(codes.len()) {
            let truth = by_definition(&rate, m as usize);
            assert!((oadev_codes(&codes, 1.0, 1.0, &[m])[0].dev / truth - 1.0).abs() < 1e-13, "codes, m = {m}");
            assert!((oadev(&rate, 1.0, &[m])[0].dev / truth - 1.0).abs() < 1e-12, "floats, m = {m}");
        }
    }

    #[test]
    fn extreme_codes_do_not_overflow() {
        let codes: alloc::vec::Vec<i32> =
            (0..4096).map(|i| if i / 1024 % 2 == 0 { i32::MAX } else { i32::MIN }).collect();
        let dev = oadev_codes(&codes, 1.0, 1.0, &[1024])[0].dev;
        let rate: alloc::vec::Vec<f64> = codes.iter().map(|&c| f64::from(c)).collect();
        assert!((dev / by_definition(&rate, 1024) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn averages_that_do_not_fit_are_left_out() {
        assert_eq!(octaves(1), []);
        assert_eq!(octaves(9), [1, 2, 4]);
        assert!(oadev(&[1.0, 2.0, 3.0], 1.0, &[0, 2]).is_empty());
        assert_eq!(oadev(&[1.0, 2.0], 1.0, &[1])[0].n, 1);
    }
}
