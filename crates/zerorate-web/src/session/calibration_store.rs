//! The stored calibrations, and the applied one.

use super::About;
use crate::message::{CalibrationEntry, Download};
use zerorate::calibration::FileWarning;
use zerorate::{Calibration, Correction, Corrector, Part};
use zerorate_view::SessionWarning;
use zerorate_view::export::{Export, ExportForm, Options};
use zerorate_view::report;

/// Largest number of stored calibrations.
const MOST: usize = 100;

/// The stored calibrations, the newest last.
#[derive(Debug, Default)]
pub struct CalibrationStore {
    stored: Vec<StoredCalibration>,
    applied: Option<String>,
    /// Number of additions and removals so far.
    pub changes: u64,
}

#[derive(Debug)]
struct StoredCalibration {
    calibration: Calibration,
    warnings: Vec<FileWarning>,
}

impl CalibrationStore {
    /// Stores a calibration from its TOML text and returns its id. `free` places must remain. An identical
    /// calibration stays as it is; one with the same id but other content is refused.
    pub fn add_file(&mut self, toml: &str, free: usize) -> Result<String, String> {
        let (calibration, warnings) = Calibration::parse(toml).map_err(|error| error.to_string())?;
        self.put(StoredCalibration { calibration, warnings }, free)
    }

    /// Stores a calibration that was measured in this session.
    pub fn add(&mut self, calibration: Calibration) -> Result<String, String> {
        self.put(StoredCalibration { calibration, warnings: Vec::new() }, 0)
    }

    fn put(&mut self, new: StoredCalibration, free: usize) -> Result<String, String> {
        let id = new.calibration.id();
        if let Some(there) = self.find(&id) {
            let is_same = there.calibration.to_toml() == new.calibration.to_toml();
            return if is_same { Ok(id) } else { Err(other_content(&id)) };
        }
        self.has_room(1 + free)?;
        self.stored.push(new);
        self.changes += 1;
        Ok(id)
    }

    pub fn has_room(&self, more: usize) -> Result<(), String> {
        match self.stored.len() + more <= MOST {
            true => Ok(()),
            false => Err(format!("at most {MOST} calibrations can be on file: remove one that you do not need")),
        }
    }

    /// Removes a stored calibration. Returns an error if it is unknown or applied.
    pub fn remove(&mut self, id: &str) -> Result<(), String> {
        self.known(id)?;
        if self.is_applied(id) {
            return Err("this calibration is applied: apply another one first, or none".to_owned());
        }
        self.stored.retain(|stored| stored.calibration.id() != id);
        self.changes += 1;
        Ok(())
    }

    pub fn all(&self) -> impl Iterator<Item = &Calibration> {
        self.stored.iter().map(|stored| &stored.calibration)
    }

    /// The warnings about applying a calibration to this device. Returns an error if the calibration is unknown or
    /// belongs to another part.
    pub fn doubts(&self, id: &str, about: &About) -> Result<Vec<SessionWarning>, String> {
        let StoredCalibration { calibration, warnings } = self.known(id)?;
        let cal = || format!("calibration {id}");
        let of_file = |warning: &FileWarning| SessionWarning::OfCalibration { cal: cal(), warning: *warning };
        let (calibrated, part) = (calibration.serial.as_deref(), (&*about.name, about.info.serial.as_deref()));
        let of_serial = SessionWarning::of_serial((cal(), calibrated), part, "check its number")?;
        Ok(warnings.iter().map(of_file).chain(of_serial).collect())
    }

    pub fn applied(&self) -> Option<&Calibration> {
        self.find(self.applied.as_deref()?).map(|stored| &stored.calibration)
    }

    /// Applies a calibration, or none. Returns its corrector for the axes of a part.
    pub fn apply(&mut self, id: Option<&str>, part: &Part) -> Result<Option<Corrector<Vec<Correction>>>, String> {
        let Some(id) = id else {
            self.apply_none();
            return Ok(None);
        };
        let calibration = &self.known(id)?.calibration;
        let axes = part.axes.iter().map(|axis| &*axis.name);
        let corrector = calibration.corrector(&part.name, axes).map_err(|error| error.to_string())?;
        self.applied = Some(id.to_owned());
        Ok(Some(corrector))
    }

    pub fn apply_none(&mut self) {
        self.applied = None;
    }

    pub fn entries(&self) -> Vec<CalibrationEntry> {
        self.all().map(|calibration| entry(calibration, self.is_applied(&calibration.id()))).collect()
    }

    pub fn entry_of(&self, id: &str) -> Option<CalibrationEntry> {
        self.find(id).map(|stored| entry(&stored.calibration, self.is_applied(id)))
    }

    pub fn download(&self, id: &str, form: &str) -> Result<Download, String> {
        let calibration = &self.known(id)?.calibration;
        let stem = calibration.serial.as_deref().map_or_else(|| id.to_owned(), plain);
        let file = |ending: &str, media_type: &str, text: String| Download {
            name: format!("{stem}.{ending}"),
            media_type: media_type.to_owned(),
            text,
        };
        let failed = |error: anyhow::Error| format!("{error:#}");
        Ok(match form {
            "toml" => file("toml", "application/toml", calibration.to_toml()),
            "report" => {
                let page = report::calibration_page(&[(calibration.clone(), format!("{stem}.toml"))], None);
                file("html", "text/html", page.map_err(failed)?)
            }
            name => {
                let form = ExportForm::named(name).filter(|form| !form.is_autopilot());
                let form = form.ok_or_else(|| format!("unknown form of download: `{name}`"))?;
                let export = Export::new(calibration.clone(), Options::default()).map_err(failed)?;
                file(form.row().extension, form.row().media_type, export.text(form).map_err(failed)?)
            }
        })
    }

    fn is_applied(&self, id: &str) -> bool {
        self.applied.as_deref() == Some(id)
    }

    fn find(&self, id: &str) -> Option<&StoredCalibration> {
        self.stored.iter().find(|stored| stored.calibration.id() == id)
    }

    fn known(&self, id: &str) -> Result<&StoredCalibration, String> {
        self.find(id).ok_or_else(|| format!("no calibration {id} is on file"))
    }
}

/// The error for a stored id with other content. The id does not depend on all of the content.
fn other_content(id: &str) -> String {
    format!(
        "calibration {id} is on file with the same coefficients but other values, such as [validity]. Remove that \
         one, then add this one"
    )
}

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

/// The first 60 characters of a name, with `_` for each that is not an ASCII letter, a digit, `-` or `_`.
fn plain(name: &str) -> String {
    let allowed = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    name.chars().take(60).map(allowed).collect()
}
