//! `cargo xtask iiod`: reads the libiio server with clients of other projects.

use crate::app;
use crate::server::Server;
use crate::tools::{Tool, available, module_available};
use crate::venv::{self, done, printed};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

const CLIENTS: Tool = Tool { program: "iio_info", package: "libiio-utils" };
const REQUIREMENTS: &str = "lab/iiod-requirements.txt";
const PURPOSE: &str = "the libiio server with libiio's clients";

/// The tests that use the clients; the step `test` has built them.
const TESTS: &str = "--quiet --test iiod";

/// Installs the clients and runs the tests that use them. Without the clients it says so and passes.
pub fn run() -> Result<()> {
    if !(available(&[CLIENTS], PURPOSE)? && module_available("iio", "python3-libiio", PURPOSE)?) {
        return Ok(());
    }
    let mut tests = Command::new("cargo");
    tests.arg("test").args(app::WHOLE.split(' ')).args(TESTS.split(' ')).env("ZERORATE_IIO_CLIENTS", "required");
    match adi() {
        Ok(python) => drop(tests.env("ZERORATE_ADI_PYTHON", python)),
        Err(why) => println!("SKIPPED: pyadi-iio: {why:#}"),
    }
    done(&mut tests)?;
    trial(&app::program()?)
}

/// Clients of the program at once, and how many samples each takes: ten seconds in real time.
const TOGETHER: usize = 4;
const SAMPLES: usize = 60_000;
/// All channels of an ADIS16130 without a calibration: code, temperature, lost samples, time.
const SAMPLE_BYTES: usize = 24;
const RECORDING: &str = "target/iiod.arrows";

/// Several clients read while the program records. No client misses a sample, and nothing is lost.
fn trial(program: &Path) -> Result<()> {
    let _ = fs::remove_file(RECORDING);
    let server = Server::start(program, &["--device", "twin:seed=8", "-o", RECORDING])?;
    thread::scope(|scope| {
        let clients: Vec<_> = (0..TOGETHER).map(|_| scope.spawn(|| client(&server.iio_uri))).collect();
        clients.into_iter().try_for_each(|client| client.join().expect("no thread panics"))
    })?;
    let (cpu_s, peak_mb) = (server.cpu_s()?, server.peak_mb()?);
    server.end()?;
    let report: Value = serde_json::from_str(&printed(Command::new(program).args(["verify", RECORDING, "--json"]))?)?;
    let file = &report["files"][0];
    ensure!(file["whole"] == true && file["lost"] == 0, "the recording lost samples: {file}");
    let span_s = (file["last_ns"].as_f64().unwrap_or(0.0) - file["first_ns"].as_f64().unwrap_or(0.0)) * 1e-9;
    println!(
        "{TOGETHER} clients of libiio took {SAMPLES} samples each, {} samples in {span_s:.1} s recorded, none lost, \
         {cpu_s:.1} s of processor, {peak_mb:.0} MB at most",
        file["rows"]
    );
    Ok(fs::remove_file(RECORDING)?)
}

/// Its exit code says nothing: it is 0 even without a sample.
fn client(uri: &str) -> Result<()> {
    let mut client = Command::new("iio_readdev");
    client.args(["-u", uri, "-b", "256", "-s", &SAMPLES.to_string(), "iio:device0"]);
    let (found, expected) = (client.output().context("iio_readdev")?.stdout.len(), SAMPLES * SAMPLE_BYTES);
    ensure!(found == expected, "a client got {found} of {expected} bytes");
    Ok(())
}

/// A Python with pyadi-iio.
fn adi() -> Result<PathBuf> {
    let python = venv::python("adi", Path::new(REQUIREMENTS))?;
    Ok(fs::canonicalize("target")?.join(python.strip_prefix("target")?))
}
