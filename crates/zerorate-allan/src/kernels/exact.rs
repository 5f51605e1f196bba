use core::ops::AddAssign;

/// A sum of squares of integers, exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ExactSum {
    high: u128,
    low: u128,
}

impl ExactSum {
    /// Adds `value · 2^shift`, for a shift below 128.
    pub fn add(&mut self, value: u128, shift: u32) {
        let (low, carry) = self.low.overflowing_add(value << shift);
        self.low = low;
        self.high += value.checked_shr(128 - shift).unwrap_or(0) + u128::from(carry);
    }

    /// Adds the square of a number below 2^111.
    pub fn add_square(&mut self, number: i128) {
        let (high, low) = (number.unsigned_abs() >> 48, number.unsigned_abs() & 0xffff_ffff_ffff);
        self.add(high * high, 96);
        self.add(high * low, 49);
        self.add(low * low, 0);
    }

    /// The nearest f64, or one of its neighbours.
    pub fn to_f64(self) -> f64 {
        self.high as f64 * TWO_POW_128 + self.low as f64
    }
}

impl AddAssign for ExactSum {
    fn add_assign(&mut self, more: Self) {
        self.add(more.low, 0);
        self.high += more.high;
    }
}

impl From<u128> for ExactSum {
    fn from(sum: u128) -> Self {
        Self { high: 0, low: sum }
    }
}

const TWO_POW_128: f64 = 340_282_366_920_938_463_463_374_607_431_768_211_456.0;
