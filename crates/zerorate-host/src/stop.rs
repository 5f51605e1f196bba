//! The wish that something ends.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to end long work early; all clones share one.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks everything that has a clone of this to end cleanly.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether that was asked. One relaxed load: fit for the path of every sample.
    #[inline]
    #[must_use]
    pub fn asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
