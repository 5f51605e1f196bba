//! Carries the protocol over a socket, and sends the samples of a buffer.

use super::device::Device;
use super::request::Errno;
use super::scan::Scanner;
use super::session::{Open, Session, Step, number, refusal};
use crate::hub::Poll;
use crate::{Hub, Stop, WatchedBatch, Watcher};
use std::io::{self, BufRead, BufReader, ErrorKind, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Largest length of a request line, bytes.
const LONGEST_LINE: usize = 1024;
/// Time limit for the rest of a line whose start has arrived, and for a value.
const LONGEST_LINE_TIME: Duration = Duration::from_secs(10);
/// Time without a request after which a client counts as gone.
const LONGEST_SILENCE: Duration = Duration::from_secs(3600);
/// Time without accepting data after which a client counts as gone.
const LONGEST_STALL: Duration = Duration::from_secs(10);
/// Longest delay until a stop is noticed.
const POLL: Duration = Duration::from_millis(100);
/// Number of batches that are queued for a client: 2.5 s of a live part.
pub const QUEUE: usize = 128;

/// Serves a client until it hangs up or `stop` is requested.
pub fn serve(stream: &TcpStream, hub: &Hub, device: &Device, stop: &Stop) -> io::Result<()> {
    let mut peer = Peer::new(stream, stop)?;
    let mut session = Session::new(device);
    let mut buffer = None;
    while let Some(line) = peer.line()? {
        match session.line(&line) {
            Step::Nothing => {}
            Step::Reply(reply) => peer.send(&reply)?,
            Step::Take(bytes) => {
                let value = peer.value(bytes)?;
                peer.send(&session.written(&value))?;
            }
            Step::Open(open) => {
                buffer = Some(Buffer::new(hub, device, open));
                peer.send(&number(0))?;
            }
            Step::Fill(bytes) => match &mut buffer {
                Some(buffer) => buffer.fill(&mut peer, bytes, session.patience)?,
                None => peer.send(&refusal(Errno::NOT_OPEN))?,
            },
            Step::Close => {
                buffer = None;
                peer.send(&number(0))?;
            }
            Step::HangUp(reply) => return peer.send(&reply),
        }
    }
    Ok(())
}

/// A client's open buffer. It watches the hub and counts the samples that it missed.
struct Buffer<'a> {
    watcher: Watcher,
    device: &'a Device,
    scanner: Scanner,
    open: Open,
    /// The samples as bytes. Those from `sent` on were not sent yet.
    bytes: Vec<u8>,
    sent: usize,
}

impl<'a> Buffer<'a> {
    fn new(hub: &Hub, device: &'a Device, open: Open) -> Self {
        Self { watcher: hub.watch(QUEUE), device, scanner: device.scanner(), open, bytes: Vec::new(), sent: 0 }
    }

    /// Sends samples as they come, until `bytes` are sent, none comes within `patience`, or the device is gone.
    fn fill(&mut self, peer: &mut Peer<'_>, bytes: usize, patience: Option<Duration>) -> io::Result<()> {
        let mut left = bytes;
        while left > 0 {
            match self.wait(patience, peer.stop) {
                Poll::Samples(()) => {}
                Poll::Nothing if left == bytes => return peer.send(&refusal(Errno::TIMED_OUT)),
                Poll::End if left == bytes => return peer.send(&refusal(Errno::NO_DEVICE)),
                Poll::Nothing | Poll::End => return peer.send(&number(0)),
            }
            let chunk = &self.bytes[self.sent..];
            let chunk = &chunk[..chunk.len().min(left)];
            let mask = if left == bytes { format!("{:08x}\n", self.open.mask) } else { String::new() };
            peer.send(&[&number(chunk.len()), mask.as_bytes(), chunk].concat())?;
            self.sent += chunk.len();
            left -= chunk.len();
        }
        Ok(())
    }

    /// Waits until there are samples to send, for `patience` at most. `None` sets no limit.
    fn wait(&mut self, patience: Option<Duration>, stop: &Stop) -> Poll<()> {
        let begun = Instant::now();
        while self.sent == self.bytes.len() {
            match self.watcher.next_within(POLL) {
                Poll::Samples(watched) => self.take(&watched),
                Poll::End => return Poll::End,
                Poll::Nothing if stop.asked() || self.device.is_gone() => return Poll::End,
                Poll::Nothing if patience.is_some_and(|patience| begun.elapsed() >= patience) => {
                    return Poll::Nothing;
                }
                Poll::Nothing => {}
            }
        }
        Poll::Samples(())
    }

    fn take(&mut self, watched: &WatchedBatch) {
        self.bytes.clear();
        self.sent = 0;
        self.device.note_missed(watched.missed);
        let trims_dps = self.device.trims_dps();
        let mut missed = watched.missed + watched.lost;
        for row in &watched.batch.rows {
            if let Some(scan) = self.scanner.push(row, missed, &trims_dps) {
                self.open.packing.pack(&self.device.layout, &scan, &mut self.bytes);
            }
            missed = 0;
        }
    }
}

struct Peer<'a> {
    reader: BufReader<&'a TcpStream>,
    stop: &'a Stop,
}

impl<'a> Peer<'a> {
    fn new(stream: &'a TcpStream, stop: &'a Stop) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(POLL))?;
        stream.set_write_timeout(Some(POLL))?;
        Ok(Self { reader: BufReader::new(stream), stop })
    }

    /// Reads the next line, without its line end. `None` if the client hung up, or sent a line that is too long.
    fn line(&mut self) -> io::Result<Option<Vec<u8>>> {
        let (mut line, mut since, mut limit) = (Vec::new(), Instant::now(), LONGEST_SILENCE);
        loop {
            let chunk = self.more(since, limit)?;
            if chunk.is_empty() {
                return Ok(None);
            }
            let end = chunk.iter().position(|byte| *byte == b'\n');
            line.extend(&chunk[..end.unwrap_or(chunk.len())]);
            let taken = end.map_or(chunk.len(), |end| end + 1);
            self.reader.consume(taken);
            if line.len() > LONGEST_LINE {
                self.send(&refusal(Errno::NONSENSE))?;
                return Ok(None);
            }
            if end.is_some() {
                return Ok(Some(line));
            }
            if limit == LONGEST_SILENCE {
                (since, limit) = (Instant::now(), LONGEST_LINE_TIME);
            }
        }
    }

    fn value(&mut self, bytes: usize) -> io::Result<Vec<u8>> {
        let (mut value, since) = (Vec::with_capacity(bytes), Instant::now());
        while value.len() < bytes {
            let chunk = self.more(since, LONGEST_LINE_TIME)?;
            if chunk.is_empty() {
                return Err(ErrorKind::UnexpectedEof.into());
            }
            let taken = chunk.len().min(bytes - value.len());
            value.extend(&chunk[..taken]);
            self.reader.consume(taken);
        }
        Ok(value)
    }

    /// Waits for received bytes until `limit` after `since`; empty if the client hung up.
    fn more(&mut self, since: Instant, limit: Duration) -> io::Result<&[u8]> {
        loop {
            match self.reader.fill_buf() {
                Ok(_) => break,
                Err(error) if is_wait(&error) => {}
                Err(error) => return Err(error),
            }
            if self.stop.asked() || since.elapsed() > limit {
                return Err(ErrorKind::TimedOut.into());
            }
        }
        Ok(self.reader.buffer())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let (mut left, mut since) = (bytes, Instant::now());
        while !left.is_empty() {
            match self.reader.get_mut().write(left) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(taken) => (left, since) = (&left[taken..], Instant::now()),
                Err(error) if is_wait(&error) => {}
                Err(error) => return Err(error),
            }
            if !left.is_empty() && (self.stop.asked() || since.elapsed() > LONGEST_STALL) {
                return Err(ErrorKind::TimedOut.into());
            }
        }
        Ok(())
    }
}

/// True if the operation may be repeated after this error.
fn is_wait(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
