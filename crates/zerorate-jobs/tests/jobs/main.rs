//! The jobs as functions: typed options in, typed result out, on the twin and on small files.
//!
//! Words and exit codes are tested with the command line.

mod analysis;
mod bench;
mod calibrate;
mod correct;
mod plan;
mod reading;
mod recalibrate;
