//! Keeps the results of finished steps in a file beside the output, so that an interrupted measurement can continue.

use super::UnusableSteps;
use crate::error::InvalidOptions;
use crate::output::Slot;
use crate::warning::JobWarning;
use anyhow::Result;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use zerorate::Part;
use zerorate::chamber::{ChamberProcedure, Saved};
use zerorate_host::clock;
use zerorate_input::limits::Bytes;

/// The ending of the name of a steps file, as in `unit.toml.chamber`.
const ENDING: &str = ".chamber";
/// The largest file that is read. It holds a week of one-second means of eight axes as text.
const LARGEST: Bytes = Bytes(256 << 20);

/// The file of finished steps, if there is one, and the identity of the measurement that they belong to.
pub struct FinishedSteps {
    pub slot: Option<Slot>,
    pub plan_text: String,
    pub part: Part,
    pub device: String,
    pub serial: String,
    /// True if the samples come in real time, so that the wall clock gives the time between two runs.
    pub is_real: bool,
}

impl FinishedSteps {
    pub fn beside(output: &Path) -> PathBuf {
        let mut name = output.as_os_str().to_owned();
        name.push(ENDING);
        name.into()
    }

    /// The saved steps and the time since their end, s (0 if unknown); `None` without a file or with `restart`.
    pub fn found(&self, restart: bool) -> Result<Option<(Saved, f64)>> {
        let Some(slot) = self.slot.as_ref().filter(|_| !restart) else { return Ok(None) };
        let shown = slot.path().display();
        let text = slot.content(LARGEST).map_err(|error| match error.kind() {
            ErrorKind::FileTooLarge => {
                InvalidOptions(format!("{shown} is too large for an interrupted measurement")).into()
            }
            _ => anyhow::Error::from(error).context(format!("cannot read {shown}")),
        })?;
        let Some(text) = text else { return Ok(None) };
        let saved = Saved::parse(&text, &self.plan_text, &self.part, &self.device, &self.serial)
            .map_err(|why| UnusableSteps { path: slot.path().to_owned(), why: why.to_string() })?;
        let ended = saved.ended.as_deref().and_then(|text| text.parse::<jiff::Timestamp>().ok());
        let gap = |ended| Some(clock::now()?.duration_since(ended).as_secs_f64());
        let gap_s = ended.filter(|_| self.is_real).and_then(gap).unwrap_or(0.0);
        Ok(Some((saved, gap_s)))
    }

    /// Saves the finished steps atomically, unless all steps are finished. A failure is a warning, because the
    /// measurement can go on.
    pub fn keep(&mut self, procedure: &ChamberProcedure) -> Option<JobWarning> {
        let slot = self.slot.as_mut()?;
        let (record, steps) = procedure.finished_steps();
        if steps == procedure.plan().steps.len() {
            return None;
        }
        let ended = clock::now().filter(|_| self.is_real).map(|now| now.to_string());
        let text = Saved { record, steps, ended }.to_toml(&self.plan_text, &self.part, &self.device, &self.serial);
        let failed = |error| JobWarning::StepsNotKept(format!("{:#}", anyhow::Error::from(error)));
        slot.put(text.as_bytes()).err().map(failed)
    }

    /// The advice to print after an interruption with this many finished steps; empty if none is kept.
    pub fn hint(&self, steps: usize) -> String {
        match (&self.slot, steps) {
            (Some(slot), 1..) => format!(
                ". {steps} finished {} kept in {}: the same command goes on from there",
                if steps == 1 { "step is" } else { "steps are" },
                slot.path().display()
            ),
            _ => String::new(),
        }
    }

    pub fn forget(&mut self) {
        self.slot.iter_mut().for_each(Slot::clear);
    }
}
