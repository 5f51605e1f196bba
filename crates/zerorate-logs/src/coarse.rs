//! Samples in steps that the noise does not reach across: rounding decides which noise is left.

use super::series::Series;

/// Samples of a window in which the noise is measured.
const WINDOW: usize = 32;

/// Below this many steps, the noise of a rounded column is below half a step before it is rounded: rounding adds a
/// variance of 1/12 of a step squared.
const SAID: f64 = 0.577;

/// The text about a column whose noise is hidden by its steps.
pub fn doubt(series: &Series) -> Option<String> {
    let steps = match series {
        Series::Codes(codes) => noise_steps(codes, |code| f64::from(*code)),
        Series::Numbers(numbers) => noise_steps(numbers, |number| *number),
    };
    let steps = steps.filter(|steps| *steps < SAID)?;
    Some(format!("noise of {steps:.2} steps: N, B and K are of the rounding"))
}

/// The usual standard deviation of a few samples, in steps: the least that neighbours differ by.
fn noise_steps<T>(samples: &[T], value: impl Fn(&T) -> f64) -> Option<f64> {
    let differences = samples.windows(2).map(|pair| (value(&pair[1]) - value(&pair[0])).abs());
    let step = differences.filter(|difference| *difference > 0.0).fold(f64::INFINITY, f64::min);
    let variance = |window: &[T]| {
        let mean = window.iter().map(&value).sum::<f64>() / WINDOW as f64;
        window.iter().map(|sample| (value(sample) - mean).powi(2)).sum::<f64>() / (WINDOW - 1) as f64
    };
    let mut variances: Vec<f64> = samples.chunks_exact(WINDOW).map(variance).filter(|v| v.is_finite()).collect();
    let middle = variances.len() / 2;
    if variances.is_empty() || !step.is_finite() {
        return None;
    }
    let (_, usual, _) = variances.select_nth_unstable_by(middle, f64::total_cmp);
    Some(usual.sqrt() / step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clipped::tests::noise;

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

    #[test]
    fn fine_numbers_and_none_have_no_steps() {
        assert_eq!(doubt(&Series::Numbers(noise(10_000))), None);
        assert_eq!(doubt(&Series::Numbers(vec![1.0; 10_000])), None);
        assert_eq!(doubt(&Series::Numbers(vec![1.0, 2.0])), None);
    }
}
