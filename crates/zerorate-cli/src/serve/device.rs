//! The device behind the page. It is opened and read, and opened again after it was disconnected or on request.

use super::connection::connection_checks;
use anyhow::Result;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use std::time::Duration;
use zerorate_host::{Bus, DeviceSpec, Hub, LosslessReader, Poll, Setup, Stop, WatchedBatch, Watcher};
use zerorate_record::CaptureInfo;
use zerorate_web::registers;
use zerorate_web::session::About;

/// The address of the device, and the settings for opening it.
#[derive(Clone, Debug)]
pub struct Opener {
    pub spec: DeviceSpec,
    pub setup: Setup,
    pub serial: Option<String>,
    /// Requests the end of the whole server, also while the device is being opened.
    pub stop: Stop,
}

/// A device that was opened, initialised and checked, but is not being read yet.
pub struct OpenDevice {
    pub hub: Arc<Hub>,
    pub about: About,
    pub bus: Option<Bus>,
}

impl Opener {
    /// Opens the device, and makes the checks of `zerorate probe` that need no samples.
    pub fn open(&self) -> Result<OpenDevice> {
        let hub = Hub::open(&self.spec, self.setup.clone(), &self.stop)?;
        let revision = hub.with(|source| source.initialise())?;
        let bus = hub.with(|source| source.try_bus())?;
        let registers = hub.with(|source| source.registers())?;
        let facts = hub.facts();
        let about = About {
            name: facts.name.clone(),
            info: CaptureInfo {
                serial: self.serial.clone().or_else(|| facts.info.serial.clone()),
                ..facts.info.clone()
            },
            part: facts.part.clone(),
            simulated: !facts.is_real,
            nominal_hz: facts.rate_hz,
            registers: registers.map_or_else(Vec::new, |read| registers::described(&read.config, &read.values)),
            checks: connection_checks(revision, bus),
        };
        Ok(OpenDevice { hub: Arc::new(hub), about, bus })
    }

    /// Opens the device in a separate thread, after dropping the previous hub `before`.
    pub fn open_again(&self, before: Option<Arc<Hub>>) -> Opening {
        let (opener, (tell, told)) = (self.clone(), channel());
        let body = move || {
            drop(before);
            // the receiver may have been dropped
            let _ = tell.send(opener.open());
        };
        // if no thread can be started, the channel is closed, which `ready` reports
        drop(thread::Builder::new().name("opening".to_owned()).spawn(body));
        Opening(told)
    }
}

pub struct Opening(Receiver<Result<OpenDevice>>);

impl Opening {
    /// `None` while the device is being opened.
    pub fn ready(&self) -> Option<Result<OpenDevice>> {
        match self.0.try_recv() {
            Ok(opened) => Some(opened),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(anyhow::anyhow!("cannot start a thread for the device"))),
        }
    }
}

/// How the session gets its samples: without loss, or without delaying a real part.
pub enum SampleFeed {
    /// Simulated or replayed time waits for the session.
    LosslessReader(LosslessReader),
    /// A real part does not wait. Samples that do not fit into the queue are missed, and counted.
    Watcher(Watcher),
}

/// Length of the queue for a real part, in batches of 20 ms: 20 s, so that only a session that hangs misses samples.
const PATIENCE: usize = 1024;

impl SampleFeed {
    /// Subscribes to the samples from now on.
    pub fn of(hub: &Hub) -> Self {
        if hub.facts().is_real { Self::Watcher(hub.watch(PATIENCE)) } else { Self::LosslessReader(hub.everything()) }
    }

    /// Waits for samples, for `patience` at most. After the last sample, the hub states why the samples ended.
    pub fn next_within(&self, patience: Duration) -> Poll<WatchedBatch> {
        match self {
            Self::LosslessReader(everything) => match everything.next_within(patience) {
                Ok(Poll::Samples(batch)) => Poll::Samples(WatchedBatch { batch, missed: 0, lost: 0 }),
                Ok(Poll::Nothing) => Poll::Nothing,
                Ok(Poll::End) | Err(_) => Poll::End,
            },
            Self::Watcher(watcher) => watcher.next_within(patience),
        }
    }
}
