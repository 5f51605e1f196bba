//! A request to end work early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to end long work early. All clones share one request.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Requests that all work that has a clone ends cleanly.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// True if a stop was requested. It costs one relaxed load, so it may be called for every sample.
    #[inline]
    #[must_use]
    pub fn asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
