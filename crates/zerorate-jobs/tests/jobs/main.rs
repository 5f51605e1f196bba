//! The jobs as functions: typed options in, typed result out, on the twin and on small files.
//!
//! The tests of the command line hold words and exit codes.

mod analysis;
mod bench;
mod calibrate;
mod correct;
mod plan;
mod reading;
mod recalibrate;
