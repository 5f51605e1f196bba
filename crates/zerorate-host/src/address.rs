//! The interface that every kind of device address implements.

use crate::source::{Setup, Source};
use crate::{Result, Stop};
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// A parsed address, without its kind: the text after the colon.
pub(crate) trait Address: fmt::Debug + Send + Sync {
    /// Opens the device. `name` is the address as the user wrote it. [`Source::initialise`] initialises the part
    /// later. `stop` ends every long wait.
    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> Result<Box<dyn Source>>;

    /// The path of the recording; `None` for any other device.
    fn file(&self) -> Option<&Path> {
        None
    }

    /// True if the device is simulated and follows the ambient temperature of its [`Setup`].
    fn is_simulated(&self) -> bool {
        false
    }
}

/// The parsed address, or an error text.
pub(crate) type ParseResult = Result<Arc<dyn Address>, String>;
