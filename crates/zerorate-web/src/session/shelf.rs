//! Calibrations on file, and the one that is applied.

use crate::message::{CalibrationEntry, Download, Form};
use zerorate::{Calibration, Correction, Corrector, Part};
use zerorate_view::export::{self, Export, Options};
use zerorate_view::report;

/// Calibrations that are kept.
const MOST: usize = 100;

/// Calibrations, the newest last.
#[derive(Debug, Default)]
pub struct Shelf {
    kept: Vec<Calibration>,
    applied: Option<String>,
}

impl Shelf {
    /// Puts a calibration on file, by its TOML; its id. One that is there already stays as it is.
    pub fn add_file(&mut self, toml: &str) -> Result<String, String> {
        let (calibration, _) = Calibration::parse(toml).map_err(|error| error.to_string())?;
        self.add(calibration)
    }

    /// The same of one that was measured here.
    pub fn add(&mut self, calibration: Calibration) -> Result<String, String> {
        let id = calibration.id();
        if self.find(&id).is_none() {
            if self.kept.len() == MOST {
                return Err(format!("{MOST} calibrations are on file already; begin anew with those that you need"));
            }
            self.kept.push(calibration);
        }
        Ok(id)
    }

    pub fn all(&self) -> impl Iterator<Item = &Calibration> {
        self.kept.iter()
    }

    /// The one that is applied.
    pub fn applied(&self) -> Option<&Calibration> {
        self.find(self.applied.as_deref()?)
    }

    /// What applies it to the axes of a part.
    pub fn apply(&mut self, id: Option<&str>, part: &Part) -> Result<Option<Corrector<Vec<Correction>>>, String> {
        let Some(id) = id else {
            self.apply_none();
            return Ok(None);
        };
        let calibration = self.known(id)?;
        let axes = part.axes.iter().map(|axis| &*axis.name);
        let corrector = calibration.corrector(&part.name, axes).map_err(|error| error.to_string())?;
        self.applied = Some(id.to_owned());
        Ok(Some(corrector))
    }

    /// From here on none is applied.
    pub fn apply_none(&mut self) {
        self.applied = None;
    }

    pub fn entries(&self) -> Vec<CalibrationEntry> {
        self.kept.iter().map(|calibration| entry(calibration, self.is_applied(&calibration.id()))).collect()
    }

    pub fn entry_of(&self, id: &str) -> Option<CalibrationEntry> {
        self.find(id).map(|calibration| entry(calibration, self.is_applied(id)))
    }

    /// A calibration as a file.
    pub fn download(&self, id: &str, form: Form) -> Result<Download, String> {
        let calibration = self.known(id)?;
        let stem = calibration.serial.as_deref().map_or_else(|| id.to_owned(), plain);
        let file = |ending: &str, media_type: &str, text: String| Download {
            name: format!("{stem}.{ending}"),
            media_type: media_type.to_owned(),
            text,
        };
        let failed = |error: anyhow::Error| format!("{error:#}");
        let exported = |form| {
            let export = Export::new(calibration.clone(), Options::default())?;
            export.text(form)
        };
        Ok(match form {
            Form::Toml => file("toml", "application/toml", calibration.to_toml()),
            Form::C => file("h", "text/x-c", exported(export::Form::C).map_err(failed)?),
            Form::Rust => file("rs", "text/rust", exported(export::Form::Rust).map_err(failed)?),
            Form::Csv => file("csv", "text/csv", exported(export::Form::Csv).map_err(failed)?),
            Form::Json => file("json", "application/json", exported(export::Form::Json).map_err(failed)?),
            Form::Report => {
                let name = format!("{stem}.toml");
                file("html", "text/html", report::calibration_page(calibration, &name).map_err(failed)?)
            }
        })
    }

    fn is_applied(&self, id: &str) -> bool {
        self.applied.as_deref() == Some(id)
    }

    fn find(&self, id: &str) -> Option<&Calibration> {
        self.kept.iter().find(|calibration| calibration.id() == id)
    }

    fn known(&self, id: &str) -> Result<&Calibration, String> {
        self.find(id).ok_or_else(|| format!("no calibration {id} is on file"))
    }
}

/// A calibration as the page lists it.
pub fn entry(calibration: &Calibration, applied: bool) -> CalibrationEntry {
    let correction = calibration.axes.first().map_or(Correction::line(0.0, 0.0, 0.0), |axis| axis.correction);
    CalibrationEntry {
        id: calibration.id(),
        serial: calibration.serial.clone(),
        created: calibration.created.clone(),
        method: calibration.method.clone(),
        pbc_dps: correction.pbc_dps,
        btc_dps_per_c: correction.btc_dps_per_c,
        t3_c: correction.t3_c,
        range_c: calibration.validity.map(|validity| [validity.temp_min_c, validity.temp_max_c]),
        applied,
        toml: calibration.to_toml(),
    }
}

/// What any file system takes.
fn plain(name: &str) -> String {
    let allowed = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    name.chars().take(60).map(allowed).collect()
}
