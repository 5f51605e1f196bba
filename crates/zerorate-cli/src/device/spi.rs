//! The part on a Linux SPI bus: spidev for the bus, the GPIO character device for the edges of RDY.

use super::Bus;
use super::address::SpiAddress;
use super::live::{Edges, Live};
use super::pin::PinError;
use super::reader::{Reader, WhenFull};
use crate::output::say;
use adis16130::{Config, Edge, Framing, MAX_SCLK_HZ, RdyEdge, Sample, SamplerConfig, SelfTest};
use anyhow::{Context, Result, anyhow, bail};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiDevice};
use gpiocdev::Request;
use gpiocdev::line::{EdgeDetection, Value};
use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;
use rustix::mm::{MlockAllFlags, mlockall};
use spidev::{SpiModeFlags, Spidev, SpidevOptions, SpidevTransfer};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// Edges that the kernel keeps until they are read; it allows no more for one line.
const KERNEL_EDGES: u32 = 1024;
/// Edges fetched at once.
const EDGES_AT_ONCE: usize = 64;
/// SCHED_FIFO priority of the reading thread: above everything ordinary, below the kernel's interrupt threads (50).
const PRIORITY: u8 = 40;
const NOT_REALTIME: &str = "allow it with `sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"`, or \
    in a systemd unit AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK";

/// Reads whose time is taken.
const TIMED_READS: u32 = 200;

/// The part, and the thread that reads it once the first sample was asked for.
pub struct SpiPart {
    address: SpiAddress,
    clock: Arc<AtomicU32>,
    sampling: SamplerConfig,
    state: State,
}

enum State {
    Ready(Box<Live<SpiBus, GpioEdges>>),
    Reading(Reader),
    Ended,
}

impl SpiPart {
    /// Opens both files; sends nothing.
    pub fn open(address: &SpiAddress, sampling: SamplerConfig) -> Result<Self> {
        let clock = Arc::new(AtomicU32::new(address.hz));
        let bus = SpiBus::open(address, Arc::clone(&clock))?;
        let edges = GpioEdges::open(address)?;
        // the commands go as one frame each; where CS is to rise between bytes, the bus splits them
        let config = address.part.config.with_framing(Framing::Command);
        let live = Live::new(bus, edges, config, sampling, address.mclk_hz);
        Ok(Self { address: address.clone(), clock, sampling, state: State::Ready(Box::new(live)) })
    }

    /// What the driver is told of the clock, Hz.
    pub fn mclk_hz(&self) -> u32 {
        self.address.mclk_hz
    }

    /// How the part is configured, and how it is sampled.
    pub fn settings(&self) -> (Config, SamplerConfig) {
        (self.address.part.config, self.sampling)
    }

    /// Resets the part, initialises it, reads everything back. Returns the revision.
    pub fn initialise(&mut self) -> Result<u8> {
        match &mut self.state {
            State::Ready(live) => live.initialise().map_err(|error| explain(error, &self.address)),
            _ => bail!("the part is being read already"),
        }
    }

    /// Tries faster and faster clocks, and times a read at the one that was asked for. Leaves the part configured.
    pub fn try_bus(&mut self) -> Result<Bus> {
        let State::Ready(live) = &mut self.state else { bail!("the part is being read already") };
        let fastest_clean_hz = live.fastest_clean_hz(|hz| {
            self.clock.store(hz, Ordering::Relaxed);
            Ok(hz)
        })?;
        self.clock.store(self.address.hz, Ordering::Relaxed);
        let mut timed = || {
            live.initialise()?;
            let started = Instant::now();
            live.read_often(TIMED_READS)?;
            Ok(started.elapsed().as_secs_f64() / f64::from(TIMED_READS))
        };
        let read_s = timed().map_err(|error| explain(error, &self.address))?;
        Ok(Bus { sclk_hz: self.address.hz, fastest_clean_hz, read_s: Some(read_s) })
    }

    /// What the self-test does to the rate; its pins are on this line.
    pub fn self_test(&mut self, (chip, line): (PathBuf, u32)) -> Result<SelfTest> {
        let State::Ready(live) = &mut self.state else { bail!("the part is being read already") };
        let mut pin = GpioOutput::open(&chip, line)?;
        live.self_test(&mut pin).map_err(|error| explain(error, &self.address))
    }

    /// The next sample.
    pub fn next(&mut self) -> Result<Sample> {
        loop {
            match std::mem::replace(&mut self.state, State::Ended) {
                State::Ready(mut live) => {
                    let address = self.address.clone();
                    let next = move || live.next().map_err(|error| explain(error, &address));
                    self.state = State::Reading(Reader::start(WhenFull::Drop, become_realtime, next)?);
                }
                State::Reading(reader) => {
                    let sample = reader.next();
                    self.state = State::Reading(reader);
                    return sample;
                }
                State::Ended => bail!("the part is no longer read"),
            }
        }
    }

    /// Samples that were read but could not be stored in time.
    pub fn overflowed(&self) -> u64 {
        match &self.state {
            State::Reading(reader) => reader.overflowed(),
            _ => 0,
        }
    }
}

/// Priority and locked memory, or a word on how to allow them.
fn become_realtime() {
    let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::try_from(PRIORITY).map_err(|why| why.to_owned());
    let set = priority.and_then(|priority| {
        set_thread_priority_and_policy(thread_native_id(), priority, fifo).map_err(|error| error.to_string())
    });
    if set.is_err() {
        say(format_args!(
            "warning: no-realtime-priority: other programs can delay the reading and cost samples; {NOT_REALTIME}"
        ));
    }
    if mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT).is_err() {
        say(format_args!(
            "warning: memory-not-locked: the reading thread may have to wait for memory that was swapped out; \
             {NOT_REALTIME}"
        ));
    }
}

/// Says which file failed and what to do, where the system said why.
fn explain(error: anyhow::Error, address: &SpiAddress) -> anyhow::Error {
    let spi = address.spi.display();
    let gone = [Errno::NODEV, Errno::SHUTDOWN, Errno::NXIO, Errno::NOENT];
    let text = format!("{error:#}");
    match gone.iter().find(|errno| text.contains(&os_text(**errno))) {
        Some(_) => error.context(format!(
            "{spi} is gone: the SPI adapter was unplugged or its driver unbound; plug it in and start again"
        )),
        None if text.contains(&os_text(Errno::TIMEDOUT)) => {
            error.context(format!("{spi} does not finish its transfers: check the SPI adapter (dmesg tells more)"))
        }
        None => error,
    }
}

fn os_text(errno: Errno) -> String {
    format!("os error {}", errno.raw_os_error())
}

// ---- the bus ----

/// A spidev file as an embedded-hal device.
pub struct SpiBus {
    spi: Spidev,
    clock: Arc<AtomicU32>,
    /// CS rises after every byte of a command (F-22).
    split: bool,
}

impl SpiBus {
    fn open(address: &SpiAddress, clock: Arc<AtomicU32>) -> Result<Self> {
        let path = &address.spi;
        let mut spi = Spidev::open(path).map_err(|error| why_no_spi(path, error))?;
        flock(spi.inner(), FlockOperation::NonBlockingLockExclusive).map_err(|_| {
            anyhow!(
                "{} is busy: another zerorate is reading this part; end it first (fuser {})",
                path.display(),
                path.display()
            )
        })?;
        let options = SpidevOptions::new()
            .bits_per_word(8)
            .max_speed_hz(MAX_SCLK_HZ)
            .mode(SpiModeFlags::SPI_MODE_3)
            .lsb_first(false)
            .build();
        spi.configure(&options).map_err(|error| why_not_configured(path, error))?;
        Ok(Self { spi, clock, split: address.part.config.framing() == Framing::PerByte })
    }

    /// One message to the kernel: one frame of CS, or one per byte.
    fn message(&self, operations: &mut [Operation<'_, u8>]) -> io::Result<()> {
        let mut transfers = Vec::with_capacity(8);
        for operation in operations.iter_mut() {
            self.add(&mut transfers, operation);
        }
        self.spi.transfer_multiple(&mut transfers)
    }

    fn add<'a>(&self, transfers: &mut Vec<SpidevTransfer<'a, 'a>>, operation: &'a mut Operation<'_, u8>) {
        let first = transfers.len();
        match operation {
            Operation::Read(read) => transfers.push(SpidevTransfer::read(read)),
            Operation::Write(write) => transfers.push(SpidevTransfer::write(write)),
            Operation::Transfer(read, write) => {
                let both = read.len().min(write.len());
                let (read, more_read) = read.split_at_mut(both);
                transfers.push(SpidevTransfer::read_write(&write[..both], read));
                if !more_read.is_empty() {
                    transfers.push(SpidevTransfer::read(more_read));
                }
                if write.len() > both {
                    transfers.push(SpidevTransfer::write(&write[both..]));
                }
            }
            Operation::TransferInPlace(bytes) => {
                let piece = if self.split { 1 } else { bytes.len().max(1) };
                let pieces = bytes.len().div_ceil(piece);
                for (index, bytes) in bytes.chunks_mut(piece).enumerate() {
                    let mut transfer = SpidevTransfer::read_write_in_place(bytes);
                    transfer.cs_change = u8::from(index + 1 < pieces);
                    transfers.push(transfer);
                }
            }
            Operation::DelayNs(ns) => {
                transfers.push(SpidevTransfer::delay(u16::try_from(ns.div_ceil(1000)).unwrap_or(u16::MAX)));
            }
        }
        for transfer in &mut transfers[first..] {
            transfer.speed_hz = self.clock.load(Ordering::Relaxed);
        }
    }
}

impl ErrorType for SpiBus {
    type Error = SpiError;
}

impl SpiDevice for SpiBus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), SpiError> {
        loop {
            match self.message(operations) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                done => return done.map_err(SpiError),
            }
        }
    }
}

/// What the system says about a failed transfer.
pub struct SpiError(io::Error);

impl fmt::Debug for SpiError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

impl Error for SpiError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

fn why_no_spi(path: &Path, error: io::Error) -> anyhow::Error {
    let file = path.display();
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => match holder(path) {
            Some(driver) => format!(
                "no {file}: the kernel driver {driver} holds this part; unbind it \
                 (/sys/bus/spi/drivers/{driver}/unbind), or read through it with --device iio:iio:device0"
            ),
            None => format!(
                "no {file}: no such SPI device; enable it (Raspberry Pi: dtparam=spi=on in config.txt), plug the \
                 adapter in, and look with ls /dev/spidev*"
            ),
        },
        io::ErrorKind::PermissionDenied => {
            format!(
                "no permission to open {file}: sudo usermod -aG spi \"$USER\", then log in again (ls -l {file} shows \
                 the group)"
            )
        }
        io::ErrorKind::ResourceBusy => format!("{file} is busy: another driver or program holds it (fuser {file})"),
        _ => format!("cannot open {file}"),
    };
    anyhow::Error::new(error).context(remedy)
}

/// The driver that is bound to the SPI device which `/dev/spidevB.C` would be, if that is another one.
fn holder(path: &Path) -> Option<String> {
    let number = path.file_name()?.to_str()?.strip_prefix("spidev")?;
    let driver = std::fs::read_link(format!("/sys/bus/spi/devices/spi{number}/driver")).ok()?;
    Some(driver.file_name()?.to_str()?.to_owned())
}

fn why_not_configured(path: &Path, error: io::Error) -> anyhow::Error {
    let file = path.display();
    let text = match error.kind() {
        io::ErrorKind::InvalidInput => format!(
            "{file} cannot do SPI mode 3 with 8-bit words, which the part needs (F-20): use another SPI controller, \
             or spi-gpio"
        ),
        _ => format!("{file} is no spidev device: name the file as ls /dev/spidev* lists it"),
    };
    anyhow::Error::new(error).context(text)
}

// ---- the edges ----

/// The RDY line at the GPIO character device.
pub struct GpioEdges {
    request: Request,
    name: String,
    buffer: Vec<u64>,
    first_ns: Option<u64>,
    last_ns: u64,
}

impl GpioEdges {
    fn open(address: &SpiAddress) -> Result<Self> {
        let (chip, line) = (&address.chip, address.line);
        let edge = match address.part.config.rdy_edge() {
            RdyEdge::Falling => EdgeDetection::FallingEdge,
            RdyEdge::Rising => EdgeDetection::RisingEdge,
        };
        let request = Request::builder()
            .on_chip(chip)
            .with_consumer("zerorate RDY")
            .with_line(line)
            .as_input()
            .with_edge_detection(edge)
            .with_kernel_event_buffer_size(KERNEL_EDGES)
            .request()
            .map_err(|error| why_no_line(chip, line, error))?;
        let buffer = vec![0; EDGES_AT_ONCE * request.edge_event_u64_size()];
        Ok(Self { request, name: format!("{} line {line}", chip.display()), buffer, first_ns: None, last_ns: 0 })
    }

    /// The newest of the edges that wait in the kernel. It counts them all, also those that it had no room for.
    fn newest(&mut self) -> Result<Option<Edge>> {
        let size = self.request.edge_event_u64_size();
        let mut newest = None;
        // at most as many as the kernel keeps: new ones that come meanwhile can wait
        for _ in 0..KERNEL_EDGES as usize / EDGES_AT_ONCE {
            let words = self.request.read_edge_events_into_slice(&mut self.buffer)?;
            if let Some(last) = words.checked_sub(size) {
                let event = self.request.edge_event_from_slice(&self.buffer[last..words])?;
                newest = Some(Edge { t_ns: event.timestamp_ns, seq: event.line_seqno });
            }
            if words < self.buffer.len() || !self.request.has_edge_event()? {
                break;
            }
        }
        Ok(newest)
    }
}

impl Edges for GpioEdges {
    fn next(&mut self, timeout_ns: u64) -> Result<Option<Edge>> {
        let came = self.request.wait_edge_event(Duration::from_nanos(timeout_ns));
        let edge = match came {
            Ok(true) => self.newest().with_context(|| format!("reading the RDY line, {}", self.name))?,
            Ok(false) => None,
            Err(error) if error.to_string().contains(&os_text(Errno::INTR)) => return self.next(timeout_ns),
            Err(error) => return Err(error).with_context(|| format!("waiting for the RDY line, {}", self.name)),
        };
        if let Some(edge) = edge {
            self.first_ns.get_or_insert(edge.t_ns);
            self.last_ns = edge.t_ns;
        }
        Ok(edge)
    }

    fn now(&self) -> String {
        let elapsed_ns = self.last_ns.saturating_sub(self.first_ns.unwrap_or(self.last_ns));
        format!("{:.1} s after the first edge", elapsed_ns as f64 * 1e-9)
    }
}

/// A line that drives the self-test pins, inactive at first; the kernel lets it go when the program ends.
struct GpioOutput {
    request: Request,
    line: u32,
}

impl GpioOutput {
    fn open(chip: &Path, line: u32) -> Result<Self> {
        let request = Request::builder()
            .on_chip(chip)
            .with_consumer("zerorate self-test")
            .with_line(line)
            .as_output(Value::Inactive)
            .request()
            .map_err(|error| why_no_line(chip, line, error))?;
        Ok(Self { request, line })
    }
}

impl digital::ErrorType for GpioOutput {
    type Error = PinError;
}

impl OutputPin for GpioOutput {
    fn set_low(&mut self) -> Result<(), PinError> {
        self.request.set_value(self.line, Value::Inactive).map(drop).map_err(PinError::new)
    }

    fn set_high(&mut self) -> Result<(), PinError> {
        self.request.set_value(self.line, Value::Active).map(drop).map_err(PinError::new)
    }
}

fn why_no_line(chip: &Path, line: u32, error: gpiocdev::Error) -> anyhow::Error {
    let file = chip.display();
    let text = format!("{error}");
    let is = |errno: Errno| text.contains(&os_text(errno));
    let remedy = if is(Errno::BUSY) {
        format!("line {line} of {file} is busy: gpioinfo shows who uses it; RDY needs a line of its own")
    } else if is(Errno::ACCESS) || is(Errno::PERM) || text.contains("not have permission") {
        format!(
            "no permission to open {file}: sudo usermod -aG gpio \"$USER\", then log in again (ls -l {file} shows the \
             group)"
        )
    } else if is(Errno::INVAL) {
        format!("{file} has no line {line} that can raise interrupts: gpioinfo lists its lines")
    } else {
        format!("no GPIO chip {file}: ls /dev/gpiochip* lists them; RDY (pin 10) needs one of their lines")
    };
    anyhow::Error::new(error).context(remedy)
}
