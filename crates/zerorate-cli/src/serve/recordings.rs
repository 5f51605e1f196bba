//! Records while the page is served. A new file is started each time the device is opened and delivers samples.

use crate::output::{Outputs, say};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use zerorate_host::{Batch, Hub, LosslessReader};
use zerorate_jobs::Recorder;
use zerorate_jobs::output::{OutputError, Recording};
use zerorate_record::{CaptureInfo, Format};

/// The recordings of a run. When the device is opened again, its time restarts, so another recording is started.
pub struct Recordings {
    files: Option<Arc<Mutex<Files>>>,
    running: Option<JoinHandle<Result<()>>>,
}

impl Recordings {
    /// Records into files named after `path`; with `None`, records nothing.
    pub fn new(path: Option<PathBuf>, outputs: Outputs) -> Self {
        let files = path.map(|path| Arc::new(Mutex::new(Files { path, outputs, count: 0 })));
        Self { files, running: None }
    }

    /// Starts to record all samples of a hub, in a separate thread. The first file is created at once, so that a
    /// user who cannot record learns that immediately. Later files are created with their first samples, because a
    /// broken part may be opened again and again without giving samples. `info` is the description of the capture.
    pub fn begin(&mut self, hub: &Hub, info: &CaptureInfo) -> Result<()> {
        self.end()?;
        let Some(files) = &self.files else { return Ok(()) };
        let first = lock(files).first()?;
        let (everything, files) = (hub.everything(), Arc::clone(files));
        let info = info.clone();
        let (begun, waits) = channel();
        let body = move || {
            let mut open = first.map(|file| OpenRecording::create(file, &info)).transpose()?;
            // tells the waiting `begin` that the first file is there
            let _ = begun.send(());
            while let Ok(Some(batch)) = everything.next() {
                if batch.rows.is_empty() {
                    continue;
                }
                let into = match open.take() {
                    Some(open) => open,
                    None => OpenRecording::create(lock(&files).next()?, &info)?,
                };
                return into.record(&batch, &everything);
            }
            open.map_or(Ok(()), OpenRecording::finish)
        };
        let thread =
            thread::Builder::new().name("recorder".to_owned()).spawn(body).context("starting the recorder")?;
        self.running = Some(thread);
        // if the file cannot be created, the thread drops the sender, and `end` returns the error
        waits.recv().or_else(|_| self.end())
    }

    /// The error that ended the recording, if it failed.
    pub fn failure(&mut self) -> Option<anyhow::Error> {
        let is_over = self.running.as_ref().is_some_and(JoinHandle::is_finished);
        if is_over { self.end().err() } else { None }
    }

    /// Waits for the end of the recording. The device must have ended before this call.
    pub fn end(&mut self) -> Result<()> {
        let Some(thread) = self.running.take() else { return Ok(()) };
        thread.join().unwrap_or_else(|_| anyhow::bail!("the recorder died"))
    }
}

fn lock(files: &Mutex<Files>) -> std::sync::MutexGuard<'_, Files> {
    files.lock().unwrap_or_else(PoisonError::into_inner)
}

struct Files {
    path: PathBuf,
    outputs: Outputs,
    /// The number of the last file that was created or skipped.
    count: u32,
}

impl Files {
    fn first(&mut self) -> Result<Option<Recording>> {
        if self.count == 0 { self.next().map(Some) } else { Ok(None) }
    }

    /// Creates the next file. Numbered files of an earlier run are skipped and not changed.
    fn next(&mut self) -> Result<Recording> {
        // checks the format before anything is created
        Format::choose(None, &self.path)?;
        loop {
            self.count += 1;
            match self.outputs.recording(&numbered(&self.path, self.count)) {
                Err(OutputError::Exists { .. }) if self.count > 1 => {}
                open => return Ok(open?),
            }
        }
    }
}

struct OpenRecording {
    name: String,
    recorder: Recorder,
}

impl OpenRecording {
    fn create(file: Recording, info: &CaptureInfo) -> Result<Self> {
        let path = file.path().to_owned();
        let recorder = Recorder::create(file, Format::choose(None, &path)?, info)?;
        Ok(Self { name: path.display().to_string(), recorder })
    }

    /// Records until the end or an error. The file is completed with the samples up to then.
    fn record(mut self, first: &Batch, more: &LosslessReader) -> Result<()> {
        let mut written = self.push(first);
        while written.is_ok() {
            let Ok(Some(batch)) = more.next() else { break };
            written = self.push(&batch);
        }
        let finished = self.finish();
        written.and(finished)
    }

    fn push(&mut self, batch: &Batch) -> Result<()> {
        batch.rows.iter().try_for_each(|row| self.recorder.push(row)).with_context(|| self.name.clone())
    }

    fn finish(self) -> Result<()> {
        let Self { name, recorder } = self;
        let samples = recorder.finish().with_context(|| name.clone())?.samples;
        say(format_args!("{name}: {samples} samples"));
        Ok(())
    }
}

/// The path of a numbered file: `unit.arrows`, `unit-2.arrows`, …
fn numbered(path: &Path, count: u32) -> PathBuf {
    if count == 1 {
        return path.to_owned();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().map_or(String::new(), |ending| format!(".{}", ending.to_string_lossy()));
    path.with_file_name(format!("{stem}-{count}{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_opening_has_a_name_of_its_own() {
        let name = |count| numbered(Path::new("a/unit.7.arrows"), count);
        assert_eq!([name(1), name(2)], [Path::new("a/unit.7.arrows"), Path::new("a/unit.7-2.arrows")]);
        assert_eq!(numbered(Path::new("unit"), 3), Path::new("unit-3"));
    }

    #[test]
    fn files_of_an_earlier_run_are_skipped() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for left in ["unit-2.arrows", "unit-3.arrows"] {
            std::fs::write(path(left), "left").unwrap();
        }
        let files = |first: &str| Files { path: path(first), outputs: Outputs::new(false), count: 0 };
        let mut own = files("unit.arrows");
        assert_eq!(own.first().unwrap().unwrap().path(), path("unit.arrows"));
        assert!(own.first().unwrap().is_none(), "it was made");
        assert_eq!(own.next().unwrap().path(), path("unit-4.arrows"));
        assert_eq!(std::fs::read(path("unit-3.arrows")).unwrap(), b"left");
        assert!(files("unit-2.arrows").first().is_err(), "the one that was asked for is another matter");
    }
}
