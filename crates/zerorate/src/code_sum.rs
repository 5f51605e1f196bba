//! Codes to physical units in f64, alone and as exact sums.

use adis16130::{RATE_LSB_PER_DPS, RateCode, TEMP_AT_ZERO_CODE_C, TEMP_LSB_PER_C, TempCode, ZERO_CODE};

/// The rate of a code, °/s (F-40).
#[must_use]
pub fn rate_dps(code: RateCode) -> f64 {
    from_zero(code.code24()) as f64 / f64::from(RATE_LSB_PER_DPS)
}

/// The temperature of a code, °C (F-41).
#[must_use]
pub fn temp_c(code: TempCode) -> f64 {
    from_zero(code.code24()) as f64 / f64::from(TEMP_LSB_PER_C) + f64::from(TEMP_AT_ZERO_CODE_C)
}

/// The sum of 24-bit codes of one channel, exact for up to 2³² of them, and how many they were.
///
/// ```
/// let mut rates = zerorate::CodeSum::default();
/// rates.push(8_388_608 + 23_488);
/// rates.push(8_388_608);
/// assert_eq!(rates.rate_dps(), Some(0.5));
/// assert_eq!(zerorate::CodeSum::default().rate_dps(), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CodeSum {
    from_zero: i64,
    count: u32,
}

impl CodeSum {
    /// Adds a 24-bit code.
    #[inline]
    pub fn push(&mut self, code24: u32) {
        self.from_zero += from_zero(code24);
        self.count += 1;
    }

    /// The sum of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { from_zero: self.from_zero + other.from_zero, count: self.count + other.count }
    }

    /// What is left when a part of the sum is taken out.
    #[must_use]
    pub(crate) fn without(self, part: Self) -> Self {
        Self { from_zero: self.from_zero - part.from_zero, count: self.count - part.count }
    }

    /// Codes in the sum.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Mean of rate codes, °/s (F-40), divided once; none of no codes.
    #[must_use]
    pub fn rate_dps(&self) -> Option<f64> {
        self.mean(RATE_LSB_PER_DPS)
    }

    /// Mean of temperature codes, °C (F-41); none of no codes.
    #[must_use]
    pub fn temp_c(&self) -> Option<f64> {
        self.mean(TEMP_LSB_PER_C).map(|above_zero| above_zero + f64::from(TEMP_AT_ZERO_CODE_C))
    }

    fn mean(&self, lsb_per_unit: u32) -> Option<f64> {
        (self.count > 0).then(|| self.from_zero as f64 / (f64::from(self.count) * f64::from(lsb_per_unit)))
    }
}

fn from_zero(code24: u32) -> i64 {
    i64::from(code24) - i64::from(ZERO_CODE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130::Width;

    /// F-42: all nine rates, as printed to five digits, and a temperature of each width.
    #[test]
    fn codes_of_the_note() {
        let rates = [
            (14_260_608, 250.0),
            (8_623_488, 10.0),
            (8_388_612, 0.000_170_30),
            (8_388_609, 0.000_042_575),
            (8_388_608, 0.0),
            (8_388_607, -0.000_042_575),
            (8_388_604, -0.000_170_30),
            (8_153_728, -10.0),
            (2_516_608, -250.0),
        ];
        for (code, printed_dps) in rates {
            let found_dps = rate_dps(RateCode::new(code, Width::Bits24));
            assert!((found_dps - printed_dps).abs() < 5e-9, "{code}: {found_dps}");
        }
        assert_eq!(temp_c(TempCode::new(9_234_188, Width::Bits24)), 85.0);
        assert_eq!(temp_c(TempCode::new(32_768, Width::Bits16)), 25.0);
    }
}
