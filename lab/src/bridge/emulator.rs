//! Runs the bridge's firmware in QEMU.

use crate::killed::Killed;
use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Time limit for the emulator to listen.
const START: Duration = Duration::from_secs(20);

/// How the bridge's UART is connected.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Line {
    Socket,
    /// By a pseudo-terminal, which programs open like a serial port.
    Serial,
}

/// A running emulator, which ends when this value is dropped.
pub struct Emulator {
    qemu: Killed,
    pub device: String,
    /// The TCP port on which QEMU serves the UART of a [`Line::Socket`].
    pub port: u16,
}

impl Emulator {
    pub fn start(image: &Path, seed: u64, line: Line) -> Result<Self> {
        // the port was free a moment ago, and no other code of this task opens a port
        let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let serial = match line {
            // without nodelay, every byte of an answer would wait for the acknowledgement of the previous one
            Line::Socket => format!("tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on"),
            Line::Serial => "pty".to_owned(),
        };
        let mut qemu = Command::new("qemu-system-arm")
            .args(["-M", "mps2-an386", "-nographic", "-monitor", "none", "-serial", &serial])
            .arg("-semihosting-config")
            .arg(format!("enable=on,target=native,arg=bridge,arg={seed}"))
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .context("starting qemu-system-arm")?;
        let output = qemu.stdout.take().context("no output of the emulator")?;
        let mut emulator = Self { qemu: Killed(qemu), device: format!("tcp:127.0.0.1:{port}"), port };
        match line {
            Line::Socket => emulator.wait()?,
            Line::Serial => emulator.device = format!("bridge:{}", terminal(BufReader::new(output))?),
        }
        Ok(emulator)
    }

    fn wait(&mut self) -> Result<()> {
        let started = Instant::now();
        while TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            if let Some(status) = self.qemu.0.try_wait()? {
                bail!("qemu-system-arm ended with {status}");
            }
            if started.elapsed() > START {
                bail!("qemu-system-arm does not listen on port {}", self.port);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(())
    }
}

/// Reads the path from QEMU's line `char device redirected to /dev/pts/3 (label serial0)`.
fn terminal(mut output: impl BufRead) -> Result<String> {
    let mut line = String::new();
    output.read_line(&mut line)?;
    let path = line.split(' ').find(|word| word.starts_with("/dev/"));
    Ok(path.with_context(|| format!("qemu-system-arm said: {line}"))?.to_owned())
}
