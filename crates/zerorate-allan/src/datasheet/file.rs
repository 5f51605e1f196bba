//! A [`DataSheet`] from a file (`docs/formats/datasheet.md`).

use super::unit::{Of, Unit};
use super::{DataSheet, Figure, Line};
use crate::toml_error::syntax;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use serde::Deserialize;
use toml::Spanned;

/// Version of the file form, and the newest that is read.
const SCHEMA: u32 = 1;

impl DataSheet {
    /// Reads the file of a data sheet.
    ///
    /// ```
    /// let sheet = zerorate_allan::DataSheet::parse(r#"
    ///     schema = 1
    ///     name = "ADIS16405"
    ///     [gyroscope]
    ///     noise_density = { typical = 0.05, unit = "°/s/√Hz" }
    ///     bias_instability = { typical = 0.007, unit = "°/s" }
    /// "#)?;
    /// assert_eq!((sheet.gyroscope.len(), sheet.gyroscope[0].value), (2, 0.05));
    /// # Ok::<(), zerorate_allan::DataSheetError>(())
    /// ```
    ///
    /// # Errors
    /// No such file: where, and what is wrong.
    pub fn parse(text: &str) -> Result<Self, DataSheetError> {
        let file: File = toml::from_str(text).map_err(|error| DataSheetError::new(syntax(text, &error)))?;
        if file.schema != SCHEMA {
            let what = format_args!("schema {} is unknown; this software reads {SCHEMA}", file.schema);
            return Err(DataSheetError::new(what));
        }
        let gyroscope = file.gyroscope.map(|gyroscope| gyroscope.lines(text)).transpose()?.unwrap_or_default();
        let accelerometer = file.accelerometer.map(|kind| kind.lines(text)).transpose()?.unwrap_or_default();
        if gyroscope.is_empty() && accelerometer.is_empty() {
            return Err(DataSheetError::new("it states nothing; give [gyroscope] or [accelerometer] a figure"));
        }
        Ok(Self { name: file.name, source: file.source, gyroscope, accelerometer })
    }
}

/// What is wrong with the file of a data sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataSheetError(String);

impl DataSheetError {
    fn new(what: impl fmt::Display) -> Self {
        Self(alloc::format!("{what}"))
    }
}

impl fmt::Display for DataSheetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not the file of a data sheet (docs/formats/datasheet.md): {}", self.0.trim_end())
    }
}

impl core::error::Error for DataSheetError {}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    schema: u32,
    name: String,
    source: Option<String>,
    gyroscope: Option<Gyroscope>,
    accelerometer: Option<Accelerometer>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Gyroscope {
    noise_density: Option<Entry>,
    angle_random_walk: Option<Entry>,
    bias_instability: Option<Entry>,
    rate_random_walk: Option<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Accelerometer {
    noise_density: Option<Entry>,
    velocity_random_walk: Option<Entry>,
    bias_instability: Option<Entry>,
    acceleration_random_walk: Option<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    typical: Option<Spanned<f64>>,
    maximum: Option<Spanned<f64>>,
    unit: String,
    means: Option<Means>,
    source: Option<String>,
}

/// What is called bias instability.
#[derive(Clone, Copy, Deserialize, PartialEq)]
enum Means {
    #[serde(rename = "minimum")]
    Minimum,
    B,
}

/// A key with its entry, what it is of, and the units that it may have.
struct Row<'a> {
    key: &'static str,
    entry: Option<&'a Entry>,
    figure: Figure,
    of: Of,
    /// As [`Unit::halves`].
    halves: i32,
    units: &'static str,
}

impl Gyroscope {
    fn lines(&self, text: &str) -> Result<Vec<Line>, DataSheetError> {
        let row = |key, entry, figure, halves, units| Row { key, entry, figure, of: Of::Angle, halves, units };
        lines(
            text,
            [
                row(
                    "gyroscope.noise_density",
                    self.noise_density.as_ref(),
                    Figure::NoiseDensity,
                    -1,
                    "°/s/√Hz, °/h/√Hz, mdps/√Hz or rad/s/√Hz",
                ),
                row(
                    "gyroscope.angle_random_walk",
                    self.angle_random_walk.as_ref(),
                    Figure::RandomWalk,
                    -1,
                    "°/√h, °/√s or rad/√s",
                ),
                row(
                    "gyroscope.bias_instability",
                    self.bias_instability.as_ref(),
                    Figure::CurveMinimum,
                    -2,
                    "°/h, °/s or rad/s",
                ),
                row(
                    "gyroscope.rate_random_walk",
                    self.rate_random_walk.as_ref(),
                    Figure::RateRandomWalk,
                    -3,
                    "°/h/√h, °/s/√s, °/s/√h or rad/s/√s",
                ),
            ],
        )
    }
}

impl Accelerometer {
    fn lines(&self, text: &str) -> Result<Vec<Line>, DataSheetError> {
        let row = |key, entry, figure, halves, units| Row { key, entry, figure, of: Of::Length, halves, units };
        lines(
            text,
            [
                row(
                    "accelerometer.noise_density",
                    self.noise_density.as_ref(),
                    Figure::NoiseDensity,
                    -3,
                    "µg/√Hz, mg/√Hz, g/√Hz or m/s²/√Hz",
                ),
                row(
                    "accelerometer.velocity_random_walk",
                    self.velocity_random_walk.as_ref(),
                    Figure::RandomWalk,
                    -3,
                    "m/s/√h or m/s/√s",
                ),
                row(
                    "accelerometer.bias_instability",
                    self.bias_instability.as_ref(),
                    Figure::CurveMinimum,
                    -4,
                    "µg, mg, g or m/s²",
                ),
                row(
                    "accelerometer.acceleration_random_walk",
                    self.acceleration_random_walk.as_ref(),
                    Figure::RateRandomWalk,
                    -5,
                    "µg/√h, m/s²/√h or m/s²/√s",
                ),
            ],
        )
    }
}

fn lines(text: &str, rows: [Row<'_>; 4]) -> Result<Vec<Line>, DataSheetError> {
    let mut lines = Vec::new();
    for row in &rows {
        let Some(entry) = row.entry else { continue };
        let limits = [(&entry.typical, false), (&entry.maximum, true)];
        if entry.typical.is_none() && entry.maximum.is_none() {
            return Err(DataSheetError::new(format_args!("{} has no value; give it typical or maximum", row.key)));
        }
        for (value, is_maximum) in limits {
            if let Some(value) = value {
                lines.push(row.line(text, entry, value, is_maximum)?);
            }
        }
    }
    Ok(lines)
}

impl Row<'_> {
    fn line(&self, text: &str, entry: &Entry, value: &Spanned<f64>, is_maximum: bool) -> Result<Line, DataSheetError> {
        let Self { key, figure, of, halves, units, .. } = *self;
        let wrong = |what: fmt::Arguments<'_>| Err(DataSheetError::new(format_args!("{key}: {what}")));
        let printed = text.get(value.span()).unwrap_or_default();
        let value = *value.get_ref();
        if !(value > 0.0 && value.is_finite()) {
            return wrong(format_args!("{value} is no noise; it must be above zero"));
        }
        let Some(unit) = Unit::parse(&entry.unit).filter(|unit| (unit.of, unit.halves) == (of, halves)) else {
            return wrong(format_args!("its unit is {:?}; use {units}", entry.unit));
        };
        let figure = match (figure, entry.means) {
            (Figure::CurveMinimum, Some(Means::B)) => Figure::BiasInstability,
            (Figure::CurveMinimum, _) | (_, None) => figure,
            _ => return wrong(format_args!("only a bias_instability can mean one thing or another")),
        };
        let (unit, factor) = (entry.unit.clone(), unit.factor);
        let source = entry.source.clone();
        Ok(Line { figure, is_maximum, value, half_digit: half_digit(printed, value), unit, factor, source })
    }
}

/// Half of the last digit that is printed: 0.05 of `2.0`, 0.5 of `5`, 5e-6 of `1.5e-4`.
fn half_digit(printed: &str, value: f64) -> f64 {
    let small = printed.to_lowercase();
    let (digits, exponent) = small.split_once('e').unwrap_or((&small, "0"));
    let places = digits.split_once('.').map_or(0, |(_, places)| places.chars().filter(char::is_ascii_digit).count());
    let exponent = exponent.parse::<i32>().unwrap_or(0).saturating_sub(i32::try_from(places).unwrap_or(0));
    // an odd way of writing a number is no uncertainty of half of it
    (0.5 * libm::pow(10.0, f64::from(exponent))).min(0.5 * value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    const SHEET: &str = r#"
        schema = 1
        name = "ADIS16405"
        source = "a data sheet"
        [gyroscope]
        noise_density = { typical = 0.05, unit = "°/s/√Hz" }
        angle_random_walk = { typical = 2.0, maximum = 3, unit = "°/√h", source = "table 1" }
        bias_instability = { typical = 7e-3, unit = "deg/sec", means = "B" }
        [accelerometer]
        velocity_random_walk = { typical = 0.2, unit = "m/s/√hr" }
        bias_instability = { typical = 0.20, unit = "mg" }
    "#;

    #[test]
    fn a_line_is_what_is_printed() {
        let sheet = DataSheet::parse(SHEET).unwrap();
        let found: Vec<(Figure, bool, f64, f64)> = sheet
            .gyroscope
            .iter()
            .chain(&sheet.accelerometer)
            .map(|line| (line.figure, line.is_maximum, line.value, line.half_digit))
            .collect();
        let expected = [
            (Figure::NoiseDensity, false, 0.05, 0.005),
            (Figure::RandomWalk, false, 2.0, 0.05),
            (Figure::RandomWalk, true, 3.0, 0.5),
            (Figure::BiasInstability, false, 7e-3, 5e-4),
            (Figure::RandomWalk, false, 0.2, 0.05),
            (Figure::CurveMinimum, false, 0.2, 0.005),
        ];
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.into_iter().zip(expected) {
            assert_eq!((found.0, found.1, found.2), (expected.0, expected.1, expected.2));
            assert!((found.3 / expected.3 - 1.0).abs() < 1e-12, "{found:?}");
        }
        assert_eq!(sheet.gyroscope[1].source.as_deref(), Some("table 1"));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (from, to, said) in [
            ("schema = 1", "schema = 2", "schema 2 is unknown"),
            ("\"°/s/√Hz\"", "\"mg\"", "gyroscope.noise_density: its unit is \"mg\"; use °/s/√Hz"),
            ("\"mg\"", "\"µg/√Hz\"", "accelerometer.bias_instability: its unit is \"µg/√Hz\"; use µg, mg"),
            ("\"m/s/√hr\"", "\"furlong\"", "velocity_random_walk: its unit is \"furlong\""),
            ("noise_density", "noise_densty", "noise_densty"),
            ("typical = 0.05", "typical = 0", "gyroscope.noise_density: 0 is no noise"),
            ("typical = 0.05, ", "", "gyroscope.noise_density has no value; give it typical or maximum"),
            ("means = \"B\"", "means = \"b\"", "means"),
            ("maximum = 3,", "means = \"B\",", "only a bias_instability"),
        ] {
            let text = SHEET.replacen(from, to, 1);
            assert_ne!(text, SHEET, "{from}");
            let error = DataSheet::parse(&text).unwrap_err().to_string();
            assert!(error.contains(said), "{to}: {error}");
        }
        let error = DataSheet::parse("schema = 1\nname = \"x\"\n").unwrap_err().to_string();
        assert!(error.contains("states nothing"), "{error}");
    }
}
