//! Sources of data-ready edges.

use adis16130::Edge;
use anyhow::Result;
use std::time::Duration;

/// A source of data-ready edges.
pub trait Edges {
    /// The newest edge that was not returned yet, or else the next one; `None` if none comes within this time, ns.
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>>;

    /// The time in words, for messages.
    fn now(&self) -> String;

    /// Waits for this time, ns.
    fn pause(&mut self, ns: u64) {
        std::thread::sleep(Duration::from_nanos(ns));
    }
}
