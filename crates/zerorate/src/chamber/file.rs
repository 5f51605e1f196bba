//! Reading of a plan from its file (`docs/formats/plan.md`).

use super::plan::{ChamberPlan, ChamberPlanError, Step, StepEnd};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::ops::RangeInclusive;
use serde::Deserialize;
use zerorate_allan::entry::{Bounds, Document, Entry, EntryError};

const SCHEMA: u32 = 1;
/// Largest number of steps of a plan that states `cycles`, and of a saved measurement: a week of ten-minute steps.
pub(super) const MAX_STEPS: usize = 1000;

pub(super) const SET_POINTS_C: RangeInclusive<f64> = -100.0..=250.0;
const TO_C: Bounds = Bounds::Within(SET_POINTS_C, "°C");
const SAFE_C: Bounds = Bounds::Within(-40.0..=60.0, "°C");
const C_PER_MIN: Bounds = Bounds::Within(0.01..=100.0, "°C/min");
const HOLD_S: Bounds = Bounds::Within(0.0..=86_400.0, "s");
const AVERAGE_S: Bounds = Bounds::Within(10.0..=86_400.0, "s, or \"auto\"");
const DRIFT: Bounds = Bounds::Within(1e-4..=10.0, "°C/min, or \"auto\"");
const WINDOW_S: Bounds = Bounds::Within(10.0..=3600.0, "s");
const TIMEOUT_S: Bounds = Bounds::Within(60.0..=172_800.0, "s");
const OVERSHOOT_C: Bounds = Bounds::Within(0.5..=50.0, "°C");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    schema: u32,
    name: Option<String>,
    cycles: Option<u32>,
    average_s: Option<Number>,
    drift_c_per_min: Option<Number>,
    window_s: Option<f64>,
    settle_timeout_s: Option<f64>,
    overshoot_c: Option<f64>,
    safe_c: Option<f64>,
    #[serde(default)]
    step: Vec<StepForm>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StepForm {
    to_c: f64,
    c_per_min: Option<f64>,
    hold_s: Option<f64>,
    average_s: Option<Number>,
}

/// A number, or `"auto"`.
#[derive(Deserialize)]
#[serde(untagged)]
enum Number {
    Known(f64),
    Word(String),
}

/// Name and file text of each plan that comes with this software.
pub const SHIPPED: [(&str, &str); 2] =
    [("f57", include_str!("../../plans/f57.toml")), ("two-point", include_str!("../../plans/two-point.toml"))];

impl ChamberPlan {
    /// Reads the file of a plan.
    ///
    /// # Errors
    /// Returns an error with the place and the remedy if the text is not a plan.
    pub fn parse(text: &str) -> Result<Self, ChamberPlanError> {
        let document = Document::parse(text)?;
        let (root, file) = (document.root(), document.fields::<File>()?);
        root.at("schema").require(file.schema == SCHEMA, || {
            format!("schema = {} is unknown; this software reads {SCHEMA}", file.schema)
        })?;
        let planned = auto(root.at("average_s"), file.average_s.as_ref(), &AVERAGE_S)?;
        let step = |(index, step): (usize, &StepForm)| step.read(root.at("step").item(index), planned);
        let once = file.step.iter().enumerate().map(step).collect::<Result<Vec<Step>, _>>()?;
        let cycles = cycles(root, file.cycles, once.len())?;
        let number = |key, value: Option<f64>, bounds, default| {
            value.map_or(Ok(default), |value| root.at(key).number(value, bounds))
        };
        let default = Self::default();
        Ok(Self {
            name: file.name.unwrap_or_default(),
            steps: core::iter::repeat_n(once, cycles).flatten().collect(),
            drift_c_per_min: auto(root.at("drift_c_per_min"), file.drift_c_per_min.as_ref(), &DRIFT)?,
            window_s: number("window_s", file.window_s, &WINDOW_S, default.window_s)?,
            settle_timeout_s: number("settle_timeout_s", file.settle_timeout_s, &TIMEOUT_S, default.settle_timeout_s)?,
            overshoot_c: number("overshoot_c", file.overshoot_c, &OVERSHOOT_C, default.overshoot_c)?,
            safe_c: number("safe_c", file.safe_c, &SAFE_C, default.safe_c)?,
        })
    }
}

/// Reads a number or `"auto"`. Returns `None` for `"auto"`, and for an absent value.
fn auto(entry: Entry<'_>, value: Option<&Number>, bounds: &Bounds) -> Result<Option<f64>, EntryError> {
    match value {
        Some(Number::Known(number)) => entry.number(*number, bounds).map(Some),
        Some(Number::Word(word)) if word != "auto" => {
            Err(entry.error(format_args!("{} is {word:?}; {bounds}", entry.key())))
        }
        _ => Ok(None),
    }
}

impl StepForm {
    fn read(&self, entry: Entry<'_>, planned: Option<f64>) -> Result<Step, EntryError> {
        let end = match (self.hold_s, &self.average_s) {
            (Some(_), Some(_)) => {
                return Err(entry.at("hold_s").error(
                    "hold_s and average_s in one step: hold_s waits by the clock, average_s for the part to settle; \
                     delete one of them",
                ));
            }
            (Some(hold_s), None) => StepEnd::Hold(entry.at("hold_s").number(hold_s, &HOLD_S)?),
            (None, Some(average)) => StepEnd::Average(auto(entry.at("average_s"), Some(average), &AVERAGE_S)?),
            (None, None) => StepEnd::Average(planned),
        };
        let c_per_min = self.c_per_min.map(|value| entry.at("c_per_min").number(value, &C_PER_MIN)).transpose()?;
        Ok(Step { to_c: entry.at("to_c").number(self.to_c, &TO_C)?, c_per_min, end })
    }
}

fn cycles(root: Entry<'_>, cycles: Option<u32>, steps: usize) -> Result<usize, EntryError> {
    root.require(steps > 0, || {
        "there is no [[step]]; give at least two, each with to_c = the temperature of the chamber in °C".into()
    })?;
    root.require(steps <= MAX_STEPS, || format!("there are {steps} [[step]]; a plan has at most {MAX_STEPS}"))?;
    let (count, most) = (cycles.unwrap_or(1) as usize, MAX_STEPS / steps);
    let fits = (1..=most).contains(&count);
    root.at("cycles")
        .require(fits, || format!("cycles is {count}; give a number from 1 to {most} ({steps} steps each)"))?;
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

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
            let seen = ChamberPlan::parse(text).unwrap_err().to_string();
            assert!(seen.contains(expected), "{text:?}: {seen}");
        }
        let long = ["schema = 1\n", &"[[step]]\nto_c = 5\n".repeat(1001)].concat();
        let seen = ChamberPlan::parse(&long).unwrap_err().to_string();
        assert!(seen.contains("there are 1001 [[step]]; a plan has at most 1000"), "{seen}");
    }
}
