//! What the finished steps measured, in a file beside the output: an interrupted measurement goes on from there.

use crate::exit::Usage;
use crate::output::{Outputs, say};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use zerorate::Part;
use zerorate::chamber::{ChamberProcedure, Saved};

/// Ends the name of the file: `unit.toml.chamber`.
const ENDING: &str = ".chamber";
/// A week of seconds of eight axes in text.
const LARGEST: u64 = 256 << 20;

/// Where finished steps go, if anywhere, and what they are of.
pub struct Kept {
    path: Option<PathBuf>,
    plan_text: String,
    part: Part,
    device: String,
    serial: String,
    /// Time is that of the wall clock.
    is_real: bool,
}

impl Kept {
    pub fn new(path: Option<PathBuf>, plan_text: &str, part: &Part, device: &str, serial: Option<&str>) -> Self {
        let serial = serial.unwrap_or_default().to_owned();
        Self {
            path,
            plan_text: plan_text.to_owned(),
            part: part.clone(),
            device: device.to_owned(),
            serial,
            is_real: false,
        }
    }

    /// Of a part whose time is that of the wall clock.
    pub fn in_real_time(self, is_real: bool) -> Self {
        Self { is_real, ..self }
    }

    /// Beside the output.
    pub fn beside(output: &Path) -> PathBuf {
        let mut name = output.as_os_str().to_owned();
        name.push(ENDING);
        name.into()
    }

    /// What is there already, and how long ago that ended, s.
    pub fn found(&self, restart: bool) -> Result<Option<(Saved, f64)>> {
        let Some(path) = self.path.as_deref().filter(|path| !restart && path.exists()) else { return Ok(None) };
        let shown = path.display();
        let size = fs::metadata(path).with_context(|| format!("cannot look at {shown}"))?.len();
        let text = match size {
            ..=LARGEST => fs::read_to_string(path).with_context(|| format!("cannot read {shown}"))?,
            _ => return Err(Usage(format!("{shown} is too large for an interrupted measurement")).into()),
        };
        let saved = Saved::parse(&text, &self.plan_text, &self.part, &self.device, &self.serial).map_err(|why| {
            Usage(format!(
                "{shown} does not go on with this measurement: {why}; take another -o, or --restart to begin anew"
            ))
        })?;
        let ended = saved.ended.as_deref().and_then(|text| text.parse::<jiff::Timestamp>().ok());
        let gap_s =
            ended.filter(|_| self.is_real).map_or(0.0, |ended| (jiff::Timestamp::now() - ended).get_seconds() as f64);
        Ok(Some((saved, gap_s)))
    }

    /// Keeps the steps that are over, whole or not at all.
    pub fn keep(&self, procedure: &ChamberProcedure) -> Result<()> {
        let Some(path) = &self.path else { return Ok(()) };
        let (record, steps) = procedure.finished_steps();
        if steps == procedure.plan().steps.len() {
            return Ok(());
        }
        let ended = self.is_real.then(|| jiff::Timestamp::now().to_string());
        let text = Saved { record, steps, ended }.to_toml(&self.plan_text, &self.part, &self.device, &self.serial);
        let kept = Outputs::new(true).derived(path).and_then(|file| file.fill(text.as_bytes()));
        if let Err(error) = kept {
            // the measurement is worth more than the way back to it
            say(format_args!(
                "warning: not-kept: the finished steps cannot be kept: {:#}",
                anyhow::Error::from(error)
            ));
        }
        Ok(())
    }

    /// What to do after an interruption when so many steps are over.
    pub fn hint(&self, steps: usize) -> String {
        match (&self.path, steps) {
            (Some(path), 1..) => format!(
                ". {steps} finished {} kept in {}: the same command goes on from there",
                if steps == 1 { "step is" } else { "steps are" },
                path.display()
            ),
            _ => String::new(),
        }
    }

    /// The measurement is whole.
    pub fn forget(&self) {
        if let Some(path) = self.path.as_deref().filter(|path| path.exists()) {
            let _ = fs::remove_file(path);
        }
    }
}
