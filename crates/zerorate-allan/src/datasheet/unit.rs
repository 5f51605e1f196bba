//! Units as data sheets write them: `°/s/√Hz`, `deg/rt(hr)`, `ug/sqrt(Hz)`, `m/s^2`.

use alloc::string::String;

/// The base quantity of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    Angle,
    Length,
}

/// A unit of angle or length, times a power of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    pub(super) of: Of,
    /// Twice the exponent of the second: −2 for °/s, −1 for °/√s.
    pub(super) halves: i32,
    /// Size of the unit in °·s^(`halves`/2) or m·s^(`halves`/2).
    pub(super) factor: f64,
}

const HOUR_S: f64 = 3600.0;
/// Standard gravity, m/s².
const G: f64 = 9.806_65;

impl Unit {
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text = plain(text);
        let mut parts = text.split('/');
        let mut unit = Self::numerator(parts.next()?)?;
        for part in parts {
            let (halves, factor) = denominator(part)?;
            unit.halves += halves;
            unit.factor /= factor;
        }
        Some(unit)
    }

    fn numerator(text: &str) -> Option<Self> {
        let (of, halves, factor) = match text {
            "°" => (Of::Angle, 0, 1.0),
            "m°" => (Of::Angle, 0, 1e-3),
            "°/s" | "dps" => (Of::Angle, -2, 1.0),
            "mdps" => (Of::Angle, -2, 1e-3),
            "rad" => (Of::Angle, 0, 180.0 / core::f64::consts::PI),
            "mrad" => (Of::Angle, 0, 0.18 / core::f64::consts::PI),
            "µrad" => (Of::Angle, 0, 0.000_18 / core::f64::consts::PI),
            "m" => (Of::Length, 0, 1.0),
            "mm" => (Of::Length, 0, 1e-3),
            "g" => (Of::Length, -4, G),
            "mg" => (Of::Length, -4, 1e-3 * G),
            "µg" => (Of::Length, -4, 1e-6 * G),
            "mgal" => (Of::Length, -4, 1e-5),
            _ => return None,
        };
        Some(Self { of, halves, factor })
    }
}

/// Twice the exponent of the second that a denominator adds, and the value of the denominator with times in s.
fn denominator(text: &str) -> Option<(i32, f64)> {
    Some(match text {
        "s" => (-2, 1.0),
        "s²" => (-4, 1.0),
        "s³" => (-6, 1.0),
        "h" => (-2, HOUR_S),
        "√s" => (-1, 1.0),
        "√h" => (-1, 60.0),
        "√hz" => (1, 1.0),
        _ => return None,
    })
}

/// The text with all spellings of a unit unified.
fn plain(text: &str) -> String {
    let small: String = text.to_lowercase().chars().filter(|c| !c.is_whitespace() && !"()".contains(*c)).collect();
    [
        ("sqrt", "√"),
        ("rt", "√"),
        ("degrees", "°"),
        ("degree", "°"),
        ("deg", "°"),
        ("º", "°"),
        ("hours", "h"),
        ("hour", "h"),
        ("hr", "h"),
        ("sec", "s"),
        ("^2", "²"),
        ("^3", "³"),
        ("μ", "µ"),
        ("ug", "µg"),
        ("urad", "µrad"),
    ]
    .into_iter()
    .fold(small, |text, (from, to)| text.replace(from, to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_as_data_sheets_write_them() {
        for (text, of, halves, factor) in [
            ("°/s/√Hz", Of::Angle, -1, 1.0),
            ("deg/sec/rtHz", Of::Angle, -1, 1.0),
            ("dps/sqrt(Hz)", Of::Angle, -1, 1.0),
            ("mdps/√Hz", Of::Angle, -1, 1e-3),
            ("°/h/√Hz", Of::Angle, -1, 1.0 / 3600.0),
            ("°/√h", Of::Angle, -1, 1.0 / 60.0),
            ("deg/√(hr)", Of::Angle, -1, 1.0 / 60.0),
            ("deg/rt(hour)", Of::Angle, -1, 1.0 / 60.0),
            ("°/h", Of::Angle, -2, 1.0 / 3600.0),
            ("rad/s/√s", Of::Angle, -3, 180.0 / core::f64::consts::PI),
            ("rad/s²/√Hz", Of::Angle, -3, 180.0 / core::f64::consts::PI),
            ("°/h/√h", Of::Angle, -3, 1.0 / 216_000.0),
            ("µg/√Hz", Of::Length, -3, 9.806_65e-6),
            ("ug/sqrt(hz)", Of::Length, -3, 9.806_65e-6),
            ("m/s/√h", Of::Length, -3, 1.0 / 60.0),
            ("mg", Of::Length, -4, 9.806_65e-3),
            ("m/s^2", Of::Length, -4, 1.0),
            ("m/s²/√s", Of::Length, -5, 1.0),
        ] {
            let unit = Unit::parse(text).unwrap();
            assert_eq!((unit.of, unit.halves), (of, halves), "{text}");
            assert!((unit.factor / factor - 1.0).abs() < 1e-12, "{text}: {unit:?}");
        }
        for text in ["", "°/", "V", "LSB/√Hz", "°/s/√Hz/", "√Hz", "°/√parsec"] {
            assert_eq!(Unit::parse(text), None, "{text}");
        }
    }
}
