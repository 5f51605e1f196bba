//! The device behind the page: opened, read, and opened again where it was unplugged or somebody asks for it.

use super::connection::connection_checks;
use anyhow::Result;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use std::time::Duration;
use zerorate_host::{Awaited, Batch, Bus, DeviceError, DeviceSpec, Hub, LosslessReader, Pace, Setup, Stop, Watcher};
use zerorate_record::CaptureInfo;
use zerorate_web::registers;
use zerorate_web::session::About;

/// Which device, and how it is read.
#[derive(Clone, Debug)]
pub struct Opener {
    /// Which.
    pub spec: DeviceSpec,
    /// How.
    pub setup: Setup,
    /// Serial number of the part, where somebody said it.
    pub serial: Option<String>,
    /// The wish that all ends.
    pub stop: Stop,
}

/// A device that was opened, initialised and looked at, and is not read yet.
pub struct Opened {
    pub hub: Arc<Hub>,
    pub about: About,
    pub bus: Option<Bus>,
}

impl Opener {
    /// Opens the device and looks at it as `zerorate probe` does.
    pub fn open(&self) -> Result<Opened> {
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
        Ok(Opened { hub: Arc::new(hub), about, bus })
    }

    /// The same in a thread of its own, after `before` has been let go.
    pub fn open_again(&self, before: Option<Arc<Hub>>) -> Opening {
        let (opener, (tell, told)) = (self.clone(), channel());
        let body = move || {
            drop(before);
            // who asked may be gone
            let _ = tell.send(opener.open());
        };
        // where there is no thread to be had, the channel is closed
        drop(thread::Builder::new().name("opening".to_owned()).spawn(body));
        Opening(told)
    }
}

/// A device that is being opened.
pub struct Opening(Receiver<Result<Opened>>);

impl Opening {
    /// What became of it, once that is known.
    pub fn ready(&self) -> Option<Result<Opened>> {
        match self.0.try_recv() {
            Ok(opened) => Some(opened),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(anyhow::anyhow!("there is no thread to open the device in"))),
        }
    }
}

/// Samples for the session: all there are, unless it were to keep a real part waiting.
pub enum Feed {
    /// Simulated and recorded time waits for the session.
    LosslessReader(LosslessReader),
    /// A real part does not: what does not fit into this queue is missed, and counted.
    Patient(Watcher),
}

/// Batches of 20 ms that wait for the session of a real part: 20 s, so that only a session that hangs misses any.
const PATIENCE: usize = 1024;

/// What a feed gives.
pub struct Fed {
    pub batch: Arc<Batch>,
    /// Samples before it that were missed.
    pub missed: u64,
}

impl Feed {
    /// From here on.
    pub fn of(hub: &Hub) -> Self {
        if hub.facts().is_real { Self::Patient(hub.watch(PATIENCE)) } else { Self::LosslessReader(hub.everything()) }
    }

    /// What comes within this time. Why there is no more tells the hub.
    pub fn next_within(&self, patience: Duration) -> Awaited<Fed> {
        match self {
            Self::LosslessReader(everything) => match everything.next_within(patience) {
                Ok(Awaited::Samples(batch)) => Awaited::Samples(Fed { batch, missed: 0 }),
                Ok(Awaited::Nothing) => Awaited::Nothing,
                Ok(Awaited::End) | Err(_) => Awaited::End,
            },
            Self::Patient(watcher) => match watcher.next_within(patience) {
                Awaited::Samples(watched) => Awaited::Samples(Fed { batch: watched.batch, missed: watched.missed }),
                Awaited::Nothing => Awaited::Nothing,
                Awaited::End => Awaited::End,
            },
        }
    }
}

/// Begins to read at a speed.
pub fn begin(hub: &Hub, speed: f64) -> Result<(), DeviceError> {
    hub.read(Pace::RealTime, Vec::new())?;
    hub.speed().set(speed);
    Ok(())
}
