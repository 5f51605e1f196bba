//! Reading of a [`Part`] from a file (`docs/formats/part.md`).

use super::{Axis, MAX_AXES, NamedAxis, NoiseSources, Part, Scale, SelfHeating, Tone, TypicalBias, TypicalNoise};
use alloc::borrow::Cow;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::ops::RangeInclusive;
use serde::Deserialize;
use zerorate_allan::entry::{Bounds, Document, Entry, EntryError, PART_KEYS};

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
    /// Returns an error with the place and the cause if the text does not describe a part.
    pub fn parse(text: &str) -> Result<Self, PartError> {
        Self::parse_at(text, None)
    }

    /// Reads the file of a part at the full scale `range_dps`, °/s. `None` takes the default full scale.
    ///
    /// # Errors
    /// Returns the errors of [`Part::parse`], or an error that lists the full scales if the file lacks this one.
    pub fn parse_at(text: &str, range_dps: Option<f64>) -> Result<Self, PartError> {
        let document = Document::parse(text)?;
        let (root, file) = (document.root(), document.fields::<File>()?);
        root.only(&PART_KEYS)?;
        root.at("schema").require(file.schema == SCHEMA, || {
            format!("schema {} is unknown; this software reads {SCHEMA}", file.schema)
        })?;
        let (list, count) = (root.at("axis"), file.axis.len());
        list.require(count > 0, || "it has no [[axis]]; give each axis a name".into())?;
        list.require(count <= MAX_AXES, || format!("it has {count} axes; give at most {MAX_AXES}"))?;
        let axes = (0..count).map(|index| file.named(root, index, range_dps));
        let axes = axes.collect::<Result<Vec<NamedAxis>, _>>()?;
        for (index, one) in axes.iter().enumerate() {
            let alone = axes[..index].iter().all(|other| other.name != one.name);
            list.item(index).at("name").require(alone, || format!("two axes are called {:?}", one.name))?;
        }
        let (temperature, at_temperature) = file.temperature(root)?;
        let temp_column = temperature.column.clone().map(Cow::Owned);
        let operating_c = temperature.operating_c(at_temperature)?;
        let name = Cow::Owned(word("name", root.at("name"), &file.name)?);
        Ok(Self { name, axes: Cow::Owned(axes), temp_column, operating_c })
    }
}

/// The error in the file of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartError(EntryError);

impl From<EntryError> for PartError {
    fn from(error: EntryError) -> Self {
        Self(error)
    }
}

impl fmt::Display for PartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not the file of a part (docs/formats/part.md): {}", self.0)
    }
}

impl core::error::Error for PartError {}

/// The fields of the file from which a [`Part`] is made.
#[derive(Deserialize)]
struct File {
    schema: u32,
    name: String,
    #[serde(default)]
    alternates: bool,
    rate: Rate,
    temperature: Option<Temperature>,
    noise: Option<Noise>,
    bias: Option<Bias>,
    self_heating: Option<Heating>,
    resonance: Option<Resonance>,
    axis: Vec<AxisForm>,
}

/// The tables of an axis, which replace the tables of the part.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisForm {
    name: String,
    column: Option<String>,
    rate: Option<Rate>,
    noise: Option<Noise>,
    bias: Option<Bias>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rate {
    lsb_per_dps: Option<Number>,
    zero_code: Option<i64>,
    width_bits: Option<u8>,
    signed: Option<bool>,
    range_dps: Option<Number>,
    #[serde(default)]
    full_scales: Vec<FullScale>,
    bandwidth_hz: Option<Number>,
}

/// A full scale other than the default one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FullScale {
    range_dps: Number,
    lsb_per_dps: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Temperature {
    lsb_per_c: Number,
    zero_code: i64,
    zero_c: Number,
    width_bits: u8,
    signed: Option<bool>,
    noise_c: Option<Number>,
    column: Option<String>,
    operating_c: Option<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Noise {
    white_dps_per_rt_hz: Number,
    flicker_floor_dps: Number,
    rate_random_walk_dps_per_rt_s: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bias {
    initial_dps: Option<Number>,
    tempco_dps_per_c: Option<Number>,
    curvature_dps_per_c2: Option<Number>,
    hysteresis_dps: Option<Number>,
    supply_dps_per_mv: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Heating {
    fast_c: Number,
    fast_s: Number,
    slow_c: Number,
    slow_s: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Resonance {
    hz: Number,
    rms_dps: Number,
}

/// A number, alone or with its standard uncertainty over units and its source.
#[derive(Deserialize)]
#[serde(from = "Written")]
struct Number {
    value: f64,
    u: f64,
    source: Option<String>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Written {
    Value(f64),
    Known(Known),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Known {
    value: f64,
    #[serde(default)]
    u: f64,
    source: Option<String>,
}

impl From<Written> for Number {
    fn from(written: Written) -> Self {
        match written {
            Written::Value(value) => Self { value, u: 0.0, source: None },
            Written::Known(Known { value, u, source }) => Self { value, u, source },
        }
    }
}

impl Number {
    fn positive(&self, entry: Entry<'_>) -> Result<f64, EntryError> {
        entry.number(self.value, &Bounds::Positive)
    }

    /// Returns the value and the uncertainty, if both are numbers and the latter is not negative.
    fn known(&self, entry: Entry<'_>) -> Result<(f64, f64), EntryError> {
        let &Self { value, u, .. } = self;
        entry.require(value.is_finite() && Bounds::NotNegative.hold(u), || {
            format!("{} is {value} with u = {u}; both must be numbers, and u not negative", entry.key())
        })?;
        Ok((value, u))
    }
}

impl File {
    fn temperature<'e>(&self, root: Entry<'e>) -> Result<(&Temperature, Entry<'e>), EntryError> {
        let at = root.at("temperature");
        let missing = || at.error("it has no [temperature]; a bias is calibrated over the sensor's own");
        Ok((self.temperature.as_ref().ok_or_else(missing)?, at))
    }

    fn named(&self, root: Entry<'_>, index: usize, range_dps: Option<f64>) -> Result<NamedAxis, EntryError> {
        let (form, own) = (&self.axis[index], root.at("axis").item(index));
        // a table of the axis replaces the whole table of the part
        let table = |key, is_own| if is_own { own.at(key) } else { root.at(key) };
        let (rate, at_rate) = (form.rate.as_ref().unwrap_or(&self.rate), table("rate", form.rate.is_some()));
        let (noise, at_noise) = (form.noise.as_ref().or(self.noise.as_ref()), table("noise", form.noise.is_some()));
        let (bias, at_bias) = (form.bias.as_ref().or(self.bias.as_ref()), table("bias", form.bias.is_some()));
        let (temperature, at_temperature) = self.temperature(root)?;
        let (rate_scale, range_dps) = rate.at(at_rate, range_dps)?;
        let axis = Axis {
            rate: rate_scale,
            temp: temperature.scale(at_temperature)?,
            temp_noise_c: positive(at_temperature.at("noise_c"), &temperature.noise_c)?,
            range_dps,
            bandwidth_hz: positive(at_rate.at("bandwidth_hz"), &rate.bandwidth_hz)?,
            noise: noise.map(|noise| noise.typical(at_noise)).transpose()?,
            bias: bias.map(|bias| bias.typical(at_bias)).transpose()?.unwrap_or_default(),
            self_heating: self.self_heating.as_ref().map(|it| it.typical(root.at("self_heating"))).transpose()?,
            resonance: self.resonance.as_ref().map(|it| it.tone(root.at("resonance"))).transpose()?,
            alternates: self.alternates,
        };
        let column = form.column.clone().map(Cow::Owned);
        let name = Cow::Owned(word("an axis", own.at("name"), &form.name)?);
        Ok(NamedAxis { name, column, axis, sources: noise.map(Noise::sources).unwrap_or_default() })
    }
}

impl Rate {
    /// Returns the scale and the range, °/s, for the given full scale or for the default one.
    fn at(&self, table: Entry<'_>, range_dps: Option<f64>) -> Result<(Scale, Option<f64>), EntryError> {
        let (Some(lsb_per_dps), Some(zero_code), Some(width_bits)) =
            (&self.lsb_per_dps, self.zero_code, self.width_bits)
        else {
            let needs = "lsb_per_dps, zero_code and width_bits";
            return Err(table.error(format!("[rate] lacks {needs}; a calibration is made of codes")));
        };
        let default_dps = positive(table.at("range_dps"), &self.range_dps)?;
        let (per_dps, range_dps) = match range_dps.filter(|dps| Some(*dps) != default_dps) {
            None => (lsb_per_dps.positive(table.at("lsb_per_dps"))?, default_dps),
            Some(dps) => (self.full_scale(table, dps)?, Some(dps)),
        };
        let scale = Scale::checked(per_dps, 0.0, zero_code, width_bits, self.signed);
        Ok((scale.map_err(|why| table.error(why))?, range_dps))
    }

    /// Returns the codes per °/s at a full scale.
    fn full_scale(&self, table: Entry<'_>, range_dps: f64) -> Result<f64, EntryError> {
        let entry = table.at("full_scales");
        let found = self.full_scales.iter().find(|full_scale| full_scale.range_dps.value == range_dps);
        let known = || {
            let ranges = self.range_dps.iter().chain(self.full_scales.iter().map(|full_scale| &full_scale.range_dps));
            ranges.map(|range| format!("{}", range.value)).collect::<Vec<_>>().join(", ")
        };
        let wrong = || entry.error(format!("it has no full scale of {range_dps} °/s; it has: {}", known()));
        found.ok_or_else(wrong)?.lsb_per_dps.positive(entry)
    }
}

impl Temperature {
    fn scale(&self, table: Entry<'_>) -> Result<Scale, EntryError> {
        let &Self { zero_code, width_bits, signed, .. } = self;
        let lsb_per_unit = self.lsb_per_c.positive(table.at("lsb_per_c"))?;
        let (zero_c, _) = self.zero_c.known(table.at("zero_c"))?;
        Scale::checked(lsb_per_unit, zero_c, zero_code, width_bits, signed).map_err(|why| table.error(why))
    }

    fn operating_c(&self, table: Entry<'_>) -> Result<Option<(f64, f64)>, EntryError> {
        let Some([low_c, high_c]) = self.operating_c else { return Ok(None) };
        let rises = ABSOLUTE_ZERO_C <= low_c && low_c < high_c && high_c <= HOTTEST_C;
        table.at("operating_c").require(rises, || {
            format!(
                "operating_c is [{low_c}, {high_c}]; give the coldest and the warmest temperature in °C, the colder \
                 first"
            )
        })?;
        Ok(Some((low_c, high_c)))
    }
}

/// Lowest and highest temperature that a part may state, °C.
const ABSOLUTE_ZERO_C: f64 = -273.15;
const HOTTEST_C: f64 = 1000.0;

fn positive(entry: Entry<'_>, number: &Option<Number>) -> Result<Option<f64>, EntryError> {
    number.as_ref().map(|number| number.positive(entry)).transpose()
}

impl Noise {
    fn sources(&self) -> NoiseSources {
        let source = |number: &Number| number.source.clone().map(Cow::Owned);
        NoiseSources {
            flicker: source(&self.flicker_floor_dps),
            rate_random_walk: source(&self.rate_random_walk_dps_per_rt_s),
        }
    }

    fn typical(&self, table: Entry<'_>) -> Result<TypicalNoise, EntryError> {
        let not_negative = |key, number: &Number| {
            let (value, _) = number.known(table.at(key))?;
            table.at(key).number(value, &Bounds::NotNegative)
        };
        Ok(TypicalNoise {
            white_dps_per_rt_hz: self.white_dps_per_rt_hz.positive(table.at("white_dps_per_rt_hz"))?,
            flicker_floor_dps: not_negative("flicker_floor_dps", &self.flicker_floor_dps)?,
            rate_random_walk_dps_per_rt_s: not_negative(
                "rate_random_walk_dps_per_rt_s",
                &self.rate_random_walk_dps_per_rt_s,
            )?,
        })
    }
}

impl Bias {
    /// Converts to a typical bias. Initial bias, curvature and hysteresis become √(value² + u²), their rms over units.
    fn typical(&self, table: Entry<'_>) -> Result<TypicalBias, EntryError> {
        let known = |key, number: &Option<Number>| number.as_ref().map(|it| it.known(table.at(key))).transpose();
        let spread = |key, number| known(key, number).map(|known| known.map(|(value, u)| libm::hypot(value, u)));
        let tempco = known("tempco_dps_per_c", &self.tempco_dps_per_c)?;
        Ok(TypicalBias {
            initial_dps: spread("initial_dps", &self.initial_dps)?,
            tempco_dps_per_c: tempco.map(|(value, _)| value),
            tempco_spread_dps_per_c: tempco.map(|(_, u)| u),
            curvature_dps_per_c2: spread("curvature_dps_per_c2", &self.curvature_dps_per_c2)?,
            hysteresis_dps: spread("hysteresis_dps", &self.hysteresis_dps)?,
            supply_dps_per_mv: positive(table.at("supply_dps_per_mv"), &self.supply_dps_per_mv)?,
        })
    }
}

impl Heating {
    fn typical(&self, table: Entry<'_>) -> Result<SelfHeating, EntryError> {
        Ok(SelfHeating {
            fast_c: self.fast_c.positive(table.at("fast_c"))?,
            fast_s: self.fast_s.positive(table.at("fast_s"))?,
            slow_c: self.slow_c.positive(table.at("slow_c"))?,
            slow_s: self.slow_s.positive(table.at("slow_s"))?,
        })
    }
}

impl Resonance {
    fn tone(&self, table: Entry<'_>) -> Result<Tone, EntryError> {
        let (hz, tolerance_hz) = self.hz.known(table.at("hz"))?;
        Ok(Tone { hz, tolerance_hz, rms_dps: self.rms_dps.positive(table.at("rms_dps"))? })
    }
}

impl Scale {
    pub(crate) fn checked(
        lsb_per_unit: f64,
        zero_value: f64,
        zero_code: i64,
        width_bits: u8,
        signed: Option<bool>,
    ) -> Result<Self, String> {
        let signed = signed.unwrap_or(zero_code <= 0);
        if !(lsb_per_unit > 0.0 && lsb_per_unit.is_finite() && zero_value.is_finite()) {
            return Err(format!("{lsb_per_unit} codes per unit around {zero_value} are not a scale"));
        }
        if !(1..=32).contains(&width_bits) {
            return Err(format!("width_bits is {width_bits}; it must be 1 to 32"));
        }
        if zero_code.unsigned_abs() > 1 << 32 {
            return Err(format!("zero_code is {zero_code}; no code of 32 bits is so large"));
        }
        Ok(Self { lsb_per_unit, zero_code, zero_value, width_bits, signed })
    }

    /// Returns the range of values that the codes express.
    pub(crate) fn values(&self) -> RangeInclusive<f64> {
        let (first, last) = self.codes();
        self.value(first - self.zero_code)..=self.value(last - self.zero_code)
    }
}

/// Checks that a name fits into a file name and a column of a table, and returns it.
fn word(what: &str, entry: Entry<'_>, name: &str) -> Result<String, EntryError> {
    entry.require(is_word(name), || format!("{what} is called {name:?}; use up to 40 letters, digits, -, _ and ."))?;
    Ok(String::from(name))
}

/// Whether a name has 1 to 40 letters, digits, `-`, `_` and `.`.
pub(crate) fn is_word(name: &str) -> bool {
    let good = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    !name.is_empty() && name.len() <= 40 && name.chars().all(good)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    const ADIS16130: &str = include_str!("../../../../parts/adis16130.toml");

    #[test]
    fn each_error_is_named() {
        for (from, to, said) in [
            ("schema = 1", "schema = 2", "schema 2 is unknown"),
            ("name = \"ADIS16130\"", "name = \"a\\nb\"", "use up to 40 letters"),
            ("lsb_per_dps = 23488", "lsb_per_dps = 0", "line 9: lsb_per_dps is 0; it must be above zero"),
            (
                "{ name = \"rate\" }",
                "{ name = \"z\", bias = { supply_dps_per_mv = 0 } }",
                "line 5, axis z: supply_dps_per_mv is 0",
            ),
            ("[{ name = \"rate\" }]", "[]", "no [[axis]]"),
            ("[{ name = \"rate\" }]", "[{ name = \"x\" }, { name = \"x\" }]", "two axes are called \"x\""),
            ("range_dps = 250", "range_dsp = 250", "range_dsp"),
            ("[bias]", "[bais]", "line 28: bais is unknown; use schema, name"),
            ("u = 0.01", "u = -1", "u not negative"),
            ("width_bits = 24", "width_bits = 64", "width_bits is 64"),
            ("noise_c = { value = 0.05", "noise_c = { value = -1", "noise_c is -1; it must be above zero"),
            ("[-40, 85]", "[85, -40]", "operating_c is [85, -40]; give the coldest and the warmest"),
            ("[-40, 85]", "[nan, 85]", "operating_c is [NaN, 85]"),
            ("lsb_per_dps = 23488", "", "[rate] lacks lsb_per_dps, zero_code and width_bits"),
        ] {
            let error = Part::parse(&ADIS16130.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains(said), "{to}: {error}");
        }
    }

    #[test]
    fn a_part_is_set_to_one_of_its_full_scales() {
        let text = ADIS16130
            .replace("range_dps = 250", "range_dps = 250\nfull_scales = [{ range_dps = 500, lsb_per_dps = 11744 }]");
        let at = |range_dps| Part::parse_at(&text, range_dps).map(|part| part.axes[0].axis);
        for (range_dps, expected) in
            [(None, (23_488.0, 250.0)), (Some(250.0), (23_488.0, 250.0)), (Some(500.0), (11_744.0, 500.0))]
        {
            let axis = at(range_dps).unwrap();
            assert_eq!((axis.rate.lsb_per_unit, axis.range_dps.unwrap()), expected);
        }
        let error = at(Some(2000.0)).unwrap_err().to_string();
        assert!(error.contains("no full scale of 2000 °/s; it has: 250, 500"), "{error}");
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
    fn an_axis_may_differ_from_the_part() {
        let text = ADIS16130.replace(
            "[{ name = \"rate\" }]",
            "[{ name = \"x\" }, { name = \"y\", rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16 } }]",
        );
        let part = Part::parse(&text).unwrap();
        let y = &part.axes[1].axis;
        assert_eq!((y.rate.lsb_per_unit, y.range_dps, y.noise.is_some()), (20.0, None, true));
    }
}
