//! Sources of data-ready edges.

use adis16130::Edge;
use anyhow::Result;
use std::time::Duration;

/// A source of data-ready edges.
pub trait Edges {
    /// The newest edge not handed out yet, or else the next; `None` if none comes within so many ns.
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>>;

    /// The time in words, for messages.
    fn now(&self) -> String;

    /// Lets so many ns pass.
    fn pause(&mut self, ns: u64) {
        std::thread::sleep(Duration::from_nanos(ns));
    }
}
