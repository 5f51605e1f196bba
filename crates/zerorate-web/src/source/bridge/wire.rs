//! Requests and answers over bytes that the page transfers.

use crate::message::Register;
use adis16130::bridge::{Answer, Client, Command, Event, Pending, RequestError, Step, WireSample};
use embedded_hal::spi::ErrorType;
use embedded_hal_async::spi::{Operation, SpiDevice};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::Poll;
use std::time::Duration;
use zerorate_record::Row;

/// The state that the future of the communication shares with its owner.
pub type SharedWire = Rc<RefCell<Wire>>;

/// The buffers of a port in both directions, and what is known about the bridge.
#[derive(Default)]
pub struct Wire {
    pub client: Client,
    pub received: VecDeque<u8>,
    pub to_send: Vec<u8>,
    /// The time of the page's clock.
    pub now: Duration,
    /// The firmware that the bridge reported; `None` before its answer.
    pub firmware: Option<String>,
    /// The registers of the part, as read when it was opened.
    pub registers: Vec<Register>,
    /// True if the part was just configured.
    pub is_opened: bool,
    pub rows: VecDeque<Row>,
}

/// Sends a request, repeatedly if necessary, until an answer comes that `take` accepts.
pub async fn request<T>(
    shared: &SharedWire,
    command: Command<'_>,
    take: impl Fn(Answer<'_>) -> Option<T>,
) -> Result<T, RequestError> {
    let mut pending = Pending::new(command);
    poll_fn(|_| {
        let Wire { client, received, to_send, now, .. } = &mut *shared.borrow_mut();
        loop {
            match client.poll(&mut pending, &mut std::iter::from_fn(|| received.pop_front()), *now, &take) {
                Ok(Step::Send(frame)) => to_send.extend_from_slice(frame.bytes()),
                Ok(Step::Wait(_)) => return Poll::Pending,
                Ok(Step::Answered(taken)) => return Poll::Ready(Ok(taken)),
                Err(error) => return Poll::Ready(Err(error)),
            }
        }
    })
    .await
}

/// Waits for the next sample; `None` if the part sends none for the time `silence`.
///
/// Silence may also be caused by the window that transfers the bytes. So a request is sent to the bridge: if it is
/// answered, the part is silent. Otherwise, the bytes under way get the additional time `blocked`.
pub async fn sample(shared: &SharedWire, silence: Duration, blocked: Duration) -> Result<Option<WireSample>, String> {
    let mut event = next_event(shared, silence, |event| event != Event::Answer).await;
    if event.is_none() {
        {
            let wire = &mut *shared.borrow_mut();
            let frame = wire.client.frame(Command::LastEdge).map_err(|error| error.to_string())?;
            wire.to_send.extend_from_slice(frame.bytes());
        }
        event = next_event(shared, blocked, |_| true).await;
    }
    match event {
        Some(Event::Sample(sample)) => Ok(Some(sample)),
        Some(_) => Ok(None),
        None => Err(format!(
            "nothing came from the bridge for {} s: the window that reads its port is blocked (by a dialog, or \
             because it is hidden), or the bridge hangs. Bring that window to the front, and open the \
             port again",
            blocked.as_secs()
        )),
    }
}

/// Waits for an event for which `counts` is true, for the time `within` at most.
async fn next_event(shared: &SharedWire, within: Duration, counts: impl Fn(Event) -> bool) -> Option<Event> {
    let deadline = shared.borrow().now + within;
    poll_fn(|_| {
        let Wire { client, received, now, .. } = &mut *shared.borrow_mut();
        let mut received = std::iter::from_fn(|| received.pop_front());
        let event = std::iter::from_fn(|| client.next_event(&mut received)).find(|event| counts(*event));
        if event.is_some() || *now >= deadline { Poll::Ready(event) } else { Poll::Pending }
    })
    .await
}

/// The SPI bus behind the bridge. Each operation with bytes is one request to the bridge.
pub struct Transfers(pub SharedWire);

impl ErrorType for Transfers {
    type Error = RequestError;
}

impl SpiDevice for Transfers {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), RequestError> {
        for operation in operations {
            match operation {
                Operation::TransferInPlace(bytes) => {
                    let received = self.exchange(bytes).await?;
                    bytes.copy_from_slice(&received);
                }
                Operation::Write(bytes) => drop(self.exchange(bytes).await?),
                // the driver uses no other operation
                _ => return Err(RequestError::Unsupported),
            }
        }
        Ok(())
    }
}

impl Transfers {
    async fn exchange(&self, bytes: &[u8]) -> Result<Vec<u8>, RequestError> {
        request(&self.0, Command::Transfer { bytes }, |answer| match answer {
            Answer::Transfer { bytes: received } if received.len() == bytes.len() => Some(received.to_owned()),
            _ => None,
        })
        .await
    }
}
