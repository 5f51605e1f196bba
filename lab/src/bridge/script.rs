//! Sends the same requests to the emulated controller and to the firmware's loop on the host.

use super::emulator::Emulator;
use super::firmware::{Port, serve};
use adis16130::bridge::{Command, MAX_FRAME, Request, encode};
use adis16130_twin::{Spec, Twin};
use anyhow::{Context, Result, ensure};
use std::collections::VecDeque;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Smallest size of a sample, bytes (docs/formats/bridge.md).
const LEAST_BYTES: usize = 26;
const PATIENCE: Duration = Duration::from_secs(20);

/// Starts the stream on the controller and on the host, and compares as many bytes as this number of samples has at
/// least. Returns the number of bytes, or an error if one differs.
pub fn compare(emulator: &Emulator, seed: u64, samples: u32) -> Result<usize> {
    let start = Command::Start { every_temp: 1, divider: 1, mclk_hz: adis16130::MCLK_HZ };
    let mut room = [0; MAX_FRAME];
    let request = encode(&Request { tag: 1, command: start }, &mut room)?;
    let bytes = samples as usize * LEAST_BYTES;

    let mut stream = TcpStream::connect(("127.0.0.1", emulator.port))?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.write_all(request)?;
    let mut theirs = vec![0; bytes];
    stream.read_exact(&mut theirs).context("the bridge in the emulator sends no samples")?;

    let mut host = Script { requests: request.iter().copied().collect(), sent: Vec::new(), most: bytes };
    let Err(Enough) = serve(&Twin::new(Spec::from_seed(seed)), "host", &mut host);
    ensure!(host.sent.len() >= bytes, "the loop on the host sends no samples");
    let alike = theirs.iter().zip(&host.sent).take_while(|(theirs, ours)| theirs == ours).count();
    ensure!(alike == bytes, "controller and host send the same for {alike} of {bytes} bytes");
    Ok(alike)
}

/// A port that delivers prepared bytes. It closes once enough bytes were sent, or when the reader waits for more.
struct Script {
    requests: VecDeque<u8>,
    sent: Vec<u8>,
    most: usize,
}

struct Enough;

impl Port for Script {
    type Closed = Enough;

    fn read(&mut self, wait: bool) -> Result<Option<u8>, Enough> {
        match self.requests.pop_front() {
            None if wait => Err(Enough),
            byte => Ok(byte),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Enough> {
        self.sent.extend(bytes);
        if self.sent.len() >= self.most { Err(Enough) } else { Ok(()) }
    }
}
