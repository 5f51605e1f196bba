//! A process that does not outlive the task that started it.

use std::process::Child;

/// A process that is killed on drop if it still runs.
pub struct Killed(pub Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
