//! The interface of every kind of address.

use crate::source::{Setup, Source};
use crate::{Result, Stop};
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// An address without its kind: the parsed text after the colon.
pub(crate) trait Address: fmt::Debug + Send + Sync {
    /// Opens the device that was called `name`; sends nothing to the part yet. `stop` ends every long wait.
    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> Result<Box<dyn Source>>;

    /// The file that is read, if the device is a recording.
    fn file(&self) -> Option<&Path> {
        None
    }

    /// Whether the device takes the air of its [`Setup`].
    fn is_simulated(&self) -> bool {
        false
    }
}

/// An address, or the text of the error in it.
pub(crate) type ParseResult = Result<Arc<dyn Address>, String>;
