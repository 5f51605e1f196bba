//! Numbers as text, with the unit or the digits that suit their size.

use alloc::format;
use alloc::string::String;

/// Formats a time in the unit that suits its size: `40 min`, `3.5 h`, `12 d`.
#[must_use]
pub fn span(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.0} d", s / 86_400.0),
    }
}

/// Formats a frequency with six significant digits: a slow log has lines below 0.001 Hz.
#[must_use]
pub fn hertz(frequency_hz: f64) -> String {
    format!("{} Hz", significant(frequency_hz, 6))
}

/// Formats a number with `digits` significant digits, but at most 12 decimals.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    let before = if value == 0.0 { 0 } else { libm::floor(libm::log10(value.abs())) as i32 };
    format!("{value:.*}", (digits - 1 - before).clamp(0, 12) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frequency_of_a_slow_line_is_not_rounded_to_zero() {
        let all = [0.0, 1.0 / 7000.0, 0.25, 62.245, 12_345.67].map(hertz);
        assert_eq!(all, ["0.00000 Hz", "0.000142857 Hz", "0.250000 Hz", "62.2450 Hz", "12345.7 Hz"]);
    }
}
