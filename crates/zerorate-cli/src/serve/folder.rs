//! The calibrations on disk: read at the start, and written when the page makes one. This module makes the file
//! names; they are never taken from a request.

use crate::output::{Outputs, say, warn};
use crate::wording::text;
use anyhow::{Context, Result, ensure};
use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use zerorate::Calibration;
use zerorate_input::limits;
use zerorate_view::SessionWarning;
use zerorate_web::session::{NoticeText, Session};

/// The folder with the calibrations. Without a path, no calibration is saved.
#[derive(Debug, Default)]
pub struct Folder {
    pub path: Option<PathBuf>,
    /// Ids of calibrations that are not written again: they came from a file, or a write was tried before.
    known: HashSet<String>,
    /// The files in the folder, by the id of their calibration.
    files: HashMap<String, Vec<PathBuf>>,
    /// The session's count of changes when the folder was last brought up to date.
    seen: u64,
}

impl Folder {
    pub fn new(path: Option<PathBuf>) -> Self {
        Self { path, ..Self::default() }
    }

    /// Stores all calibrations of the folder in the session. Prints the names of files that cannot be read.
    pub fn read(&mut self, session: &mut Session) -> Result<()> {
        let Some(folder) = &self.path else { return Ok(()) };
        let about = || format!("--folder {}", folder.display());
        ensure!(!folder.is_file(), "{}: it is a file, not a folder", about());
        fs::create_dir_all(folder).with_context(about)?;
        let entries = fs::read_dir(folder).with_context(about)?;
        let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
        files.sort();
        for file in files {
            match self.add(&file, session) {
                Ok(id) => self.files.entry(id).or_default().push(file),
                Err(error) => warn(&[NoticeText::from(SessionWarning::LeftOut(text(&error)))]),
            }
        }
        Ok(())
    }

    /// Stores a calibration from a file in the session, and returns its id.
    pub fn add(&mut self, path: &Path, session: &mut Session) -> Result<String> {
        let name = || path.display().to_string();
        let toml = Outputs::without_force().text(path, limits::TEXT)?;
        let id = session.add_calibration(&toml).map_err(|why| anyhow::anyhow!("{}: {why}", name()))?;
        self.known.insert(id.clone());
        Ok(id)
    }

    /// Writes new calibrations, if there is a folder, and renames the files of removed calibrations. Failures are
    /// reported on stderr and on the page.
    pub fn keep(&mut self, session: &mut Session) {
        let changes = session.store_changes();
        if std::mem::replace(&mut self.seen, changes) == changes {
            return;
        }
        self.put_away(session);
        let new: Vec<Calibration> =
            session.calibrations().filter(|calibration| !self.known.contains(&calibration.id())).cloned().collect();
        for calibration in new {
            let id = calibration.id();
            if let Some(folder) = &self.path {
                match write(folder, &id, &calibration.to_toml()) {
                    Ok(path) => {
                        say(format_args!("kept {}", path.display()));
                        self.files.entry(id.clone()).or_default().push(path);
                    }
                    Err(error) => tell(session, SessionWarning::NotKept { id: id.clone(), why: text(&error) }),
                }
            }
            self.known.insert(id);
        }
    }

    /// Renames the files of removed calibrations, so that they are not read at the next start.
    fn put_away(&mut self, session: &mut Session) {
        let on_file: HashSet<String> = session.calibrations().map(Calibration::id).collect();
        let removed: Vec<String> = self.known.difference(&on_file).cloned().collect();
        for id in removed {
            self.known.remove(&id);
            for file in self.files.remove(&id).into_iter().flatten() {
                match rename(&file, &id) {
                    Ok(removed) => {
                        let note = format!("Calibration {id} was removed; its file is {} now.", removed.display());
                        say(&note);
                        session.note(NoticeText::plain(note));
                    }
                    Err(error) => tell(session, SessionWarning::NotRemoved { id: id.clone(), why: text(&error) }),
                }
            }
        }
    }
}

/// Reports a warning on stderr and on the page.
pub fn tell(session: &mut Session, warning: SessionWarning) {
    let notice = NoticeText::from(warning);
    warn(&[&notice]);
    session.note(notice);
}

/// Renames a file so that it is not read again. No file is deleted.
fn rename(file: &Path, id: &str) -> Result<PathBuf> {
    let mut names = (1..=MOST_REMOVED).map(|count| file.with_extension(removed_ending(id, count)));
    let free = names.find(|path| path.symlink_metadata().is_err());
    let removed = free.with_context(|| format!("{MOST_REMOVED} files of it were removed already: delete some"))?;
    fs::rename(file, &removed).with_context(|| format!("cannot rename {}", file.display()))?;
    Ok(removed)
}

/// Largest number of removed files with one id.
const MOST_REMOVED: u32 = 1000;

/// The extension of a removed file. Later removed files of the same id get a number.
fn removed_ending(id: &str, count: u32) -> String {
    match count {
        1 => format!("toml.removed-{id}"),
        _ => format!("toml.removed-{id}-{count}"),
    }
}

fn write(folder: &Path, id: &str, toml: &str) -> Result<PathBuf> {
    let path = folder.join(format!("calibration-{id}.toml"));
    Outputs::without_force().derived(&path)?.fill(toml.as_bytes())?;
    Ok(path)
}
