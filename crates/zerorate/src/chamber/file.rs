//! A plan from its file (`docs/formats/plan.md`).

use super::plan::{ChamberPlan, ChamberPlanError, Step, StepEnd};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use serde::Deserialize;
use toml::Spanned;
use zerorate_allan::toml_error::{line_of, syntax};

/// Version of the file form, and the newest that is read.
const SCHEMA: u32 = 1;
/// Steps of all cycles at most: a week of them.
pub(super) const MAX_STEPS: usize = 1000;

/// A number's key, its bounds and its unit.
pub(super) struct Bounds(&'static str, pub(super) f64, pub(super) f64, &'static str);

pub(super) const TO_C: Bounds = Bounds("to_c", -100.0, 250.0, "°C");
const SAFE_C: Bounds = Bounds("safe_c", -40.0, 60.0, "°C");
const C_PER_MIN: Bounds = Bounds("c_per_min", 0.01, 100.0, "°C/min");
const HOLD_S: Bounds = Bounds("hold_s", 0.0, 86_400.0, "s");
const AVERAGE_S: Bounds = Bounds("average_s", 10.0, 86_400.0, "s, or \"auto\"");
const DRIFT: Bounds = Bounds("drift_c_per_min", 1e-4, 10.0, "°C/min, or \"auto\"");
const WINDOW_S: Bounds = Bounds("window_s", 10.0, 3600.0, "s");
const TIMEOUT_S: Bounds = Bounds("settle_timeout_s", 60.0, 172_800.0, "s");
const OVERSHOOT_C: Bounds = Bounds("overshoot_c", 0.5, 50.0, "°C");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    schema: Spanned<u32>,
    name: Option<String>,
    cycles: Option<Spanned<u32>>,
    average_s: Option<Spanned<Entry>>,
    drift_c_per_min: Option<Spanned<Entry>>,
    window_s: Option<Spanned<f64>>,
    settle_timeout_s: Option<Spanned<f64>>,
    overshoot_c: Option<Spanned<f64>>,
    safe_c: Option<Spanned<f64>>,
    #[serde(default)]
    step: Vec<Spanned<StepEntry>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StepEntry {
    to_c: Spanned<f64>,
    c_per_min: Option<Spanned<f64>>,
    hold_s: Option<Spanned<f64>>,
    average_s: Option<Spanned<Entry>>,
}

/// A number, or `"auto"`.
#[derive(Clone, Deserialize)]
#[serde(untagged)]
enum Entry {
    Number(f64),
    Word(String),
}

/// Plans that come with this software: name and file.
pub const SHIPPED: [(&str, &str); 2] =
    [("f57", include_str!("../../plans/f57.toml")), ("two-point", include_str!("../../plans/two-point.toml"))];

impl ChamberPlan {
    /// Reads the file of a plan.
    ///
    /// # Errors
    /// No such file: the line, the key, and what to do.
    pub fn parse(text: &str) -> Result<Self, ChamberPlanError> {
        let file: File = toml::from_str(text).map_err(|error| ChamberPlanError::unplaced(syntax(text, &error)))?;
        let reader = Reader { text };
        let schema = *file.schema.get_ref();
        if schema != SCHEMA {
            let what = format!("schema = {schema} is unknown; this software reads {SCHEMA}");
            return Err(reader.error(file.schema.span().start, what));
        }
        let planned = reader.auto(file.average_s.as_ref(), &AVERAGE_S)?;
        let once = file.step.iter().map(|step| reader.step(step, planned)).collect::<Result<Vec<Step>, _>>()?;
        let cycles = reader.cycles(file.cycles.as_ref(), once.len())?;
        let number = |value: &Option<Spanned<f64>>, bounds, default| {
            value.as_ref().map_or(Ok(default), |value| reader.number(value, bounds))
        };
        Ok(Self {
            name: file.name.unwrap_or_default(),
            steps: core::iter::repeat_n(once, cycles).flatten().collect(),
            drift_c_per_min: reader.auto(file.drift_c_per_min.as_ref(), &DRIFT)?,
            window_s: number(&file.window_s, &WINDOW_S, 120.0)?,
            settle_timeout_s: number(&file.settle_timeout_s, &TIMEOUT_S, 7200.0)?,
            overshoot_c: number(&file.overshoot_c, &OVERSHOOT_C, 5.0)?,
            safe_c: number(&file.safe_c, &SAFE_C, 25.0)?,
        })
    }
}

/// Knows the lines of what it reads.
struct Reader<'a> {
    text: &'a str,
}

impl Reader<'_> {
    fn error(&self, byte: usize, what: impl Into<String>) -> ChamberPlanError {
        ChamberPlanError::at(line_of(self.text, byte), what)
    }

    fn number(&self, value: &Spanned<f64>, bounds: &Bounds) -> Result<f64, ChamberPlanError> {
        self.within(*value.get_ref(), value.span().start, bounds)
    }

    fn within(&self, value: f64, byte: usize, bounds: &Bounds) -> Result<f64, ChamberPlanError> {
        let &Bounds(key, least, most, unit) = bounds;
        match (least..=most).contains(&value) {
            true => Ok(value),
            false => Err(self.error(byte, format!("{key} is {value}; give a number from {least} to {most} {unit}"))),
        }
    }

    /// None for `"auto"`, and for nothing.
    fn auto(&self, value: Option<&Spanned<Entry>>, bounds: &Bounds) -> Result<Option<f64>, ChamberPlanError> {
        let Some(value) = value else { return Ok(None) };
        match value.get_ref() {
            Entry::Number(number) => self.within(*number, value.span().start, bounds).map(Some),
            Entry::Word(word) if word == "auto" => Ok(None),
            Entry::Word(word) => {
                let &Bounds(key, least, most, unit) = bounds;
                let what = format!("{key} is {word:?}; give a number from {least} to {most} {unit}");
                Err(self.error(value.span().start, what))
            }
        }
    }

    fn step(&self, entry: &Spanned<StepEntry>, planned: Option<f64>) -> Result<Step, ChamberPlanError> {
        let step = entry.get_ref();
        let end = match (&step.hold_s, &step.average_s) {
            (Some(hold_s), Some(_)) => {
                let what = "hold_s and average_s in one step: hold_s waits by the clock, average_s for the part to \
                            settle; delete one of them";
                return Err(self.error(hold_s.span().start, what));
            }
            (Some(hold_s), None) => StepEnd::Hold(self.number(hold_s, &HOLD_S)?),
            (None, Some(average)) => StepEnd::Average(self.auto(Some(average), &AVERAGE_S)?),
            (None, None) => StepEnd::Average(planned),
        };
        let c_per_min = step.c_per_min.as_ref().map(|value| self.number(value, &C_PER_MIN)).transpose()?;
        Ok(Step { to_c: self.number(&step.to_c, &TO_C)?, c_per_min, end })
    }

    /// How often the steps are gone through.
    fn cycles(&self, cycles: Option<&Spanned<u32>>, steps: usize) -> Result<usize, ChamberPlanError> {
        if steps == 0 {
            return Err(ChamberPlanError::unplaced(
                "there is no [[step]]; give at least two, each with to_c = the temperature of the chamber in °C",
            ));
        }
        let Some(cycles) = cycles else { return Ok(1) };
        let count = *cycles.get_ref() as usize;
        match count {
            1.. if count.saturating_mul(steps) <= MAX_STEPS => Ok(count),
            _ => {
                let most = MAX_STEPS / steps;
                let what = format!("cycles is {count}; give a number from 1 to {most} ({steps} steps each)");
                Err(self.error(cycles.span().start, what))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    fn error(text: &str) -> String {
        ChamberPlan::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn a_plan_is_read_with_its_defaults() {
        let plan = ChamberPlan::parse(
            "schema = 1\ncycles = 2\naverage_s = 300\n\
             [[step]]\nto_c = -40\nc_per_min = 2.5\nhold_s = 0\n\
             [[step]]\nto_c = 85\n\
             [[step]]\nto_c = 20\naverage_s = \"auto\"\n",
        )
        .unwrap();
        assert_eq!(plan.steps.len(), 6);
        assert_eq!(plan.steps[0], Step { to_c: -40.0, c_per_min: Some(2.5), end: StepEnd::Hold(0.0) });
        assert_eq!(plan.steps[4], Step { to_c: 85.0, c_per_min: None, end: StepEnd::Average(Some(300.0)) });
        assert_eq!(plan.steps[5].end, StepEnd::Average(None));
        assert_eq!((plan.window_s, plan.safe_c, plan.overshoot_c, plan.drift_c_per_min), (120.0, 25.0, 5.0, None));
        assert_eq!(
            (plan.course_c(0), plan.course_c(3), plan.span_c()),
            ((-40.0, -40.0), (20.0, -40.0), (-40.0, 85.0))
        );
    }

    #[test]
    fn every_error_names_line_and_key_and_says_what_to_do() {
        let cases = [
            ("schema = 2\n[[step]]\nto_c = 5\n", "line 1: schema = 2 is unknown; this software reads 1"),
            ("schema = 1\n", "there is no [[step]]; give at least two"),
            ("schema = 1\n[[step]]\nto_c = 500\n", "line 3: to_c is 500; give a number from -100 to 250 °C"),
            ("schema = 1\n[[step]]\nto_c = nan\n", "line 3: to_c is NaN; give a number"),
            ("schema = 1\n[[step]]\nto_c = 5\nc_per_min = 0\n", "line 4: c_per_min is 0; give a number from 0.01"),
            ("schema = 1\n[[step]]\nto_c = 5\nhold_s = 60\naverage_s = 60\n", "line 4: hold_s and average_s in one"),
            ("schema = 1\n[[step]]\nto_c = 5\naverage_s = \"long\"\n", "line 4: average_s is \"long\"; give a number"),
            ("schema = 1\ncycles = 0\n[[step]]\nto_c = 5\n", "line 2: cycles is 0; give a number from 1 to 1000"),
            ("schema = 1\n[[step]]\nto_c = 5\nramp = 3\n", "line 4, `ramp = 3`: unknown field"),
            ("schema = 1\n[[step]]\nhold_s = 5\n", "missing field `to_c`"),
            ("schema = 1\ndrift_c_per_min = 0\n[[step]]\nto_c = 5\n", "line 2: drift_c_per_min is 0; give"),
        ];
        for (text, expected) in cases {
            let seen = error(text);
            assert!(seen.contains(expected), "{text:?}: {seen}");
        }
    }
}
