//! Runs a chamber in its own thread, so that reading a sensor does not wait for the chamber.

use super::{Chamber, SafeEnd};
use crate::{DeviceError, Result, Stop};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Pause between two readings of the chamber.
const PERIOD: Duration = Duration::from_secs(5);

/// Period of the checks that the thread still runs.
const SLICE: Duration = Duration::from_millis(100);

/// A chamber in its own thread, which sets the first set point at once. Every 5 s, the thread sets a changed set point
/// and reads the chamber. [`Chamber::read_c`] returns the latest reading, and each reading once at most. The next call
/// of [`Chamber::start`], [`Chamber::set`] or [`Chamber::read_c`] returns a failure of the chamber.
pub struct ChamberThread {
    shared: Arc<SharedState>,
    halt: Stop,
    thread: Option<JoinHandle<Box<dyn Chamber>>>,
}

#[derive(Default)]
struct SharedState {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    started: bool,
    wanted_c: Option<f64>,
    air_c: Option<f64>,
    failed: Option<DeviceError>,
    ended: bool,
}

impl SharedState {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn serve(&self, chamber: &mut dyn Chamber) -> Result<()> {
        chamber.start()?;
        self.state().started = true;
        self.changed.notify_all();
        let mut told_c = None;
        loop {
            let (wanted_c, ended) = {
                let state = self.state();
                (state.wanted_c, state.ended)
            };
            if ended {
                return Ok(());
            }
            if let Some(temp_c) = wanted_c.filter(|_| wanted_c != told_c) {
                chamber.set(temp_c)?;
                told_c = wanted_c;
            }
            let air_c = chamber.read_c()?;
            let mut state = self.state();
            state.air_c = air_c;
            // the first set point and the end are handled at once
            let idle = |state: &mut State| !state.ended && (state.wanted_c == told_c || told_c.is_some());
            drop(self.changed.wait_timeout_while(state, PERIOD, idle).unwrap_or_else(PoisonError::into_inner));
        }
    }
}

impl ChamberThread {
    /// Starts the thread, which starts the chamber.
    pub fn new(mut chamber: Box<dyn Chamber>) -> Result<Self> {
        let shared = Arc::new(SharedState::default());
        let (inner, halt) = (shared.clone(), chamber.halt());
        let body = move || {
            if let Err(error) = inner.serve(chamber.as_mut()) {
                inner.state().failed = Some(error);
                inner.changed.notify_all();
            }
            chamber
        };
        let thread = thread::Builder::new().name("chamber".to_owned()).spawn(body).map_err(anyhow::Error::from)?;
        Ok(Self { shared, halt, thread: Some(thread) })
    }

    fn failure(&self) -> Result<()> {
        self.shared.state().failed.take().map_or(Ok(()), Err)
    }
}

impl Chamber for ChamberThread {
    /// Waits until the chamber has started or failed.
    fn start(&mut self) -> Result<()> {
        loop {
            let state = self.shared.state();
            if state.started || state.failed.is_some() || self.thread.as_ref().is_none_or(JoinHandle::is_finished) {
                break;
            }
            drop(self.shared.changed.wait_timeout(state, SLICE).unwrap_or_else(PoisonError::into_inner));
        }
        self.failure()
    }

    fn set(&mut self, temp_c: f64) -> Result<()> {
        self.failure()?;
        self.shared.state().wanted_c = Some(temp_c);
        self.shared.changed.notify_all();
        Ok(())
    }

    fn read_c(&mut self) -> Result<Option<f64>> {
        self.failure()?;
        Ok(self.shared.state().air_c.take())
    }

    fn halt(&self) -> Stop {
        self.halt.clone()
    }

    fn end(&mut self, safe_c: f64) -> Option<SafeEnd> {
        self.shared.state().ended = true;
        self.halt.ask();
        self.shared.changed.notify_all();
        match self.thread.take()?.join() {
            Ok(mut chamber) => chamber.end(safe_c),
            Err(_) => Some(SafeEnd { failed: Some("its thread ended by an error".to_owned()), air_c: None }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chamber whose `set` waits until the chamber is halted, or panics if `breaks` is true.
    struct Waiting {
        halt: Stop,
        breaks: bool,
    }

    impl Chamber for Waiting {
        fn set(&mut self, _: f64) -> Result<()> {
            assert!(!self.breaks, "it breaks");
            while !self.halt.asked() {
                thread::sleep(Duration::from_millis(1));
            }
            Err(anyhow::anyhow!("halted").into())
        }

        fn read_c(&mut self) -> Result<Option<f64>> {
            Ok(None)
        }

        fn halt(&self) -> Stop {
            self.halt.clone()
        }

        fn end(&mut self, _: f64) -> Option<SafeEnd> {
            Some(SafeEnd::default())
        }
    }

    fn end(breaks: bool) -> SafeEnd {
        let mut chamber = ChamberThread::new(Box::new(Waiting { halt: Stop::default(), breaks })).expect("a thread");
        chamber.start().expect("it starts");
        chamber.set(60.0).expect("nothing failed so far");
        thread::sleep(Duration::from_millis(20));
        chamber.end(25.0).expect("it was set")
    }

    #[test]
    fn a_chamber_that_waits_is_ended_and_a_thread_that_is_gone_is_reported() {
        assert_eq!(end(false), SafeEnd::default(), "it would wait for ever");
        assert!(end(true).failed.is_some(), "somebody has to look");
    }
}
