//! The interface that every kind of device address implements.

use crate::source::{Setup, Source};
use crate::{Result, Stop};
use std::fmt;
use std::path::Path;

pub(crate) trait Address: fmt::Debug + Send + Sync {
    /// Opens the device. `name` is the whole address, as the user wrote it. The part is initialised later, by
    /// [`Source::initialise`]. `stop` ends every long wait.
    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> Result<Box<dyn Source>>;

    /// The path of the recording, if the device replays one. `None` for any other device.
    fn file(&self) -> Option<&Path> {
        None
    }

    /// True if the device is simulated, so that it can follow the ambient temperature of its [`Setup`].
    fn is_simulated(&self) -> bool {
        false
    }
}
