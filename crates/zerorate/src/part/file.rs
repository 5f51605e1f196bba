//! A [`Part`] from a file (`docs/formats/part.md`).

use super::{Axis, MAX_AXES, NamedAxis, NoiseSources, Part, Scale, SelfHeating, Tone, TypicalBias, TypicalNoise};
use alloc::borrow::Cow;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use serde::Deserialize;
use zerorate_allan::toml_error::syntax;

/// Version of the file form, and the newest that is read.
const SCHEMA: u32 = 1;

impl Part {
    /// Reads the file of a part.
    ///
    /// ```
    /// let part = zerorate::Part::parse(r#"
    ///     schema = 1
    ///     name = "ADIS16405"
    ///     axis = [{ name = "x" }, { name = "y" }, { name = "z" }]
    ///     rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16, range_dps = 300 }
    ///     temperature = { lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12 }
    /// "#)?;
    /// assert_eq!((part.axes.len(), part.axes[0].axis.rate.value(20)), (3, 1.0));
    /// # Ok::<(), zerorate::PartError>(())
    /// ```
    ///
    /// # Errors
    /// No such file: where, and what is wrong.
    pub fn parse(text: &str) -> Result<Self, PartError> {
        let file: File = toml::from_str(text).map_err(|error| PartError::new(syntax(text, &error)))?;
        if file.schema != SCHEMA {
            return Err(PartError::new(format_args!(
                "schema {} is unknown; this software reads {SCHEMA}",
                file.schema
            )));
        }
        if file.axis.is_empty() {
            return Err(PartError::new("it has no [[axis]]; give each axis a name"));
        }
        if file.axis.len() > MAX_AXES {
            return Err(PartError::new(format_args!("it has {} axes; {MAX_AXES} is the most", file.axis.len())));
        }
        let axes: Vec<NamedAxis> = file.axis.iter().map(|entry| file.named(entry)).collect::<Result<_, _>>()?;
        for (k, one) in axes.iter().enumerate() {
            if axes[..k].iter().any(|other| other.name == one.name) {
                return Err(PartError::new(format_args!("two axes are called {:?}", one.name)));
            }
        }
        let temp_column = file.temperature.column.clone().map(Cow::Owned);
        let operating_c = file.temperature.operating_c()?;
        let name = Cow::Owned(word("name", &file.name)?);
        Ok(Self { name, axes: Cow::Owned(axes), temp_column, operating_c })
    }
}

/// What is wrong with the file of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartError(String);

impl PartError {
    fn new(what: impl fmt::Display) -> Self {
        Self(alloc::format!("{what}"))
    }
}

impl fmt::Display for PartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not the file of a part (docs/formats/part.md): {}", self.0.trim_end())
    }
}

impl core::error::Error for PartError {}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    schema: u32,
    name: String,
    rate: Rate,
    temperature: Temperature,
    noise: Option<Noise>,
    bias: Option<Bias>,
    self_heating: Option<Heating>,
    resonance: Option<Resonance>,
    axis: Vec<AxisEntry>,
}

/// What differs from the rest of the part.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisEntry {
    name: String,
    column: Option<String>,
    rate: Option<Rate>,
    noise: Option<Noise>,
    bias: Option<Bias>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rate {
    lsb_per_dps: Entry,
    zero_code: i64,
    width_bits: u8,
    signed: Option<bool>,
    range_dps: Option<Entry>,
    bandwidth_hz: Option<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Temperature {
    lsb_per_c: Entry,
    zero_code: i64,
    zero_c: f64,
    width_bits: u8,
    signed: Option<bool>,
    noise_c: Option<Entry>,
    column: Option<String>,
    operating_c: Option<[f64; 2]>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Noise {
    white_dps_per_rt_hz: Entry,
    flicker_floor_dps: Entry,
    rate_random_walk_dps_per_rt_s: Entry,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bias {
    initial_dps: Option<Entry>,
    tempco_dps_per_c: Option<Entry>,
    curvature_dps_per_c2: Option<Entry>,
    hysteresis_dps: Option<Entry>,
    supply_dps_per_mv: Option<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Heating {
    fast_c: Entry,
    fast_s: Entry,
    slow_c: Entry,
    slow_s: Entry,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Resonance {
    hz: Entry,
    rms_dps: Entry,
}

/// A number, alone or with its standard uncertainty over units and where it comes from.
#[derive(Clone, Deserialize)]
#[serde(untagged)]
enum Entry {
    Value(f64),
    Known(Known),
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Known {
    value: f64,
    #[serde(default)]
    u: f64,
    source: Option<String>,
}

impl Entry {
    fn value(&self) -> f64 {
        match self {
            Self::Value(value) => *value,
            Self::Known(known) => known.value,
        }
    }

    fn source(&self) -> Option<Cow<'static, str>> {
        match self {
            Self::Value(_) => None,
            Self::Known(known) => known.source.clone().map(Cow::Owned),
        }
    }

    fn u(&self) -> f64 {
        match self {
            Self::Value(_) => 0.0,
            Self::Known(known) => known.u,
        }
    }

    /// Its value, if it is above zero.
    fn positive(&self, key: &str) -> Result<f64, PartError> {
        match self.value() {
            value if value > 0.0 && value.is_finite() => Ok(value),
            value => Err(PartError::new(format_args!("{key} is {value}; it must be above zero"))),
        }
    }

    /// Its value and its uncertainty, if both are numbers and the latter is not negative.
    fn number(&self, key: &str) -> Result<(f64, f64), PartError> {
        let (value, u) = (self.value(), self.u());
        if value.is_finite() && u >= 0.0 && u.is_finite() {
            Ok((value, u))
        } else {
            Err(PartError::new(format_args!(
                "{key} is {value} with u = {u}; both must be numbers, and u not negative"
            )))
        }
    }
}

impl File {
    fn named(&self, entry: &AxisEntry) -> Result<NamedAxis, PartError> {
        let rate = entry.rate.as_ref().unwrap_or(&self.rate);
        let noise = entry.noise.as_ref().or(self.noise.as_ref());
        let bias = entry.bias.as_ref().or(self.bias.as_ref());
        let sources = noise.map(Noise::sources).unwrap_or_default();
        let axis = Axis {
            rate: rate.scale()?,
            temp: self.temperature.scale()?,
            temp_noise_c: positive(&self.temperature.noise_c, "noise_c")?,
            range_dps: positive(&rate.range_dps, "range_dps")?,
            bandwidth_hz: positive(&rate.bandwidth_hz, "bandwidth_hz")?,
            noise: noise.map(Noise::typical).transpose()?,
            bias: bias.map(Bias::typical).transpose()?.unwrap_or_default(),
            self_heating: self.self_heating.as_ref().map(Heating::typical).transpose()?,
            resonance: self.resonance.as_ref().map(Resonance::tone).transpose()?,
            alternates: false,
        };
        let column = entry.column.clone().map(Cow::Owned);
        Ok(NamedAxis { name: Cow::Owned(word("an axis", &entry.name)?), column, axis, sources })
    }
}

impl Rate {
    fn scale(&self) -> Result<Scale, PartError> {
        let &Self { zero_code, width_bits, signed, .. } = self;
        let lsb_per_unit = self.lsb_per_dps.positive("lsb_per_dps")?;
        Scale::checked(lsb_per_unit, 0.0, zero_code, width_bits, signed).map_err(PartError::new)
    }
}

impl Temperature {
    fn scale(&self) -> Result<Scale, PartError> {
        let &Self { zero_code, zero_c, width_bits, signed, .. } = self;
        let lsb_per_unit = self.lsb_per_c.positive("lsb_per_c")?;
        Scale::checked(lsb_per_unit, zero_c, zero_code, width_bits, signed).map_err(PartError::new)
    }

    fn operating_c(&self) -> Result<Option<(f64, f64)>, PartError> {
        match self.operating_c {
            Some([low_c, high_c]) if !(ABSOLUTE_ZERO_C <= low_c && low_c < high_c && high_c <= HOTTEST_C) => {
                Err(PartError::new(format_args!(
                    "operating_c is [{low_c}, {high_c}]; give the coldest and the warmest temperature in °C, the \
                     colder first"
                )))
            }
            limits => Ok(limits.map(|[low_c, high_c]| (low_c, high_c))),
        }
    }
}

/// No part operates beyond these, °C.
const ABSOLUTE_ZERO_C: f64 = -273.15;
const HOTTEST_C: f64 = 1000.0;

fn positive(entry: &Option<Entry>, key: &str) -> Result<Option<f64>, PartError> {
    entry.as_ref().map(|entry| entry.positive(key)).transpose()
}

impl Noise {
    fn sources(&self) -> NoiseSources {
        NoiseSources {
            flicker: self.flicker_floor_dps.source(),
            rate_random_walk: self.rate_random_walk_dps_per_rt_s.source(),
        }
    }

    fn typical(&self) -> Result<TypicalNoise, PartError> {
        let not_negative = |entry: &Entry, key| match entry.number(key)?.0 {
            value if value >= 0.0 => Ok(value),
            value => Err(PartError::new(format_args!("{key} is {value}; it must not be negative"))),
        };
        Ok(TypicalNoise {
            white_dps_per_rt_hz: self.white_dps_per_rt_hz.positive("white_dps_per_rt_hz")?,
            flicker_floor_dps: not_negative(&self.flicker_floor_dps, "flicker_floor_dps")?,
            rate_random_walk_dps_per_rt_s: not_negative(
                &self.rate_random_walk_dps_per_rt_s,
                "rate_random_walk_dps_per_rt_s",
            )?,
        })
    }
}

impl Bias {
    /// The initial bias and the curvature are zero on average: what is typical is how they spread.
    fn typical(&self) -> Result<TypicalBias, PartError> {
        let number = |entry: &Option<Entry>, key| entry.as_ref().map(|entry| entry.number(key)).transpose();
        let spread =
            |entry: &Option<Entry>, key| number(entry, key).map(|known| known.map(|(value, u)| libm::hypot(value, u)));
        let tempco = number(&self.tempco_dps_per_c, "tempco_dps_per_c")?;
        Ok(TypicalBias {
            initial_dps: spread(&self.initial_dps, "initial_dps")?,
            tempco_dps_per_c: tempco.map(|(value, _)| value),
            tempco_spread_dps_per_c: tempco.map(|(_, u)| u),
            curvature_dps_per_c2: spread(&self.curvature_dps_per_c2, "curvature_dps_per_c2")?,
            hysteresis_dps: spread(&self.hysteresis_dps, "hysteresis_dps")?,
            supply_dps_per_mv: self.supply_dps_per_mv.as_ref().map(|e| e.positive("supply_dps_per_mv")).transpose()?,
        })
    }
}

impl Heating {
    fn typical(&self) -> Result<SelfHeating, PartError> {
        Ok(SelfHeating {
            fast_c: self.fast_c.positive("self_heating.fast_c")?,
            fast_s: self.fast_s.positive("self_heating.fast_s")?,
            slow_c: self.slow_c.positive("self_heating.slow_c")?,
            slow_s: self.slow_s.positive("self_heating.slow_s")?,
        })
    }
}

impl Resonance {
    fn tone(&self) -> Result<Tone, PartError> {
        let (hz, tolerance_hz) = self.hz.number("resonance.hz")?;
        Ok(Tone { hz, tolerance_hz, rms_dps: self.rms_dps.positive("resonance.rms_dps")? })
    }
}

impl Scale {
    /// A scale out of a file, if codes can have it.
    pub(crate) fn checked(
        lsb_per_unit: f64,
        zero_value: f64,
        zero_code: i64,
        width_bits: u8,
        signed: Option<bool>,
    ) -> Result<Self, String> {
        let signed = signed.unwrap_or(zero_code <= 0);
        if !(lsb_per_unit > 0.0 && lsb_per_unit.is_finite() && zero_value.is_finite()) {
            return Err(format!("{lsb_per_unit} codes per unit around {zero_value} are no scale"));
        }
        if !(1..=32).contains(&width_bits) {
            return Err(format!("width_bits is {width_bits}; it must be 1 to 32"));
        }
        if zero_code.unsigned_abs() > 1 << 32 {
            return Err(format!("zero_code is {zero_code}; no code of 32 bits is so large"));
        }
        Ok(Self { lsb_per_unit, zero_code, zero_value, width_bits, signed })
    }
}

/// A name that can stand in a file name and in a column of a table.
fn word(what: &str, name: &str) -> Result<String, PartError> {
    if !is_word(name) {
        return Err(PartError::new(format_args!(
            "{what} is called {name:?}; use up to 40 letters, digits, -, _ and ."
        )));
    }
    Ok(String::from(name))
}

/// Up to 40 letters, digits, `-`, `_` and `.`.
pub(crate) fn is_word(name: &str) -> bool {
    let good = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    !name.is_empty() && name.len() <= 40 && name.chars().all(good)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    const ADIS16130: &str = r#"
        schema = 1
        name = "ADIS16130"
        axis = [{ name = "rate" }]
        [rate]
        lsb_per_dps = 23488
        zero_code = 8388608
        width_bits = 24
        range_dps = 250
        bandwidth_hz = { value = 300, u = 10, source = "AN-1042" }
        [temperature]
        lsb_per_c = 14093
        zero_code = 8388608
        zero_c = 25
        width_bits = 24
        noise_c = 0.05
        operating_c = [-40, 85]
        [noise]
        white_dps_per_rt_hz = 0.0125
        flicker_floor_dps = { value = 0.0016, source = "M-04" }
        rate_random_walk_dps_per_rt_s = { value = 1e-4, source = "M-04" }
        [bias]
        initial_dps = { value = 0, u = 1 }
        tempco_dps_per_c = { value = 0.04, u = 0.01 }
        curvature_dps_per_c2 = { value = 0, u = 0.0005 }
        hysteresis_dps = 0.002
        supply_dps_per_mv = 0.0002
        [self_heating]
        fast_c = 3.2
        fast_s = 90
        slow_c = 4.8
        slow_s = 600
        [resonance]
        hz = { value = 14300, u = 50 }
        rms_dps = 0.02
    "#;

    #[test]
    fn the_built_in_part_can_be_written_as_a_file() {
        let part = Part::parse(ADIS16130).unwrap();
        let NamedAxis { axis, sources, .. } = &part.axes[0];
        assert_eq!(*axis, Axis { alternates: false, ..Axis::ADIS16130 });
        assert_eq!(*sources, Part::ADIS16130.axes[0].sources);
        assert_eq!(part.operating_c, Part::ADIS16130.operating_c);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (from, to, said) in [
            ("schema = 1", "schema = 2", "schema 2 is unknown"),
            ("name = \"ADIS16130\"", "name = \"a\\nb\"", "use up to 40 letters"),
            ("lsb_per_dps = 23488", "lsb_per_dps = 0", "lsb_per_dps is 0; it must be above zero"),
            ("[{ name = \"rate\" }]", "[]", "no [[axis]]"),
            ("[{ name = \"rate\" }]", "[{ name = \"x\" }, { name = \"x\" }]", "two axes are called \"x\""),
            ("range_dps = 250", "range_dsp = 250", "range_dsp"),
            ("u = 0.01", "u = -1", "u not negative"),
            ("width_bits = 24", "width_bits = 64", "width_bits is 64"),
            ("noise_c = 0.05", "noise_c = -1", "noise_c is -1; it must be above zero"),
            ("[-40, 85]", "[85, -40]", "operating_c is [85, -40]; give the coldest and the warmest"),
            ("[-40, 85]", "[nan, 85]", "operating_c is [NaN, 85]"),
        ] {
            let error = Part::parse(&ADIS16130.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains(said), "{to}: {error}");
        }
    }

    #[test]
    fn a_log_may_have_other_names() {
        let text = ADIS16130
            .replace("{ name = \"rate\" }", "{ name = \"rate\", column = \"gz [rad/s]\" }")
            .replace("zero_c = 25", "zero_c = 25\n        column = \"T\"");
        let part = Part::parse(&text).unwrap();
        assert_eq!((part.axes[0].column.as_deref(), part.temp_column.as_deref()), (Some("gz [rad/s]"), Some("T")));
    }

    #[test]
    fn an_axis_may_differ() {
        let text = ADIS16130.replace(
            "[{ name = \"rate\" }]",
            "[{ name = \"x\" }, { name = \"y\", rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16 } }]",
        );
        let part = Part::parse(&text).unwrap();
        let y = &part.axes[1].axis;
        assert_eq!((y.rate.lsb_per_unit, y.range_dps, y.noise.is_some()), (20.0, None, true));
    }
}
