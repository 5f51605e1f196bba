//! The rate over temperature: its mean in bins of temperature, and the straight line through the means.

use super::axis::{BLOCK_S, Block};
use crate::message::{OverTemperature, TemperatureLine, TemperaturePoint};
use std::collections::BTreeMap;

/// The initial width of a bin, °C.
const NARROWEST_C: f64 = 0.05;
/// The largest number of bins. If there are more, the bins are widened.
const MOST_BINS: usize = 400;
/// The smallest number of points for a line.
const FEWEST_POINTS: usize = 3;

#[derive(Debug)]
pub struct Temperatures {
    width_c: f64,
    bins: BTreeMap<i64, Bin>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    temp_c: f64,
    rate_dps: f64,
    blocks: u32,
}

impl Default for Temperatures {
    fn default() -> Self {
        Self { width_c: NARROWEST_C, bins: BTreeMap::new() }
    }
}

impl Temperatures {
    pub fn push(&mut self, block: &Block) {
        if block.rate_dps.is_nan() || block.temp_c.is_nan() {
            return;
        }
        let bin = self.bins.entry((block.temp_c / self.width_c).floor() as i64).or_default();
        bin.temp_c += block.temp_c;
        bin.rate_dps += block.rate_dps;
        bin.blocks += 1;
        if self.bins.len() > MOST_BINS {
            self.widen();
        }
    }

    fn widen(&mut self) {
        self.width_c *= 2.0;
        let narrow = std::mem::take(&mut self.bins);
        for (index, bin) in narrow {
            let wide = self.bins.entry(index.div_euclid(2)).or_default();
            wide.temp_c += bin.temp_c;
            wide.rate_dps += bin.rate_dps;
            wide.blocks += bin.blocks;
        }
    }

    /// The difference between the mean temperatures of the warmest and the coldest bin, °C; 0 for fewer than two bins.
    pub fn span_c(&self) -> f64 {
        let mut temps = self.bins.values().map(|bin| bin.temp_c / f64::from(bin.blocks));
        temps.next().zip(temps.next_back()).map_or(0.0, |(low_c, high_c)| high_c - low_c)
    }

    /// The means and the line for the page. Their uncertainties follow from the one-sided noise density
    /// `white_dps_per_rt_hz`.
    pub fn shown(&self, white_dps_per_rt_hz: f64) -> OverTemperature {
        let point = |bin: &Bin| {
            let (blocks, duration_s) = (f64::from(bin.blocks), f64::from(bin.blocks) * BLOCK_S);
            TemperaturePoint {
                temp_c: bin.temp_c / blocks,
                rate_dps: bin.rate_dps / blocks,
                u_dps: white_dps_per_rt_hz / (2.0 * duration_s).sqrt(),
                seconds: duration_s.round() as u32,
            }
        };
        let points: Vec<TemperaturePoint> = self.bins.values().map(point).collect();
        OverTemperature { line: line(&points), points }
    }
}

/// Fits a line by weighted least squares.
fn line(points: &[TemperaturePoint]) -> Option<TemperatureLine> {
    let weighted: Vec<_> =
        points.iter().filter(|point| point.u_dps > 0.0).map(|point| (point.u_dps.powi(-2), point)).collect();
    let sum = |of: &dyn Fn(&TemperaturePoint) -> f64| -> f64 {
        weighted.iter().map(|(weight, point)| weight * of(point)).sum()
    };
    let middle_c = sum(&|point| point.temp_c) / sum(&|_| 1.0);
    let spread = sum(&|point| (point.temp_c - middle_c).powi(2));
    let slope_dps_per_c = sum(&|point| (point.temp_c - middle_c) * point.rate_dps) / spread;
    let is_line = weighted.len() >= FEWEST_POINTS && spread > 0.0;
    is_line.then(|| TemperatureLine { slope_dps_per_c, u_dps_per_c: spread.sqrt().recip() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(blocks: impl Iterator<Item = (f64, f64)>) -> OverTemperature {
        let mut temperatures = Temperatures::default();
        blocks.for_each(|(temp_c, rate_dps)| temperatures.push(&Block { rate_dps, corrected_dps: f64::NAN, temp_c }));
        temperatures.shown(0.04)
    }

    /// The fit finds a straight line for any bins, and its slope has the variance σ² / Σ(T − mean)² of the textbook.
    #[test]
    fn a_line_is_found() {
        for step_c in [0.01, 0.1, 1.0] {
            let temps = || (0..1000).map(|k| 25.0 + step_c * f64::from(k));
            let line = of(temps().map(|temp_c| (temp_c, 0.3 - 0.014 * temp_c))).line.unwrap();
            assert!((line.slope_dps_per_c + 0.014).abs() < 1e-9, "{line:?}");
            let middle_c = temps().sum::<f64>() / 1000.0;
            let spread: f64 = temps().map(|temp_c| (temp_c - middle_c).powi(2)).sum();
            let u = 0.04 / (2.0 * BLOCK_S).sqrt() / spread.sqrt();
            assert!((line.u_dps_per_c / u - 1.0).abs() < 0.001, "{line:?} {u}");
        }
    }

    #[test]
    fn two_temperatures_do_not_make_a_line() {
        assert!(of([(25.0, 0.1), (26.0, 0.2)].into_iter()).line.is_none());
        assert!(of(std::iter::repeat_n((25.0, 0.1), 100)).line.is_none());
    }
}
