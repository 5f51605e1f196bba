//! Lag-1 autocorrelation of a series and of its differences, in one pass.

/// Number of difference orders: 0 (the series itself) to 3.
const ORDERS: usize = 4;

/// Sums over a series and its first three differences, from which [`Lag1::correlation`] follows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lag1 {
    orders: [Sums; ORDERS],
    /// Number of values since the series began or was cut.
    unbroken: u64,
    /// Constant subtracted from each first difference. It does not change a correlation, but keeps precision if the
    /// series is a steep ramp.
    ramp: f64,
}

impl Lag1 {
    pub(crate) fn new(ramp: f64) -> Self {
        Self { ramp, ..Self::default() }
    }

    pub(crate) fn push(&mut self, value: f64) {
        let (mut value, mut ramp) = (value, self.ramp);
        for (sums, order) in self.orders.iter_mut().zip(0..) {
            if order > self.unbroken {
                break;
            }
            let before = sums.last;
            sums.add(value, order == self.unbroken);
            value -= before + ramp;
            ramp = 0.0;
        }
        self.unbroken += 1;
    }

    /// Adds the same value `count` times, in a time that does not depend on `count`.
    pub(crate) fn push_level(&mut self, value: f64, count: u64) {
        let settled = count.min(ORDERS as u64 + 1);
        (0..settled).for_each(|_| self.push(value));
        for (sums, level) in self.orders.iter_mut().zip([value, -self.ramp, 0.0, 0.0]) {
            sums.repeat(level, count - settled);
        }
        self.unbroken += count - settled;
    }

    /// Cuts the series: the next value does not follow on the last one.
    pub(crate) fn cut(&mut self) {
        self.unbroken = 0;
    }

    /// r1 of the differences of the given order: Σ (z_i − z̄)(z_{i+1} − z̄)/n over the sample variance of z. After a
    /// cut, the sum is scaled to n − 1 pairs. `None` for a constant series and for fewer than three values.
    pub(crate) fn correlation(&self, order: usize) -> Option<f64> {
        let Sums { n, pairs, sum, of_pairs, squares, cross, .. } = self.orders[order];
        let (n, pairs) = (n as f64, pairs as f64);
        let mean = sum / n;
        let covariance = cross - mean * of_pairs + pairs * mean * mean;
        let variance = squares - n * mean * mean;
        // there are n − 1 pairs unless the series was cut
        let r1 = covariance / variance * ((n - 1.0) / pairs) * ((n - 1.0) / n);
        let certain = n >= 3.0 && variance > 1e-12 * squares;
        (certain && r1.is_finite()).then_some(r1)
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    n: u64,
    pairs: u64,
    sum: f64,
    /// Σ (z_i + z_{i+1})
    of_pairs: f64,
    squares: f64,
    cross: f64,
    last: f64,
}

impl Sums {
    fn add(&mut self, value: f64, is_first: bool) {
        if !is_first {
            self.pairs += 1;
            self.of_pairs += self.last + value;
            self.cross += self.last * value;
        }
        self.n += 1;
        self.sum += value;
        self.squares += value * value;
        self.last = value;
    }

    fn repeat(&mut self, level: f64, count: u64) {
        let times = count as f64;
        self.n += count;
        self.pairs += count;
        self.sum += times * level;
        self.of_pairs += 2.0 * times * level;
        self.squares += times * level * level;
        self.cross += times * level * level;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    fn by_definition(z: &[f64]) -> f64 {
        let n = z.len() as f64;
        let mean = z.iter().sum::<f64>() / n;
        let covariance: f64 = z.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum::<f64>() / n;
        covariance / (z.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0))
    }

    fn differences(z: &[f64]) -> Vec<f64> {
        z.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    fn series() -> Vec<f64> {
        (0..1000u32).map(|i| f64::from(i.wrapping_mul(2_654_435_761) % 1009) + 0.3 * f64::from(i)).collect()
    }

    #[test]
    fn the_correlation_follows_the_definition() {
        let mut z = series();
        let mut lag = Lag1::new(0.3);
        z.iter().for_each(|&value| lag.push(value));
        for order in 0..ORDERS {
            let r1 = lag.correlation(order).unwrap();
            assert!((r1 - by_definition(&z)).abs() < 1e-10, "order {order}: {r1}");
            z = differences(&z);
        }
    }

    #[test]
    fn a_level_counts_as_often_as_it_lasts() {
        let z = series();
        let mut lag = Lag1::new(0.3);
        z.iter().for_each(|&value| lag.push(value));
        lag.push_level(7.5, 500);
        z.iter().for_each(|&value| lag.push(value));
        let mut whole = z.clone();
        whole.extend([7.5; 500]);
        whole.extend(z);
        for order in 0..ORDERS {
            assert!((lag.correlation(order).unwrap() - by_definition(&whole)).abs() < 1e-10, "order {order}");
            whole = differences(&whole);
        }
    }

    /// The same piece twice, with a cut between, has the correlation of the piece, except for the counts of pairs.
    #[test]
    fn a_cut_separates_the_correlations() {
        let z = series();
        let (mut once, mut twice) = (Lag1::new(0.3), Lag1::new(0.3));
        z.iter().for_each(|&value| once.push(value));
        for _ in 0..2 {
            twice.cut();
            z.iter().for_each(|&value| twice.push(value));
        }
        for order in 0..ORDERS {
            let (once, twice) = (once.correlation(order).unwrap(), twice.correlation(order).unwrap());
            assert!((once - twice).abs() < 2e-3 * once.abs(), "order {order}: {once} {twice}");
        }
    }

    #[test]
    fn too_few_or_equal_values_have_no_correlation() {
        let mut lag = Lag1::default();
        lag.push_level(3.0, 1_000_000);
        assert_eq!((lag.correlation(0), lag.correlation(1)), (None, None));
        let mut lag = Lag1::default();
        lag.push(1.0);
        lag.push(2.0);
        assert_eq!((lag.correlation(0), lag.correlation(3)), (None, None));
    }
}
