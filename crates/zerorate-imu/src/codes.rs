//! Checks whether columns can hold integer codes, and suggests the options that state their unit or scale.

use super::Kind;
use std::path::Path;
use zerorate_logs::{Column, ColumnOptions, LogError, Names, Result, STANDARD_GRAVITY, Series, Setting, Unit};

/// The user's statement that the columns of a kind hold integer codes. Unit and scale then belong to one code step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Codes {
    /// The option that says that the columns hold codes.
    pub setting: Setting,
    /// Width of a code in bits, sign included.
    pub width_bits: u8,
}

impl Codes {
    pub(super) fn check(self, path: &Path, column: &Column, names: Names) -> Result<()> {
        let given = names.of(self.setting);
        let wrong = |why: String| {
            let (path, name) = (path.display(), &column.name);
            Err(LogError::Ask(format!("{path}: {given} is for integer codes, and column `{name}` {why}")))
        };
        let most = 2f64.powi(i32::from(self.width_bits) - 1);
        let is_beyond = |code: &&f64| !(-most..most).contains(*code);
        if let Some(quantity) = column.quantity {
            return wrong(format!("is in {}; leave {given} out", quantity.unit()));
        }
        let numbers = numbers(column);
        if let Some(number) = numbers.iter().find(|number| number.fract() != 0.0) {
            return wrong(format!("holds {number}; give its unit and scale instead"));
        }
        match numbers.iter().find(is_beyond) {
            Some(code) => wrong(format!("holds {code}, which is beyond {} bits", self.width_bits)),
            None => Ok(()),
        }
    }
}

/// The samples of a column, without the missing ones.
pub(super) fn numbers(column: &Column) -> Vec<f64> {
    match &column.series {
        Series::Codes(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
        Series::Numbers(numbers) => numbers.iter().copied().filter(|number| !number.is_nan()).collect(),
    }
}

pub(super) fn are_whole(column: &Column) -> bool {
    matches!(column.series, Series::Codes(_)) || numbers(column).iter().all(|number| number.fract() == 0.0)
}

/// The norm of the means of three axes counts as gravity if it differs from gravity by less than this share.
const WITHIN: f64 = 0.05;

/// The usual full scales of accelerometers, g.
const FULL_SCALES_G: [f64; 8] = [2.0, 4.0, 8.0, 16.0, 3.0, 6.0, 12.0, 24.0];

/// Number of 16-bit codes on one side of zero.
const CODES: f64 = 32768.0;

/// A hint at the unit or scale of the three axes of an accelerometer at rest, which measures gravity. `None` if there
/// are not three axes, or if neither a unit nor a usual full scale of integer codes fits.
pub(super) fn of_gravity(axes: &[&Column], log: &ColumnOptions) -> Option<String> {
    let ([x, y, z], names) = (axes, log.names) else { return None };
    let mean = |axis: &Column| axis.facts().mean() * log.per_second(axis.rate_hz);
    let steps = [x, y, z].map(|axis| mean(axis).powi(2)).iter().sum::<f64>().sqrt();
    let is_near = |one_g: f64| (steps / one_g - 1.0).abs() < WITHIN;
    let mut units = Unit::ALL.into_iter().filter(|unit| unit.quantity() == Kind::Accelerometer.quantity());
    let unit = units.find(|unit| is_near(STANDARD_GRAVITY / unit.in_results()));
    if let Some(unit) = unit {
        let given = unit_to_give(names, Setting::AccelUnit, unit, x);
        return Some(format!("gravity of {steps:.4} looks like {}: {given}", unit.name()));
    }
    let range_g = FULL_SCALES_G.into_iter().find(|range_g| is_near(CODES / range_g))?;
    if !axes.iter().all(|axis| are_whole(axis)) {
        return None;
    }
    let (given, per_g) = (names.of(Setting::AccelRange), CODES / range_g);
    Some(format!("gravity of {steps:.0} looks like codes of ±{range_g} g ({per_g:.0} per g): {given} {range_g}"))
}

/// The options that give the unit of a column. Its name may state another unit, which one more option overrides.
pub(super) fn unit_to_give(names: Names, setting: Setting, unit: Unit, column: &Column) -> String {
    let (given, unit_name) = (names.of(setting), unit.name());
    match Unit::of_column(&column.name).filter(|stated| *stated != unit) {
        Some(_) => format!("{given} {unit_name}, and {}", names.of(Setting::ForceUnit)),
        None => format!("{given} {unit_name}"),
    }
}

pub(super) fn of_gyroscope(names: Names) -> String {
    let [range, part] = [Setting::GyroRange, Setting::Part].map(|setting| names.of(setting));
    format!("if these are codes, {range} with the full scale in °/s, or {part} with the name of the sensor")
}
