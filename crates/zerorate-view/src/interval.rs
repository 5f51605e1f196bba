//! Formats a number and its interval, with as many digits as the interval justifies.

use crate::plot::{number, superscript};
use core::fmt;

/// A value with its uncertainty, in the same unit. Both have the decimals that show two significant digits of `half`:
/// `+0.2578 ± 0.0053`. If `half` is not finite or not above zero, only the value is shown, with five decimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlusMinus {
    /// The value, shown with its sign.
    pub value: f64,
    /// Half width of the value's 95 % interval.
    pub half: f64,
}

/// The number of decimals that shows two significant digits of `half`.
fn decimals(half: f64) -> usize {
    // 0.0996 becomes 0.10, which has one decimal less than 0.0996 itself
    let rounded: f64 = format!("{half:.1e}").parse().unwrap_or(half);
    (1 - rounded.log10().floor() as i32).clamp(0, 12) as usize
}

impl fmt::Display for PlusMinus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, half } = *self;
        if !half.is_finite() || half <= 0.0 {
            return write!(f, "{value:+.5}");
        }
        let decimals = decimals(half);
        write!(f, "{value:+.decimals$} ± {half:.decimals$}")
    }
}

/// A value with limits that may be asymmetric, in the same unit. All three numbers have the decimals that show two
/// significant digits of half the interval: `0.5591 [0.5543, 0.5639]`. If both limits are equal, only the value
/// is shown, as by [`number`]. With an infinite limit, each number is shown as by [`number`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower limit.
    pub lo: f64,
    /// Upper limit.
    pub hi: f64,
}

impl Interval {
    /// The value as text.
    #[must_use]
    pub fn value(&self) -> String {
        self.written(self.value)
    }

    /// Both limits as text; `None` if they are equal.
    #[must_use]
    pub fn limits(&self) -> Option<[String; 2]> {
        self.has_width().then(|| [self.written(self.lo), self.written(self.hi)])
    }

    fn has_width(&self) -> bool {
        self.lo < self.hi
    }

    /// Formats one of the three numbers. All share the decimals and the power of ten.
    fn written(&self, one: f64) -> String {
        let largest = self.value.abs().max(self.hi.abs());
        let half = (self.hi - self.lo) / 2.0;
        if !self.has_width() || half.is_infinite() {
            return number(one);
        }
        match largest.log10().floor() as i32 {
            -4..=5 => format!("{one:.*}", decimals(half)),
            k => {
                let scale = 10f64.powi(k);
                format!("{:.*}·10{}", decimals(half / scale), one / scale, superscript(k))
            }
        }
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.value())?;
        self.limits().map_or(Ok(()), |[lo, hi]| write!(f, " [{lo}, {hi}]"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_have_the_digits_of_the_value() {
        let text = |value, lo, hi| Interval { value, lo, hi }.to_string();
        assert_eq!(text(0.559_11, 0.554_3, 0.563_9), "0.5591 [0.5543, 0.5639]");
        assert_eq!(text(38.193, 0.0, 115.26), "38 [0, 115]");
        assert_eq!(text(1.768_2e-5, 1.7e-5, 1.85e-5), "1.768·10⁻⁵ [1.700·10⁻⁵, 1.850·10⁻⁵]");
        assert_eq!(text(51.346, 51.346, 51.346), "51.3");
        assert_eq!(text(0.0, 0.0, 0.0), "0");
        assert_eq!(text(1.5, 1.0, f64::INFINITY), "1.50 [1.00, inf]");
    }

    #[test]
    fn two_digits_of_the_interval_are_shown() {
        let text = |value, half| PlusMinus { value, half }.to_string();
        assert_eq!(text(0.257_79, 0.005_30), "+0.2578 ± 0.0053");
        assert_eq!(text(-0.035_93, 0.009_96), "-0.036 ± 0.010");
        assert_eq!(text(1234.5, 12.3), "+1234 ± 12");
        assert_eq!(text(1234.5, 1234.0), "+1234 ± 1234");
        assert_eq!(text(-0.25, f64::NAN), "-0.25000");
        assert_eq!(text(-0.25, 0.0), "-0.25000");
    }
}
