//! `cargo xtask twin-usb`: the twin behind an emulated USB adapter. QEMU plugs it into a guest through a socket.
//!
//! [`redir`] and [`ljca`] encode and decode bytes, and [`part`] runs the twin in real time. This module contains the
//! loop that connects them. README.md specifies the exchange.

#[cfg(test)]
mod fuzz;
mod ljca;
mod part;
mod redir;

pub use part::Summary;

use adis16130_twin::Spec;
use anyhow::{Context, Result, bail};
use ljca::{ANNOUNCEMENT, Ljca};
use part::WallPart;
use redir::{Connection, Request, Status};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
pub struct TwinUsbArgs {
    /// The unix socket that QEMU listens on (-chardev socket,…,server=on)
    socket: PathBuf,
    /// The unit, as in `zerorate --device twin:KEY=VALUE,…`
    #[arg(value_name = "KEY=VALUE,…")]
    keys: Option<Spec>,
    /// Master clock of the converter, Hz
    ///
    /// It may be slower than the key mclk_hz allows, so that a slow host can follow. Temperatures and noise follow the
    /// wall clock.
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1_000..=10_000_000))]
    mclk_hz: Option<u32>,
    /// Convert from the start, as after F-30: for drivers that write no register, such as the driver of Linux
    #[arg(long)]
    initialised: bool,
    /// Log every SPI frame to this file: t_ns,mosi,miso,lost_rate,edges as CSV
    #[arg(long, value_name = "FILE")]
    wire: Option<PathBuf>,
}

/// Plugs the part in, and prints a [`Summary`] after it is unplugged.
pub fn run(args: &TwinUsbArgs) -> Result<()> {
    let mut spec = args.keys.clone().unwrap_or_else(|| Spec::from_seed(1));
    if let Some(mclk_hz) = args.mclk_hz {
        spec.mclk_hz = mclk_hz.into();
    }
    println!("{}", serde_json::to_string_pretty(&serve(args, spec)?)?);
    Ok(())
}

/// Serves the part until the host closes the socket, or Ctrl-C unplugs the part. The part is switched on when the
/// connection is made.
fn serve(args: &TwinUsbArgs, spec: Spec) -> Result<Summary> {
    let unplug = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&unplug))?;
    }
    let unplugged = || unplug.load(Ordering::Relaxed);
    let stream = connect(&args.socket, unplugged)?;
    let part = WallPart::new(spec, args.initialised, args.wire.as_deref())?;
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
    while !unplugged() && plug.turn()? {}
    // the host may have closed the connection already
    let _ = plug.stream.write_all(&plug.connection.disconnect_packet());
    plug.part.finish(plug.ljca.events)
}

/// Time limit for the host to listen.
const PATIENCE: Duration = Duration::from_secs(30);
const RETRY: Duration = Duration::from_millis(50);
/// Longest delay until Ctrl-C is noticed.
const LONGEST_WAIT: Duration = Duration::from_millis(100);
/// Largest number of messages that wait for the host. Each is an answer to a message of the host, or the event of the
/// RDY line.
const MOST_WAITING: usize = 64;

fn connect(socket: &Path, unplugged: impl Fn() -> bool) -> Result<UnixStream> {
    let started = Instant::now();
    loop {
        match UnixStream::connect(socket) {
            Ok(stream) => return Ok(stream),
            Err(error) if started.elapsed() >= PATIENCE || unplugged() => {
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

struct Plug {
    stream: UnixStream,
    connection: Connection,
    ljca: Ljca,
    part: WallPart,
    configuration: u8,
    /// In-transfers that the host has requested: id and endpoint.
    wanted: VecDeque<(u64, u8)>,
    /// Messages that the host has not fetched yet.
    waiting: VecDeque<Vec<u8>>,
}

impl Plug {
    /// Waits for an event of the host or the part, and handles it. Returns `false` if the host has disconnected.
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
        while let Some((id, request)) = self.connection.next().map_err(anyhow::Error::msg)? {
            self.serve(id, request)?;
        }
        Ok(true)
    }

    fn serve(&mut self, id: u64, request: Request) -> Result<()> {
        let answer = match request {
            Request::Hello(name) => {
                eprintln!("plugged into {name}");
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

    /// Answers the requested in-transfers with the waiting messages.
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
            // the next read detects the end of the connection
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            sent => sent.context("writing to the socket"),
        }
    }
}
