//! Sources of data-ready edges.

use adis16130::Edge;
use anyhow::Result;
use std::time::Duration;

pub trait Edges {
    /// Returns the newest unread edge, or waits for the next one. `None` if none comes within `timeout_ns`.
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>>;

    /// The current time on the clock of the edges, as text for messages.
    fn now(&self) -> String;

    /// Pauses for `ns` nanoseconds on the clock of the edges, which may be simulated.
    fn pause(&mut self, ns: u64) {
        std::thread::sleep(Duration::from_nanos(ns));
    }
}
