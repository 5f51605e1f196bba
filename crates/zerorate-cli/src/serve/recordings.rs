//! What is recorded while the page is served: one file from one opening of the device to its end.

use crate::output::{Outputs, say};
use crate::recorder::Recorder;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::thread::{self, JoinHandle};
use zerorate_data::capture::Format;
use zerorate_host::{Everything, Hub};

/// The recordings of a run. A device that was opened again begins another one: its time begins anew.
pub struct Recordings {
    path: Option<PathBuf>,
    outputs: Outputs,
    count: u32,
    running: Option<Running>,
}

struct Running {
    path: PathBuf,
    thread: JoinHandle<Result<u64>>,
}

impl Recordings {
    /// Into files named after this one; none: nothing is recorded.
    pub fn new(path: Option<PathBuf>, outputs: Outputs) -> Self {
        Self { path, outputs, count: 0, running: None }
    }

    /// Begins to record what a hub will read, in a thread of its own, which takes every sample.
    pub fn begin(&mut self, hub: &Hub) -> Result<()> {
        self.end()?;
        let Some(path) = &self.path else { return Ok(()) };
        self.count += 1;
        let path = numbered(path, self.count);
        let file = self.outputs.recording(&path)?;
        let (everything, info, name) = (hub.everything(), hub.facts().info.clone(), path.display().to_string());
        let (begun, waits) = channel();
        let body = move || {
            let recorder = Recorder::create(file, Format::choose(None, Path::new(&name)), &info)?;
            // whoever waits for that is still there
            let _ = begun.send(());
            record(&everything, recorder).context(name)
        };
        let thread =
            thread::Builder::new().name("recorder".to_owned()).spawn(body).context("starting the recorder")?;
        self.running = Some(Running { path, thread });
        // nothing is sent where it could not begin
        waits.recv().or_else(|_| self.end())
    }

    /// Why the recording has ended, if it failed.
    pub fn failure(&mut self) -> Option<anyhow::Error> {
        let is_over = self.running.as_ref().is_some_and(|running| running.thread.is_finished());
        if is_over { self.end().err() } else { None }
    }

    /// Waits for the end of the recording: what it records has ended.
    pub fn end(&mut self) -> Result<()> {
        let Some(Running { path, thread }) = self.running.take() else { return Ok(()) };
        let samples = thread.join().unwrap_or_else(|_| anyhow::bail!("{}: the recorder died", path.display()))?;
        say(format_args!("{}: {samples} samples", path.display()));
        Ok(())
    }
}

/// Records until the end, whatever that is: what there is until then is whole.
fn record(everything: &Everything, mut recorder: Recorder) -> Result<u64> {
    let mut written = Ok(());
    while let Ok(Some(batch)) = everything.next() {
        written = batch.rows.iter().try_for_each(|row| recorder.push(row));
        if written.is_err() {
            break;
        }
    }
    let summary = recorder.finish();
    written?;
    Ok(summary?.samples)
}

/// `unit.arrows`, `unit-2.arrows`, …
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
}
