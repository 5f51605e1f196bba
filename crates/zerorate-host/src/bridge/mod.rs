//! A part behind a bridge: a microcontroller that reads the part and streams its samples (docs/formats/bridge.md).

mod address;
mod link;
mod progress;

use crate::Stop;
use crate::address::Address;
use crate::connected::{ConnectedPart, Connection};
use crate::edges::Edges;
use crate::error::{Cause, UserError};
use crate::live::Live;
use crate::pin::HalError;
use crate::reader::{QUEUE, Reader, WhenFull};
use crate::source::{DeviceInfo, Setup, Source};
use crate::wire::Wire;
pub use address::BridgeAddress;
use adis16130::bridge::{Answer, Command, Continuity, Event, GONE, PROTOCOL, Refusal, RequestError, SILENT, Settings};
use adis16130::{Edge, Sample, SamplerConfig};
use anyhow::{Context, Result, anyhow, bail, ensure};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use link::{Link, LinkError};
use progress::Progress;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use zerorate::{Setting, SettingNames};

impl Address for BridgeAddress {
    /// Opens the port, stops a running measurement, checks the protocol, and sends the SPI clock and the part's
    /// settings.
    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> crate::Result<Box<dyn Source>> {
        let sampling = setup.sampling.config(self.part.divided);
        let facts = DeviceInfo::of_part(name, &self.part, sampling, self.mclk_hz, setup.part.as_ref())?;
        let link = SharedLink(Arc::new(Mutex::new(Link::new(Wire::open(&self.port)?))));
        greet(&link, self, setup.names).map_err(|error| link.explain(error, self))?;
        let edges = LastEdges { link: link.clone(), last: None };
        let live = Live::new(Transfers(link.clone()), edges, self.part.config, sampling, self.mclk_hz, stop);
        Ok(Box::new(ConnectedPart::new(BridgePart { address: self.clone(), link }, live, facts)))
    }
}

/// The part behind a bridge. Dropping this value stops the sampling.
struct BridgePart {
    address: BridgeAddress,
    link: SharedLink,
}

impl Connection for BridgePart {
    type Error = LinkError;
    type Spi = Transfers;
    type Edges = LastEdges;
    type Pin = SelfTestWire;

    const IS_BUS: bool = false;

    fn hz(&self) -> u32 {
        self.address.hz
    }

    fn set_clock(&self, hz: u32) -> Result<u32> {
        self.link.set_clock(hz)
    }

    fn self_test_pin(&self, gpio: &str, names: SettingNames) -> Result<SelfTestWire> {
        if !gpio.is_empty() {
            let why = "takes no GPIO with a bridge, whose firmware knows the pin";
            let option = names(Setting::SelfTest);
            return Err(UserError::request(format!("{option} {why}: leave `{gpio}` out")));
        }
        let pin = SelfTestWire(self.link.clone());
        match pin.set(false) {
            Err(LinkError::Request(RequestError::Refused(Refusal::NoSuchWire))) => {
                bail!(
                    "{} has no self-test pin: its firmware drives none (pins 1-7 and 9 of the part, F-11)",
                    self.address
                )
            }
            released => released.map_err(|error| self.link.explain(error, &self.address))?,
        }
        Ok(pin)
    }

    fn start(&self, live: Box<Live<Transfers, LastEdges>>) -> Result<Reader> {
        let SamplerConfig { every_temp, divider, .. } = live.sampling;
        let start = Command::Start { every_temp, divider, mclk_hz: self.address.mclk_hz };
        let started = self.link.request(start, Answer::Started.only());
        started.map_err(|error| self.link.explain(error, &self.address))?;
        let (link, address) = (self.link.clone(), self.address.clone());
        let continuity = Continuity::new(address.part.config.width());
        let mut stream = Stream { link: link.clone(), live, continuity, progress: Progress::default() };
        let next = move || stream.next().map_err(|error| link.explain(error, &address));
        Reader::start(QUEUE, WhenFull::Wait, || (), next)
    }

    fn explain(&self, error: anyhow::Error) -> anyhow::Error {
        self.link.explain(error, &self.address)
    }

    fn damaged(&self) -> u64 {
        self.link.lock().client.damaged
    }
}

impl Drop for BridgePart {
    fn drop(&mut self) {
        // nothing can be done about an error here
        let _ = self.link.request(Command::Stop, |_| Some(()));
    }
}

fn greet(link: &SharedLink, address: &BridgeAddress, names: SettingNames) -> Result<()> {
    link.request(Command::Stop, Answer::Stopped.only())?;
    let (protocol, firmware) = link.request(Command::Hello, |answer| match answer {
        Answer::Hello { protocol, firmware, .. } => Some((protocol, firmware.to_owned())),
        _ => None,
    })?;
    ensure!(
        protocol == PROTOCOL,
        "{address} is {firmware} and speaks version {protocol} of the protocol, this zerorate version {PROTOCOL}: \
         bring the older one up to date"
    );
    link.set_clock(address.hz)?;
    let settings = Command::Configure(Settings::from(&address.part.config));
    match link.request(settings, Answer::Configured.only()) {
        Err(LinkError::Request(RequestError::Refused(Refusal::NoSuchWire))) => bail!(
            "{address} is {firmware}, which cannot hear the edge of RDY that was asked for: leave edge= out, or bring \
             its firmware up to date"
        ),
        configured => configured?,
    }
    tell_divided(link, address, names)?;
    // the first frame after opening a port is often incomplete
    link.lock().client.damaged = 0;
    Ok(())
}

/// Tells the bridge that a counter divides the RDY signal. Sends nothing if there is no counter, because old firmware
/// does not know the command.
fn tell_divided(link: &SharedLink, address: &BridgeAddress, names: SettingNames) -> Result<()> {
    let edges = address.part.divided;
    if edges == 1 {
        return Ok(());
    }
    match link.request(Command::Divided { edges }, Answer::Configured.only()) {
        Err(LinkError::Request(RequestError::Silent)) => bail!(
            "{address} does not know of a counter in the line of RDY (divided={edges}): \
             bring its firmware up to date, or connect RDY itself and use {} {edges}",
            names(Setting::Divider)
        ),
        told => Ok(told?),
    }
}

struct Stream {
    link: SharedLink,
    live: Box<Live<Transfers, LastEdges>>,
    continuity: Continuity,
    progress: Progress,
}

impl Stream {
    /// Returns the next sample, or an error if sampling ended or no sample came within [`Live::silence_ns`].
    fn next(&mut self) -> Result<Sample> {
        let asked = Instant::now();
        let deadline = asked + Duration::from_nanos(self.live.silence_ns());
        while Instant::now() < deadline {
            match self.link.lock().next_event(deadline)? {
                Some(Event::Sample(reading)) => {
                    self.progress.require(reading.t_ns, asked.elapsed())?;
                    return Ok(self.continuity.sample(&reading));
                }
                // a second answer to a request that was sent twice
                Some(Event::Answer) => {}
                Some(Event::Ended) | None => break,
            }
        }
        self.link.request(Command::Stop, Answer::Stopped.only())?;
        Err(self.live.why_silent())
    }
}

#[derive(Clone)]
struct SharedLink(Arc<Mutex<Link>>);

impl SharedLink {
    fn lock(&self) -> std::sync::MutexGuard<'_, Link> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn request<T>(&self, command: Command<'_>, take: impl Fn(Answer<'_>) -> Option<T>) -> Result<T, LinkError> {
        self.lock().request(command, take)
    }

    fn set_clock(&self, sclk_hz: u32) -> Result<u32> {
        let set = self.request(Command::Clock { sclk_hz }, |answer| match answer {
            Answer::Clock { sclk_hz } => Some(sclk_hz),
            _ => None,
        });
        set.context("setting the SPI clock of the bridge")
    }

    /// Returns an error with the cause `Gone` or `Silent` if the bridge is gone or silent, and else `error` unchanged.
    fn explain(&self, error: impl Into<anyhow::Error>, address: &BridgeAddress) -> anyhow::Error {
        let error = error.into();
        match self.lock().gone.clone() {
            Some(why) => anyhow!(why).context(UserError::new(Cause::Gone, format!("{address} {GONE}"))),
            None if error
                .chain()
                .any(|cause| matches!(cause.downcast_ref(), Some(LinkError::Request(RequestError::Silent)))) =>
            {
                error.context(UserError::new(Cause::Silent, format!("{address} {SILENT}")))
            }
            None => error,
        }
    }
}

/// The SPI bus behind the bridge. Each write and each transfer in place is one request to the bridge.
struct Transfers(SharedLink);

impl ErrorType for Transfers {
    type Error = LinkError;
}

impl SpiDevice for Transfers {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), LinkError> {
        for operation in operations {
            match operation {
                Operation::TransferInPlace(bytes) => {
                    let received = self.exchange(bytes)?;
                    bytes.copy_from_slice(&received);
                }
                Operation::Write(bytes) => drop(self.exchange(bytes)?),
                // the driver uses neither of these operations
                Operation::Read(_) | Operation::Transfer(..) => return Err(RequestError::Unsupported.into()),
                Operation::DelayNs(ns) => std::thread::sleep(Duration::from_nanos((*ns).into())),
            }
        }
        Ok(())
    }
}

impl Transfers {
    fn exchange(&self, bytes: &[u8]) -> Result<Vec<u8>, LinkError> {
        self.0.request(Command::Transfer { bytes }, |answer| match answer {
            Answer::Transfer { bytes: received } if received.len() == bytes.len() => Some(received.to_owned()),
            _ => None,
        })
    }
}

/// The self-test pins of the bridge. The bridge releases them by itself when the host is gone.
struct SelfTestWire(SharedLink);

impl SelfTestWire {
    fn set(&self, on: bool) -> Result<(), LinkError> {
        self.0.request(Command::SelfTest { on }, Answer::SelfTest { on }.only())
    }
}

impl digital::ErrorType for SelfTestWire {
    type Error = HalError;
}

impl OutputPin for SelfTestWire {
    fn set_low(&mut self) -> Result<(), HalError> {
        self.set(false).map_err(HalError::new)
    }

    fn set_high(&mut self) -> Result<(), HalError> {
        self.set(true).map_err(HalError::new)
    }
}

/// The RDY edges that the bridge reports while it does not sample.
struct LastEdges {
    link: SharedLink,
    last: Option<Edge>,
}

impl Edges for LastEdges {
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>> {
        let deadline = Instant::now() + Duration::from_nanos(timeout_ns);
        loop {
            let edge = self.link.request(Command::LastEdge, |answer| match answer {
                Answer::LastEdge { t_ns, seq } => Some(Edge { t_ns, seq }),
                _ => None,
            })?;
            match self.last.replace(edge) {
                Some(last) if last.seq != edge.seq => return Ok(Some(edge)),
                _ if Instant::now() >= deadline => return Ok(None),
                _ => {}
            }
        }
    }

    fn now(&self) -> String {
        let t_ns = self.last.map_or(0, |edge| edge.t_ns);
        format!("{:.1} s on the bridge's clock", t_ns as f64 * 1e-9)
    }
}
