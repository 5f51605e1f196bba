//! A part on a Linux SPI bus.

use crate::Stop;
use crate::address::Address;
use crate::connected::{ConnectedPart, Connection};
use crate::error::{Cause, UserError, no_permission};
use crate::gpio::{GpioEdges, GpioOutput, errno};
use crate::live::Live;
use crate::options::{DEFAULT_HZ, MCLK_RANGE_HZ, PART_OPTIONS, PartOptions, SLOWEST_HZ, gpio_line, number, split};
use crate::pin::HalError;
use crate::reader::{QUEUE, Reader, WhenFull};
use crate::source::{DeviceInfo, Setup, Source};
use crate::warning::SourceWarning;
use adis16130::{Framing, MAX_SCLK_HZ, MCLK_HZ};
use anyhow::Result;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use preempt_rt::sched::{Pid, Scheduler, SchedulerParams, set_scheduler};
use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;
use rustix::mm::{MlockAllFlags, mlockall};
use spidev::{SpiModeFlags, Spidev, SpidevOptions, SpidevTransfer};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicI32, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use zerorate::{Setting, SettingNames};

/// SCHED_FIFO priority of the reading thread: above ordinary threads, below the kernel's interrupt threads (50).
const PRIORITY: i32 = 40;

const SPI_EXAMPLE: &str = "spi:/dev/spidev0.0?rdy=gpiochip0:25&hz=4000000";

/// The address `spi:/dev/spidevB.C?rdy=CHIP:LINE`.
#[derive(Clone, Debug, PartialEq)]
pub struct SpiAddress {
    pub spi: PathBuf,
    /// The GPIO chip of the RDY line.
    pub chip: PathBuf,
    /// The number of the RDY line on that chip.
    pub line: u32,
    /// SPI clock, Hz.
    pub hz: u32,
    pub part: PartOptions,
    pub mclk_hz: u32,
}

impl SpiAddress {
    /// Parses the text after `spi:`.
    pub fn read(text: &str) -> Result<Self, String> {
        let (spi, options) = split(text);
        if !spi.starts_with('/') {
            return Err(format!("spi: needs the spidev file and the RDY line, as in {SPI_EXAMPLE}"));
        }
        let mut rdy = None;
        let (mut hz, mut part, mut mclk_hz) = (DEFAULT_HZ, PartOptions::of_host(), MCLK_HZ);
        for option in options {
            match option.split_once('=') {
                Some(("rdy", line)) => rdy = Some(gpio_line(line)?),
                Some(("hz", text)) => hz = number("hz", text, SLOWEST_HZ..=MAX_SCLK_HZ)?,
                Some(("mclk", text)) => mclk_hz = number("mclk", text, MCLK_RANGE_HZ)?,
                _ => match part.with(option)? {
                    Some(changed) => part = changed,
                    None => {
                        return Err(format!(
                            "`{option}` is not an option; there are rdy=CHIP:LINE, hz=SCLK, mclk=HZ, {PART_OPTIONS}, \
                             as in {SPI_EXAMPLE}"
                        ));
                    }
                },
            }
        }
        let (chip, line) =
            rdy.ok_or_else(|| format!("which line is RDY (pin 10)? give rdy=CHIP:LINE, as in {SPI_EXAMPLE}"))?;
        Ok(Self { spi: spi.into(), chip, line, hz, part, mclk_hz })
    }
}

impl Address for SpiAddress {
    /// Opens the SPI and GPIO files. Nothing is sent to the part.
    fn open(&self, name: &str, setup: &Setup, stop: &Stop) -> crate::Result<Box<dyn Source>> {
        let sampling = setup.sampling.config(self.part.divided);
        let facts = DeviceInfo::of_part(name, &self.part, sampling, self.mclk_hz, setup.part.as_ref())?;
        let (clock, failed) = (Arc::new(AtomicU32::new(self.hz)), LastErrno::default());
        let bus = SpiBus::open(self, Arc::clone(&clock), failed.clone(), setup.names)?;
        let edges = GpioEdges::open(&self.chip, self.line, self.part.config.rdy_edge())?;
        // the driver sends each command as one frame; if CS must rise between bytes, `SpiBus` splits the frame
        let config = self.part.config.with_framing(Framing::Command);
        let live = Live::new(bus, edges, config, sampling, self.mclk_hz, stop);
        let wired = SpiConnection { address: self.clone(), clock, failed, notes: Notes::default() };
        Ok(Box::new(ConnectedPart::new(wired, live, facts)))
    }
}

#[derive(Clone)]
struct SpiConnection {
    address: SpiAddress,
    clock: Arc<AtomicU32>,
    failed: LastErrno,
    notes: Notes,
}

/// The warnings of the reading thread.
type Notes = Arc<Mutex<Vec<SourceWarning>>>;

impl Connection for SpiConnection {
    type Error = HalError;
    type Spi = SpiBus;
    type Edges = GpioEdges;
    type Pin = GpioOutput;

    const IS_BUS: bool = true;

    fn hz(&self) -> u32 {
        self.address.hz
    }

    fn set_clock(&self, hz: u32) -> Result<u32> {
        self.clock.store(hz, Ordering::Relaxed);
        Ok(hz)
    }

    fn self_test_pin(&self, gpio: &str, names: SettingNames) -> Result<GpioOutput> {
        let option = names(Setting::SelfTest);
        let (chip, line) = gpio_line(gpio).map_err(|why| UserError::request(format!("{option}: {why}")))?;
        GpioOutput::open(&chip, line)
    }

    fn start(&self, mut live: Box<Live<SpiBus, GpioEdges>>) -> Result<Reader> {
        let (wired, notes) = (self.clone(), self.notes.clone());
        let next = move || live.next().map_err(|error| wired.explain(error));
        Reader::start(QUEUE, WhenFull::Drop, move || become_realtime(&notes), next)
    }

    fn explain(&self, error: anyhow::Error) -> anyhow::Error {
        explain(error, &self.address, &self.failed)
    }

    fn take_notes(&self) -> Vec<SourceWarning> {
        std::mem::take(&mut *self.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

fn become_realtime(notes: &Notes) {
    let say = |warning| notes.lock().unwrap_or_else(PoisonError::into_inner).push(warning);
    let priority = SchedulerParams { priority: PRIORITY };
    if set_scheduler(Pid::current_thread(), Scheduler::SCHED_FIFO, priority).is_err() {
        say(SourceWarning::NoRealtimePriority);
    }
    if mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT).is_err() {
        say(SourceWarning::MemoryNotLocked);
    }
}

/// The error number of the last failed transfer, which the driver's errors do not carry; 0 without one.
type LastErrno = Arc<AtomicI32>;

/// Adds the name of the spidev file and advice to an error that shows that the SPI adapter is gone or hangs.
fn explain(error: anyhow::Error, address: &SpiAddress, failed: &LastErrno) -> anyhow::Error {
    let spi = address.spi.display();
    let of_line = error.chain().find_map(|source| source.downcast_ref()).and_then(errno);
    let of_bus = Some(failed.load(Ordering::Relaxed)).filter(|raw| *raw > 0).map(Errno::from_raw_os_error);
    let told = match of_line.or(of_bus) {
        Some(Errno::NODEV | Errno::SHUTDOWN | Errno::NXIO | Errno::NOENT) => UserError::new(
            Cause::Gone,
            format!("{spi} is gone: the SPI adapter was unplugged or its driver unbound; plug it in and start again"),
        ),
        Some(Errno::TIMEDOUT) => UserError::new(
            Cause::Silent,
            format!("{spi} does not finish its transfers: check the SPI adapter (dmesg tells more)"),
        ),
        _ => return error,
    };
    error.context(told)
}

struct SpiBus {
    spi: Spidev,
    clock: Arc<AtomicU32>,
    failed: LastErrno,
    /// True if CS rises after every byte of a command (F-22).
    split: bool,
}

impl SpiBus {
    fn open(address: &SpiAddress, clock: Arc<AtomicU32>, failed: LastErrno, names: SettingNames) -> Result<Self> {
        let path = &address.spi;
        let mut spi = Spidev::open(path).map_err(|error| why_no_spi(path, error, names))?;
        flock(spi.inner(), FlockOperation::NonBlockingLockExclusive).map_err(|_| {
            let file = path.display();
            UserError::new(
                Cause::Busy,
                format!("{file} is busy: another zerorate is reading this part; end it first (fuser {file})"),
            )
        })?;
        let options = SpidevOptions::new()
            .bits_per_word(8)
            .max_speed_hz(MAX_SCLK_HZ)
            .mode(SpiModeFlags::SPI_MODE_3)
            .lsb_first(false)
            .build();
        spi.configure(&options).map_err(|error| why_not_configured(path, error))?;
        Ok(Self { spi, clock, failed, split: address.part.config.framing() == Framing::PerByte })
    }

    /// Sends the operations to the kernel as one message. CS is low throughout, except between the bytes of a transfer
    /// in place if `split`.
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
    type Error = HalError;
}

impl SpiDevice for SpiBus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), HalError> {
        loop {
            match self.message(operations) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Ok(()) => return Ok(()),
                Err(error) => {
                    self.failed.store(error.raw_os_error().unwrap_or_default(), Ordering::Relaxed);
                    return Err(HalError::new(error));
                }
            }
        }
    }
}

fn why_no_spi(path: &Path, error: io::Error, names: SettingNames) -> anyhow::Error {
    let file = path.display();
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => match holder(path) {
            Some(driver) => format!(
                "no {file}: the kernel driver {driver} holds this part; unbind it \
                 (/sys/bus/spi/drivers/{driver}/unbind), or read through it with {} iio:iio:device0",
                names(Setting::Device)
            ),
            None => format!(
                "no {file}: no such SPI device; enable it (Raspberry Pi: dtparam=spi=on in config.txt), plug the \
                 adapter in, and look with ls /dev/spidev*"
            ),
        },
        io::ErrorKind::PermissionDenied => no_permission(file, "spi"),
        io::ErrorKind::ResourceBusy => format!("{file} is busy: another driver or program holds it (fuser {file})"),
        _ => format!("cannot open {file}"),
    };
    UserError::of_system(error, remedy)
}

/// The name of the kernel driver that is bound to the SPI device of `/dev/spidevB.C`, if there is one.
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
        _ => format!("{file} is not a spidev device; name a file that ls /dev/spidev* lists"),
    };
    anyhow::Error::new(error).context(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pulled cable fails a transfer or the wait for an edge, depending on what the program does at that time.
    #[test]
    fn a_pulled_cable_is_recognised_on_the_bus_and_on_rdy() {
        let address = SpiAddress::read("/dev/spidev0.0?rdy=gpiochip0:3").unwrap();
        let seen = |raw| {
            let os = gpiocdev::Error::Os(gpiocdev_uapi::Errno(raw));
            let error =
                explain(anyhow::Error::new(os).context("reading the RDY line"), &address, &LastErrno::default());
            crate::DeviceError::from(error).cause()
        };
        assert_eq!(seen(Errno::NODEV.raw_os_error()), Cause::Gone);
        assert_eq!(seen(Errno::IO.raw_os_error()), Cause::Other);
        let of_bus = Arc::new(AtomicI32::new(Errno::SHUTDOWN.raw_os_error()));
        assert!(
            explain(UserError::request("transfer"), &address, &of_bus).to_string().contains("/dev/spidev0.0 is gone")
        );
    }
}
