//! The corrected rate of a device, row by row.

use crate::calibration::Calibration;
use crate::device::{Device, DeviceOptions, Duration, text};
use crate::worker::{OF_CALLER, Worker, warn};
use anyhow::anyhow;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Mutex, TryLockError};
use zerorate_host::Stop;
use zerorate_jobs::JobWarning;
use zerorate_jobs::output::Outputs;
use zerorate_jobs::stream::{LearnedAxis, Listener, StreamOptions, StreamRow, check_serial, period_ns, stream};

/// Number of rows that may wait for the program: 0.7 s at the full rate. After that, samples wait in the device's own
/// queue.
const ROWS: usize = 4096;

/// A message from the thread of a stream.
enum Item {
    /// The device is open, and has these axes.
    Open(Vec<String>),
    Row(StreamRow),
    Warning(String),
}

/// Sends rows to the program, and waits while the queue is full.
struct RowSender(SyncSender<Item>);

impl Listener for RowSender {
    fn row(&mut self, row: &StreamRow) -> anyhow::Result<()> {
        self.0.send(Item::Row(row.clone())).map_err(|_| anyhow!("the stream is closed"))
    }

    fn end(&mut self) -> anyhow::Result<()> {
        Ok(())
    }

    fn warn(&mut self, warning: JobWarning) {
        let _ = self.0.send(Item::Warning(text(warning)));
    }

    // both functions report a tracked bias, and this stream does not track the bias
    fn kept_again(&mut self, _: &Path) {}

    fn learned(&mut self, _: &LearnedAxis<'_>) {}
}

/// The corrected rate of a device.
#[pyclass(module = "zerorate._zerorate", frozen)]
pub struct Stream {
    #[pyo3(get)]
    axes: Vec<String>,
    stop: Stop,
    worker: Mutex<Option<Worker<Item, ()>>>,
}

/// Time, rates, temperature, lost samples and flags of a row.
type Row = (f64, Vec<f64>, f64, u64, String);

#[pymethods]
impl Stream {
    /// Opens the device and begins to read it.
    #[new]
    fn new(
        py: Python<'_>,
        device: DeviceOptions,
        calibration: &Calibration,
        serial: Option<String>,
        rate_hz: Option<f64>,
        duration: Option<Duration>,
    ) -> PyResult<Self> {
        let device = device.checked()?;
        let wrong = |hz| PyValueError::new_err(format!("rate_hz={hz}: give a number from 0.0001 to 1000000"));
        let options = StreamOptions {
            period_ns: rate_hz.map(|hz| period_ns(hz).ok_or_else(|| wrong(hz))).transpose()?,
            duration_ns: duration.map(|time| time.s("duration=")).transpose()?.map(|time| time.nanos()),
        };
        let known = calibration.known.clone();
        let work = move |stop: &Stop, tell| follow(&device, &known, serial.as_deref(), options, stop, tell);
        let mut worker = Worker::start(sync_channel(ROWS), work);
        let stop = worker.stop.clone();
        match next(&mut worker, py, OF_CALLER)? {
            Some(Item::Open(axes)) => Ok(Self { axes, stop, worker: Mutex::new(Some(worker)) }),
            _ => {
                worker.end(py)?;
                Err(PyRuntimeError::new_err("the stream ended before it began"))
            }
        }
    }

    /// The next row, or None at the end: the time, s, the rates, °/s (NaN without a good reading), the temperature,
    /// °C, the samples lost since the row before, and the faults of readings that were left out.
    ///
    /// Raises Refused if the part is frozen.
    fn next(&self, py: Python<'_>) -> PyResult<Option<Row>> {
        let mut held = match self.worker.try_lock() {
            Ok(held) => held,
            Err(TryLockError::Poisoned(held)) => held.into_inner(),
            Err(TryLockError::WouldBlock) => {
                return Err(PyRuntimeError::new_err("another thread reads this stream: open one for each"));
            }
        };
        let Some(worker) = held.as_mut() else { return Ok(None) };
        if let Some(Item::Row(StreamRow { t_s, rates_dps, temp_c, lost, flags, .. })) = next(worker, py, OF_ROW)? {
            let rates_dps = rates_dps.into_iter().map(|rate_dps| rate_dps.unwrap_or(f64::NAN)).collect();
            return Ok(Some((t_s, rates_dps, temp_c, lost, flags.to_string())));
        }
        held.take().map_or(Ok(()), |worker| worker.end(py))?;
        Ok(None)
    }

    /// Ends the stream. A thread that reads it meanwhile gets None.
    fn close(&self, py: Python<'_>) {
        self.stop.ask();
        let worker = self.worker.try_lock().ok().and_then(|mut held| held.take());
        // waits for the thread, which gives up a silent device after some seconds
        py.detach(move || drop(worker));
    }
}

/// Stack level, for warnings, of the user's line that calls `Stream.__next__`.
const OF_ROW: i32 = 2;

/// Waits for the next row or the opening. Raises warnings in Python for the line `calls` stack levels up.
fn next(worker: &mut Worker<Item, ()>, py: Python<'_>, calls: i32) -> PyResult<Option<Item>> {
    loop {
        match worker.wait(py)? {
            Ok(Item::Warning(text)) => warn(py, &text, calls)?,
            Ok(item) => return Ok(Some(item)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
}

fn follow(
    device: &Device,
    calibration: &zerorate::Calibration,
    serial: Option<&str>,
    options: StreamOptions,
    stop: &Stop,
    tell: SyncSender<Item>,
) -> anyhow::Result<()> {
    let of_device = tell.clone();
    let warn = move |text| drop(of_device.send(Item::Warning(text)));
    let acquisition = device.open(device.setup(&mut Outputs::without_force())?, stop, warn)?;
    let mut sender = RowSender(tell);
    let cal = format!("calibration {}", calibration.id());
    let name = device.spec.to_string();
    let warning = check_serial(&acquisition, (&cal, calibration), (&name, serial), "give serial=")?;
    warning.into_iter().for_each(|warning| sender.warn(warning));
    acquisition.initialise()?;
    let axes = acquisition.part().axes.iter().map(|axis| axis.name.to_string()).collect();
    let _ = sender.0.send(Item::Open(axes));
    stream(acquisition, calibration, options, None, &mut sender)
}
