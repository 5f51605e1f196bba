//! `cargo xtask iiod`: the libiio server, read by clients that nobody here wrote.

use crate::app;
use crate::tools::{Tool, available, module_available};
use crate::venv::{self, done, printed};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;

const CLIENTS: Tool = Tool { program: "iio_info", package: "libiio-utils" };
const REQUIREMENTS: &str = "xtask/iiod-requirements.txt";
const PURPOSE: &str = "the libiio server with libiio's clients";

/// The tests, with all clients installed that can be had. As in `cargo xtask test`, so that nothing is compiled twice.
const TESTS: &str = "test --workspace --exclude xtask --all-features --quiet --test iiod";

/// Installs the clients, and runs the tests that use them. Where they cannot be had it says so and passes.
pub fn run() -> Result<()> {
    if !(available(&[CLIENTS], PURPOSE)? && module_available("iio", "python3-libiio", PURPOSE)?) {
        return Ok(());
    }
    let mut tests = Command::new("cargo");
    tests.args(TESTS.split(' ')).env("ZERORATE_IIO_CLIENTS", "required");
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

/// Several clients look on while the program records: none is short of a sample, and nothing is lost.
fn trial(program: &Path) -> Result<()> {
    let _ = fs::remove_file(RECORDING);
    let mut serve = Command::new(program);
    serve.args([
        "serve",
        "--listen",
        "127.0.0.1:0",
        "--iio",
        "127.0.0.1:0",
        "--device",
        "twin:seed=8",
        "-o",
        RECORDING,
    ]);
    let mut server = Server(serve.stderr(Stdio::piped()).spawn().context("cannot start the program")?);
    let mut said = BufReader::new(server.0.stderr.take().context("no stderr")?).lines();
    let address = said.by_ref().map_while(Result::ok).find_map(|line| Some(line.split_once("-u ip:")?.1.to_owned()));
    let uri = format!("ip:{}", address.context("the program serves no libiio")?);
    thread::scope(|scope| {
        let clients: Vec<_> = (0..TOGETHER).map(|_| scope.spawn(|| client(&uri))).collect();
        clients.into_iter().try_for_each(|client| client.join().expect("no thread panics"))
    })?;
    let (cpu_s, memory_kb) = (server.cpu_s()?, server.memory_kb()?);
    done(Command::new("kill").args(["-INT", &server.0.id().to_string()]))?;
    ensure!(server.0.wait()?.success(), "the program did not end well");
    let report: Value = serde_json::from_str(&printed(Command::new(program).args(["verify", RECORDING, "--json"]))?)?;
    let file = &report["files"][0];
    ensure!(file["whole"] == true && file["lost"] == 0, "the recording lost samples: {file}");
    let span_s = (file["last_ns"].as_f64().unwrap_or(0.0) - file["first_ns"].as_f64().unwrap_or(0.0)) * 1e-9;
    println!(
        "{TOGETHER} clients of libiio took {SAMPLES} samples each; {} samples in {span_s:.1} s recorded, none lost; \
         {cpu_s:.1} s of processor, {} MB at most",
        file["rows"],
        memory_kb / 1024
    );
    Ok(fs::remove_file(RECORDING)?)
}

/// Its exit code says nothing: it ends well even where it got no sample.
fn client(uri: &str) -> Result<()> {
    let mut client = Command::new("iio_readdev");
    client.args(["-u", uri, "-b", "256", "-s", &SAMPLES.to_string(), "iio:device0"]);
    let (found, expected) = (client.output().context("iio_readdev")?.stdout.len(), SAMPLES * SAMPLE_BYTES);
    ensure!(found == expected, "a client got {found} of {expected} bytes");
    Ok(())
}

/// The program, ended with the trial.
struct Server(Child);

impl Server {
    /// Processor time, s: of a hundred ticks a second, which Linux counts for whoever asks.
    fn cpu_s(&self) -> Result<f64> {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.0.id()))?;
        let behind_name = stat.rsplit_once(')').context("no name")?.1;
        let ticks = behind_name.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
        Ok(ticks.sum::<Result<f64, _>>()? / 100.0)
    }

    /// The most memory that it had, KB.
    fn memory_kb(&self) -> Result<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.0.id()))?;
        let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next());
        Ok(most.context("no VmHWM")?.parse()?)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // it has ended, where all went well
        let _ = self.0.kill();
    }
}

/// A Python with pyadi-iio.
fn adi() -> Result<PathBuf> {
    let python = venv::python("adi", Path::new(REQUIREMENTS))?;
    Ok(fs::canonicalize("target")?.join(python.strip_prefix("target")?))
}
