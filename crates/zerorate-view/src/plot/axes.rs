//! Converts values to pixels and chooses readable ticks.

/// The smallest distance between two ticks of a linear axis, pixels. Ticks are closer if two distances do not fit.
const ROOM: f64 = 24.0;

#[derive(Clone, Debug)]
pub struct Axis {
    low: f64,
    high: f64,
    /// The pixel positions of `low` and `high`.
    span: (f64, f64),
    log: bool,
}

/// The least and the largest finite value; `None` if there is none.
pub fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let ends = values.filter(|value| value.is_finite()).map(|value| (value, value));
    ends.reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}

/// The range of the values, with shares of its width added below and above. A single value is in the middle of a range
/// from or to 0; without a value, or for 0, the range is −1 to 1.
pub fn range_with_margins(values: impl Iterator<Item = f64>, below: f64, above: f64) -> (f64, f64) {
    match range(values) {
        Some((low, high)) if low < high => (low - below * (high - low), high + above * (high - low)),
        Some((only, _)) if only.is_normal() => (only - only.abs(), only + only.abs()),
        _ => (-1.0, 1.0),
    }
}

/// A tick or grid line.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    /// The number beside the line; `None` for a line without one.
    pub label: Option<String>,
    /// True if the line is major: a whole decade, or any tick of a linear axis.
    pub major: bool,
}

impl Axis {
    /// A logarithmic axis over positive values, at least one decade long. Its ends are moved outward to 1, 2 or 5
    /// times a power of ten.
    pub fn log(low: f64, high: f64, span: (f64, f64)) -> Self {
        let widen = (10.0 * low / high).max(1.0).sqrt();
        Self { low: round_125(low / widen, f64::floor), high: round_125(high * widen, f64::ceil), span, log: true }
    }

    /// A linear axis between exactly these values; from `low` to `low` + 1 if `high` is not above `low`.
    pub fn linear(low: f64, high: f64, span: (f64, f64)) -> Self {
        Self { low, high: if high > low { high } else { low + 1.0 }, span, log: false }
    }

    /// The same axis in a unit that is smaller by `factor`, so that its values are larger by `factor`.
    pub fn in_unit(&self, factor: f64) -> Self {
        Self { low: self.low * factor, high: self.high * factor, ..*self }
    }

    /// The pixel of a value. Values far outside, such as zero on a logarithmic axis, are clamped outside of the frame.
    pub fn at(&self, value: f64) -> f64 {
        let fraction = if self.log {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.span.0 + fraction.clamp(-2.0, 3.0) * (self.span.1 - self.span.0)
    }

    pub fn value(&self, pixel: f64) -> f64 {
        let fraction = (pixel - self.span.0) / (self.span.1 - self.span.0);
        if self.log {
            self.low * (self.high / self.low).powf(fraction)
        } else {
            self.low + fraction * (self.high - self.low)
        }
    }

    /// First and last pixel.
    pub fn ends(&self) -> (f64, f64) {
        self.span
    }

    pub fn covers(&self, value: f64) -> bool {
        let slack = 1e-9 * (self.high - self.low);
        (self.low - slack..=self.high + slack).contains(&value)
    }

    /// The ticks, lowest first.
    pub fn ticks(&self) -> Vec<Tick> {
        if self.log { self.decades() } else { self.steps() }
    }

    fn decades(&self) -> Vec<Tick> {
        let (first, last) = (exponent(self.low), exponent(self.high));
        let decades = last - first;
        let plain = first >= -3 && last <= 4;
        let every = 1 + decades / 10;
        let labelled = |k: i32, digit: i32| match digit {
            1 => k % every == 0,
            2 | 5 => decades <= 2,
            _ => false,
        };
        let tick = |k: i32, digit: i32| Tick {
            value: f64::from(digit) * 10f64.powi(k),
            label: labelled(k, digit).then(|| power(digit, k, plain)),
            major: digit == 1,
        };
        let digits = if decades > 10 { 1..=1 } else { 1..=9 };
        (first..=last)
            .flat_map(|k| digits.clone().map(move |digit| (k, digit)))
            .map(|(k, digit)| tick(k, digit))
            .filter(|tick| self.covers(tick.value))
            .collect()
    }

    fn steps(&self) -> Vec<Tick> {
        let most = ((self.span.1 - self.span.0).abs() / ROOM).clamp(2.0, 7.0).floor();
        let (step, places) = round_step((self.high - self.low) / most);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        let tick = |k: i64| {
            let value = k as f64 * step;
            Tick { value, label: Some(minus(&format!("{value:.places$}"))), major: true }
        };
        (first..=last).map(tick).collect()
    }
}

/// The smallest step of 1, 2 or 5 times a power of ten that is at least this large, and the decimals of its multiples.
pub fn round_step(least: f64) -> (f64, usize) {
    let step = round_125(least, f64::ceil);
    (step, usize::try_from(-exponent(step)).unwrap_or(0))
}

/// Formats a number with three significant digits: 0.0123 or 1.23·10⁻⁵. From 1000 to 99 949, all digits before
/// the decimal point are written.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return minus(&value.to_string());
    }
    let scientific = format!("{value:.2e}");
    let (digits, k) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    match k.parse::<i32>().unwrap_or(0) {
        k @ -3..=4 => minus(&format!("{value:.*}", usize::try_from(2 - k).unwrap_or(0))),
        k => minus(&format!("{digits}·10{}", superscript(k))),
    }
}

/// Replaces hyphens by typographic minus signs.
pub fn minus(text: &str) -> String {
    text.replace('-', "−")
}

/// The tick label of digit · 10^k. With `plain`, the number is written out: 100 instead of 10².
fn power(digit: i32, k: i32, plain: bool) -> String {
    match (plain, digit) {
        (true, _) => {
            let places = usize::try_from(-k).unwrap_or(0);
            format!("{:.places$}", f64::from(digit) * 10f64.powi(k))
        }
        (false, 1) if k == 0 => "1".to_owned(),
        (false, 1) if k == 1 => "10".to_owned(),
        (false, 1) => format!("10{}", superscript(k)),
        (false, _) => format!("{digit}·10{}", superscript(k)),
    }
}

pub fn superscript(k: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32(digit as u32 - '0' as u32 + '⁰' as u32).unwrap_or(digit),
    };
    k.to_string().chars().map(raised).collect()
}

/// The exponent of the power of ten at or below a positive value.
fn exponent(value: f64) -> i32 {
    (value.log10() + 1e-9).floor() as i32
}

/// Rounds a value to 1, 2 or 5 times a power of ten, in the direction of `round`.
fn round_125(value: f64, round: fn(f64) -> f64) -> f64 {
    let k = exponent(value);
    let lead = value / 10f64.powi(k);
    // an index into the list 1, 2, 5, 10; half-way between two indices for a value in between
    let place = match lead {
        x if x <= 1.0 + 1e-9 => 0.0,
        x if x < 2.0 - 1e-9 => 0.5,
        x if x <= 2.0 + 1e-9 => 1.0,
        x if x < 5.0 - 1e-9 => 1.5,
        x if x <= 5.0 + 1e-9 => 2.0,
        _ => 2.5,
    };
    [1.0, 2.0, 5.0, 10.0][round(place) as usize] * 10f64.powi(k)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn known_points_of_a_logarithmic_axis() {
        let axis = Axis::log(0.01, 1000.0, (100.0, 600.0));
        // five decades over 500 pixels
        for (value, pixel) in [(0.01, 100.0), (0.1, 200.0), (1000.0, 600.0), (2.0, 330.103)] {
            assert!((axis.at(value) - pixel).abs() < 1e-3, "{value}: {}", axis.at(value));
            assert!((axis.value(pixel) / value - 1.0).abs() < 1e-5);
        }
        assert!(axis.at(0.0) < 0.0 && axis.at(1e30) > 700.0, "outside, but finite");
    }

    #[test]
    fn a_constant_is_in_the_middle_of_its_range() {
        let ends = |value: f64| range_with_margins([value; 2].into_iter(), 0.05, 0.3);
        assert_eq!([25.0, -4.0, 0.0].map(ends), [(0.0, 50.0), (-8.0, 0.0), (-1.0, 1.0)]);
    }

    #[test]
    fn ends_are_round() {
        for (low, high, ends) in [
            (0.013, 870.0, (0.01, 1000.0)),
            (0.3, 30.0, (0.2, 50.0)),
            (1.0, 100.0, (1.0, 100.0)),
            (6e-7, 0.9, (5e-7, 1.0)),
        ] {
            let axis = Axis::log(low, high, (0.0, 1.0));
            assert!((axis.low / ends.0 - 1.0).abs() < 1e-12 && (axis.high / ends.1 - 1.0).abs() < 1e-12, "{axis:?}");
        }
        let point = Axis::log(3.0, 3.0, (0.0, 1.0));
        assert!(point.high / point.low >= 10.0 && point.covers(3.0), "{point:?}");
    }

    #[test]
    fn labels_as_people_write_them() {
        assert_eq!(labels(&Axis::log(0.01, 1000.0, (0.0, 1.0))), ["0.01", "0.1", "1", "10", "100", "1000"]);
        assert_eq!(labels(&Axis::log(1e-5, 0.01, (0.0, 1.0))), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]);
        assert_eq!(labels(&Axis::log(2e-6, 3e-5, (0.0, 1.0))), ["2·10⁻⁶", "5·10⁻⁶", "10⁻⁵", "2·10⁻⁵", "5·10⁻⁵"]);
        assert_eq!(
            labels(&Axis::linear(-0.21, 0.4, (0.0, 400.0))),
            ["−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3", "0.4"]
        );
        assert!(labels(&Axis::log(1e-30, 1e30, (0.0, 1.0))).len() < 12);
    }

    #[test]
    fn minor_lines_are_the_multiples_of_the_decade() {
        let values: Vec<f64> = Axis::log(1.0, 20.0, (0.0, 1.0)).ticks().iter().map(|tick| tick.value).collect();
        assert_eq!(values, [1., 2., 3., 4., 5., 6., 7., 8., 9., 10., 20.]);
    }

    #[test]
    fn numbers_with_three_digits() {
        let texts = [0.012_345, 6.25, 1234.5, -0.5, 1.2345e-5, 0.0, 99_960.0].map(number);
        assert_eq!(texts, ["0.0123", "6.25", "1234", "−0.500", "1.23·10⁻⁵", "0", "1.00·10⁵"]);
    }
}
