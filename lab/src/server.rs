//! Runs `zerorate serve` as a process, for other tasks.

use crate::killed::Killed;
use crate::venv::done;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// A running server. Dropping this value ends the server.
pub struct Server {
    child: Killed,
    pub page: String,
    /// The address for libiio clients, as a URI of libiio.
    pub iio_uri: String,
}

impl Server {
    /// Starts the server on free ports with these arguments. Forwards its later messages to stderr.
    pub fn start(program: &Path, arguments: &[&str]) -> Result<Self> {
        Self::start_with(&mut Command::new(program), "127.0.0.1:0", arguments)
    }

    /// Starts the server by this command, with libiio served at the address `iio`.
    pub fn start_with(command: &mut Command, iio: &str, arguments: &[&str]) -> Result<Self> {
        command.args(["serve", "--listen", "127.0.0.1:0", "--iio", iio]).args(arguments);
        let mut child = Killed(command.stderr(Stdio::piped()).spawn().context("cannot start the program")?);
        let mut lines = BufReader::new(child.0.stderr.take().context("no stderr")?).lines().map_while(Result::ok);
        let mut behind = |text: &str| lines.find_map(|line| Some(line.split_once(text)?.1.to_owned()));
        let page = behind("open http://").context("the program serves no page")?.trim_end_matches('/').to_owned();
        let iio_uri = format!("ip:{}", behind("-u ip:").context("the program serves no libiio")?.trim());
        thread::spawn(move || lines.for_each(|line| eprintln!("{line}")));
        Ok(Self { child, page, iio_uri })
    }

    /// Processor time used so far, s.
    pub fn cpu_s(&self) -> Result<f64> {
        /// Clock ticks per second in Linux's statistics (`getconf CLK_TCK`).
        const TICKS_PER_S: f64 = 100.0;
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.id()))?;
        let (_, behind_name) = stat.rsplit_once(')').context("/proc/PID/stat")?;
        let ticks = behind_name.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
        Ok(ticks.sum::<Result<f64, _>>()? / TICKS_PER_S)
    }

    pub fn id(&self) -> u32 {
        self.child.0.id()
    }

    /// Waits until the server has closed all but this number of files and connections. Returns their number then.
    pub fn settled(&self, most: usize) -> Result<usize> {
        /// Longest wait. It exceeds any timeout of the server.
        const PATIENCE: Duration = Duration::from_secs(120);
        let begun = Instant::now();
        loop {
            let left = descriptors(self.id())?;
            if left <= most {
                return Ok(left);
            }
            ensure!(begun.elapsed() < PATIENCE, "{left} descriptors are open, in place of {most} at most");
            thread::sleep(Duration::from_millis(200));
        }
    }

    /// Ends the server as Ctrl-C does.
    pub fn end(mut self) -> Result<()> {
        done(Command::new("kill").args(["-INT", &self.id().to_string()]))?;
        let status = self.child.0.wait()?;
        ensure!(status.success(), "the server ended with {status}");
        Ok(())
    }
}

/// Number of open files and connections of a process.
pub fn descriptors(id: u32) -> Result<usize> {
    Ok(fs::read_dir(format!("/proc/{id}/fd"))?.count())
}

/// A memory size in the kernel's status of a process, MB.
pub fn memory_mb(id: u32, field: &str) -> Result<f64> {
    let status = fs::read_to_string(format!("/proc/{id}/status"))?;
    let line = status.lines().find_map(|line| line.strip_prefix(field)).context("/proc/PID/status")?;
    Ok(line.trim().trim_end_matches(" kB").parse::<f64>()? * 1024.0 / 1e6)
}
