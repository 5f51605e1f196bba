//! `cargo xtask iiod`: reads from the libiio server with clients of other projects. (`bench-serve` runs several
//! clients while the program records.)

use crate::app;
use crate::tools::{Tool, available, module_available};
use crate::venv::{self, done};
use anyhow::Result;
use std::process::Command;

const CLIENTS: Tool = Tool { program: "iio_info", package: "libiio-utils" };
/// The list of packages in the Python environment with pyadi-iio.
const REQUIREMENTS: &str = "lab/iiod-requirements.txt";
const PURPOSE: &str = "the libiio server with libiio's clients";

/// The tests that use the clients. The step `test` has compiled them.
const TESTS: &str = "--quiet --test iiod";

/// Installs the clients and runs the tests that use them. Without the clients, prints that and succeeds.
pub fn run() -> Result<()> {
    if !(available(&[CLIENTS], PURPOSE)? && module_available("iio", "python3-libiio", PURPOSE)?) {
        return Ok(());
    }
    let mut tests = Command::new("cargo");
    tests.arg("test").args(app::WHOLE.split(' ')).args(TESTS.split(' ')).env("ZERORATE_IIO_CLIENTS", "required");
    match venv::python("adi", REQUIREMENTS) {
        Ok(python) => drop(tests.env("ZERORATE_ADI_PYTHON", python)),
        Err(why) => println!("SKIPPED: pyadi-iio: {why:#}"),
    }
    done(&mut tests)
}
