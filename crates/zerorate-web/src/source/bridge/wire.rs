//! Requests and answers over bytes that somebody else moves.

use crate::message::Register;
use adis16130::bridge::{Answer, Ask, Decoder, MAX_FRAME, Message, Refusal, Request, WireSample, encode};
use embedded_hal::spi::{ErrorKind, ErrorType};
use embedded_hal_async::spi::{Operation, SpiDevice};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt::{Display, Formatter, Result as Printed};
use std::future::poll_fn;
use std::rc::Rc;
use std::task::Poll;
use zerorate_record::Row;

/// A bridge answers within this, ms.
const ANSWER_MS: f64 = 500.0;
/// So often a request is sent before the bridge counts as silent.
const ATTEMPTS: u32 = 3;

/// What the work on a bridge and its owner both see.
pub type Shared = Rc<RefCell<Wire>>;

/// Both directions of a port.
pub struct Wire {
    decoder: Decoder,
    heard: VecDeque<Heard>,
    tag: u8,
    pub to_send: Vec<u8>,
    pub now_ms: f64,
    pub damaged: u64,
    /// What the bridge calls itself, once it has said so.
    pub firmware: Option<String>,
    /// Of the part, as they were when it was opened.
    pub registers: Vec<Register>,
    /// The part has just taken its configuration.
    pub is_opened: bool,
    pub rows: VecDeque<Row>,
}

/// Something that the bridge says.
pub enum Heard {
    /// With the tag of its request.
    Answer(u8, Reply),
    Sample(WireSample),
    /// It samples no more.
    Ended,
}

/// An answer that owns what it says.
pub enum Reply {
    Hello {
        protocol: u16,
        firmware: String,
    },
    Clock,
    Transfer(Vec<u8>),
    Started,
    Stopped,
    Configured,
    Refused(Refusal),
    /// To what is not asked here.
    Other,
}

/// Why a request failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WireError {
    Silent,
    /// Nothing at all came for so long while it sampled, ms.
    Blocked(u32),
    Refused(Refusal),
    Unsupported,
}

impl Display for WireError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Printed {
        match self {
            Self::Silent => write!(f, "the bridge did not answer within {} s", ANSWER_MS * f64::from(ATTEMPTS) / 1e3),
            Self::Blocked(for_ms) => write!(
                f,
                "nothing came from the bridge for {} s: the window that reads its port is blocked (by a dialog, or by \
                 the browser while nobody sees it), or the bridge hangs; bring that window to the front, and open the \
                 port again",
                for_ms / 1000
            ),
            Self::Refused(refusal) => write!(f, "the bridge refused: {refusal}"),
            Self::Unsupported => f.write_str("the bridge cannot do this transfer"),
        }
    }
}

impl Wire {
    pub fn new(now_ms: f64) -> Self {
        Self {
            decoder: Decoder::new(),
            heard: VecDeque::new(),
            tag: 0,
            to_send: Vec::new(),
            now_ms,
            damaged: 0,
            firmware: None,
            registers: Vec::new(),
            is_opened: false,
            rows: VecDeque::new(),
        }
    }

    /// What came.
    pub fn take(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            match self.decoder.push::<Message<'_>>(byte) {
                Some(Ok(message)) => self.heard.push_back(Heard::from(message)),
                Some(Err(_)) => self.damaged += 1,
                None => {}
            }
        }
    }

    /// The part has taken its configuration; these are its registers.
    pub fn opened(&mut self, registers: Vec<Register>) {
        self.registers = registers;
        self.is_opened = true;
    }

    fn send(&mut self, ask: Ask<'_>) -> Result<u8, WireError> {
        self.tag = self.tag.wrapping_add(1);
        let mut room = [0; MAX_FRAME];
        let frame = encode(&Request { tag: self.tag, ask }, &mut room).map_err(|_| WireError::Unsupported)?;
        // a zero first: rubbish that was there before is then no part of it
        self.to_send.push(0);
        self.to_send.extend_from_slice(frame);
        Ok(self.tag)
    }

    /// The answer to the request with this tag. What else was said before it is dropped: what is asked for ends
    /// sampling, or begins it.
    fn answer(&mut self, tag: u8) -> Option<Reply> {
        while let Some(heard) = self.heard.pop_front() {
            match heard {
                Heard::Answer(of, reply) if of == tag => return Some(reply),
                _ => {}
            }
        }
        None
    }
}

/// Sends a request until it is answered with what `take` takes.
pub async fn ask<T>(shared: &Shared, ask: Ask<'_>, take: impl Fn(Reply) -> Option<T>) -> Result<T, WireError> {
    for _ in 0..ATTEMPTS {
        let tag = shared.borrow_mut().send(ask)?;
        let deadline_ms = shared.borrow().now_ms + ANSWER_MS;
        let answered = poll_fn(|_| {
            let mut wire = shared.borrow_mut();
            match wire.answer(tag) {
                Some(reply) => Poll::Ready(Some(reply)),
                None if wire.now_ms >= deadline_ms => Poll::Ready(None),
                None => Poll::Pending,
            }
        });
        match answered.await {
            Some(Reply::Refused(refusal)) => return Err(WireError::Refused(refusal)),
            Some(reply) => {
                if let Some(taken) = take(reply) {
                    return Ok(taken);
                }
            }
            None => {}
        }
    }
    Err(WireError::Silent)
}

/// The next sample; none where the part brings none for so long, ms.
///
/// Silence may be that of whoever moves the bytes instead. So the bridge is asked for anything: if it answers, the
/// part is silent; else what is on its way may come for so much longer, ms.
pub async fn sample(shared: &Shared, silence_ms: u32, blocked_ms: u32) -> Result<Option<WireSample>, WireError> {
    let heard = match hear(shared, silence_ms, None).await {
        None => {
            let tag = shared.borrow_mut().send(Ask::LastEdge)?;
            hear(shared, blocked_ms, Some(tag)).await.ok_or(WireError::Blocked(blocked_ms))?
        }
        Some(heard) => heard,
    };
    Ok(if let Heard::Sample(sample) = heard { Some(sample) } else { None })
}

/// What comes within so long, ms; of answers, the one with this tag alone.
async fn hear(shared: &Shared, within_ms: u32, wanted: Option<u8>) -> Option<Heard> {
    let deadline_ms = shared.borrow().now_ms + f64::from(within_ms);
    poll_fn(|_| {
        let mut wire = shared.borrow_mut();
        while let Some(heard) = wire.heard.pop_front() {
            // a second answer to a request that was sent twice is none
            if !matches!(heard, Heard::Answer(tag, _) if wanted != Some(tag)) {
                return Poll::Ready(Some(heard));
            }
        }
        if wire.now_ms >= deadline_ms { Poll::Ready(None) } else { Poll::Pending }
    })
    .await
}

/// The bus behind the bridge: a transaction is one transfer.
pub struct Transfers(pub Shared);

impl embedded_hal::spi::Error for WireError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl ErrorType for Transfers {
    type Error = WireError;
}

impl SpiDevice for Transfers {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), WireError> {
        for operation in operations {
            match operation {
                Operation::TransferInPlace(bytes) => {
                    let received = self.exchange(bytes).await?;
                    bytes.copy_from_slice(&received);
                }
                Operation::Write(bytes) => drop(self.exchange(bytes).await?),
                // the driver does none of these
                _ => return Err(WireError::Unsupported),
            }
        }
        Ok(())
    }
}

impl Transfers {
    async fn exchange(&self, bytes: &[u8]) -> Result<Vec<u8>, WireError> {
        ask(&self.0, Ask::Transfer { bytes }, |reply| match reply {
            Reply::Transfer(received) if received.len() == bytes.len() => Some(received),
            _ => None,
        })
        .await
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
            Answer::Clock { .. } => Self::Clock,
            Answer::Transfer { bytes } => Self::Transfer(bytes.to_owned()),
            Answer::Started => Self::Started,
            Answer::Stopped => Self::Stopped,
            Answer::Configured => Self::Configured,
            Answer::Refused(refusal) => Self::Refused(refusal),
            Answer::LastEdge { .. } | Answer::SelfTest { .. } => Self::Other,
        }
    }
}
