//! A server for libiio clients, as docs/libiio.md specifies it. Clients see the device of a [`Hub`] like a device of
//! the Linux kernel, with a buffer.
//!
//! `request.rs`, `session.rs`, `device.rs`, `table.rs`, `scan.rs` and `xml.rs` are the protocol, without sockets or
//! clocks. `connection.rs` and this file connect it to sockets and the hub.

mod connection;
mod correcting;
mod device;
mod request;
mod scan;
mod session;
mod table;
#[cfg(test)]
mod tests;
mod xml;

use crate::hub::Poll;
use crate::{Hub, Stop};
use device::Device;
use std::io::{self, ErrorKind};
use std::net::TcpListener;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use zerorate::Calibration;
use zerorate::calibration::OtherPart;

/// The TCP port of libiio servers.
pub const PORT: u16 = 30431;

/// Largest number of simultaneous connections. A client uses one, and a second one for a buffer.
const MOST_CONNECTIONS: usize = 64;
/// Interval between two checks for new connections.
const POLL: Duration = Duration::from_millis(20);
/// Longest time after the start for which clients wait for the first sample. Clients read all attributes at once, and
/// some attributes need a sample.
const FIRST_SAMPLE: Duration = Duration::from_secs(2);

/// A libiio server for the device that a hub reads.
pub struct Server<'a> {
    hub: &'a Hub,
    device: Device,
}

impl<'a> Server<'a> {
    /// Makes a server. With a calibration, it serves corrected rates as well as the codes.
    ///
    /// # Errors
    /// Returns [`OtherPart`] if the calibration belongs to another part.
    pub fn new(hub: &'a Hub, calibration: Option<&Calibration>) -> Result<Self, OtherPart> {
        Ok(Self { hub, device: Device::new(hub.facts(), calibration)? })
    }

    /// Allows clients to write `calibbias`, the only writable attribute, which shifts this server's corrected rate.
    #[must_use]
    pub fn writable(self) -> Self {
        Self { device: self.device.writable(), ..self }
    }

    /// Serves clients until `stop` is requested. Each client has its own thread, so no client delays another. The
    /// caller must start the reading of the hub.
    ///
    /// # Errors
    /// Returns an error if the listener cannot accept connections. The server then requests `stop` itself, so that
    /// this method returns at once and not after the last client has left.
    pub fn serve(&self, listener: &TcpListener, stop: &Stop) -> io::Result<()> {
        listener.set_nonblocking(true)?;
        let (device, connections) = (&self.device, AtomicUsize::new(0));
        thread::scope(|scope| {
            scope.spawn(|| self.look_on(stop));
            let begun = Instant::now();
            while !stop.asked() {
                let is_early = !device.has_readings() && !device.is_gone() && begun.elapsed() < FIRST_SAMPLE;
                match if is_early { Err(ErrorKind::WouldBlock.into()) } else { listener.accept() } {
                    Ok((stream, _)) => {
                        let taken = Place::take(&connections);
                        let body = move || taken.map(|_place| connection::serve(&stream, self.hub, device, stop));
                        // an error of a client is not an error of the server; if no thread can be started, the
                        // connection is closed
                        drop(thread::Builder::new().name("iiod".to_owned()).spawn_scoped(scope, body));
                    }
                    Err(error) if is_passing(&error) => thread::sleep(POLL),
                    Err(error) => {
                        stop.ask();
                        return Err(error);
                    }
                }
            }
            Ok(())
        })
    }

    /// Updates the readings that the attributes show.
    fn look_on(&self, stop: &Stop) {
        let watcher = self.hub.watch(connection::QUEUE);
        while !stop.asked() {
            match watcher.next_within(POLL) {
                Poll::Samples(watched) => self.device.take(&watched),
                Poll::Nothing => {}
                Poll::End => return self.device.note_gone(),
            }
        }
    }
}

/// One of the [`MOST_CONNECTIONS`] connections, freed on drop.
struct Place<'a>(&'a AtomicUsize);

impl<'a> Place<'a> {
    fn take(connections: &'a AtomicUsize) -> Option<Self> {
        let more = |taken| (taken < MOST_CONNECTIONS).then_some(taken + 1);
        connections.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok().map(|_| Self(connections))
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// True if the error is temporary: no connection is waiting, the client has left, or resources are short.
fn is_passing(error: &io::Error) -> bool {
    let no_descriptor = [23, 24]; // ENFILE, EMFILE
    let kinds =
        [ErrorKind::WouldBlock, ErrorKind::Interrupted, ErrorKind::ConnectionAborted, ErrorKind::ConnectionReset];
    kinds.contains(&error.kind()) || error.raw_os_error().is_some_and(|errno| no_descriptor.contains(&errno))
}
