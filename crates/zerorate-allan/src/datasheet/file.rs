//! Reads a [`DataSheet`] from a file (`docs/formats/datasheet.md`).

use super::unit::{Of, Unit};
use super::{DataSheet, Figure, Line};
use crate::entry::{Bounds, Document, Entry, EntryError, PART_KEYS};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use serde::Deserialize;
use serde::de::IgnoredAny;

const SCHEMA: u32 = 1;

impl DataSheet {
    /// Parses the file of a data sheet.
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
    /// Returns [`DataSheetError`] with the line and the problem if the file is not valid.
    pub fn parse(text: &str) -> Result<Self, DataSheetError> {
        let document = Document::parse(text)?;
        let (root, file) = (document.root(), document.fields::<File>()?);
        root.only(&PART_KEYS)?;
        root.at("schema").require(file.schema == SCHEMA, || {
            format!("schema {} is unknown; this software reads {SCHEMA}", file.schema)
        })?;
        let gyroscope = file.gyroscope.map(|stated| stated.lines(root)).transpose()?.unwrap_or_default();
        let accelerometer = file.accelerometer.map(|stated| stated.lines(root)).transpose()?.unwrap_or_default();
        let states_some = !(gyroscope.is_empty() && accelerometer.is_empty());
        root.require(states_some, || "it states nothing; give [gyroscope] or [accelerometer] a figure".into())?;
        Ok(Self { name: file.name, source: file.source, gyroscope, accelerometer })
    }
}

/// The reason why the file of a data sheet is not valid. `Display` states the line, the problem and what is valid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataSheetError(EntryError);

impl From<EntryError> for DataSheetError {
    fn from(error: EntryError) -> Self {
        Self(error)
    }
}

impl fmt::Display for DataSheetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not the file of a data sheet (docs/formats/datasheet.md): {}", self.0)
    }
}

impl core::error::Error for DataSheetError {}

/// The fields of a part file that a data sheet needs.
#[derive(Deserialize)]
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
    noise_density: Option<FigureEntry>,
    angle_random_walk: Option<FigureEntry>,
    bias_instability: Option<FigureEntry>,
    rate_random_walk: Option<FigureEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Accelerometer {
    noise_density: Option<FigureEntry>,
    velocity_random_walk: Option<FigureEntry>,
    bias_instability: Option<FigureEntry>,
    acceleration_random_walk: Option<FigureEntry>,
    // the output format and bandwidth of the accelerometer, which the comparison of noise does not use
    #[serde(rename = "lsb_per_g")]
    _lsb_per_g: Option<IgnoredAny>,
    #[serde(rename = "width_bits")]
    _width_bits: Option<IgnoredAny>,
    #[serde(rename = "range_g")]
    _range_g: Option<IgnoredAny>,
    #[serde(rename = "full_scales")]
    _full_scales: Option<IgnoredAny>,
    #[serde(rename = "bandwidth_hz")]
    _bandwidth_hz: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FigureEntry {
    typical: Option<f64>,
    maximum: Option<f64>,
    unit: String,
    means: Option<Means>,
    source: Option<String>,
}

/// The meaning of "bias instability" in a data sheet.
#[derive(Clone, Copy, Deserialize, PartialEq)]
enum Means {
    #[serde(rename = "minimum")]
    Minimum,
    B,
}

/// A key, the quantity that it states, the exponent of its unit (as [`Unit::halves`]), and the units that errors name.
struct FigureRow(&'static str, Figure, i32, &'static str);

impl Gyroscope {
    const ROWS: [FigureRow; 4] = [
        FigureRow("noise_density", Figure::NoiseDensity, -1, "°/s/√Hz, °/h/√Hz, mdps/√Hz or rad/s/√Hz"),
        FigureRow("angle_random_walk", Figure::RandomWalk, -1, "°/√h, °/√s or rad/√s"),
        FigureRow("bias_instability", Figure::CurveMinimum, -2, "°/h, °/s or rad/s"),
        FigureRow("rate_random_walk", Figure::RateRandomWalk, -3, "°/h/√h, °/s/√s, °/s/√h or rad/s/√s"),
    ];

    fn lines(self, root: Entry<'_>) -> Result<Vec<Line>, EntryError> {
        let stated = [self.noise_density, self.angle_random_walk, self.bias_instability, self.rate_random_walk];
        lines(root.at("gyroscope"), Of::Angle, &Self::ROWS, stated)
    }
}

impl Accelerometer {
    const ROWS: [FigureRow; 4] = [
        FigureRow("noise_density", Figure::NoiseDensity, -3, "µg/√Hz, mg/√Hz, g/√Hz or m/s²/√Hz"),
        FigureRow("velocity_random_walk", Figure::RandomWalk, -3, "m/s/√h or m/s/√s"),
        FigureRow("bias_instability", Figure::CurveMinimum, -4, "µg, mg, g or m/s²"),
        FigureRow("acceleration_random_walk", Figure::RateRandomWalk, -5, "µg/√h, m/s²/√h or m/s²/√s"),
    ];

    fn lines(self, root: Entry<'_>) -> Result<Vec<Line>, EntryError> {
        let Self { noise_density, velocity_random_walk, bias_instability, acceleration_random_walk, .. } = self;
        let stated = [noise_density, velocity_random_walk, bias_instability, acceleration_random_walk];
        lines(root.at("accelerometer"), Of::Length, &Self::ROWS, stated)
    }
}

fn lines(
    table: Entry<'_>,
    of: Of,
    rows: &[FigureRow; 4],
    stated: [Option<FigureEntry>; 4],
) -> Result<Vec<Line>, EntryError> {
    let mut lines = Vec::new();
    for (row, stated) in rows.iter().zip(stated) {
        let Some(stated) = stated else { continue };
        let (entry, before) = (table.at(row.0), lines.len());
        for (key, value, is_maximum) in [("typical", stated.typical, false), ("maximum", stated.maximum, true)] {
            let Some(value) = value else { continue };
            let printed = entry.at(key);
            let line = row.line(of, &stated, value, is_maximum, printed.written());
            lines.push(line.map_err(|what| printed.error(format!("{}.{}: {what}", table.key(), row.0)))?);
        }
        entry.require(lines.len() > before, || {
            format!("{}.{} has no value; give it typical or maximum", table.key(), row.0)
        })?;
    }
    Ok(lines)
}

impl FigureRow {
    fn line(&self, of: Of, stated: &FigureEntry, value: f64, is_maximum: bool, printed: &str) -> Result<Line, String> {
        let &Self(_, figure, halves, units) = self;
        let bounds = Bounds::Positive;
        if !bounds.hold(value) {
            return Err(format!("{value} is not a noise; {bounds}"));
        }
        let Some(unit) = Unit::parse(&stated.unit).filter(|unit| (unit.of, unit.halves) == (of, halves)) else {
            return Err(format!("its unit is {:?}; use {units}", stated.unit));
        };
        let figure = match (figure, stated.means) {
            (Figure::CurveMinimum, Some(Means::B)) => Figure::BiasInstability,
            (Figure::CurveMinimum, _) | (_, None) => figure,
            _ => return Err("only a bias_instability can have `means`; remove it".into()),
        };
        let (unit, factor) = (stated.unit.clone(), unit.factor);
        let source = stated.source.clone();
        Ok(Line { figure, is_maximum, value, half_digit: half_digit(printed, value), unit, factor, source })
    }
}

/// Half a unit of the last printed digit: 0.05 for `2.0`, 0.5 for `5`, 5e-6 for `1.5e-4`.
fn half_digit(printed: &str, value: f64) -> f64 {
    let small = printed.to_lowercase();
    let (digits, exponent) = small.split_once('e').unwrap_or((&small, "0"));
    let places = digits.split_once('.').map_or(0, |(_, places)| places.chars().filter(char::is_ascii_digit).count());
    let exponent = exponent.parse::<i32>().unwrap_or(0).saturating_sub(i32::try_from(places).unwrap_or(0));
    // an unusual notation must not make the value uncertain by more than half
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
    fn a_line_has_the_printed_value_and_unit() {
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
    fn errors_name_the_field_and_the_remedy() {
        for (from, to, said) in [
            ("schema = 1", "schema = 2", "schema 2 is unknown"),
            ("\"°/s/√Hz\"", "\"mg\"", "gyroscope.noise_density: its unit is \"mg\"; use °/s/√Hz"),
            ("\"mg\"", "\"µg/√Hz\"", "accelerometer.bias_instability: its unit is \"µg/√Hz\"; use µg, mg"),
            ("\"m/s/√hr\"", "\"furlong\"", "velocity_random_walk: its unit is \"furlong\""),
            ("noise_density", "noise_densty", "noise_densty"),
            ("[accelerometer]", "[accelerometre]", "accelerometre is unknown; use"),
            ("typical = 0.05", "typical = 0", "line 6: gyroscope.noise_density: 0 is not a noise"),
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
