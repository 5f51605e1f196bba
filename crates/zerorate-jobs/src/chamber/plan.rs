//! The plan of a measurement: shipped with the program, read from a file, or derived from a chamber's log.

use crate::error::InvalidOptions;
use crate::output::Outputs;
use anyhow::Result;
use std::io::ErrorKind;
use std::path::Path;
use zerorate::chamber::{ChamberPlan, SHIPPED};
use zerorate::{Calibration, Setting, SettingNames};
use zerorate_input::limits::Bytes;

/// The largest file that is read: a plan of 1000 steps, or a week of a chamber's log.
const LARGEST: Bytes = Bytes(64 << 20);

/// A plan and its text. The text shows whether an interrupted measurement used the same plan.
#[derive(Debug)]
pub struct PlanFile {
    /// The plan, as read from the text.
    pub plan: ChamberPlan,
    /// The text of the plan.
    pub text: String,
    /// The name of the plan as the user gave it.
    pub name: String,
}

impl PlanFile {
    /// Reads a plan. A CSV log of a chamber is accepted for a recording only. Errors use `names` for the settings.
    ///
    /// # Errors
    /// Returns [`InvalidOptions`] if the file is not a plan, or an error if it cannot be read.
    pub fn read(name: &Path, of_recording: bool, outputs: &mut Outputs, names: SettingNames) -> Result<Self> {
        let shown = name.display().to_string();
        let text = match shipped(name) {
            Some(text) => text.to_owned(),
            None => read(name, outputs)?,
        };
        let is_csv = name.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
        if is_csv && !of_recording {
            let why = "a CSV says what a chamber did, and is the plan of a recording only";
            let of = names(Setting::Device);
            return Err(InvalidOptions(format!(
                "{shown}: {why} ({of} replay:FILE); write a plan (docs/formats/plan.md)"
            ))
            .into());
        }
        let plan = if is_csv { course(&text) } else { ChamberPlan::parse(&text).map_err(|error| error.to_string()) };
        let is_calibration = Calibration::is_begun_by(&text);
        let plan = plan.map_err(|why| match is_calibration {
            true => InvalidOptions(format!("{shown} is not a plan: it is a calibration")),
            false => InvalidOptions(format!("{shown}: {why}")),
        })?;
        Ok(Self { plan, text, name: shown })
    }
}

fn shipped(name: &Path) -> Option<&'static str> {
    SHIPPED.iter().find(|(known, _)| Path::new(known) == name).map(|(_, text)| *text)
}

fn read(name: &Path, outputs: &mut Outputs) -> Result<String> {
    outputs.try_text(name, LARGEST)?.map_err(|error| {
        let shown = name.display();
        match error.kind() {
            ErrorKind::FileTooLarge => InvalidOptions(format!("{shown} is too large for a plan: {error}")).into(),
            ErrorKind::InvalidData => InvalidOptions(format!("{shown} is not a plan: {error}")).into(),
            ErrorKind::NotFound => {
                let names = SHIPPED.map(|(name, _)| name).join(" and ");
                anyhow::Error::from(error).context(format!("no plan {shown}; {names} come with the program"))
            }
            _ => anyhow::Error::from(error).context(format!("cannot read {shown}")),
        }
    })
}

/// The required columns of a chamber's CSV log.
const COLUMNS: [&str; 2] = ["t_s", "temp_c"];

fn course(text: &str) -> Result<ChamberPlan, String> {
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let head = reader.headers().map_err(|error| error.to_string())?.clone();
    let Some([time, temp]) = find(&head) else {
        let given = if head.is_empty() { "none".to_owned() } else { head.iter().collect::<Vec<_>>().join(", ") };
        return Err(format!("columns {} are needed; it has {given}", COLUMNS.join(" and ")));
    };
    let mut course = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|error| error.to_string())?;
        let line = row.position().map_or(0, csv::Position::line);
        let number =
            |column: usize| row.get(column).and_then(|text| text.parse::<f64>().ok()).filter(|one| one.is_finite());
        match (number(time), number(temp)) {
            (Some(at_s), Some(temp_c)) => course.push((at_s, temp_c)),
            _ => return Err(format!("line {line}: t_s and temp_c must be numbers")),
        }
    }
    ChamberPlan::of_course(&course).map_err(|error| error.to_string())
}

fn find(head: &csv::StringRecord) -> Option<[usize; 2]> {
    let [time, temp] = COLUMNS.map(|name| head.iter().position(|column| column == name));
    Some([time?, temp?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130_twin::facts::OVEN_MIN_C;
    use zerorate::chamber::StepEnd;

    /// The built-in plan `f57` has the corners of the twin's chamber profile (F-57), and lasts 210 minutes.
    #[test]
    fn the_plan_f57_has_the_corners_of_the_fact() {
        let plan = ChamberPlan::parse(shipped(Path::new("f57")).expect("a shipped plan")).expect("a plan");
        let (mut at_s, mut corners) = (0.0, vec![(0.0, 25.0)]);
        for (index, step) in plan.steps.iter().enumerate() {
            let StepEnd::Hold(hold_s) = step.end else { panic!("by the clock") };
            let ramp_s = step.ramp_s(plan.course_c(index).0);
            corners.extend((ramp_s > 0.0).then_some((at_s + ramp_s, step.to_c)));
            at_s += ramp_s + hold_s;
            corners.push((at_s, step.to_c));
        }
        let minutes: Vec<(f64, f64)> = corners.iter().map(|(s, c)| (s / 60.0, *c)).collect();
        assert_eq!(minutes[..OVEN_MIN_C.len()], OVEN_MIN_C);
        assert_eq!(minutes.last(), Some(&(210.0, 25.0)));
    }

    #[test]
    fn the_plan_two_point_spans_15_to_55_c() {
        let plan = ChamberPlan::parse(shipped(Path::new("two-point")).expect("a shipped plan")).expect("a plan");
        assert_eq!(plan.span_c(), (15.0, 55.0));
    }
}
