//! A Chebyshev series over the temperatures of the logs.

use super::COEFFICIENTS;

/// The temperature span of the series, °C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Series {
    low_c: f64,
    high_c: f64,
}

impl Series {
    pub(super) fn over(temps_c: impl Iterator<Item = f64>) -> Self {
        let (low_c, high_c) = temps_c.fold((f64::MAX, f64::MIN), |(low, high), c| (low.min(c), high.max(c)));
        Self { low_c, high_c }
    }

    pub(super) fn span_c(&self) -> (f64, f64) {
        (self.low_c, self.high_c)
    }

    /// Values of the polynomials at a temperature.
    pub(super) fn at(&self, temp_c: f64) -> [f64; COEFFICIENTS] {
        let x = self.x(temp_c);
        let mut values = [1.0, x, 0.0, 0.0, 0.0, 0.0, 0.0];
        for k in 2..COEFFICIENTS {
            values[k] = 2.0 * x * values[k - 1] - values[k - 2];
        }
        values
    }

    /// Values of the polynomials at a temperature that the bias follows. If the sensor was on before the log began,
    /// this temperature may lie outside of the span. There, each polynomial continues along its tangent.
    pub(super) fn followed(&self, temp_c: f64) -> [f64; COEFFICIENTS] {
        let beyond_c = temp_c - temp_c.clamp(self.low_c, self.high_c);
        let (mut values, slopes) = (self.at(temp_c), self.slope_at(temp_c));
        values.iter_mut().zip(slopes).for_each(|(value, slope)| *value += beyond_c * slope);
        values
    }

    /// The slope of each polynomial at a temperature, per °C: n·U(n−1), with Chebyshev polynomials of the second
    /// kind.
    pub(super) fn slope_at(&self, temp_c: f64) -> [f64; COEFFICIENTS] {
        let x = self.x(temp_c);
        let mut second = [1.0, 2.0 * x, 0.0, 0.0, 0.0, 0.0, 0.0];
        for k in 2..COEFFICIENTS {
            second[k] = 2.0 * x * second[k - 1] - second[k - 2];
        }
        let per_c = 2.0 / (self.high_c - self.low_c);
        core::array::from_fn(|k| if k == 0 { 0.0 } else { k as f64 * second[k - 1] * per_c })
    }

    /// Maps a temperature to −1 … 1. A temperature outside of the span is clamped, because a polynomial departs
    /// fast from the bias there.
    fn x(&self, temp_c: f64) -> f64 {
        (2.0 * (temp_c - self.low_c) / (self.high_c - self.low_c) - 1.0).clamp(-1.0, 1.0)
    }
}
