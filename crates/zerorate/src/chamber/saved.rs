//! The text form of an interrupted measurement: the record of its finished steps.

use super::file::{MAX_STEPS, SET_POINTS_C};
use super::record::{Record, Soak};
use crate::check_lines::{self, Damage, sha256_hex};
use crate::part::{NamedAxis, Part};
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use core::ops::RangeInclusive;
use serde::{Deserialize, Serialize};
use zerorate_allan::entry::{Document, EntryError};

const SCHEMA: u32 = 1;
const HEADER: &str =
    "# An interrupted measurement in a chamber: zerorate chamber goes on with it (docs/chamber.md).\n";
/// Longest time of a record, s: ten years, including the pauses of a resumed measurement.
const LONGEST_S: f64 = 3.2e8;
/// Largest valid number of samples. Ten years hold fewer, and sums of such numbers do not overflow.
const MOST_SAMPLES: u64 = 1 << 50;
const DRIFTS_C_PER_MIN: RangeInclusive<f64> = -1e4..=1e4;

/// The finished steps of a measurement. `docs/chamber.md` says when they are written and read.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// The record of the finished steps.
    pub record: Record,
    /// Number of finished steps of the plan.
    pub steps: usize,
    /// Time at which the last finished step ended, RFC 3339. `None` for a simulated part.
    pub ended: Option<String>,
}

/// The reason why a text cannot continue a measurement. Lines count from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the text shows them")]
pub enum SavedError {
    /// The text does not have the form of an interrupted measurement.
    Syntax(String),
    /// The text has changed since it was written.
    Altered(Damage),
    /// The text has no check lines, so nothing shows whether it is whole.
    Unchecked,
    /// Lists have different lengths, or times do not rise.
    Damaged,
    /// A number is impossible for a measurement.
    Impossible { what: &'static str },
    /// The text belongs to another measurement.
    Other { what: &'static str, saved: String, wanted: String },
}

impl fmt::Display for SavedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(what) => write!(f, "it is not an interrupted measurement: {what}"),
            Self::Altered(damage) => damage.fmt(f),
            Self::Unchecked => f.write_str(check_lines::UNCHECKED),
            Self::Damaged => f.write_str("it is damaged: its lists have different lengths, or its times do not rise"),
            Self::Impossible { what } => write!(f, "it is damaged: its {what} cannot come from a measurement"),
            Self::Other { what, saved, wanted } => {
                write!(f, "it belongs to another {what}: {saved:?} there, {wanted:?} here")
            }
        }
    }
}

impl core::error::Error for SavedError {}

impl From<EntryError> for SavedError {
    fn from(error: EntryError) -> Self {
        Self::Syntax(error.to_string())
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedForm {
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
    /// A digit for each second: 1 if the part was at rest, 0 if not.
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

impl Saved {
    /// Writes the text. `device` and `serial` identify the measured unit, and `plan_text` is the file of the plan.
    #[must_use]
    pub fn to_toml(&self, plan_text: &str, part: &Part, device: &str, serial: &str) -> String {
        let Record { start_s, temp_c, rates_dps, at_rest, soaks, samples, lost, impossible } = self.record.clone();
        let name = |(axis, rate_dps): (&NamedAxis, Vec<f64>)| AxisForm { name: axis.name.to_string(), rate_dps };
        let form = SavedForm {
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
        check_lines::file(HEADER, &form)
    }

    /// Reads the text of an interrupted measurement, if it is complete and belongs to this measurement.
    ///
    /// # Errors
    /// Returns the reason why the text cannot continue this measurement.
    pub fn parse(text: &str, plan_text: &str, part: &Part, device: &str, serial: &str) -> Result<Self, SavedError> {
        let is_checked = check_lines::verify(text).map_err(SavedError::Altered)?;
        let fields = check_lines::without_checks(text);
        let form: SavedForm = Document::parse(&fields)?.fields()?;
        if !is_checked {
            return Err(SavedError::Unchecked);
        }
        form.is_of(plan_text, part, device, serial)?;
        form.is_possible(part)?;
        let at_rest: Vec<bool> = form.at_rest.chars().map(|digit| digit == '1').collect();
        let len = form.start_s.len();
        let rates_dps: Vec<Vec<f64>> = form.axis.into_iter().map(|axis| axis.rate_dps).collect();
        let whole = form.temp_c.len() == len && at_rest.len() == len && rates_dps.iter().all(|one| one.len() == len);
        let rises = form.start_s.windows(2).all(|pair| pair[0] < pair[1]);
        let soaks_fit = form.soak.iter().all(|soak| soak.rates_dps.len() == rates_dps.len());
        if !(whole && rises && soaks_fit) {
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

fn all(range: &RangeInclusive<f64>, mut numbers: impl Iterator<Item = f64>) -> bool {
    numbers.all(|number| range.contains(&number))
}

impl SavedForm {
    /// Checks each number against the range that a measurement of this part can give. Later code loops over these
    /// times and steps.
    fn is_possible(&self, part: &Part) -> Result<(), SavedError> {
        let Some(first) = part.axes.first() else { return Err(SavedError::Damaged) };
        let (times_s, temps_c) = (0.0..=LONGEST_S, first.axis.temp.values());
        let rates_dps = || self.axis.iter().zip(part.axes.iter()).map(|(one, known)| (one, known.axis.rate.values()));
        let of_soaks = |number: fn(&Soak) -> f64| self.soak.iter().map(number);
        let soaks_dps = |soak: &Soak| {
            soak.rates_dps.iter().zip(part.axes.iter()).all(|(dps, known)| known.axis.rate.values().contains(dps))
        };
        let steps = self.steps <= MAX_STEPS && self.soak.iter().all(|soak| soak.step < self.steps);
        let checks = [
            ("number of steps", steps),
            (
                "number of samples",
                [self.samples, self.lost, self.impossible].iter().all(|count| *count <= MOST_SAMPLES),
            ),
            ("times", all(&times_s, self.start_s.iter().copied())),
            ("times", all(&times_s, of_soaks(|soak| soak.start_s).chain(of_soaks(|soak| soak.end_s)))),
            ("times", self.soak.iter().all(|soak| soak.start_s < soak.end_s)),
            ("temperatures", all(&temps_c, self.temp_c.iter().copied().chain(of_soaks(|soak| soak.temp_c)))),
            ("set points", all(&SET_POINTS_C, of_soaks(|soak| soak.set_c))),
            ("drifts", all(&DRIFTS_C_PER_MIN, of_soaks(|soak| soak.drift_c_per_min))),
            ("rates", rates_dps().all(|(one, range)| all(&range, one.rate_dps.iter().copied()))),
            ("rates", self.soak.iter().all(soaks_dps)),
            ("marks of rest", self.at_rest.chars().all(|digit| matches!(digit, '0' | '1'))),
        ];
        let impossible = checks.into_iter().find(|(_, is_possible)| !is_possible);
        impossible.map_or(Ok(()), |(what, _)| Err(SavedError::Impossible { what }))
    }

    fn is_of(&self, plan_text: &str, part: &Part, device: &str, serial: &str) -> Result<(), SavedError> {
        let axes = |names: &mut dyn Iterator<Item = &str>| names.collect::<Vec<_>>().join(", ");
        let pairs = [
            ("version", self.schema.to_string(), SCHEMA.to_string()),
            ("plan", self.plan_sha256.clone(), sha256_hex(plan_text)),
            ("part", self.part.clone(), part.name.to_string()),
            ("device", self.device.clone(), device.to_string()),
            ("serial number", self.serial.clone(), serial.to_string()),
            (
                "set of axes",
                axes(&mut self.axis.iter().map(|axis| axis.name.as_str())),
                axes(&mut part.axes.iter().map(|axis| axis.name.as_ref())),
            ),
        ];
        let other = pairs.into_iter().find(|(_, saved, wanted)| saved != wanted);
        other.map_or(Ok(()), |(what, saved, wanted)| Err(SavedError::Other { what, saved, wanted }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{format, vec};

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
    fn saved_steps_come_back_to_the_bit() {
        let text = saved().to_toml("plan", &Part::ADIS16130, "twin:", "SN1");
        assert_eq!(Saved::parse(&text, "plan", &Part::ADIS16130, "twin:", "SN1"), Ok(saved()));
    }

    #[test]
    fn a_text_of_another_measurement_is_refused() {
        let text = saved().to_toml("plan", &Part::ADIS16130, "twin:", "SN1");
        for (plan, device, serial, what) in [
            ("other", "twin:", "SN1", "plan"),
            ("plan", "spi:", "SN1", "device"),
            ("plan", "twin:", "SN2", "serial number"),
        ] {
            let error = Saved::parse(&text, plan, &Part::ADIS16130, device, serial).unwrap_err();
            assert!(error.to_string().starts_with(&format!("it belongs to another {what}")), "{error}");
        }
        let nothing = parsed("nonsense");
        assert!(matches!(nothing, Err(SavedError::Syntax(_))), "{nothing:?}");
    }

    fn parsed(text: &str) -> Result<Saved, SavedError> {
        Saved::parse(text, "plan", &Part::ADIS16130, "twin:", "SN1")
    }

    #[test]
    fn an_incomplete_file_is_refused() {
        let text = saved().to_toml("plan", &Part::ADIS16130, "twin:", "SN1");
        let changed = parsed(&text.replace("lost = 1\n", "lost = 2\n"));
        assert!(matches!(changed, Err(SavedError::Altered(Damage::Changed { .. }))), "{changed:?}");
        let without: Vec<&str> =
            text.lines().filter(|line| !line.starts_with("checksum") && !line.starts_with("line_checks")).collect();
        assert_eq!(parsed(&without.join("\n")), Err(SavedError::Unchecked), "as older software wrote it");
        for length in [200, text.rfind("\n[[axis]]").unwrap()] {
            let cut = parsed(&text[..length]);
            assert!(matches!(cut, Err(SavedError::Altered(Damage::EndsEarly { .. }))), "{cut:?}");
        }
    }

    #[test]
    fn numbers_that_no_measurement_gives_are_named() {
        let text = saved().to_toml("plan", &Part::ADIS16130, "twin:", "SN1");
        let fields: Vec<&str> = text.lines().skip(3).collect();
        let fields = fields.join("\n");
        let forged = |from: &str, to: &str| {
            assert!(fields.contains(from), "{fields}");
            parsed(&check_lines::with_checks(HEADER, &fields.replacen(from, to, 1)))
        };
        assert_eq!(forged("samples", "samples"), Ok(saved()));
        assert_eq!(forged("temp_c = [23.0, ", "temp_c = ["), Err(SavedError::Damaged));
        for (from, to, what) in [
            ("steps = 1", "steps = 1001", "number of steps"),
            ("steps = 1", "steps = 0", "number of steps"),
            ("step = 0", "step = 7", "number of steps"),
            ("lost = 1\n", "lost = 9223372036854775807\n", "number of samples"),
            ("start_s = [0.0, 1.0, 2.0]", "start_s = [0.0, 1.0, 1e300]", "times"),
            ("start_s = [0.0, 1.0, 2.0]", "start_s = [-1e9, 1.0, 2.0]", "times"),
            ("start_s = 1.0", "start_s = 4.0", "times"),
            ("end_s = 3.0", "end_s = inf", "times"),
            ("temp_c = [23.0", "temp_c = [2300.0", "temperatures"),
            ("temp_c = 23.1", "temp_c = nan", "temperatures"),
            ("set_c = 15.0", "set_c = 251.0", "set points"),
            ("drift_c_per_min = 0.01", "drift_c_per_min = 1e9", "drifts"),
            ("rate_dps = [0.1", "rate_dps = [1e3", "rates"),
            ("rates_dps = [0.3", "rates_dps = [1000.3", "rates"),
            ("at_rest = \"101\"", "at_rest = \"1x1\"", "marks of rest"),
        ] {
            assert_eq!(forged(from, to), Err(SavedError::Impossible { what }), "{to}");
        }
    }
}
