//! Runs libiio's own programs against the server for libiio clients.

use super::tally::{Outcome, Tally};
use crate::server::{Server, descriptors};
use crate::tools::{self, Tool};
use anyhow::{Context, Result};
use std::path::Path;
use std::process::{Command, Output, Stdio};

const TOOLS: [Tool; 2] = [
    Tool { program: "iio_stresstest", package: "libiio-utils" },
    Tool { program: "iio_info", package: "libiio-utils" },
];
/// The default port, because `iio_stresstest` of libiio 0.24 forgets the port after its first connection.
const ADDRESS: &str = "127.0.0.1:30431";
const URI: &str = "ip:127.0.0.1";
const DEVICE: &str = "iio:device0";
/// Duration of the stress test, s. At its end the test is interrupted and prints its counts.
const STRESS: &str = "10";
/// A number of threads that exceeds the server's limit on connections.
const CROWD: &str = "200";

/// Runs the programs. If they are missing or their port is in use, prints that and returns `None`.
pub fn run(program: &Path) -> Result<Option<Tally>> {
    if !tools::available(&TOOLS, "libiio's test programs")? {
        return Ok(None);
    }
    if std::net::TcpListener::bind(ADDRESS).is_err() {
        println!("SKIPPED: Libiio: {ADDRESS} is taken, and iio_stresstest knows no other port");
        return Ok(None);
    }
    let server = Server::start_with(&mut Command::new(program), ADDRESS, &["--device", "twin:seed=4"])?;
    let mut tally = Tally::default();
    // count the files after a first client, because the server has then opened all files that it keeps open
    tally.note("iio_genxml", described_again()?);
    let before = descriptors(server.id())?;
    tally.note("iio_stresstest, 4 threads", stress("4", true)?);
    tally.note(format!("iio_stresstest, {CROWD} threads"), stress(CROWD, false)?);
    for (name, arguments) in REFUSED {
        tally.note(name, refused(name, arguments)?);
    }
    tally.note("iio_genxml", described_again()?);
    // the server drops a client that stops in the middle of a line after 10 s
    let left = server.settled(before).map_or_else(|why| Outcome::Wrong(why.to_string()), |_| Outcome::Right);
    tally.note("descriptors afterwards", left);
    server.end()?;
    Ok(Some(tally))
}

/// Requests that the server must refuse: output samples, register access, a trigger, a buffer of more than 2²⁴
/// samples, and a write to `raw`.
const REFUSED: [(&str, &[&str]); 5] = [
    ("iio_writedev", &["-u", URI, "-b", "256", "-s", "256", DEVICE]),
    ("iio_reg", &["-u", URI, DEVICE, "0"]),
    ("iio_readdev", &["-u", URI, "-t", "none", "-s", "256", DEVICE]),
    ("iio_readdev", &["-u", URI, "-b", "16777217", "-s", "16777217", DEVICE]),
    ("iio_attr", &["-u", URI, "-c", DEVICE, "anglvel_z", "raw", "1"]),
];

/// Runs a libiio program. After `seconds` it is interrupted, and 10 s later it is killed if it still runs.
fn tool(seconds: &str, name: &str, arguments: &[&str]) -> Result<Output> {
    let mut command = Command::new("timeout");
    command.args(["--signal=INT", "--kill-after=10", seconds, name]).args(arguments).stdin(Stdio::null());
    command.output().context("timeout")
}

/// Opens and closes contexts and buffers for [`STRESS`] seconds. If `alone`, all threads must get samples without an
/// error. Otherwise there are too many threads, of which most are refused, and the server must only survive.
fn stress(threads: &str, alone: bool) -> Result<Outcome> {
    let output = tool(STRESS, "iio_stresstest", &["-u", URI, "-b", "256", "-t", threads, "-T", "5", DEVICE])?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    let total = text.lines().rfind(|line| line.starts_with("total:")).unwrap_or("it had to be killed");
    let refills = total.rsplit("refills :").next().and_then(|rest| rest.split_whitespace().next());
    let refills: u64 = refills.and_then(|count| count.parse().ok()).unwrap_or(0);
    println!("iio_stresstest, {threads} threads, {STRESS} s: {total}");
    let failed = text.lines().find(|line| line.to_ascii_lowercase().contains("fail"));
    Ok(match (alone, failed) {
        (true, Some(line)) => Outcome::Wrong(line.to_owned()),
        (true, None) if refills == 0 => Outcome::Wrong(total.to_owned()),
        _ => answers()?,
    })
}

/// Checks that the server still describes its device.
fn answers() -> Result<Outcome> {
    let output = tool("60", "iio_info", &["-u", URI])?;
    let text = String::from_utf8_lossy(&output.stdout);
    let is_there = output.status.success() && text.contains("adis16130") && !text.contains("ERROR");
    Ok(if is_there { Outcome::Right } else { Outcome::Wrong(format!("the server does not answer: {text}")) })
}

/// Sends a request that must fail at once, with a reason.
fn refused(name: &str, arguments: &[&str]) -> Result<Outcome> {
    let output = tool("60", name, arguments)?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    let reason = said.trim().lines().next().unwrap_or_default().chars().take(100).collect::<String>();
    let is_alive = matches!(answers()?, Outcome::Right);
    // iio_readdev exits with 0 in any case
    let has_nothing = output.status.code() != Some(124) && (!output.status.success() || output.stdout.is_empty());
    Ok(match is_alive && has_nothing && !reason.is_empty() {
        true => Outcome::Refused(reason),
        false => Outcome::Wrong(format!("{arguments:?}, {}: {reason}", output.status)),
    })
}

/// Lets libiio write its description of the device, and create a new context from that description.
fn described_again() -> Result<Outcome> {
    let output = tool("60", "iio_genxml", &["-u", URI])?;
    let text = String::from_utf8_lossy(&output.stdout);
    let is_same = output.status.success() && text.contains("re-creation from generated XML succeeded");
    Ok(if is_same { Outcome::Right } else { Outcome::Wrong(text.into_owned()) })
}
