//! Calibrations on disk: read at the start, and written when one was made. Names are made here, never taken from a
//! request.

use crate::output::{Outputs, say};
use anyhow::{Context, Result};
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use zerorate::Calibration;
use zerorate_web::session::Session;

/// A calibration file has no more bytes than this.
const MOST_BYTES: u64 = 1 << 20;

/// Where calibrations are kept; without a path, nowhere.
#[derive(Debug, Default)]
pub struct Folder {
    path: Option<PathBuf>,
    /// Ids that are there, or came from a file.
    known: HashSet<String>,
    /// Calibrations that were looked at.
    seen: usize,
}

impl Folder {
    /// Where calibrations that are made are to be kept.
    pub fn new(path: Option<PathBuf>) -> Self {
        Self { path, ..Self::default() }
    }

    /// Whether they are kept at all.
    pub fn is_there(&self) -> bool {
        self.path.is_some()
    }

    /// Puts all calibrations of the folder on file; those that cannot be read are named on stderr.
    ///
    /// # Errors
    /// The folder cannot be made or read.
    pub fn read(&mut self, session: &mut Session) -> Result<()> {
        let Some(folder) = &self.path else { return Ok(()) };
        let about = || format!("--folder {}", folder.display());
        fs::create_dir_all(folder).with_context(about)?;
        let entries = fs::read_dir(folder).with_context(about)?;
        let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
        files.sort();
        for file in files {
            match self.add(&file, session) {
                Ok(_) => {}
                Err(error) => say(format_args!("warning: {error:#}; it is left out")),
            }
        }
        Ok(())
    }

    /// Puts a calibration on file; its id.
    ///
    /// # Errors
    /// It cannot be read, or is no calibration.
    pub fn add(&mut self, path: &Path, session: &mut Session) -> Result<String> {
        let name = || path.display().to_string();
        let bytes = fs::metadata(path).with_context(|| format!("cannot read {}", name()))?.len();
        anyhow::ensure!(bytes <= MOST_BYTES, "{} is no calibration: it has {bytes} bytes", name());
        let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", name()))?;
        let id = session.add_calibration(&text).map_err(|why| anyhow::anyhow!("{}: {why}", name()))?;
        self.known.insert(id.clone());
        Ok(id)
    }

    /// Writes what came since, if there is a folder; what went wrong is said on stderr and on the page.
    pub fn keep(&mut self, session: &mut Session) {
        let count = session.calibrations().count();
        if std::mem::replace(&mut self.seen, count) == count {
            return;
        }
        let new: Vec<Calibration> =
            session.calibrations().filter(|calibration| !self.known.contains(&calibration.id())).cloned().collect();
        for calibration in new {
            let id = calibration.id();
            if let Some(folder) = &self.path {
                match write(folder, &id, &calibration.to_toml()) {
                    Ok(path) => say(format_args!("kept {}", path.display())),
                    Err(error) => {
                        let note = format!("not-kept: calibration {id} could not be written: {error:#}; download it");
                        say(format_args!("warning: {note}"));
                        session.note(&note);
                    }
                }
            }
            self.known.insert(id);
        }
    }
}

fn write(folder: &Path, id: &str, toml: &str) -> Result<PathBuf> {
    let path = folder.join(format!("calibration-{id}.toml"));
    Outputs::new(false).derived(&path)?.fill(toml.as_bytes())?;
    Ok(path)
}
