//! The host's end of the link. The caller provides the serial port and the clock.

use super::{Answer, Command, Decoder, MAX_FRAME, Message, Refusal, Request, WireSample, encode};
use core::fmt::{Display, Formatter, Result as Printed};
use core::time::Duration;
use embedded_hal::spi::ErrorKind;

/// Time that a bridge has to answer before the request is sent again.
const ANSWER: Duration = Duration::from_millis(500);
/// Number of times that a request is sent before the bridge counts as silent.
const ATTEMPTS: u32 = 3;

/// The message about a bridge that does not answer. It follows the name of the bridge.
pub const SILENT: &str =
    "does not answer: is it a bridge (docs/formats/bridge.md) whose firmware runs, and does nobody else read it?";
/// The message about a connection that has ended. It follows the name of the bridge.
pub const GONE: &str = "is gone: its cable was pulled, or the bridge has no power; connect it and start again";

/// Makes requests and reads the answers. The caller moves the bytes, and passes the time since any fixed moment.
#[derive(Clone, Debug, Default)]
pub struct Client {
    decoder: Decoder,
    tag: u8,
    /// Number of damaged frames. The first frame on a new port is often cut, so the owner may reset the number.
    pub damaged: u64,
}

/// A request to a bridge. The client sends it up to three times, until it is answered.
#[derive(Copy, Clone, Debug)]
pub struct Pending<'a> {
    command: Command<'a>,
    attempts: u32,
    deadline: Option<Duration>,
}

/// The next step of a request.
#[derive(Debug)]
pub enum Step<T> {
    /// Send this frame.
    Send(Frame),
    /// Call [`Client::poll`] again with the next bytes, or at this time.
    Wait(Duration),
    /// The request was answered.
    Answered(T),
}

/// A message from a bridge, without the content of an answer.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// The answer to the last request.
    Answer,
    /// A sample.
    Sample(WireSample),
    /// Sampling has ended.
    Ended,
}

/// The reasons why a request failed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum RequestError {
    /// The bridge does not answer.
    Silent,
    /// The bridge refused the request.
    Refused(Refusal),
    /// The request does not fit in a frame, or the protocol has no such transfer.
    Unsupported,
}

/// The frame of a request as bytes.
#[derive(Copy, Clone, Debug)]
pub struct Frame {
    bytes: [u8; MAX_FRAME + 1],
    len: usize,
}

impl<'a> Pending<'a> {
    /// Makes a request that has not been sent yet.
    pub const fn new(command: Command<'a>) -> Self {
        Self { command, attempts: ATTEMPTS, deadline: None }
    }
}

impl Client {
    /// Looks for the answer in the received bytes, and returns the next step. `take` converts the answer, or returns
    /// `None` to ignore an answer to another command. Samples and [`Message::Ended`] before the answer are dropped.
    pub fn poll<T>(
        &mut self,
        pending: &mut Pending<'_>,
        received: &mut impl Iterator<Item = u8>,
        now: Duration,
        take: impl Fn(Answer<'_>) -> Option<T>,
    ) -> Result<Step<T>, RequestError> {
        if let Some(deadline) = pending.deadline {
            if let Some(answered) = self.answer(received, take) {
                return answered.map(Step::Answered);
            }
            if now < deadline {
                return Ok(Step::Wait(deadline));
            }
        }
        pending.attempts = pending.attempts.checked_sub(1).ok_or(RequestError::Silent)?;
        pending.deadline = Some(now.saturating_add(ANSWER));
        self.frame(pending.command).map(Step::Send)
    }

    /// Makes the frame of a request whose answer the caller reads by [`next_event`](Self::next_event).
    pub fn frame(&mut self, command: Command<'_>) -> Result<Frame, RequestError> {
        self.tag = self.tag.wrapping_add(1);
        let mut bytes = [0; MAX_FRAME + 1];
        // the zero at the front ends any garbage that was sent before
        let [_, room @ ..] = &mut bytes;
        let frame = encode(&Request { tag: self.tag, command }, room).map_err(|_| RequestError::Unsupported)?;
        let len = frame.len().saturating_add(1);
        Ok(Frame { bytes, len })
    }

    /// Returns the next message of the bridge in the received bytes, except for answers to earlier requests.
    pub fn next_event(&mut self, received: &mut impl Iterator<Item = u8>) -> Option<Event> {
        let last = self.tag;
        received.find_map(|byte| match self.message(byte)? {
            Message::Answer { tag, .. } => (tag == last).then_some(Event::Answer),
            Message::Sample(reading) => Some(Event::Sample(reading)),
            Message::Ended => Some(Event::Ended),
        })
    }

    fn answer<T>(
        &mut self,
        received: &mut impl Iterator<Item = u8>,
        take: impl Fn(Answer<'_>) -> Option<T>,
    ) -> Option<Result<T, RequestError>> {
        let last = self.tag;
        received.find_map(|byte| match self.message(byte)? {
            Message::Answer { tag, .. } if tag != last => None,
            Message::Answer { answer: Answer::Refused(refusal), .. } => Some(Err(RequestError::Refused(refusal))),
            Message::Answer { answer, .. } => take(answer).map(Ok),
            Message::Sample(_) | Message::Ended => None,
        })
    }

    /// Returns the message that ends with this byte. Counts damaged frames.
    fn message(&mut self, byte: u8) -> Option<Message<'_>> {
        let message = self.decoder.push(byte)?;
        self.damaged = self.damaged.wrapping_add(u64::from(message.is_err()));
        message.ok()
    }
}

impl Answer<'static> {
    /// A `take` function that accepts this answer only.
    pub fn only(self) -> impl Fn(Answer<'_>) -> Option<()> {
        move |answer| (answer == self).then_some(())
    }
}

impl Frame {
    /// The bytes to send.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or_default()
    }
}

impl Display for RequestError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Printed {
        match self {
            Self::Silent => write!(f, "the bridge did not answer within {} s", (ANSWER * ATTEMPTS).as_secs_f32()),
            Self::Refused(refusal) => write!(f, "the bridge refused: {refusal}"),
            Self::Unsupported => f.write_str("the bridge cannot do this transfer"),
        }
    }
}

impl core::error::Error for RequestError {}

impl embedded_hal::spi::Error for RequestError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}
