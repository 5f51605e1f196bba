//! Detects samples that pile up at the largest or the least value, as noise does not. Either the sensor was at its
//! limit, or the value marks missing samples.

use super::block::Block;

/// Least number of samples at a limit for a warning, and their least share of all samples.
const ENOUGH: u64 = 50;
const SAID: f64 = 1e-3;

/// An extreme value is a limit if it is at least this many times as frequent as each of the next three values. In
/// noise the extreme value is rarer than its neighbours. In a sine with coarse codes it is at most 2.4 times as
/// frequent.
const MORE: u64 = 3;

#[derive(Default)]
pub struct Clipped {
    largest: Outermost,
    /// The least values, stored negated.
    least: Outermost,
    count: u64,
}

impl Clipped {
    pub fn feed(&mut self, block: &Block<'_>) {
        let Some(facts) = &block.facts else {
            return block.pairs().filter(|(_, sample)| sample.is_finite()).for_each(|(before, sample)| {
                self.count += 1;
                self.largest.push(before, sample);
                self.least.push(-before, -sample);
            });
        };
        self.count += block.len() as u64;
        if self.largest.reaches(facts.largest) {
            block.pairs().for_each(|(before, sample)| self.largest.push(before, sample));
        }
        if self.least.reaches(-facts.least) {
            block.pairs().for_each(|(before, sample)| self.least.push(-before, -sample));
        }
    }

    /// The text of the warning about samples at the largest or the least value; `None` if that may be chance.
    pub fn text(&self) -> Option<String> {
        let count = self.count as f64;
        let side = |(value, at): (f64, u64), name| {
            let percent = 100.0 * at as f64 / count;
            format!("{percent:.2} % of the samples are {value}, the {name}; a limit, or a mark?")
        };
        let limit = |side: &Outermost| side.limit().filter(|(_, at)| *at as f64 >= SAID * count);
        limit(&self.largest)
            .map(|found| side(found, "largest"))
            .or_else(|| limit(&self.least).map(|(value, at)| side((-value, at), "least")))
    }
}

/// One of the largest values.
#[derive(Clone, Copy)]
struct Extreme {
    value: f64,
    count: u64,
    /// Whether a sample was there right after one below the four largest values, as no drift from code to code brings.
    is_reached_from_afar: bool,
}

/// The four largest values so far.
struct Outermost([Extreme; 4]);

impl Default for Outermost {
    fn default() -> Self {
        Self([Extreme { value: f64::NEG_INFINITY, count: 0, is_reached_from_afar: false }; 4])
    }
}

impl Outermost {
    #[inline]
    fn reaches(&self, sample: f64) -> bool {
        sample >= self.0[3].value
    }

    #[inline]
    fn push(&mut self, before: f64, sample: f64) {
        if self.reaches(sample) {
            self.count(before, sample);
        }
    }

    fn count(&mut self, before: f64, sample: f64) {
        let from_afar = before < self.0[3].value;
        match self.0.iter().position(|extreme| extreme.value <= sample) {
            Some(at) if self.0[at].value == sample => {
                self.0[at].count += 1;
                self.0[at].is_reached_from_afar |= from_afar;
            }
            Some(at) => {
                self.0[at..].rotate_right(1);
                self.0[at] = Extreme { value: sample, count: 1, is_reached_from_afar: from_afar };
            }
            None => {}
        }
    }

    /// The largest value and its count, if the count is due neither to chance nor to a drift that ends there. A drift
    /// passes the codes before the last slowly.
    fn limit(&self) -> Option<(f64, u64)> {
        let [found, inside @ ..] = self.0;
        let most = inside.iter().map(|extreme| extreme.count).max().unwrap_or(0);
        let is_frequent = found.count >= ENOUGH.max(MORE * most) && inside.iter().all(|extreme| extreme.count > 0);
        (is_frequent && (found.is_reached_from_afar || most < ENOUGH)).then_some((found.value, found.count))
    }
}

#[cfg(test)]
pub mod tests {
    use crate::column_checks::ColumnChecks;
    use crate::series::Series;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    /// The sum of twelve uniform numbers, less its mean: nearly Gaussian, with a standard deviation of 1.
    pub fn noise(count: usize) -> Vec<f64> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
        let mut uniform = move || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    fn doubt(series: &Series) -> Option<String> {
        ColumnChecks::of(&series.input(&[])).clipped.text()
    }

    fn said(samples: impl Iterator<Item = f64>) -> String {
        doubt(&Series::Numbers(samples.collect())).unwrap_or_default()
    }

    #[test]
    fn noise_in_codes_of_any_size_and_a_sine_give_no_warning() {
        for steps in [0.3, 1.0, 3.0, 100.0, 1e6] {
            assert_eq!(said(noise(20_000).iter().map(|sample| (sample * steps).round())), "", "{steps}");
        }
        for steps in [5.4, 10.5, 200.49] {
            assert_eq!(said((0..50_000).map(|i| (f64::from(i).sin() * steps).round())), "", "{steps}");
        }
        assert_eq!(said((0..50_000).map(|i| f64::from(i / 10_000))), "", "levels");
        assert_eq!(said([f64::NAN; 5000].into_iter()), "");
    }

    #[test]
    fn the_last_code_of_a_drift_is_no_limit() {
        for sigma in [0.1, 0.15, 0.2, 0.3] {
            let warmed = |(at, z): (usize, f64)| (sigma * z - 7.8 * (-(at as f64) / 2500.0).exp()).round();
            assert_eq!(said(noise(20_000).into_iter().enumerate().map(warmed)), "", "{sigma}");
            let drifts = |(at, z): (usize, f64)| (sigma * z + at as f64 / 2500.0).min(20.0).round();
            assert_eq!(said(noise(20_000).into_iter().enumerate().map(drifts)), "", "{sigma}");
        }
    }

    #[test]
    fn limits_and_marks_are_found() {
        let clipped = |sample: f64| sample.clamp(-2.0, 2.5);
        let below = said(noise(20_000).into_iter().map(|sample| sample.max(-2.0)));
        assert!(
            below.starts_with("2.") && below.ends_with(" % of the samples are -2, the least; a limit, or a mark?")
        );
        assert!(said(noise(20_000).into_iter().map(clipped)).contains("2.5, the largest"));
        let turned = noise(20_000).into_iter().enumerate().map(|(at, z)| (5.0 * (at as f64 - 1e4) + z).min(250.0));
        assert!(said(turned).contains("are 250, the largest"));
        let marked = noise(20_000).into_iter().enumerate().map(|(i, s)| if i % 200 == 0 { -9999.0 } else { s });
        assert_eq!(said(marked), "0.50 % of the samples are -9999, the least; a limit, or a mark?");
        let codes = noise(20_000).iter().map(|sample| ((sample * 8.0).round() as i32).min(4)).collect();
        assert!(doubt(&Series::Codes(codes)).is_some_and(|text| text.contains("4, the largest")));
    }
}
