//! The protocol between a host and a bridge, which is a microcontroller with the part on its pins. This module has the
//! messages, their frames, the firmware's end without its pins ([`Station`]), and the host's end without its port and
//! clock ([`Client`]).
//!
//! The bytes are specified in `docs/formats/bridge.md` of the project. The host sends requests, and the bridge
//! answers. While the bridge samples, it sends every sample without a request. No sample is sent twice. A lost sample
//! shows in the numbers of the samples ([`WireSample`]), and [`Continuity`] counts it.
//!
//! A firmware passes bytes to a [`Decoder`], and the requests and the edges of RDY to a [`Station`]. It encodes
//! ([`encode`]) and sends the messages that the station returns. This example has both ends of the link. A firmware
//! would implement [`Bus`] for its own SPI controller:
//!
//! ```
//! use adis16130::bridge::{Answer, Command, Bus, Decoder, MAX_FRAME, Message, Request, Station, encode};
//! # use core::{convert::Infallible, future::Future, pin::pin, task::{Context, Poll, Waker}};
//! # use embedded_hal_async::spi::{ErrorType, Operation, SpiDevice};
//! # struct Spi(adis16130_twin::TwinSpi);
//! # impl ErrorType for Spi {
//! #     type Error = Infallible;
//! # }
//! # impl SpiDevice for Spi {
//! #     async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
//! #         SpiDevice::transaction(&mut self.0, operations).await
//! #     }
//! # }
//! # fn block_on<F: Future>(future: F) -> F::Output {
//! #     match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
//! #         Poll::Ready(output) => output,
//! #         Poll::Pending => unreachable!("the twin's futures are ready at once"),
//! #     }
//! # }
//! # let twin = adis16130_twin::Twin::new(adis16130_twin::Spec::from_seed(1));
//!
//! impl Bus for Spi {
//!     fn set_sclk_hz(&mut self, _hz: u32) -> u32 {
//!         5_000_000 // the only one that this controller has
//!     }
//! }
//!
//! // the host sends a request
//! let mut room = [0; MAX_FRAME];
//! let request = encode(&Request { tag: 7, command: Command::Hello }, &mut room)?;
//!
//! // the bridge answers
//! let mut station = Station::new(Spi(twin.spi()), 5_000_000, "example 1.0");
//! let (mut requests, mut room, mut answered) = (Decoder::new(), [0; MAX_FRAME], &[][..]);
//! for byte in request {
//!     if let Some(Ok(request)) = requests.push::<Request>(*byte) {
//!         answered = encode(&block_on(station.request(&request)), &mut room)?;
//!         break;
//!     }
//! }
//!
//! // the host understands
//! let (mut messages, mut count) = (Decoder::new(), 0);
//! for byte in answered {
//!     if let Some(Ok(message)) = messages.push::<Message>(*byte) {
//!         let hello = Answer::Hello { protocol: 2, firmware: "example 1.0", sclk_hz: 5_000_000 };
//!         assert_eq!(message, Message::Answer { tag: 7, answer: hello });
//!         count += 1;
//!     }
//! }
//! assert_eq!(count, 1);
//! # Ok::<(), adis16130::bridge::TooLong>(())
//! ```

mod client;
mod frame;
mod settings;
mod station;

pub use client::{Client, Event, Frame, GONE, Pending, RequestError, SILENT, Step};
pub use frame::{DamagedFrame, Decoder, MAX_FRAME, TooLong, encode};
pub use settings::Settings;
pub use station::{Bus, Station};

use crate::codes::{RateCode, TempCode, Width};
use crate::registers::ChannelStatus;
use crate::sample::Sample;
use core::fmt::{Display, Formatter, Result as Printed};
use serde::{Deserialize, Serialize};

/// Version of the protocol that this module speaks.
pub const PROTOCOL: u16 = 2;

/// Largest number of bytes of one [`Command::Transfer`]. All commands of the part are shorter.
pub const MAX_TRANSFER: usize = 8;

/// A message from the host to the bridge.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Request<'a> {
    /// A number that comes back with the answer.
    pub tag: u8,
    /// The command. A host that gets no answer may send any command again.
    #[serde(borrow)]
    pub command: Command<'a>,
}

/// The commands of a host.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Command<'a> {
    /// Ask for the protocol and the firmware.
    Hello,
    /// Set the SPI clock to this one, or to the next lower one that the bridge has, or else to its slowest one.
    Clock {
        /// The clock, Hz.
        sclk_hz: u32,
    },
    /// Exchange these bytes with the part in one frame of CS. Refused while the bridge samples.
    Transfer {
        /// The bytes, at most [`MAX_TRANSFER`].
        bytes: &'a [u8],
    },
    /// Ask for the last edge of RDY.
    LastEdge,
    /// Reset the part, initialise it with the settings of [`Command::Configure`] (F-30 by default), read the
    /// configuration back, then sample. If the bridge already samples, it begins anew.
    Start {
        /// The setting of [`SamplerConfig::every_temp`](crate::SamplerConfig::every_temp).
        every_temp: u16,
        /// The setting of [`SamplerConfig::divider`](crate::SamplerConfig::divider).
        divider: u16,
        /// The nominal master clock of the part, Hz.
        mclk_hz: u32,
    },
    /// Stop sampling, and release the self-test pin.
    Stop,
    /// Set how the next [`Command::Start`] configures the part, and how the part is wired. Ends sampling.
    Configure(Settings),
    /// Make the self-test pins active, or release them (F-11).
    SelfTest {
        /// Whether the pins are to be active.
        on: bool,
    },
    /// Tell the bridge that a counter in the RDY line lets every n-th edge through, from the next
    /// [`Command::Start`] to the next [`Command::Configure`]. Ends sampling. Answered by [`Answer::Configured`].
    Divided {
        /// The setting of [`SamplerConfig::divided`](crate::SamplerConfig::divided).
        edges: u16,
    },
}

/// A message from the bridge to the host.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Message<'a> {
    /// The answer to the request with this tag.
    Answer {
        /// The tag of the request.
        tag: u8,
        /// The content of the answer.
        #[serde(borrow)]
        answer: Answer<'a>,
    },
    /// A sample.
    Sample(WireSample),
    /// Sampling has ended, because the part no longer answers as it should. [`Command::Transfer`] can find the cause.
    Ended,
}

/// The answers of a bridge.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer<'a> {
    /// The answer to [`Command::Hello`].
    Hello {
        /// The version of the bridge's protocol, such as [`PROTOCOL`].
        protocol: u16,
        /// Name and version of the firmware, at most 24 bytes.
        firmware: &'a str,
        /// The SPI clock as it is set, Hz.
        sclk_hz: u32,
    },
    /// The answer to [`Command::Clock`].
    Clock {
        /// The clock as set now, Hz.
        sclk_hz: u32,
    },
    /// The answer to [`Command::Transfer`]: the bytes that the part sent, as many as the host sent.
    Transfer {
        /// Bytes from SDO.
        bytes: &'a [u8],
    },
    /// The answer to [`Command::LastEdge`]. All fields are zero before the first edge.
    LastEdge {
        /// Time of the edge, in ns of the bridge's clock.
        t_ns: u64,
        /// Running number of the edge.
        seq: u32,
    },
    /// The answer to [`Command::Start`].
    Started,
    /// The answer to [`Command::Stop`].
    Stopped,
    /// The request was not carried out.
    Refused(Refusal),
    /// The answer to [`Command::Configure`] and to [`Command::Divided`].
    Configured,
    /// The answer to [`Command::SelfTest`].
    SelfTest {
        /// Whether the pins are active now.
        on: bool,
    },
}

/// The reasons why a request was not carried out.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The bridge is sampling: stop first.
    Sampling,
    /// The bridge's SPI controller reports an error.
    Bus,
    /// The part did not take its configuration. [`Command::Transfer`] can find the cause.
    Part,
    /// A transfer of more than [`MAX_TRANSFER`] bytes.
    TooLong,
    /// The bridge has no such wire: no self-test pin, or no way to detect the requested edge of RDY.
    NoSuchWire,
}

impl Display for Refusal {
    fn fmt(&self, f: &mut Formatter<'_>) -> Printed {
        f.write_str(match self {
            Self::Sampling => "it is sampling",
            Self::Bus => "its SPI controller reports an error",
            Self::Part => {
                "the part did not take its configuration; check SPI wires (pins 8, 12, 14, 16) and supply (pins 11, \
                 13, 15)"
            }
            Self::TooLong => "the transfer is too long",
            Self::NoSuchWire => "it has no such wire",
        })
    }
}

/// A sample on the wire. Its codes are on the 24-bit scale: a 16-bit code times 256.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WireSample {
    /// Running number of the sample since [`Command::Start`], from 0.
    pub number: u32,
    /// Number of samples that the bridge has lost between [`Command::Start`] and this sample (F-33).
    pub lost: u32,
    /// Time of the edge that announced the sample, in ns of the bridge's clock.
    pub t_ns: u64,
    /// Running number of that edge.
    pub edge: u32,
    /// Code of the rate.
    pub rate: u32,
    /// Value of the rate channel's status register, if it was read.
    pub status: Option<u8>,
    /// Code of the temperature, if it was read.
    pub temp: Option<u32>,
}

impl WireSample {
    fn new(number: u32, lost: u32, sample: &Sample) -> Self {
        Self {
            number,
            lost,
            t_ns: sample.t_ns,
            edge: sample.seq,
            rate: sample.rate.code24(),
            status: sample.status.map(ChannelStatus::bits),
            temp: sample.temp.map(TempCode::code24),
        }
    }

    /// Number of samples since [`Command::Start`] before this one, lost or not.
    const fn position(&self) -> u32 {
        self.number.wrapping_add(self.lost)
    }
}

/// Converts wire samples to samples, and counts the losses between them: samples that the bridge lost, that did
/// not fit on the link, and that were damaged there. Make a new one with every [`Command::Start`].
#[derive(Clone, Debug)]
pub struct Continuity {
    width: Width,
    next_number: u32,
    next_position: u32,
    missing: u32,
}

impl Default for Continuity {
    fn default() -> Self {
        Self::new(Width::Bits24)
    }
}

impl Continuity {
    /// Starts counting. The converted samples have codes of this width.
    pub const fn new(width: Width) -> Self {
        Self { width, next_number: 0, next_position: 0, missing: 0 }
    }

    /// Converts a wire sample. `lost` of the sample counts all losses since the sample before.
    pub fn sample(&mut self, reading: &WireSample) -> Sample {
        let lost = reading.position().wrapping_sub(self.next_position);
        self.missing = self.missing.wrapping_add(reading.number.wrapping_sub(self.next_number));
        self.next_number = reading.number.wrapping_add(1);
        self.next_position = reading.position().wrapping_add(1);
        Sample {
            t_ns: reading.t_ns,
            seq: reading.edge,
            rate: RateCode::new(self.in_width(reading.rate), self.width),
            status: reading.status.map(ChannelStatus::new),
            temp: reading.temp.map(|code| TempCode::new(self.in_width(code), self.width)),
            lost,
        }
    }

    const fn in_width(&self, code24: u32) -> u32 {
        code24 >> self.width.dropped_bits()
    }

    /// Number of samples that the bridge took, but that never arrived.
    pub const fn missing(&self) -> u32 {
        self.missing
    }
}
