//! A measurement that was interrupted, as a text: what its finished steps measured.

use super::record::{Record, Soak};
use crate::calibration::check::sha256_hex;
use crate::part::Part;
use crate::toml_error::syntax;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use serde::{Deserialize, Serialize};

/// Version of the text, and the only one that is read.
const SCHEMA: u32 = 1;

/// The finished steps of a measurement. `docs/chamber.md` says when it is written and read.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// What was measured.
    pub record: Record,
    /// So many steps of the plan.
    pub steps: usize,
    /// When the last of them ended, RFC 3339; none for a simulated part.
    pub ended: Option<String>,
}

/// Why a text does not go on with a measurement.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the text shows them")]
pub enum SavedError {
    /// It is not such a text.
    Syntax(String),
    /// Lists of different length, or numbers that are none.
    Damaged,
    /// It belongs to something else.
    Other { what: &'static str, saved: String, wanted: String },
}

impl fmt::Display for SavedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(what) => write!(f, "it is no interrupted measurement: {}", what.trim_end()),
            Self::Damaged => f.write_str("it is damaged: its lists do not belong together"),
            Self::Other { what, saved, wanted } => {
                write!(f, "it is of another {what}: {saved:?} there, {wanted:?} here")
            }
        }
    }
}

impl core::error::Error for SavedError {}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    schema: u32,
    plan_sha256: String,
    part: String,
    device: String,
    serial: String,
    steps: usize,
    ended: Option<String>,
    samples: u64,
    lost: u64,
    impossible: u64,
    start_s: Vec<f64>,
    temp_c: Vec<f64>,
    /// A digit for each second.
    at_rest: String,
    #[serde(default)]
    soak: Vec<Soak>,
    axis: Vec<AxisForm>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisForm {
    name: String,
    rate_dps: Vec<f64>,
}

/// What a measurement is of: it goes on with nothing else.
pub(super) struct Identity<'a> {
    plan_text: &'a str,
    part: &'a Part,
    device: &'a str,
    serial: &'a str,
}

impl Saved {
    /// As a text; `device` and `serial` are what was measured, `plan_text` the plan's file.
    #[must_use]
    pub fn to_toml(&self, plan_text: &str, part: &Part, device: &str, serial: &str) -> String {
        let Record { start_s, temp_c, rates_dps, at_rest, soaks, samples, lost, impossible } = self.record.clone();
        let name =
            |(axis, rate_dps): (&crate::NamedAxis, Vec<f64>)| AxisForm { name: axis.name.to_string(), rate_dps };
        let form = Form {
            schema: SCHEMA,
            plan_sha256: sha256_hex(plan_text),
            part: part.name.to_string(),
            device: device.to_string(),
            serial: serial.to_string(),
            steps: self.steps,
            ended: self.ended.clone(),
            samples,
            lost,
            impossible,
            start_s,
            temp_c,
            at_rest: at_rest.iter().map(|at_rest| if *at_rest { '1' } else { '0' }).collect(),
            soak: soaks,
            axis: part.axes.iter().zip(rates_dps).map(name).collect(),
        };
        // every field has a place in TOML
        let body = toml::to_string(&form).unwrap_or_default();
        format!(
            "# An interrupted measurement in a chamber: zerorate chamber goes on with it (docs/chamber.md).\n{body}"
        )
    }

    /// From such a text, if it is of the same measurement.
    ///
    /// # Errors
    /// Why not.
    pub fn parse(text: &str, plan_text: &str, part: &Part, device: &str, serial: &str) -> Result<Self, SavedError> {
        let form: Form = toml::from_str(text).map_err(|error| SavedError::Syntax(syntax(text, &error)))?;
        form.is_of(&Identity { plan_text, part, device, serial })?;
        let at_rest: Vec<bool> = form.at_rest.chars().map(|digit| digit == '1').collect();
        let len = form.start_s.len();
        let rates_dps: Vec<Vec<f64>> = form.axis.into_iter().map(|axis| axis.rate_dps).collect();
        let whole = form.temp_c.len() == len && at_rest.len() == len && rates_dps.iter().all(|one| one.len() == len);
        let rises = form.start_s.windows(2).all(|pair| pair[0] < pair[1]);
        let soaks_fit = form.soak.iter().all(|soak| soak.rates_dps.len() == rates_dps.len());
        let numbers = form.start_s.iter().chain(&form.temp_c).chain(rates_dps.iter().flatten());
        if !(whole && rises && soaks_fit && numbers.copied().all(f64::is_finite)) {
            return Err(SavedError::Damaged);
        }
        let record = Record {
            start_s: form.start_s,
            temp_c: form.temp_c,
            rates_dps,
            at_rest,
            soaks: form.soak,
            samples: form.samples,
            lost: form.lost,
            impossible: form.impossible,
        };
        Ok(Self { record, steps: form.steps, ended: form.ended })
    }
}

impl Form {
    fn is_of(&self, wanted: &Identity<'_>) -> Result<(), SavedError> {
        let axes = |names: &mut dyn Iterator<Item = &str>| names.collect::<Vec<_>>().join(", ");
        let pairs = [
            ("version", self.schema.to_string(), SCHEMA.to_string()),
            ("plan", self.plan_sha256.clone(), sha256_hex(wanted.plan_text)),
            ("part", self.part.clone(), wanted.part.name.to_string()),
            ("device", self.device.clone(), wanted.device.to_string()),
            ("serial number", self.serial.clone(), wanted.serial.to_string()),
            (
                "set of axes",
                axes(&mut self.axis.iter().map(|axis| axis.name.as_str())),
                axes(&mut wanted.part.axes.iter().map(|axis| axis.name.as_ref())),
            ),
        ];
        match pairs.into_iter().find(|(_, saved, wanted)| saved != wanted) {
            Some((what, saved, wanted)) => Err(SavedError::Other { what, saved, wanted }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn saved() -> Saved {
        let soak = Soak {
            step: 0,
            set_c: 15.0,
            start_s: 1.0,
            end_s: 3.0,
            temp_c: 23.1,
            drift_c_per_min: 0.01,
            settled: true,
            rates_dps: vec![0.1 + 0.2],
        };
        let record = Record {
            start_s: vec![0.0, 1.0, 2.0],
            temp_c: vec![23.0, 23.1, 23.2],
            rates_dps: vec![vec![0.1, 0.1 + 0.2, 1e-17]],
            at_rest: vec![true, false, true],
            soaks: vec![soak],
            samples: 17_000,
            lost: 1,
            impossible: 2,
        };
        Saved { record, steps: 1, ended: Some("2026-11-23T00:40:00Z".into()) }
    }

    #[test]
    fn what_is_saved_comes_back_to_the_bit() {
        let text = saved().to_toml("plan", &Part::ADIS16130, "twin:", "SN1");
        assert_eq!(Saved::parse(&text, "plan", &Part::ADIS16130, "twin:", "SN1"), Ok(saved()));
    }

    #[test]
    fn it_goes_on_with_nothing_else_and_with_nothing_damaged() {
        let text = saved().to_toml("plan", &Part::ADIS16130, "twin:", "SN1");
        let parse = |text: &str, plan, device, serial| Saved::parse(text, plan, &Part::ADIS16130, device, serial);
        for (plan, device, serial, what) in [
            ("other", "twin:", "SN1", "plan"),
            ("plan", "spi:", "SN1", "device"),
            ("plan", "twin:", "SN2", "serial number"),
        ] {
            let error = parse(&text, plan, device, serial).unwrap_err();
            assert!(error.to_string().starts_with(&format!("it is of another {what}")), "{error}");
        }
        let short = text.replace("temp_c = [23.0, ", "temp_c = [");
        assert_ne!(short, text);
        assert_eq!(parse(&short, "plan", "twin:", "SN1"), Err(SavedError::Damaged));
        assert!(matches!(parse(&text[..200], "plan", "twin:", "SN1"), Err(SavedError::Syntax(_))));
    }
}
