//! Equivalent degrees of freedom of the deviations.

use super::{Difference, Stat};

/// Largest number of terms that are summed before tables take over (J_max in Greenhall & Riley 2003).
const MOST_TERMS: f64 = 100.0;
/// Largest filter factor in the sum for flicker phase noise. With larger ones the differences lose their digits.
const LONGEST_FILTER: f64 = 1e6;

/// Equivalent degrees of freedom of the statistic `stat` at the averaging length `m`, for power-law noise S_y(f) ∝
/// f^`alpha`. The record has `phase_points` points (one more than samples of rate) without gaps.
///
/// ADEV, OADEV, MDEV, TDEV, HDEV, OHDEV use [`finite_difference_edf`]. TOTDEV uses `b T/τ − c`, where T is the record
/// length, for white (b, c = 1.5, 0), flicker (1.17, 0.22) and random walk (0.93, 0.36) frequency noise (NIST SP 1065
/// section 5.4.2 table 6). For phase noise (α > 0) TOTDEV is treated as OADEV, whose terms it repeats. Exponents for
/// which the statistic does not converge count as the nearest one for which it does: −2…2, for HDEV and OHDEV −4…2.
/// The result is at least 1, or 0 if the record has no term (for TOTDEV with α ≤ 0: fewer than 3 points).
#[must_use]
pub fn edf(stat: Stat, alpha: i32, m: u64, phase_points: u64) -> f64 {
    let row = stat.row();
    if row.has_total_edf && alpha <= 0 {
        return total_edf(alpha, m, phase_points);
    }
    finite_difference_edf(row.kernel.difference(), alpha, m, phase_points)
}

/// Equivalent degrees of freedom of a finite-difference variance: Greenhall & Riley, "Uncertainty of stability
/// variances based on finite differences", PTTI 2003; NIST SP 1065 section 5.4.1, the full version.
///
/// The symbols are the paper's. N is the number of phase points, m = τ/τ0, F the filter factor and S the stride
/// factor. L = m/F + m d is the reach of one term, M = 1 + ⌊S (N − L)/m⌋ the number of terms, and J = min(M, (d + 1)
/// S). Up to J = 100 the correlation of the terms is summed exactly: `edf = M s_z(0)² / BasicSum(J, M, S, F, α, d)`.
/// Beyond, the paper's asymptotic formulas (tables 1 to 3) and truncation apply. The result is within 3 % of the
/// definition for even α. The paper averages the phase over each sample. For a rate with independent samples the true
/// edf is 15 % below the result at m = 1. For OADEV the true edf is above by 9 % at m = 8 and 5 % at m = 20.
#[must_use]
pub fn finite_difference_edf(difference: Difference, alpha: i32, m: u64, phase_points: u64) -> f64 {
    let order = difference.order.clamp(1, 3);
    let case = Case { alpha: alpha.clamp(2 - 2 * order as i32, 2), d: order };
    let reach = if difference.modified {
        m.saturating_mul(u64::from(order) + 1)
    } else {
        m.saturating_mul(order.into()).saturating_add(1)
    };
    if m == 0 || phase_points < reach {
        return 0.0;
    }
    let stride = if difference.overlapped { m } else { 1 };
    let terms = 1 + (phase_points - reach) / (m / stride);
    let shape = Terms { m: m as f64, stride: stride as f64, count: terms as f64, ratio: terms as f64 / stride as f64 };
    let edf = if difference.modified { case.modified(&shape) } else { case.unmodified(&shape) };
    edf.max(1.0)
}

fn total_edf(alpha: i32, m: u64, phase_points: u64) -> f64 {
    let (b, c) = match alpha {
        0.. => (1.5, 0.0),
        -1 => (1.17, 0.22),
        _ => (0.93, 0.36),
    };
    if m == 0 || phase_points < 3 {
        return 0.0;
    }
    (b * (phase_points - 1) as f64 / m as f64 - c).max(1.0)
}

struct Terms {
    m: f64,
    stride: f64,
    /// M, the number of terms
    count: f64,
    /// r = M/S, the record length in units of τ
    ratio: f64,
}

/// A noise exponent and an order of difference.
struct Case {
    alpha: i32,
    d: u32,
}

impl Case {
    /// Case 1 of Greenhall & Riley: modified variances, every α.
    fn modified(&self, terms: &Terms) -> f64 {
        match self.regime(terms) {
            Regime::Sum(j) => self.sum(j, terms.count, terms.stride, 1.0),
            Regime::Long => asymptote(terms.ratio, self.table(&MODIFIED)),
            Regime::Truncated => self.sum(MOST_TERMS, MOST_TERMS, MOST_TERMS / terms.ratio, 1.0),
        }
    }

    /// Cases 2, 3, 4 of Greenhall & Riley: unmodified variances with α ≤ 0, 1, 2.
    fn unmodified(&self, terms: &Terms) -> f64 {
        match self.alpha {
            2 => self.white_phase(terms),
            1 => self.flicker_phase(terms),
            _ => self.frequency_noise(terms),
        }
    }

    fn frequency_noise(&self, terms: &Terms) -> f64 {
        let short = terms.m * f64::from(self.d + 1) <= MOST_TERMS;
        match self.regime(terms) {
            Regime::Sum(j) => self.sum(j, terms.count, terms.stride, if short { terms.m } else { f64::INFINITY }),
            Regime::Long => asymptote(terms.ratio, self.table(&UNMODIFIED)),
            Regime::Truncated => self.sum(MOST_TERMS, MOST_TERMS, MOST_TERMS / terms.ratio, f64::INFINITY),
        }
    }

    fn flicker_phase(&self, terms: &Terms) -> f64 {
        let (b0, b1) = FLICKER_PHASE[self.d as usize - 1];
        let scale = b0 + b1 * libm::log(terms.m);
        match self.regime(terms) {
            Regime::Sum(j) => self.sum(j, terms.count, terms.stride, terms.m.min(LONGEST_FILTER)),
            Regime::Long => scale * scale * asymptote(terms.ratio, self.table(&UNMODIFIED)),
            Regime::Truncated => {
                let stride = MOST_TERMS / terms.ratio;
                scale * scale * MOST_TERMS / self.basic_sum(MOST_TERMS, MOST_TERMS, stride, stride)
            }
        }
    }

    fn white_phase(&self, terms: &Terms) -> f64 {
        let d = self.d;
        let (r, middle) = (terms.ratio, binomial(2 * d, d));
        let spans = libm::ceil(r) as u32;
        if spans > d {
            let a0 = binomial(4 * d, 2 * d) / (middle * middle);
            return terms.count / (a0 - f64::from(d) / 2.0 / r);
        }
        let tail: f64 = (1..spans)
            .map(|k| {
                let weight = binomial(2 * d, d - k);
                (1.0 - f64::from(k) / r) * weight * weight
            })
            .sum();
        terms.count / (1.0 + 2.0 / (middle * middle) * tail)
    }

    fn regime(&self, terms: &Terms) -> Regime {
        let reach = f64::from(self.d + 1);
        let j = terms.count.min(reach * terms.stride);
        if j <= MOST_TERMS {
            Regime::Sum(j)
        } else if terms.ratio >= reach {
            Regime::Long
        } else {
            Regime::Truncated
        }
    }

    fn table(&self, table: &[[(f64, f64); 3]; 7]) -> (f64, f64) {
        table[(2 - self.alpha) as usize][self.d as usize - 1]
    }

    fn sum(&self, j: f64, count: f64, stride: f64, filter: f64) -> f64 {
        let own = self.sz(0.0, filter);
        own * own * count / self.basic_sum(j, count, stride, filter)
    }

    /// BasicSum, equation 10 of Greenhall & Riley.
    fn basic_sum(&self, j: f64, count: f64, stride: f64, filter: f64) -> f64 {
        let squared = |t: f64| {
            let covariance = self.sz(t, filter);
            covariance * covariance
        };
        let inner: f64 = (1..j as u32).map(|k| (1.0 - f64::from(k) / count) * squared(f64::from(k) / stride)).sum();
        squared(0.0) + (1.0 - j / count) * squared(j / stride) + 2.0 * inner
    }

    /// s_z: covariance of two differences of order d that are t τ apart, up to a constant factor.
    fn sz(&self, t: f64, filter: f64) -> f64 {
        let d = self.d as i32;
        (-d..=d)
            .map(|k| {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                sign * binomial(2 * self.d, (d + k) as u32) * self.sx(t + f64::from(k), filter)
            })
            .sum()
    }

    /// s_x: covariance of two averages of the phase over τ/F, which are t τ apart, up to a constant factor.
    fn sx(&self, t: f64, filter: f64) -> f64 {
        if filter.is_infinite() {
            return sw(t, self.alpha + 2);
        }
        let side = 1.0 / filter;
        filter * filter * (2.0 * sw(t, self.alpha) - sw(t - side, self.alpha) - sw(t + side, self.alpha))
    }
}

enum Regime {
    /// J terms are few enough to be summed.
    Sum(f64),
    /// The record is longer than the correlation.
    Long,
    /// The terms are too many to sum, and the record is too short for the asymptote: a coarser sum is used.
    Truncated,
}

fn asymptote(ratio: f64, (a0, a1): (f64, f64)) -> f64 {
    ratio / (a0 - a1 / ratio)
}

/// s_w: generalised autocovariance of the twice integrated noise, up to a constant factor.
fn sw(t: f64, alpha: i32) -> f64 {
    let t = t.abs();
    if t == 0.0 {
        return 0.0;
    }
    let power = libm::pow(t, f64::from(3 - alpha));
    match alpha {
        2 | -2 => -power,
        1 | -3 => power * libm::log(t),
        -1 => -power * libm::log(t),
        _ => power,
    }
}

fn binomial(n: u32, k: u32) -> f64 {
    (1..=k).fold(1.0, |product, i| product * f64::from(n + 1 - i) / f64::from(i))
}

/// Table 1 of Greenhall & Riley, (a0, a1) of modified variances: α = 2 … −4, d = 1, 2, 3. Pairs that do not converge
/// are never looked up.
const MODIFIED: [[(f64, f64); 3]; 7] = [
    [(2.0 / 3.0, 1.0 / 3.0), (7.0 / 9.0, 1.0 / 2.0), (22.0 / 25.0, 2.0 / 3.0)],
    [(0.840, 0.345), (0.997, 0.616), (1.141, 0.843)],
    [(1.079, 0.368), (1.033, 0.607), (1.184, 0.848)],
    [NONE, (1.048, 0.534), (1.180, 0.816)],
    [NONE, (1.302, 0.535), (1.175, 0.777)],
    [NONE, NONE, (1.194, 0.703)],
    [NONE, NONE, (1.489, 0.702)],
];

/// Table 2 of Greenhall & Riley, (a0, a1) of unmodified variances: α = 2 … −4, d = 1, 2, 3.
const UNMODIFIED: [[(f64, f64); 3]; 7] = [
    [(3.0 / 2.0, 1.0 / 2.0), (35.0 / 18.0, 1.0), (231.0 / 100.0, 3.0 / 2.0)],
    [(78.6, 25.2), (790.0, 410.0), (9950.0, 6520.0)],
    [(2.0 / 3.0, 1.0 / 6.0), (2.0 / 3.0, 1.0 / 3.0), (7.0 / 9.0, 1.0 / 2.0)],
    [NONE, (0.852, 0.375), (0.997, 0.617)],
    [NONE, (1.079, 0.368), (1.033, 0.607)],
    [NONE, NONE, (1.053, 0.553)],
    [NONE, NONE, (1.302, 0.535)],
];

const NONE: (f64, f64) = (1.0, 0.0);

/// Table 3 of Greenhall & Riley, (b0, b1): s_z(0) of flicker phase noise is b0 + b1 ln m, d = 1, 2, 3.
const FLICKER_PHASE: [(f64, f64); 3] = [(6.0, 4.0), (15.23, 12.0), (47.8, 40.0)];

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    /// Parts per sample. The paper averages the phase over each sample. A sum over these parts approximates the
    /// average.
    const FINE: usize = 16;

    /// The definition: edf = 2 E²/Var of the mean of M squares, for Gaussian noise of an even exponent. Each term is a
    /// sum of independent normal numbers. Its weights are the differences of order d over m of the phase. They are
    /// averaged over a sample (over m, if modified) and integrated (2 − α)/2 times. The covariance of two terms then
    /// follows by multiplication. White phase noise is not averaged.
    fn by_definition(difference: Difference, alpha: i32, m: usize, points: usize) -> f64 {
        let fine = if alpha == 2 { 1 } else { FINE };
        let width = if difference.modified { m * fine } else { fine };
        let mut weights = vec![1.0; width];
        for _ in 0..difference.order {
            weights.resize(weights.len() + m * fine, 0.0);
            for i in (m * fine..weights.len()).rev() {
                weights[i] -= weights[i - m * fine];
            }
        }
        for _ in 0..(2 - alpha) / 2 {
            let mut sum = 0.0;
            weights.iter_mut().for_each(|weight| {
                sum += *weight;
                *weight = sum;
            });
        }
        let stride = if difference.overlapped { 1 } else { m };
        let terms = 1 + (points - weights.len() / fine) / stride;
        let covariance =
            |lag: usize| -> f64 { weights.iter().zip(weights.iter().skip(lag * fine)).map(|(a, b)| a * b).sum() };
        let reach = terms.min(weights.len() / fine / stride + 1);
        let others: f64 = (1..reach).map(|k| 2.0 * (terms - k) as f64 * covariance(k * stride).powi(2)).sum();
        let own = covariance(0);
        (terms as f64 * own).powi(2) / (terms as f64 * own.powi(2) + others)
    }

    /// NIST SP 1065 section 5.4.2: b T/τ − c.
    #[test]
    fn totdev_has_the_published_degrees_of_freedom() {
        assert_eq!(edf(Stat::Totdev, 0, 10, 1001), 150.0);
        assert!((edf(Stat::Totdev, -1, 10, 1001) - 116.78).abs() < 1e-9);
        assert!((edf(Stat::Totdev, -2, 10, 1001) - 92.64).abs() < 1e-9);
    }

    #[test]
    fn absurd_lengths_give_at_least_one_degree_of_freedom_or_none() {
        for stat in Stat::ALL {
            for alpha in -9..9 {
                assert_eq!(edf(stat, alpha, 0, 100), 0.0);
                assert_eq!(edf(stat, alpha, 10, 2), 0.0);
                assert_eq!(
                    edf(stat, alpha, u64::MAX, 100),
                    if stat == Stat::Totdev && alpha <= 0 { 1.0 } else { 0.0 }
                );
                for (m, points) in [(1, 4), (1, 5), (33, 100), (1 << 40, 1 << 42), (1, u64::MAX)] {
                    let edf = edf(stat, alpha, m, points);
                    assert!(edf >= 1.0 && edf <= 1.5 * points as f64, "{stat} {alpha} {m} {points}: {edf}");
                }
            }
        }
    }

    fn differences() -> impl Iterator<Item = Difference> {
        let kinds = [(false, false), (true, false), (true, true)];
        (2..=3).flat_map(move |order| kinds.map(|(overlapped, modified)| Difference { order, overlapped, modified }))
    }

    /// The relative error is 3e-3 if the correlations are summed with the filter factor m. For m (d + 1) > 100 the
    /// paper uses an infinite filter factor, which costs up to 2.7e-2.
    #[test]
    fn edf_is_close_to_the_definition() {
        for difference in differences() {
            for alpha in [2, 0, -2, -4].into_iter().take(2 + difference.order as usize - 1) {
                for (m, points) in
                    [(1, 8), (1, 1001), (3, 40), (8, 1001), (20, 400), (40, 170), (40, 1001), (100, 460), (128, 1001)]
                {
                    let exact = by_definition(difference, alpha, m, points);
                    let edf = finite_difference_edf(difference, alpha, m as u64, points as u64);
                    assert!(
                        (edf / exact - 1.0).abs() < 0.03,
                        "{difference:?} {alpha} {m} {points}: {edf} instead of {exact}"
                    );
                }
            }
        }
    }
}
