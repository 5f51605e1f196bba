//! The scales of an IMU's integer codes, from its part file or from its full scale.

use crate::{InvalidOptions, catalogue};
use serde::Deserialize;
use zerorate_allan::entry::{Document, EntryError};
use zerorate_imu::{Codes, ImuOptions, Kind, KindOptions};
use zerorate_logs::{Column, LogWarning, Names, Setting, Unit};

/// The user's settings about the integer codes of an IMU.
#[derive(Debug, Default)]
pub struct CodeOptions {
    /// The scales of the part's codes, if a part was named.
    pub part: Option<CodeScales>,
    /// The full scale of the gyroscope, °/s; `None` for that of the named part after power-up.
    pub gyro_range_dps: Option<f64>,
    /// The full scale of the accelerometer, g; `None` for that of the named part after power-up.
    pub accel_range_g: Option<f64>,
}

/// The scales of a part's codes, from its part file (`docs/formats/part.md`).
#[derive(Debug)]
pub struct CodeScales {
    name: String,
    gyro: Vec<FullScale>,
    accel: Vec<FullScale>,
}

/// The scale of the codes at one full scale.
#[derive(Clone, Copy, Debug)]
struct FullScale {
    /// The full scale, °/s or g; `None` if it is not known.
    range: Option<f64>,
    codes_per_unit: f64,
    width_bits: u8,
}

impl CodeScales {
    /// Reads the scales from the text of a part file. The first full scale of the file holds after power-up.
    ///
    /// # Errors
    /// Returns an error if the text is not a part file.
    pub fn parse(text: &str) -> Result<Self, EntryError> {
        let File { name, rate, accelerometer, axis } = Document::parse(text)?.fields()?;
        let is_common = axis.iter().all(|axis| axis.rate.is_none());
        let gyro = rate.filter(|_| is_common).map_or_else(Vec::new, Sensitivity::full_scales);
        Ok(Self { name, gyro, accel: accelerometer.map_or_else(Vec::new, Sensitivity::full_scales) })
    }

    fn of(&self, kind: Kind) -> &[FullScale] {
        match kind {
            Kind::Gyroscope => &self.gyro,
            Kind::Accelerometer => &self.accel,
        }
    }

    /// The scale of the codes at the full scale `range`, or after power-up without one; `None` if the part states
    /// none.
    fn at(&self, kind: Kind, range: Option<f64>, names: Names) -> Result<Option<FullScale>, InvalidOptions> {
        let (name, all) = (&self.name, self.of(kind));
        let Some(range) = range else { return Ok(all.first().copied()) };
        let is_it = |one: &&FullScale| one.range.is_some_and(|known| (known / range - 1.0).abs() < 1e-6);
        let found = all.iter().find(is_it).copied();
        let ranges: Vec<String> = all.iter().filter_map(|one| Some(one.range?.to_string())).collect();
        let (setting, kind) = (names.of(range_setting(kind)), kind.name());
        let has = match ranges.is_empty() {
            true => format!("states no full scale of the codes of its {kind}"),
            false => format!("has a {kind} with the full scales {}", ranges.join(", ")),
        };
        found.map(Some).ok_or_else(|| InvalidOptions(format!("{setting} {range}: {name} {has}")))
    }
}

/// A warning about the scale of one kind of axis.
type OfKind = (Kind, LogWarning);

impl CodeOptions {
    /// Sets unit and scale of each kind of axis that has neither, if known. Returns warnings about assumed scales.
    ///
    /// # Errors
    /// Returns an error if the part states no scale or lacks the full scale, or if a full scale and a unit are given.
    pub fn apply(&self, axes: &mut ImuOptions) -> Result<Vec<OfKind>, InvalidOptions> {
        let names = axes.log.names;
        let mut assumed = Vec::new();
        for kind in Kind::ALL {
            let (of_kind, range) = match kind {
                Kind::Gyroscope => (&mut axes.gyro, self.gyro_range_dps),
                Kind::Accelerometer => (&mut axes.accel, self.accel_range_g),
            };
            if of_kind.unit.is_some() || of_kind.scale.is_some() {
                match range {
                    Some(_) => return Err(twice(kind, names)),
                    None => continue,
                }
            }
            let Some(scale) = self.scale(kind, range, names)? else { continue };
            scale.give(kind, range, of_kind);
            assumed.extend(self.assumed(kind, range, scale, names).map(|text| (kind, LogWarning::ScaleAssumed(text))));
        }
        match &self.part {
            Some(part) if part.gyro.is_empty() && part.accel.is_empty() => {
                let given = names.of(Setting::Part);
                Err(InvalidOptions(format!("{given}: {} states no scale of its codes", part.name)))
            }
            _ => Ok(assumed),
        }
    }

    fn scale(&self, kind: Kind, range: Option<f64>, names: Names) -> Result<Option<FullScale>, InvalidOptions> {
        match &self.part {
            Some(part) => part.at(kind, range, names),
            None => Ok(range.map(FullScale::of_16_bits)),
        }
    }

    /// Describes the assumption about the scale of a kind of axis; `None` if it was stated, or no other is known.
    fn assumed(&self, kind: Kind, range: Option<f64>, scale: FullScale, names: Names) -> Option<String> {
        let (setting, unit) = (names.of(range_setting(kind)), unit_name(kind));
        match (&self.part, range) {
            (Some(_), Some(_)) => None,
            (Some(part), None) => {
                let others = part.of(kind).iter().skip(1).filter_map(|one| Some(one.range?.to_string()));
                let others: Vec<String> = others.collect();
                let (name, range) = (&part.name, scale.range.filter(|_| !others.is_empty())?);
                Some(format!("{name}: ±{range} {unit}, as after power-up; else {setting} {}", others.join(", ")))
            }
            (None, range) => {
                let (range, per_unit) = (range?, scale.codes_per_unit);
                let others = others(kind, scale);
                let (first, more) = (others.first()?, others.len() - 1);
                let part = names.of(Setting::Part);
                let differ = format!("{first} and {more} more differ: give {part}");
                Some(format!("{setting} {range}: {per_unit:.1} codes per {unit}; {differ}"))
            }
        }
    }
}

/// The error for a unit or a scale that is given beside a full scale, which already states both.
fn twice(kind: Kind, names: Names) -> InvalidOptions {
    let (range, kind) = (names.of(range_setting(kind)), kind.name());
    InvalidOptions(format!("{range} states unit and scale of the {kind}; leave out the others"))
}

/// The catalogue parts that have another scale at this full scale.
fn others(kind: Kind, scale: FullScale) -> Vec<&'static str> {
    let differs = |one: &FullScale| {
        let is_near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.05;
        let is_range = one.range.zip(scale.range).is_some_and(|(one, range)| is_near(one, range));
        is_range && !is_near(one.codes_per_unit, scale.codes_per_unit)
    };
    let has = |text: &str| CodeScales::parse(text).is_ok_and(|part| part.of(kind).iter().any(differs));
    catalogue::FILES.iter().filter(|(_, text)| has(text)).map(|(name, _)| *name).collect()
}

/// True if a scale warning concerns these axes. Three accelerometers need none: gravity verifies their scale.
#[must_use]
pub fn concerns(kind: Kind, axes: &[Column]) -> bool {
    let count = axes.iter().filter(|axis| axis.quantity == Some(kind.quantity())).count();
    count > 0 && (kind == Kind::Gyroscope || count != 3)
}

impl FullScale {
    fn of_16_bits(range: f64) -> Self {
        Self { range: Some(range), codes_per_unit: 32768.0 / range, width_bits: 16 }
    }

    fn give(self, kind: Kind, range: Option<f64>, of_kind: &mut KindOptions) {
        let setting = if range.is_some() { range_setting(kind) } else { Setting::Part };
        of_kind.unit = Some(if kind == Kind::Gyroscope { Unit::Dps } else { Unit::G });
        of_kind.scale = Some(1.0 / self.codes_per_unit);
        of_kind.codes = Some(Codes { setting, width_bits: self.width_bits });
    }
}

fn range_setting(kind: Kind) -> Setting {
    match kind {
        Kind::Gyroscope => Setting::GyroRange,
        Kind::Accelerometer => Setting::AccelRange,
    }
}

fn unit_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Gyroscope => "°/s",
        Kind::Accelerometer => "g",
    }
}

/// The fields of a part file that state the scales of its codes.
#[derive(Deserialize)]
struct File {
    name: String,
    rate: Option<Sensitivity>,
    accelerometer: Option<Sensitivity>,
    #[serde(default)]
    axis: Vec<Axis>,
}

#[derive(Deserialize)]
struct Axis {
    /// The scale of this axis, if it differs from the part's common scale.
    rate: Option<Sensitivity>,
}

/// The full scales that a part file states for its gyroscope or its accelerometer.
#[derive(Deserialize)]
struct Sensitivity {
    #[serde(alias = "lsb_per_dps", alias = "lsb_per_g")]
    codes_per_unit: Option<Number>,
    #[serde(default)]
    zero_code: i64,
    width_bits: Option<u8>,
    #[serde(alias = "range_dps", alias = "range_g")]
    range: Option<Number>,
    #[serde(default)]
    full_scales: Vec<OtherScale>,
}

#[derive(Deserialize)]
struct OtherScale {
    #[serde(alias = "range_dps", alias = "range_g")]
    range: Number,
    #[serde(alias = "lsb_per_dps", alias = "lsb_per_g")]
    codes_per_unit: Number,
}

/// A number, alone or in a table with its source.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Number {
    Value(f64),
    Known { value: f64 },
}

impl Number {
    fn value(self) -> f64 {
        match self {
            Self::Value(value) | Self::Known { value } => value,
        }
    }
}

impl Sensitivity {
    /// The full scales. The first applies after power-up. Empty if the file states no scale, or for codes whose zero
    /// is not 0, such as offset binary.
    fn full_scales(self) -> Vec<FullScale> {
        let width_bits = self.width_bits.unwrap_or(16);
        let of = |range: Option<Number>, per_unit: Number| FullScale {
            range: range.map(Number::value),
            codes_per_unit: per_unit.value(),
            width_bits,
        };
        let first = self.codes_per_unit.filter(|_| self.zero_code == 0).map(|per_unit| of(self.range, per_unit));
        let others = self.full_scales.iter().map(|other| of(Some(other.range), other.codes_per_unit));
        let is_usable = |one: &FullScale| one.codes_per_unit > 0.0 && one.codes_per_unit.is_finite();
        first.map_or_else(Vec::new, |first| std::iter::once(first).chain(others).filter(is_usable).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn applied(part: Option<&str>, ranges: [Option<f64>; 2]) -> Result<(ImuOptions, Vec<String>), String> {
        let scales = |name| CodeScales::parse(catalogue::find(name).unwrap()).unwrap();
        let codes = CodeOptions { part: part.map(scales), gyro_range_dps: ranges[0], accel_range_g: ranges[1] };
        let mut axes = ImuOptions::default();
        let said = codes.apply(&mut axes).map_err(|error| error.to_string())?;
        Ok((axes, said.iter().map(|(_, said)| said.to_string()).collect()))
    }

    #[test]
    fn a_part_and_its_full_scales_give_the_codes_per_unit() {
        for (part, ranges, per_dps, per_g) in [
            ("mpu6050", [None, None], 131.0, 16_384.0),
            ("mpu6050", [Some(500.0), Some(4.0)], 65.5, 8192.0),
            ("LSM6DS3", [Some(245.0), Some(16.0)], 114.285_714, 2_049.180_33),
            ("bmi088", [None, Some(3.0)], 16.384, 10_920.0),
            ("icm42688p", [Some(15.625), None], 2097.2, 2048.0),
        ] {
            let (axes, _) = applied(Some(part), ranges).unwrap();
            assert_eq!((axes.gyro.unit, axes.accel.unit), (Some(Unit::Dps), Some(Unit::G)));
            let scales = [axes.gyro.scale.unwrap() * per_dps, axes.accel.scale.unwrap() * per_g];
            assert!(scales.iter().all(|one| (one - 1.0).abs() < 1e-9), "{part}: {scales:?}");
        }
        let (axes, _) = applied(None, [Some(500.0), None]).unwrap();
        assert_eq!((axes.gyro.scale, axes.accel.unit), (Some(500.0 / 32768.0), None));
    }

    #[test]
    fn a_part_without_this_full_scale_is_an_error() {
        for (part, ranges, why) in [
            ("mpu6050", [Some(300.0), None], "gyro_range 300: MPU-6050 has a gyroscope with the full scales 250, 500"),
            ("l3gd20h", [None, Some(2.0)], "accel_range 2: L3GD20H states no full scale of the codes of its accel"),
            ("vn100", [None, None], "VN-100 states no scale of its codes"),
            ("adis16130", [None, None], "ADIS16130 states no scale of its codes"),
        ] {
            let said = applied(Some(part), ranges).map(drop).unwrap_err();
            assert!(said.contains(why), "{said}");
        }
        let mut axes =
            ImuOptions { gyro: KindOptions { unit: Some(Unit::Dps), ..Default::default() }, ..Default::default() };
        let codes = CodeOptions { gyro_range_dps: Some(250.0), ..CodeOptions::default() };
        assert!(codes.apply(&mut axes).unwrap_err().to_string().contains("states unit and scale of the gyroscope"));
    }

    #[test]
    fn a_full_scale_that_may_be_another_is_said() {
        let said = |part, ranges| applied(part, ranges).unwrap().1;
        let of_part = said(Some("mpu6050"), [None, Some(2.0)]);
        assert_eq!(of_part, ["MPU-6050: ±250 °/s, as after power-up; else gyro_range 500, 1000, 2000"]);
        assert_eq!(said(Some("mpu6050"), [Some(250.0), Some(2.0)]), [""; 0]);
        assert_eq!(said(Some("adis16470"), [None, None]), [""; 0]);
        let of_range = said(None, [Some(250.0), None]);
        assert!(of_range[0].contains("gyro_range 250: 131.1 codes per °/s; ") && of_range.len() == 1, "{of_range:?}");
        assert_eq!(said(None, [Some(90.0), None]).len(), 0);
    }
}
