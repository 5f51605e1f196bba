//! The jobs as functions: typed options in, typed result out, on the twin and on small files.
//!
//! The tests of the command line cover the words and the exit codes.

mod analysis;
mod bench;
mod calibrate;
mod codes;
mod correct;
mod plan;
mod reading;
mod recalibrate;
mod white;
