//! The firmware's end of the link, without its pins: it handles requests, and edges of RDY.

use super::{Answer, Command, MAX_TRANSFER, Message, PROTOCOL, Refusal, Request, Settings, WireSample};
use crate::asynch::Adis16130;
use crate::config::{Config, RdyEdge};
use crate::error::{InitError, SampleError};
use crate::frame::Framing;
use crate::sample::Edge;
use crate::sampler::{Sampler, SamplerConfig};
use embedded_hal_async::spi::SpiDevice;

/// The part's bus, whose clock can be set.
pub trait Bus: SpiDevice {
    /// Sets the fastest clock up to `hz` that the bus has, or else its slowest one. Returns the clock in Hz.
    fn set_sclk_hz(&mut self, hz: u32) -> u32;

    /// Sets the kind of edges that mean "new data" from now on (F-32). Returns whether the bridge can detect them.
    /// The default detects falling edges only.
    fn set_rdy_edge(&mut self, edge: RdyEdge) -> bool {
        matches!(edge, RdyEdge::Falling)
    }

    /// Makes the self-test pins active, or releases them (F-11). Returns whether there are such pins: by default not.
    fn set_self_test(&mut self, _on: bool) -> bool {
        false
    }
}

/// A bridge without its pins: the driver on a bus, and the state of sampling.
#[derive(Debug)]
pub struct Station<S> {
    part: Adis16130<S, ()>,
    firmware: &'static str,
    sclk_hz: u32,
    last: Edge,
    sampling: Option<Sampling>,
    /// Divisor n of a counter in the RDY line, which lets every n-th edge through. 1 = no counter.
    divided: u16,
    received: [u8; MAX_TRANSFER],
}

#[derive(Debug)]
struct Sampling {
    sampler: Sampler,
    number: u32,
    lost: u32,
}

impl<S: Bus> Station<S> {
    /// Makes a bridge on a bus whose clock is `sclk_hz`. `firmware` is the name and version of the firmware, at most
    /// 24 bytes. Sends nothing.
    pub const fn new(bus: S, sclk_hz: u32, firmware: &'static str) -> Self {
        let part = Adis16130::new(bus, (), Config::new().with_framing(Framing::Command));
        let last = Edge { t_ns: 0, seq: 0 };
        Self { part, firmware, sclk_hz, last, sampling: None, divided: 1, received: [0; MAX_TRANSFER] }
    }

    /// Whether the bridge samples.
    pub const fn is_sampling(&self) -> bool {
        self.sampling.is_some()
    }

    /// Ends sampling and releases the self-test pin. Call it when the host is gone.
    pub fn stop(&mut self) {
        self.sampling = None;
        self.part.bus_mut().set_self_test(false);
    }

    /// Carries out a request, and returns the answer.
    pub async fn request(&mut self, request: &Request<'_>) -> Message<'_> {
        let tag = request.tag;
        let answer = match request.command {
            Command::Hello => Answer::Hello { protocol: PROTOCOL, firmware: self.firmware, sclk_hz: self.sclk_hz },
            Command::Clock { sclk_hz } => {
                self.sclk_hz = self.part.bus_mut().set_sclk_hz(sclk_hz);
                Answer::Clock { sclk_hz: self.sclk_hz }
            }
            Command::Transfer { bytes } => {
                self.transfer(bytes).await.map_or_else(Answer::Refused, |bytes| Answer::Transfer { bytes })
            }
            Command::LastEdge => Answer::LastEdge { t_ns: self.last.t_ns, seq: self.last.seq },
            Command::Start { every_temp, divider, mclk_hz } => {
                let sampling = SamplerConfig::new().with_every_temp(every_temp).with_divider(divider);
                let sampling = sampling.with_divided(self.divided);
                self.start(sampling, mclk_hz).await.map_or_else(Answer::Refused, |()| Answer::Started)
            }
            Command::Stop => {
                self.stop();
                Answer::Stopped
            }
            Command::Configure(settings) => self.configure(settings),
            Command::Divided { edges } => {
                self.stop();
                self.divided = edges;
                Answer::Configured
            }
            Command::SelfTest { on } if self.part.bus_mut().set_self_test(on) => Answer::SelfTest { on },
            Command::SelfTest { .. } => Answer::Refused(Refusal::NoSuchWire),
        };
        Message::Answer { tag, answer }
    }

    /// Takes an edge of RDY. Returns the message to send, if any. Pass every edge, also if the bridge does not sample.
    pub async fn edge(&mut self, edge: Edge) -> Option<Message<'static>> {
        self.last = edge;
        let sampling = self.sampling.as_mut()?;
        match self.part.sample(&mut sampling.sampler, edge).await {
            Ok(sample) => sample.map(|sample| Message::Sample(sampling.reading(&sample))),
            // a failed read whose cause is gone is a lost sample, which the sampler counts
            Err(SampleError::Bus(_)) if self.part.restart().await.is_ok() => {
                sampling.sampler.restarted();
                None
            }
            Err(_) if matches!(self.part.diagnose().await, Ok(None)) => None,
            Err(_) => {
                self.stop();
                Some(Message::Ended)
            }
        }
    }

    fn configure(&mut self, settings: Settings) -> Answer<'static> {
        self.stop();
        self.divided = 1;
        let config = Config::from(settings);
        if !self.part.bus_mut().set_rdy_edge(config.rdy_edge()) {
            return Answer::Refused(Refusal::NoSuchWire);
        }
        self.part.set_config(config);
        Answer::Configured
    }

    async fn transfer(&mut self, bytes: &[u8]) -> Result<&[u8], Refusal> {
        if self.is_sampling() {
            return Err(Refusal::Sampling);
        }
        let exchanged = self.received.get_mut(..bytes.len()).ok_or(Refusal::TooLong)?;
        exchanged.copy_from_slice(bytes);
        self.part.bus_mut().transfer_in_place(exchanged).await.map_err(|_| Refusal::Bus)?;
        Ok(exchanged)
    }

    async fn start(&mut self, sampling: SamplerConfig, mclk_hz: u32) -> Result<(), Refusal> {
        self.stop();
        self.part.restart().await.map_err(|error| match error {
            InitError::Bus(_) => Refusal::Bus,
            InitError::Verify(_) => Refusal::Part,
        })?;
        let sampler = Sampler::new(sampling, self.part.config(), mclk_hz.max(1));
        self.sampling = Some(Sampling { sampler, number: 0, lost: 0 });
        Ok(())
    }
}

impl Sampling {
    fn reading(&mut self, sample: &crate::sample::Sample) -> WireSample {
        self.lost = self.lost.wrapping_add(sample.lost);
        let reading = WireSample::new(self.number, self.lost, sample);
        self.number = self.number.wrapping_add(1);
        reading
    }
}
