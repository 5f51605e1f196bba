//! Runs work in a thread of its own, while the thread of Python listens to Ctrl-C.

use crate::error::exception;
use pyo3::exceptions::{PyRuntimeError, PyUserWarning};
use pyo3::prelude::*;
use std::ffi::CString;
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use zerorate_host::Stop;

/// Longest time until Ctrl-C is noticed, and between two reports of progress.
const PATIENCE: Duration = Duration::from_millis(100);

/// A thread that works with a device and runs no Python. Dropping the worker ends the thread.
pub struct Worker<E, T> {
    events: Option<Receiver<E>>,
    thread: Option<JoinHandle<anyhow::Result<T>>>,
    pub stop: Stop,
}

impl<E: Send + 'static, T: Send + 'static> Worker<E, T> {
    /// Starts the work, which reports its events through the sender of the channel.
    pub fn start<S: Send + 'static>(
        (tell, events): (S, Receiver<E>),
        work: impl FnOnce(&Stop, S) -> anyhow::Result<T> + Send + 'static,
    ) -> Self {
        let stop = Stop::default();
        let asked = stop.clone();
        let thread = thread::spawn(move || work(&asked, tell));
        Self { events: Some(events), thread: Some(thread), stop }
    }

    /// Waits a moment for the next event. Raises KeyboardInterrupt after Ctrl-C.
    pub fn wait(&mut self, py: Python<'_>) -> PyResult<Result<E, RecvTimeoutError>> {
        let Some(events) = &mut self.events else { return Ok(Err(RecvTimeoutError::Disconnected)) };
        if let Ok(event) = events.try_recv() {
            return Ok(Ok(event));
        }
        let heard = py.detach(move || events.recv_timeout(PATIENCE));
        py.check_signals()?;
        Ok(heard)
    }

    /// Waits for the end of the work, and returns its result. Call it when there are no more events.
    pub fn end(mut self, py: Python<'_>) -> PyResult<T> {
        let Some(thread) = self.thread.take() else { return Err(PyRuntimeError::new_err("the work has ended")) };
        let done = py.detach(|| thread.join()).unwrap_or_else(|panic| resume_unwind(panic));
        done.map_err(|error| exception(&error))
    }
}

impl<E, T> Drop for Worker<E, T> {
    fn drop(&mut self) {
        self.stop.ask();
        // a thread that waits for room in the channel must learn that nobody reads it
        self.events = None;
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Reports the warnings and the latest progress of the work to the thread of Python.
#[derive(Clone)]
pub struct Reporter {
    warnings: Sender<String>,
    latest: Latest,
}

#[derive(Clone, Default)]
struct Latest(Arc<Mutex<Option<Step>>>);

/// The step in words, the amount of work done, and the total amount.
type Step = (String, f64, f64);

impl Reporter {
    /// Passes on a warning. Has no effect after the work has ended.
    pub fn warn(&self, text: String) {
        let _ = self.warnings.send(text);
    }

    /// Replaces the progress. Never waits for the thread of Python.
    pub fn show(&self, step: String, done: f64, total: f64) {
        *self.latest.lock() = Some((step, done, total));
    }
}

impl Latest {
    fn lock(&self) -> MutexGuard<'_, Option<Step>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn take(&self) -> Option<Step> {
        self.lock().take()
    }
}

/// Does the work in a thread, and returns its result. Raises its warnings in Python, and calls `progress` with the
/// latest step at most ten times a second, and once at the end. Ctrl-C and an exception of `progress` end the work.
pub fn supervised<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Stop, Reporter) -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (warnings, heard) = channel();
    let latest = Latest::default();
    let mut worker = Worker::start((Reporter { warnings, latest: latest.clone() }, heard), work);
    match follow(py, progress, &latest, &mut worker) {
        Ok(()) => worker.end(py),
        Err(error) => {
            py.detach(move || drop(worker));
            Err(error)
        }
    }
}

fn follow<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    latest: &Latest,
    worker: &mut Worker<String, T>,
) -> PyResult<()> {
    loop {
        let event = worker.wait(py)?;
        // a warning ends the wait early
        if event.is_err()
            && let (Some(progress), Some(step)) = (progress, latest.take())
        {
            progress.call1(step)?;
        }
        match event {
            Ok(text) => warn(py, &text, OF_CALLER)?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

/// Stack level, for warnings, of the user's line that calls a function of the package through its keyword check.
pub const OF_CALLER: i32 = 3;

/// Raises a warning of Python for the line `calls` stack levels up.
pub fn warn(py: Python<'_>, text: &str, calls: i32) -> PyResult<()> {
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(text.replace('\0', " "))?, calls)
}
