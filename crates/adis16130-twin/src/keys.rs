//! The text form of a specification, such as `seed=7,bias_dps=0.8`. The parser and the help share a table of keys.

use crate::fault::Fault;
use crate::spec::{Motion, Profile, RdyOutput, Roa, Spec};
use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::str::FromStr;

/// One key of the text form.
#[derive(Debug)]
pub struct Key {
    /// The name of the key in the text.
    pub name: &'static str,
    /// The default value, or the distribution from which the seed draws it.
    pub default: &'static str,
    /// The meaning of the key, in a few words.
    pub help: &'static str,
    kind: Kind,
}

/// A word that a key accepts, and its effect.
type Choice = (&'static str, fn(&mut Spec));

#[derive(Debug)]
enum Kind {
    Seed,
    Number { min: f64, max: f64, field: fn(&mut Spec) -> &mut f64 },
    Choice(&'static [Choice]),
}

const fn number(
    name: &'static str,
    (min, max): (f64, f64),
    default: &'static str,
    help: &'static str,
    field: fn(&mut Spec) -> &mut f64,
) -> Key {
    Key { name, default, help, kind: Kind::Number { min, max, field } }
}

const fn choice(name: &'static str, choices: &'static [Choice], default: &'static str, help: &'static str) -> Key {
    Key { name, default, help, kind: Kind::Choice(choices) }
}

/// Every key, in the order in which help lists them.
pub const KEYS: &[Key] = &[
    Key {
        name: "seed",
        default: "1",
        help: "draws the unit and everything random; the same seed gives the same bytes on every machine",
        kind: Kind::Seed,
    },
    number("bias_dps", (-250.0, 250.0), "drawn: 0 ± 1", "initial bias at 25 °C, °/s", |s| &mut s.bias_dps),
    number(
        "tempco_dps_per_c",
        (-10.0, 10.0),
        "drawn: 0.04 ± 0.01",
        "temperature coefficient of the bias at 25 °C, °/s/°C (BTC is its negative)",
        |s| &mut s.tempco_dps_per_c,
    ),
    number(
        "curvature",
        (-1.0, 1.0),
        "drawn: 0 ± 0.0005",
        "quadratic coefficient of the bias over T − 25 °C, °/s/°C²",
        |s| &mut s.curvature_dps_per_c2,
    ),
    number("hysteresis", (0.0, 10.0), "0.002", "half width of the bias loop over temperature, °/s", |s| {
        &mut s.hysteresis_dps
    }),
    number("lag_s", (0.0, 1e5), "0", "time by which the sensing element's temperature lags the sensor's, s", |s| {
        &mut s.lag_s
    }),
    number("ambient_c", (-60.0, 150.0), "25", "ambient temperature (at the start of a ramp), °C", |s| {
        &mut s.ambient_c
    }),
    choice(
        "profile",
        &[
            ("constant", |s| s.profile = Profile::Constant),
            ("ramp", |s| s.profile = Profile::Ramp),
            ("oven", |s| s.profile = Profile::Oven),
        ],
        "constant",
        "ambient over time: constant, ramp (+1 °C/min up to 85 °C) or oven (25, −40, +85, 25 °C in 175 min)",
    ),
    number("warmup_c", (-50.0, 100.0), "drawn: 8 ± 1", "self-heating in balance, °C", |s| &mut s.warmup_c),
    number(
        "warmup_s",
        (0.1, 1e6),
        "600",
        "slow time constant of the self-heating, s (the fast one is 0.15 of it)",
        |s| &mut s.warmup_s,
    ),
    number("mclk_hz", (1e3, 1e7), "drawn: 6000000 ± 1 %", "master clock, Hz", |s| &mut s.mclk_hz),
    choice(
        "rdy",
        &[
            ("level", |s| s.rdy = RdyOutput::Level),
            ("pulse", |s| s.rdy = RdyOutput::Pulse),
            ("inverted", |s| s.rdy = RdyOutput::Inverted),
        ],
        "level",
        "data ready: level (low while data waits), pulse (low for 26 µs before it) or inverted (behind an inverter)",
    ),
    choice(
        "roa",
        &[("none", |s| s.roa = Roa::Open), ("10nf", |s| s.roa = Roa::TenNanofarad)],
        "none",
        "capacitor across ROA1 and ROA2 (10nf: 50 Hz bandwidth)",
    ),
    number("supply_step_mv", (-5000.0, 5000.0), "0", "supply step at fault_at_s (60 unless given), mV", |s| {
        &mut s.supply_step_mv
    }),
    choice(
        "noise",
        &[("0", |s| s.noise = false), ("1", |s| s.noise = true)],
        "1",
        "0: deterministic bias and quantisation only",
    ),
    number("flicker_hz", (1e-7, 10.0), "0.0001", "the flicker is flat below this frequency, Hz", |s| {
        &mut s.flicker_hz
    }),
    number("rotation_dps", (-1000.0, 1000.0), "0", "constant rotation, °/s (motion, not bias)", |s| {
        &mut s.rotation_dps
    }),
    choice(
        "motion",
        &[
            ("none", |s| s.motion = Motion::None),
            ("sway", |s| s.motion = Motion::Sway),
            ("bump", |s| s.motion = Motion::Bump),
        ],
        "none",
        "motion of the platform (bump: 3 °/s for 0.2 s at fault_at_s, 60 unless given, and every 60 s after)",
    ),
    number("sway_dps", (0.0, 1000.0), "0.5", "peak of the sway, °/s", |s| &mut s.sway_dps),
    number("sway_hz", (0.0, 50.0), "0.2", "frequency of the sway, Hz", |s| &mut s.sway_hz),
    number(
        "bit_error_rate",
        (0.0, 0.5),
        "0; 1e-6 with fault=bit_errors",
        "probability that a bit flips on the wires",
        |s| &mut s.bit_error_rate,
    ),
    choice(
        "fault",
        &[
            ("none", |s| s.fault = Fault::None),
            ("sdo_low", |s| s.fault = Fault::SdoLow),
            ("sdo_high", |s| s.fault = Fault::SdoHigh),
            ("frozen", |s| s.fault = Fault::Frozen),
            ("rdy_lost", |s| s.fault = Fault::RdyLost),
            ("rdy_stutter", |s| s.fault = Fault::RdyStutter),
            ("bit_errors", |s| s.fault = Fault::BitErrors),
            ("brownout", |s| s.fault = Fault::Brownout),
            ("unplug", |s| s.fault = Fault::Unplug),
        ],
        "none",
        "what breaks at fault_at_s",
    ),
    number("fault_at_s", (0.0, 1e7), "0; 60 for supply step and bump", "when it breaks, s from the start", |s| {
        s.fault_at_s.insert(0.0)
    }),
];

/// The reason why a text is not a valid specification.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SpecError {
    /// The key does not exist.
    UnknownKey {
        /// The key as written.
        key: String,
        /// The known key that is most like `key`. `None` if no key is similar.
        nearest: Option<&'static str>,
    },
    /// An item has no `=`.
    NoValue {
        /// The item as written.
        item: String,
    },
    /// The value is not valid for the key.
    BadValue {
        /// The key that has the value.
        key: &'static str,
        /// The value as written.
        value: String,
        /// The valid values, in words.
        allowed: String,
    },
    /// A key was given twice.
    Repeated {
        /// The key that was given twice.
        key: &'static str,
    },
}

impl fmt::Display for SpecError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownKey { key, nearest: Some(nearest) } => {
                write!(f, "unknown key `{key}`; did you mean `{nearest}`?")
            }
            Self::UnknownKey { key, nearest: None } => {
                write!(f, "unknown key `{key}`; known keys:")?;
                KEYS.iter().try_for_each(|key| write!(f, " {}", key.name))
            }
            Self::NoValue { item } => write!(f, "`{item}` is not key=value"),
            Self::BadValue { key, value, allowed } => {
                write!(f, "{key}={value}: {key} takes {allowed}")?;
                if value.contains([';', '&']) { write!(f, ", and a comma goes before the next key") } else { Ok(()) }
            }
            Self::Repeated { key } => write!(f, "{key} is given twice"),
        }
    }
}

impl core::error::Error for SpecError {}

impl Spec {
    /// Reads comma-separated `key=value` items. `seed` draws the unit before the other keys apply, wherever it stands.
    /// An empty text gives the default unit.
    pub fn parse_keys(text: &str) -> Result<Self, SpecError> {
        let items = items(text)?;
        let seed = items.iter().find(|(key, _)| matches!(key.kind, Kind::Seed));
        let seed = seed.map_or(Ok(1), |(key, value)| value.parse().map_err(|_| key.bad(value)))?;
        let mut spec = Self::from_seed(seed);
        for (key, value) in items {
            key.apply(&mut spec, value)?;
        }
        Ok(spec)
    }
}

impl FromStr for Spec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        Self::parse_keys(text)
    }
}

fn items(text: &str) -> Result<Vec<(&'static Key, &str)>, SpecError> {
    let mut items: Vec<(&'static Key, &str)> = Vec::new();
    if text.trim().is_empty() {
        return Ok(items);
    }
    for item in text.split(',') {
        let (name, value) = item.split_once('=').ok_or_else(|| SpecError::NoValue { item: item.trim().to_owned() })?;
        let key = Key::named(name.trim())?;
        if items.iter().any(|(known, _)| known.name == key.name) {
            return Err(SpecError::Repeated { key: key.name });
        }
        items.push((key, value.trim()));
    }
    Ok(items)
}

impl Key {
    fn named(name: &str) -> Result<&'static Self, SpecError> {
        KEYS.iter()
            .find(|key| key.name == name)
            .ok_or_else(|| SpecError::UnknownKey { key: name.to_owned(), nearest: nearest(name) })
    }

    /// The values that the key takes, in words.
    pub fn allowed(&self) -> String {
        match self.kind {
            Kind::Seed => "a whole number from 0 to 2^64 - 1".to_owned(),
            Kind::Number { min, max, .. } => format!("a number from {min} to {max}"),
            Kind::Choice(choices) => {
                let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
                names.join("|")
            }
        }
    }

    fn apply(&self, spec: &mut Spec, value: &str) -> Result<(), SpecError> {
        match self.kind {
            Kind::Seed => {}
            Kind::Number { min, max, field } => {
                let number: f64 = value.parse().map_err(|_| self.bad(value))?;
                if !(min..=max).contains(&number) {
                    return Err(self.bad(value));
                }
                *field(spec) = number;
            }
            Kind::Choice(choices) => {
                let chosen = choices.iter().find(|(name, _)| *name == value);
                let (_, set) = chosen.ok_or_else(|| self.bad(value))?;
                set(spec);
            }
        }
        Ok(())
    }

    fn bad(&self, value: &str) -> SpecError {
        SpecError::BadValue { key: self.name, value: value.to_owned(), allowed: self.allowed() }
    }
}

/// Returns the known key with the smallest edit distance, or `None` if that is more than half of the length of `name`.
/// A key that begins with `name` has the distance 0.
fn nearest(name: &str) -> Option<&'static str> {
    let distance = |key: &Key| {
        let edits = edit_distance(name.as_bytes(), key.name.as_bytes());
        if key.name.starts_with(name) { 0 } else { edits }
    };
    let best = KEYS.iter().min_by_key(|key| distance(key))?;
    (2 * distance(best) <= name.len()).then_some(best.name)
}

fn edit_distance(from: &[u8], to: &[u8]) -> usize {
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, b) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[to.len()]
}
