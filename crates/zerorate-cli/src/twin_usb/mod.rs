//! The twin as hardware behind an emulated USB adapter, on a socket that QEMU plugs into a guest.
//!
//! [`redir`] and [`ljca`] decode bytes, and [`part`] runs the twin on wall time. This module has the loop between
//! them.

pub mod ljca;
mod part;
pub mod redir;

pub use part::{Final, Served};

use crate::interrupt;
use crate::output::{Recording, say};
use adis16130_twin::Spec;
use anyhow::{Context, Result, bail};
use ljca::{ANNOUNCEMENT, Ljca};
use part::WallPart;
use redir::{Connection, Request, Status};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

/// The properties of the part, and its log.
pub struct Setup {
    pub spec: Spec,
    /// Whether it converts from the start, with the registers of F-30.
    pub initialised: bool,
    /// The file for every frame of the bus.
    pub wire: Option<Recording>,
}

/// Plugs the part in at `socket`, which QEMU listens on, until the other end closes it or Ctrl-C unplugs it.
///
/// The part is switched on when the connection is made.
pub fn serve(socket: &Path, setup: Setup) -> Result<Final> {
    let stream = connect(socket)?;
    let part = WallPart::new(setup.spec, setup.initialised, setup.wire)?;
    let mut plug = Plug {
        stream,
        connection: Connection::default(),
        ljca: Ljca::default(),
        part,
        configuration: 0,
        wanted: VecDeque::new(),
        waiting: VecDeque::new(),
    };
    plug.stream.write_all(&Connection::hello_packet(zerorate::SOFTWARE))?;
    while !interrupt::asked() && plug.turn()? {}
    // the other end may be gone already
    let _ = plug.stream.write_all(&plug.connection.disconnect_packet());
    plug.part.finish(plug.ljca.events())
}

/// Time for the other end to begin listening.
const PATIENCE: Duration = Duration::from_secs(30);
const RETRY: Duration = Duration::from_millis(50);
/// Ctrl-C is checked at least this often.
const LONGEST_WAIT: Duration = Duration::from_millis(100);
/// Largest number of messages that the host has not fetched. Each answers a message of the host, or is the event of
/// the line.
const MOST_WAITING: usize = 64;

fn connect(socket: &Path) -> Result<UnixStream> {
    let started = Instant::now();
    loop {
        match UnixStream::connect(socket) {
            Ok(stream) => return Ok(stream),
            Err(error) if started.elapsed() >= PATIENCE || interrupt::asked() => {
                return Err(error).with_context(|| {
                    format!(
                        "nothing listens on {}: start QEMU with -chardev socket,id=r,path={},server=on and -device \
                         usb-redir,chardev=r",
                        socket.display(),
                        socket.display()
                    )
                });
            }
            Err(_) => std::thread::sleep(RETRY),
        }
    }
}

/// The adapter with the part on it, plugged into a socket.
struct Plug {
    stream: UnixStream,
    connection: Connection,
    ljca: Ljca,
    part: WallPart,
    configuration: u8,
    /// In-transfers that the host has requested: id, endpoint.
    wanted: VecDeque<(u64, u8)>,
    /// Messages that the host has not fetched yet.
    waiting: VecDeque<Vec<u8>>,
}

impl Plug {
    /// Waits for the host or the part, and serves it. Returns `false` if the other end is gone.
    fn turn(&mut self) -> Result<bool> {
        let open = if self.host_speaks()? { self.hear()? } else { true };
        if self.part.rdy_fell()
            && let Some(event) = self.ljca.rdy_fell()
        {
            self.waiting.push_back(event);
        }
        self.deliver()?;
        Ok(open)
    }

    fn host_speaks(&self) -> Result<bool> {
        let idle = if self.ljca.wants_rdy() { self.part.idle_time().min(LONGEST_WAIT) } else { LONGEST_WAIT };
        let mut fds = [PollFd::new(&self.stream, PollFlags::IN)];
        let timeout = Timespec { tv_sec: idle.as_secs() as i64, tv_nsec: i64::from(idle.subsec_nanos()) };
        match poll(&mut fds, Some(&timeout)) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error).context("waiting for the socket"),
        }
    }

    fn hear(&mut self) -> Result<bool> {
        let mut bytes = [0; 4096];
        match self.stream.read(&mut bytes) {
            Ok(0) => return Ok(false),
            Ok(length) => self.connection.push(&bytes[..length]),
            Err(error) if error.kind() == ErrorKind::ConnectionReset => return Ok(false),
            Err(error) if error.kind() == ErrorKind::Interrupted => return Ok(true),
            Err(error) => return Err(error).context("reading the socket"),
        }
        while let Some((id, request)) = self.connection.next()? {
            self.serve(id, request)?;
        }
        Ok(true)
    }

    fn serve(&mut self, id: u64, request: Request) -> Result<()> {
        let answer = match request {
            Request::Hello(name) => {
                say(format_args!("plugged into {name}"));
                self.connection.connect_packets(&ANNOUNCEMENT)
            }
            Request::Reset => {
                self.ljca = Ljca::default();
                self.waiting.clear();
                return Ok(());
            }
            Request::SetConfiguration(configuration) => {
                self.configuration = configuration;
                self.connection.configuration_status(id, configuration)
            }
            Request::GetConfiguration => self.connection.configuration_status(id, self.configuration),
            Request::SetAltSetting { interface, alt } => self.connection.alt_setting_status(id, interface, alt),
            Request::GetAltSetting { interface } => self.connection.alt_setting_status(id, interface, 0),
            Request::Cancel => self.cancel(id),
            Request::Control(control) => {
                let data = self.ljca.control(&control);
                self.connection.control_result(id, &control, data.as_deref())
            }
            Request::Bulk { endpoint, .. } if endpoint & 0x80 != 0 => {
                self.wanted.push_back((id, endpoint));
                return Ok(());
            }
            Request::Bulk { endpoint, length, data } => {
                self.waiting.extend(self.ljca.message(&data, &mut self.part));
                self.connection.bulk_result(id, endpoint, Status::Success, length, &[])
            }
            Request::Other(_) => return Ok(()),
        };
        self.send(&answer)
    }

    fn cancel(&mut self, id: u64) -> Vec<u8> {
        let Some(at) = self.wanted.iter().position(|(wanted, _)| *wanted == id) else { return vec![] };
        let endpoint = self.wanted.remove(at).map_or(0, |(_, endpoint)| endpoint);
        self.connection.bulk_result(id, endpoint, Status::Cancelled, 0, &[])
    }

    /// Hands messages to the in-transfers that wait for them.
    fn deliver(&mut self) -> Result<()> {
        if self.waiting.len() > MOST_WAITING {
            bail!("the host sends commands and fetches no answers");
        }
        while !self.wanted.is_empty()
            && let Some(message) = self.waiting.pop_front()
        {
            let Some((id, endpoint)) = self.wanted.pop_front() else { break };
            let packet = self.connection.bulk_result(id, endpoint, Status::Success, message.len() as u32, &message);
            self.send(&packet)?;
        }
        Ok(())
    }

    fn send(&mut self, packet: &[u8]) -> Result<()> {
        match self.stream.write_all(packet) {
            // the next read finds the end of the connection
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            sent => sent.context("writing to the socket"),
        }
    }
}
