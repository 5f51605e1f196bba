//! Durations as people write them: `10s`, `10m`, `1h30m`, or a bare number of seconds.

use jiff::SignedDuration;
use std::fmt;
use std::str::FromStr;

/// A duration in seconds. A parsed one is finite and not negative.
#[derive(Copy, Clone, Debug, PartialEq, PartialOrd)]
pub struct Seconds(pub f64);

impl Seconds {
    /// The duration in whole nanoseconds, rounded down and limited to `u64::MAX`.
    pub fn nanos(self) -> u64 {
        (self.0 * 1e9) as u64
    }
}

/// Parses a duration that must be above zero.
pub fn above_zero(text: &str) -> Result<Seconds, String> {
    let seconds: Seconds = text.parse()?;
    if seconds.0 > 0.0 { Ok(seconds) } else { Err("it must be above zero".to_owned()) }
}

impl FromStr for Seconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let seconds = match text.trim().parse::<f64>() {
            Ok(seconds) => seconds,
            Err(_) => text
                .parse::<SignedDuration>()
                .map_err(|_| "write it like 10s, 10m, 1h30m or 90 (seconds)".to_owned())?
                .as_secs_f64(),
        };
        if seconds < 0.0 {
            return Err("it cannot be negative".to_owned());
        }
        if !(0.0..=MAX_S).contains(&seconds) {
            return Err("it must lie between 0 s and 10 years".to_owned());
        }
        Ok(Self(seconds))
    }
}

/// Formats the duration, limited to 0 s to ten years, so that [`Seconds::from_str`] can read it back: `2m30s`.
/// From 1 s on it is rounded to 1 ms. NaN is written as `NaN`.
impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_nan() {
            return f.write_str("NaN");
        }
        let shown = SignedDuration::from_secs_f64(self.0.clamp(0.0, MAX_S));
        let shown =
            if self.0 < 1.0 { shown } else { SignedDuration::from_millis((shown.as_millis_f64()).round() as i64) };
        f.write_str(&format!("{shown:#}").replace(' ', ""))
    }
}

/// The longest accepted duration, s: ten years. It is far beyond any measurement and fits 64-bit nanoseconds.
const MAX_S: f64 = 10.0 * 365.25 * 86_400.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_of_writing_a_duration_is_read() {
        let cases = [
            ("10s", 10.0),
            ("10m", 600.0),
            ("1h30m", 5400.0),
            ("1h 30m", 5400.0),
            ("90", 90.0),
            ("0.5", 0.5),
            ("250ms", 0.25),
            ("1.5h", 5400.0),
        ];
        for (text, seconds) in cases {
            assert_eq!(text.parse(), Ok(Seconds(seconds)), "{text}");
        }
        for text in ["", "ten", "10 parsecs", "-1s", "-1", "nan", "inf", "11y"] {
            assert!(text.parse::<Seconds>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_shown_duration_reads_back() {
        for seconds in [0.0, 0.25, 1.0, 150.0, 600.0, 3183.5, 86_400.0] {
            let shown = Seconds(seconds).to_string();
            assert_eq!(shown.parse(), Ok(Seconds(seconds)), "{shown}");
        }
        assert_eq!(Seconds(150.0).to_string(), "2m30s");
        for odd in [f64::NAN, f64::INFINITY, -1.0, f64::MIN_POSITIVE] {
            assert!(!Seconds(odd).to_string().is_empty());
        }
    }
}
