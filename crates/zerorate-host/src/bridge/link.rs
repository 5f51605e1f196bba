//! Exchanges requests, answers and samples with a bridge.

use crate::wire::Wire;
use adis16130::bridge::{Answer, Client, Command, Event, Pending, RequestError, Step};
use embedded_hal::spi::ErrorKind;
use std::collections::VecDeque;
use std::time::Instant;

#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    #[error("the connection to the bridge ended")]
    Gone,
    #[error(transparent)]
    Request(#[from] RequestError),
}

impl embedded_hal::spi::Error for LinkError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

pub struct Link {
    wire: Wire,
    pub client: Client,
    received: VecDeque<u8>,
    since: Instant,
    /// The reason why the connection ended; `None` while the connection is open.
    pub gone: Option<String>,
}

impl Link {
    pub fn new(wire: Wire) -> Self {
        Self { wire, client: Client::default(), received: VecDeque::new(), since: Instant::now(), gone: None }
    }

    /// Sends a request, repeatedly if necessary, and returns what `take` reads from its answer.
    pub fn request<T>(
        &mut self,
        command: Command<'_>,
        take: impl Fn(Answer<'_>) -> Option<T>,
    ) -> Result<T, LinkError> {
        let mut pending = Pending::new(command);
        loop {
            let mut received = std::iter::from_fn(|| self.received.pop_front());
            match self.client.poll(&mut pending, &mut received, self.since.elapsed(), &take)? {
                Step::Answered(taken) => return Ok(taken),
                Step::Send(frame) => {
                    let written = self.wire.write(frame.bytes());
                    self.alive(written)?;
                }
                Step::Wait(until) => drop(self.read(self.since + until)?),
            }
        }
    }

    /// Returns the next message, or `None` if none comes before the deadline.
    pub fn next_event(&mut self, deadline: Instant) -> Result<Option<Event>, LinkError> {
        loop {
            let event = self.client.next_event(&mut std::iter::from_fn(|| self.received.pop_front()));
            if event.is_some() || !self.read(deadline)? {
                return Ok(event);
            }
        }
    }

    /// Waits for bytes until the deadline. Returns false only if the deadline passed before this call.
    fn read(&mut self, deadline: Instant) -> Result<bool, LinkError> {
        let patience = deadline.saturating_duration_since(Instant::now());
        if patience.is_zero() {
            return Ok(false);
        }
        let read = self.wire.read(patience, &mut self.received);
        self.alive(read).map(|()| true)
    }

    fn alive(&mut self, done: std::io::Result<()>) -> Result<(), LinkError> {
        done.map_err(|error| {
            self.gone = Some(error.to_string());
            LinkError::Gone
        })
    }
}
