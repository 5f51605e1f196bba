//! The data that pass between the USB port and the sampling side.

use core::cell::Cell;

use adis16130::bridge::{MAX_FRAME, Message, encode};
use adis16130::{Edge, RdyEdge};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, with_timeout};

use crate::state::State;

/// Longest time between two calls that feed the watchdog while no event comes.
pub const SIGN_OF_LIFE: Duration = Duration::from_millis(250);

/// Size of the queue to the host, bytes. It holds 0.17 s at the full rate with a temperature in every sample.
const TO_HOST: usize = 32 * 1024;

/// Size of the queue to the sampling side, bytes. A host waits for each answer, so it sends less than this.
const FROM_HOST: usize = 256;

/// Queues and signals between the USB port and the sampling side, and the state that the LED shows.
pub struct Link {
    /// The last edge of RDY that was not handled yet. The number of the edge counts the earlier edges, too.
    pub(crate) edge: Signal<CriticalSectionRawMutex, Edge>,
    /// The kind of edge that announces new data, as the host has chosen it. `watch` takes it from here.
    pub(crate) heard: Signal<CriticalSectionRawMutex, RdyEdge>,
    pub(crate) gone: Signal<CriticalSectionRawMutex, ()>,
    pub(crate) from_host: Pipe<CriticalSectionRawMutex, FROM_HOST>,
    pub(crate) to_host: Pipe<CriticalSectionRawMutex, TO_HOST>,
    state: Mutex<CriticalSectionRawMutex, Cell<State>>,
}

impl Default for Link {
    fn default() -> Self {
        Self::new()
    }
}

impl Link {
    /// Makes an empty link.
    pub const fn new() -> Self {
        Self {
            edge: Signal::new(),
            heard: Signal::new(),
            gone: Signal::new(),
            from_host: Pipe::new(),
            to_host: Pipe::new(),
            state: Mutex::new(Cell::new(State::Idle)),
        }
    }

    /// The current state, which the LED shows.
    pub fn state(&self) -> State {
        self.state.lock(Cell::get)
    }

    pub(crate) fn show(&self, state: State) {
        self.state.lock(|shown| shown.set(state));
    }

    /// Queues a message for the host. A sample that does not fit whole is dropped, which the number of the next sample
    /// shows. For any other message the call waits for space, until the host reads or leaves, and calls `alive` in the
    /// meantime. Call it from one task only.
    pub(crate) async fn send(&self, message: &Message<'_>, mut alive: impl FnMut()) {
        let mut room = [0; MAX_FRAME];
        let Ok(frame) = encode(message, &mut room) else { return };
        let fits = self.to_host.free_capacity() >= frame.len();
        if fits || !matches!(message, Message::Sample(_)) {
            let mut left = frame;
            while !left.is_empty() {
                match with_timeout(SIGN_OF_LIFE, self.to_host.write(left)).await {
                    Ok(len) => left = left.get(len..).unwrap_or_default(),
                    Err(_) => alive(),
                }
            }
        }
    }

    /// Tells the sampling side that the host is gone. Empties the queue to the host, so that no message waits.
    pub(crate) fn hang_up(&self) {
        self.gone.signal(());
        self.to_host.clear();
    }

    /// Empties both queues. Then queues a zero for the next host, which ends a frame that the port may have cut off.
    pub(crate) async fn clear(&self) {
        self.from_host.clear();
        self.to_host.clear();
        self.to_host.write_all(&[0]).await;
    }
}
