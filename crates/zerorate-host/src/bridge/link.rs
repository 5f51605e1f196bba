//! Requests, answers and samples over a wire.

use crate::wire::Wire;
use adis16130::Edge;
use adis16130::bridge::{Answer, Ask, Decoder, MAX_FRAME, Message, Refusal, Request, WireSample, encode};
use embedded_hal::spi::ErrorKind;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// A bridge answers within this.
const ANSWER: Duration = Duration::from_millis(500);
/// So often a request is sent before the bridge counts as silent.
const ATTEMPTS: u32 = 3;

/// Something that the bridge says.
pub enum Heard {
    /// With the tag of its request.
    Answer(u8, Reply),
    Sample(WireSample),
    Ended,
}

/// An answer that owns what it says.
pub enum Reply {
    Hello { protocol: u16, firmware: String },
    Clock { sclk_hz: u32 },
    Transfer(Vec<u8>),
    LastEdge(Edge),
    Started,
    Stopped,
    Refused(Refusal),
    Configured,
    SelfTest { on: bool },
}

/// Why a request failed.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    #[error("the connection to the bridge ended")]
    Gone,
    #[error("the bridge did not answer within {} s", (ANSWER * ATTEMPTS).as_secs_f32())]
    Silent,
    #[error("the bridge refused: {0}")]
    Refused(Refusal),
    #[error("the bridge cannot do this transfer")]
    Unsupported,
}

impl embedded_hal::spi::Error for LinkError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// The connection to a bridge.
pub struct Link {
    wire: Wire,
    decoder: Decoder,
    received: VecDeque<u8>,
    tag: u8,
    damaged: u64,
    gone: Option<String>,
}

impl Link {
    pub fn new(wire: Wire) -> Self {
        Self { wire, decoder: Decoder::new(), received: VecDeque::new(), tag: 0, damaged: 0, gone: None }
    }

    /// Sends a request until it is answered. Samples that come meanwhile are dropped: what is asked for ends sampling,
    /// or begins it.
    pub fn ask<T>(&mut self, ask: Ask<'_>, take: impl Fn(Reply) -> Option<T>) -> Result<T, LinkError> {
        for _ in 0..ATTEMPTS {
            self.tag = self.tag.wrapping_add(1);
            self.send(&Request { tag: self.tag, ask })?;
            let deadline = Instant::now() + ANSWER;
            // a bridge that talks all the time must not keep this waiting
            while Instant::now() < deadline {
                let Some(heard) = self.hear(deadline)? else { break };
                match heard {
                    Heard::Answer(tag, Reply::Refused(refusal)) if tag == self.tag => {
                        return Err(LinkError::Refused(refusal));
                    }
                    Heard::Answer(tag, reply) if tag == self.tag => {
                        if let Some(taken) = take(reply) {
                            return Ok(taken);
                        }
                    }
                    _ => {}
                }
            }
        }
        Err(LinkError::Silent)
    }

    /// The next message; `None` if none comes until then.
    pub fn hear(&mut self, deadline: Instant) -> Result<Option<Heard>, LinkError> {
        loop {
            while let Some(byte) = self.received.pop_front() {
                match self.decoder.push::<Message<'_>>(byte) {
                    Some(Ok(message)) => return Ok(Some(Heard::from(message))),
                    Some(Err(_)) => self.damaged += 1,
                    None => {}
                }
            }
            let Some(patience) = deadline.checked_duration_since(Instant::now()).filter(|time| !time.is_zero()) else {
                return Ok(None);
            };
            let read = self.wire.read(patience, &mut self.received);
            self.alive(read)?;
        }
    }

    /// Frames that were damaged on the way here.
    pub fn damaged(&self) -> u64 {
        self.damaged
    }

    /// Forgets what was damaged so far: the first frame after opening a port is often cut.
    pub fn forget_damage(&mut self) {
        self.damaged = 0;
    }

    /// Why the connection ended, if it did.
    pub fn why_gone(&self) -> Option<String> {
        self.gone.clone()
    }

    fn send(&mut self, request: &Request<'_>) -> Result<(), LinkError> {
        let mut room = [0; MAX_FRAME];
        let frame = encode(request, &mut room).map_err(|_| LinkError::Unsupported)?;
        // a zero first: rubbish that was there before is then no part of it
        let written = self.wire.write(&[&[0], frame].concat());
        self.alive(written)
    }

    fn alive(&mut self, done: std::io::Result<()>) -> Result<(), LinkError> {
        done.map_err(|error| {
            self.gone = Some(error.to_string());
            LinkError::Gone
        })
    }
}

impl From<Message<'_>> for Heard {
    fn from(message: Message<'_>) -> Self {
        match message {
            Message::Answer { tag, answer } => Self::Answer(tag, Reply::from(answer)),
            Message::Sample(reading) => Self::Sample(reading),
            Message::Ended => Self::Ended,
        }
    }
}

impl From<Answer<'_>> for Reply {
    fn from(answer: Answer<'_>) -> Self {
        match answer {
            Answer::Hello { protocol, firmware, .. } => Self::Hello { protocol, firmware: firmware.to_owned() },
            Answer::Clock { sclk_hz } => Self::Clock { sclk_hz },
            Answer::Transfer { bytes } => Self::Transfer(bytes.to_owned()),
            Answer::LastEdge { t_ns, seq } => Self::LastEdge(Edge { t_ns, seq }),
            Answer::Started => Self::Started,
            Answer::Stopped => Self::Stopped,
            Answer::Refused(refusal) => Self::Refused(refusal),
            Answer::Configured => Self::Configured,
            Answer::SelfTest { on } => Self::SelfTest { on },
        }
    }
}
