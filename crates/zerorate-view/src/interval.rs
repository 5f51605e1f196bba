//! A number with its interval, with the digits that the interval warrants.

use core::fmt;

/// `value` ± `half`, in the same unit: with two significant digits of `half`, `+0.2578 ± 0.0053`. Of a value without a
/// finite interval above zero, five decimals are shown and no interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlusMinus {
    /// The value, shown with its sign.
    pub value: f64,
    /// Half width of its 95 % interval.
    pub half: f64,
}

/// Decimals of a number whose second significant digit is the last one shown.
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

#[cfg(test)]
mod tests {
    use super::*;

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
