//! `zerorate._zerorate`: the Rust part of the Python package.
//!
//! This crate converts numbers, and errors to exceptions. Names, defaults and data classes are in `python/zerorate`.
//! The computations are in the other crates of the project.

mod allan;
mod calibrate;
mod calibration;
mod capture;
mod correction;
mod device;
mod error;
mod imu;
mod log;
mod record;
mod recording;
mod settling;
mod stream;
mod tempcal;
mod twin;
mod worker;

use pyo3::prelude::*;

/// The compiled part of zerorate. Use the package `zerorate`.
#[pymodule]
mod _zerorate {
    #[pymodule_export]
    use super::{
        allan::{Model, analyse, deviations, statistics},
        calibrate::calibrate,
        calibration::Calibration,
        capture::{rate_dps, read_capture, temp_c},
        correction::{Corrector, correct},
        imu::{column_unit, imu_file, is_time, motion, save_text, unit_kind},
        log::{read_columns, read_imu, read_temperature, temperatures},
        main,
        recording::capture,
        settling::check_record,
        stream::Stream,
        tempcal::tempcal,
        twin::{twin_device, twin_keys},
    };
}

/// Runs the command line ``args``, program name first. Returns the exit code: 0 done, 1 failed, 2 usage, 3 refused.
///
/// ``--help``, ``--version`` and an invalid command line end the process.
#[pyfunction]
fn main(py: Python<'_>, args: Vec<std::ffi::OsString>) -> u8 {
    let code = py.detach(|| zerorate_cli::main(args));
    // an `ExitCode` does not reveal its number, but can be compared
    (0..=u8::MAX).find(|number| std::process::ExitCode::from(*number) == code).unwrap_or(1)
}
