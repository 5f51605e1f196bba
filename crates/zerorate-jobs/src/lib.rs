//! What zerorate does, as functions: typed options in, events and typed results out.
//!
//! No argument parser, no printing, no exit code: the command line and the Python package word what is said here.
//!
//! * [`calibrate`](calibrate::calibrate): the procedure of AN-1042 (F-51), or a method that takes the whole recording,
//!   on a part or on its recording.
//! * [`correct`]: a capture, corrected.
//! * [`Acquisition`]: the samples of a device, one after the other, counted and judged.
//! * [`Outputs`](output::Outputs): the files of a run, none of which is overwritten by accident.

pub mod acquisition;
pub mod calibrate;
pub mod capture;
pub mod correct;
mod error;
mod judged;
pub mod output;
pub mod probe;
pub mod proposal;
pub mod recorder;
pub mod temperature;
mod warning;

pub use acquisition::{Acquisition, Tell};
pub use error::{InvalidOptions, Refused};
pub use judged::JudgedAxis;
pub use recorder::Recorder;
pub use warning::{CodedWarning, JobWarning};
