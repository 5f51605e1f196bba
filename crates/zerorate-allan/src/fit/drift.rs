//! A drift in the first coefficients of the spectrum: its size, and what its fit takes from their power.

use super::density::Table;
use alloc::vec::Vec;
use core::f64::consts::PI;

/// A time constant is raised by this factor to find how a warm-up changes with it.
const NEARBY: f64 = 1.001;
/// If 1 − r² of two columns is smaller, the second one is left out: r is their correlation.
const ALIKE: f64 = 1e-9;

/// A drift: a slow deterministic change of the rate, fitted in the first coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drift {
    /// The rate drifts evenly: R·t.
    Ramp,
    /// The rate decays as e^(−t/τ) from the start.
    WarmUp { tau_s: f64 },
}

impl Drift {
    /// The value of a drift of size 1 at the time `t_s`.
    pub(super) fn at(self, t_s: f64) -> f64 {
        match self {
            Self::Ramp => t_s,
            Self::WarmUp { tau_s } => libm::exp(-t_s / tau_s),
        }
    }

    /// The coefficients c_k·√dt of a drift of size 1, k = 1, 2 …
    pub(super) fn coefficients(self, span_s: f64, count: usize) -> Vec<f64> {
        let one = |k: usize| {
            let (odd, angle) = (k % 2 == 1, k as f64 * PI);
            match self {
                Self::Ramp if odd => -4.0 * span_s / (angle * angle) * libm::sqrt(span_s / 2.0),
                Self::Ramp => 0.0,
                Self::WarmUp { tau_s } => {
                    let (decay, end) = (span_s / tau_s, libm::exp(-span_s / tau_s));
                    let rest = if odd { 1.0 + end } else { 1.0 - end };
                    libm::sqrt(2.0 * span_s) * decay * rest / (decay * decay + angle * angle)
                }
            }
        };
        (1..=count).map(one).collect()
    }

    /// The Allan variance of a drift of size 1: half the mean square of the difference of two averages.
    pub(super) fn allan_variance(self, tau_s: f64, record_s: f64) -> f64 {
        match self {
            Self::Ramp => tau_s * tau_s / 2.0,
            Self::WarmUp { tau_s: decay_s } => {
                let fall = -libm::expm1(-tau_s / decay_s);
                let difference = decay_s / tau_s * fall * fall;
                let starts_s = (record_s - 2.0 * tau_s).max(1e-3 * record_s);
                let mean = decay_s / 2.0 * -libm::expm1(-2.0 * starts_s / decay_s) / starts_s;
                difference * difference * mean / 2.0
            }
        }
    }
}

/// Sums over the coefficients of a bin: of the drift x (of size 1), of the record c, and of the change z of x with the
/// time constant of a warm-up (0 for a ramp).
struct Sums {
    count: f64,
    cx: f64,
    xx: f64,
    xz: f64,
    zz: f64,
}

/// A drift in the bins of a record.
pub(super) struct Template(Vec<Sums>);

/// A drift that was fitted.
pub(super) struct Fitted {
    pub(super) size: f64,
    /// The powers of the first rows without the drift.
    pub(super) powers: Vec<f64>,
    /// The inverse of the variance of the size.
    pub(super) information: f64,
}

/// What the fit of a drift takes from the likelihood.
#[derive(Default)]
pub(super) struct Restriction {
    /// The part of each row's degrees of freedom.
    pub(super) taken: Vec<f64>,
    /// ln det XᵀS⁻¹X, with the columns X = (x, z) and the densities S.
    pub(super) log_det: f64,
}

impl Template {
    pub(super) fn new(drift: Drift, table: &Table) -> Self {
        let x = drift.coefficients(table.span_s, table.low.len());
        let longer = match drift {
            Drift::Ramp => drift,
            Drift::WarmUp { tau_s } => Drift::WarmUp { tau_s: tau_s * NEARBY },
        };
        let z: Vec<f64> = longer.coefficients(table.span_s, x.len()).iter().zip(&x).map(|(z, x)| z - x).collect();
        let sums = |row: usize| {
            let bin = &table.rows[row].bin;
            let sum = |of: &dyn Fn(usize) -> f64| (bin.first - 1..bin.end - 1).map(of).sum::<f64>();
            Sums {
                count: (bin.end - bin.first) as f64,
                cx: sum(&|k| table.low[k] * x[k]),
                xx: sum(&|k| x[k] * x[k]),
                xz: sum(&|k| x[k] * z[k]),
                zz: sum(&|k| z[k] * z[k]),
            }
        };
        Self((0..table.signed()).map(sums).collect())
    }

    /// The weights ν/(count·S) of the coefficients of each row.
    fn weights(&self, nu: &[f64], density: &[f64]) -> Vec<f64> {
        self.0.iter().zip(nu.iter().zip(density)).map(|(sums, (nu, s))| nu / (sums.count * s)).collect()
    }

    /// The size of the drift by weighted least squares.
    pub(super) fn fitted(&self, table: &Table, nu: &[f64], density: &[f64]) -> Fitted {
        let weights = self.weights(nu, density);
        let sum = |of: &dyn Fn(&Sums) -> f64| self.0.iter().zip(&weights).map(|(sums, w)| of(sums) * w).sum::<f64>();
        let information = sum(&|sums| sums.xx);
        let size = sum(&|sums| sums.cx) / information;
        Fitted { size, powers: self.powers(table, size), information }
    }

    /// The powers of the first rows without a drift of this size. They are above zero: their logarithm is needed.
    pub(super) fn powers(&self, table: &Table, size: f64) -> Vec<f64> {
        let power = |(row, sums): (usize, &Sums)| {
            let change = (size * size * sums.xx - 2.0 * size * sums.cx) / sums.count;
            (table.rows[row].bin.power + change).max(f64::MIN_POSITIVE)
        };
        self.0.iter().enumerate().map(power).collect()
    }

    /// With this restriction the likelihood is that of the contrasts without a drift (REML; Patterson and Thompson,
    /// Biometrika 58, 1971). Otherwise a warm-up would take a part of the slow noise, and K would be too small.
    pub(super) fn restriction(&self, nu: &[f64], density: &[f64]) -> Restriction {
        let weights = self.weights(nu, density);
        let sum = |of: fn(&Sums) -> f64| self.0.iter().zip(&weights).map(|(sums, w)| of(sums) * w).sum::<f64>();
        let (xx, xz, zz) = (sum(|sums| sums.xx), sum(|sums| sums.xz), sum(|sums| sums.zz));
        let det = xx * zz - xz * xz;
        let two = det > ALIKE * xx * zz;
        let taken = |(sums, w): (&Sums, &f64)| match two {
            true => w * (sums.xx * zz - 2.0 * sums.xz * xz + sums.zz * xx) / det,
            false => w * sums.xx / xx,
        };
        let taken = self.0.iter().zip(&weights).map(taken).collect();
        Restriction { taken, log_det: libm::log(if two { det } else { xx }) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::transform::cosine_transform;
    use super::*;

    #[test]
    fn the_coefficients_of_a_drift_are_the_transform_of_its_samples() {
        let (n, rate_hz) = (20_000, 10.0);
        let span_s = n as f64 / rate_hz;
        for drift in [Drift::Ramp, Drift::WarmUp { tau_s: 300.0 }] {
            let samples: Vec<f64> = (0..n).map(|i| drift.at((i as f64 + 0.5) / rate_hz)).collect();
            let found = cosine_transform(&samples).unwrap();
            let largest = found.iter().fold(0.0f64, |most, c| most.max(c.abs()));
            for (expected, found) in drift.coefficients(span_s, 20).into_iter().zip(&found) {
                assert!((expected * rate_hz.sqrt() - found).abs() < 1e-5 * largest, "{drift:?}: {expected} {found}");
            }
        }
    }
}
