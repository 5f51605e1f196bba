//! Detects columns whose noise before rounding was below half a step, so that rounding determines the noise of the
//! samples.

use super::block::{Block, WINDOW};

/// Noise of a rounded column, in steps, below which the noise before rounding is below half a step: rounding adds a
/// variance of 1/12 of a step squared.
const SAID: f64 = 0.577;

/// Range of a window's samples, in steps, above which their standard deviation exceeds [`SAID`]: the variance of a
/// window is at least 1/62 of the square of its range.
const WIDE: f64 = 5.0;

pub struct Coarse {
    /// Smallest difference between neighbouring samples that is not 0.
    step: f64,
    /// Number of windows without a missing sample.
    windows: usize,
    /// The variances of windows with noise below [`SAID`], by the step known at the time.
    small: Vec<f64>,
}

impl Default for Coarse {
    fn default() -> Self {
        Self { step: f64::INFINITY, windows: 0, small: Vec::new() }
    }
}

impl Coarse {
    pub fn feed(&mut self, block: &Block<'_>) {
        let differences = || block.pairs().map(|(before, sample)| (sample - before).abs());
        let step = || differences().filter(|difference| *difference > 0.0).fold(f64::INFINITY, f64::min);
        self.step = self.step.min(block.facts.as_ref().map_or_else(step, |facts| facts.step));
        for at in 0..block.windows() {
            match &block.facts {
                Some(facts) if facts.ranges[at] > WIDE * self.step => self.windows += 1,
                _ => self.take(block.window(at)),
            }
        }
    }

    fn take(&mut self, window: &[f64]) {
        let mean = window.iter().sum::<f64>() / WINDOW as f64;
        let variance = window.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / (WINDOW - 1) as f64;
        if variance.is_finite() {
            self.windows += 1;
            // the step only becomes smaller, so noise above the limit stays above it
            if variance.sqrt() / self.step < SAID {
                self.small.push(variance);
            }
        }
    }

    /// The text of the warning about steps that hide the noise. It states the median of the standard deviations of the
    /// windows, in steps.
    pub fn text(mut self) -> Option<String> {
        if !self.step.is_finite() {
            return None;
        }
        self.small.retain(|variance| variance.sqrt() / self.step < SAID);
        let middle = self.windows / 2;
        if middle >= self.small.len() {
            return None;
        }
        let (_, usual, _) = self.small.select_nth_unstable_by(middle, f64::total_cmp);
        let steps = usual.sqrt() / self.step;
        Some(format!("noise of {steps:.2} steps: N, B and K are of the rounding"))
    }
}

#[cfg(test)]
mod tests {
    use crate::column_checks::ColumnChecks;
    use crate::column_checks::clipped::tests::noise;
    use crate::series::Series;

    fn doubt(series: &Series) -> Option<String> {
        ColumnChecks::of(&series.input(&[])).coarse.text()
    }

    #[test]
    fn noise_below_half_a_step_is_said() {
        let rounded = |sigma: f64, level: f64| {
            let codes = noise(50_000).into_iter().map(|z| (sigma * z + level).round());
            doubt(&Series::Numbers(codes.map(|code| code * 0.07 + 3.0).collect())).is_some()
        };
        assert_eq!([0.15, 0.2, 0.3, 0.4].map(|sigma| rounded(sigma, 0.0)), [true; 4]);
        assert_eq!([0.15, 0.2, 0.3, 0.4].map(|sigma| rounded(sigma, 0.5)), [true; 4]);
        assert_eq!([0.6, 0.8, 3.0, 1e3].map(|sigma| rounded(sigma, 0.2)), [false; 4]);
        let codes = noise(50_000).into_iter().map(|z| (0.3 * z).round() as i32);
        assert!(doubt(&Series::Codes(codes.collect())).is_some());
    }
}
