//! The protocol of one connection, without a socket. A [`Session`] handles a line and returns the action to take.

use super::device::Device;
use super::request::{Errno, Place, Request};
use super::scan::Packing;
use super::xml::{VERSION, describe};
use std::time::Duration;

/// Largest size of a written value, bytes.
pub const LONGEST_VALUE: usize = 4096;

/// The largest buffer that a client may open, in samples. The server allocates no memory for the buffer, since it
/// sends samples as they come.
const MOST_SAMPLES: usize = 1 << 24;

/// Default of the longest wait for samples. A client of libiio 0.24 hangs up after twice this time.
const PATIENCE: Duration = Duration::from_millis(2500);

pub struct Session<'a> {
    device: &'a Device,
    buffer: Option<Open>,
    /// Longest wait for samples; `None` if there is no limit.
    pub patience: Option<Duration>,
    /// The axis whose correction the next value will set, or the reason to refuse the value.
    writing: Option<Result<usize, Errno>>,
}

#[derive(Clone, Debug)]
pub struct Open {
    pub packing: Packing,
    /// The channel mask, as the client sent it.
    pub mask: u32,
}

/// The action that a connection has to take next.
#[derive(Debug)]
pub enum Step {
    /// Send nothing.
    Nothing,
    /// Send these bytes.
    Reply(Vec<u8>),
    /// Receive this many bytes and pass them to [`Session::written`], even if the value will be refused.
    Take(usize),
    /// Start to watch the device, then send 0.
    Open(Open),
    /// Send samples of the open buffer, up to this many bytes.
    Fill(usize),
    /// Stop watching, then send 0.
    Close,
    /// Send these bytes, and hang up.
    HangUp(Vec<u8>),
}

impl<'a> Session<'a> {
    pub fn new(device: &'a Device) -> Self {
        Self { device, buffer: None, patience: Some(PATIENCE), writing: None }
    }

    pub fn line(&mut self, line: &[u8]) -> Step {
        match Request::parse(line).and_then(|request| self.request(request)) {
            Ok(step) => step,
            Err(errno) if is_http(line) => Step::HangUp(refusal(errno)),
            Err(errno) => Step::Reply(refusal(errno)),
        }
    }

    pub fn written(&mut self, value: &[u8]) -> Vec<u8> {
        let Some(axis) = self.writing.take() else { return refusal(Errno::NONSENSE) };
        match axis.and_then(|axis| self.device.trim(axis, value)) {
            Ok(()) => number(value.len()),
            Err(errno) => refusal(errno),
        }
    }

    fn request(&mut self, request: Request<'_>) -> Result<Step, Errno> {
        match request {
            Request::Nothing => Ok(Step::Nothing),
            Request::Help => Ok(Step::Reply(HELP.as_bytes().to_vec())),
            Request::Exit => Ok(Step::HangUp(Vec::new())),
            Request::Version => Ok(Step::Reply(version())),
            Request::Print => Ok(Step::Reply(counted(describe(self.device).as_bytes()))),
            Request::Timeout(patience) => {
                self.patience = patience;
                Ok(Step::Reply(number(0)))
            }
            Request::Read { device, place, attribute } => self.read(device, place, attribute).map(Step::Reply),
            Request::Write { device, place, attribute, bytes } => Ok(self.write(device, place, attribute, bytes)),
            Request::Open { device, samples, mask } => self.open(device, samples, mask),
            Request::Close { device } => self.close(device),
            Request::ReadBuffer { device, bytes } => self.fill(device, bytes),
            Request::Trigger { device } => Err(self.named(device).err().unwrap_or(Errno::NOT_FOUND)),
            Request::SetTrigger { device, trigger } => {
                self.named(device)?;
                trigger.map_or(Ok(Step::Reply(number(0))), |_| Err(Errno::NOT_FOUND))
            }
            Request::BuffersCount { device } => {
                self.named(device)?;
                Ok(Step::Reply(number(0)))
            }
        }
    }

    fn named(&self, device: &str) -> Result<(), Errno> {
        if self.device.is_called(device) { Ok(()) } else { Err(Errno::NO_DEVICE) }
    }

    fn read(&self, device: &str, place: Place<'_>, attribute: Option<&str>) -> Result<Vec<u8>, Errno> {
        self.named(device)?;
        match attribute {
            Some(attribute) => Ok(counted(self.device.read(place, attribute)?.as_bytes())),
            None => Ok(counted(&self.read_all(place))),
        }
    }

    /// Reads all attributes of a place. Each one starts with four bytes in big-endian order: the length of its value
    /// with a NUL, or a negative error number. Value and NUL follow, padded to a multiple of four bytes.
    fn read_all(&self, place: Place<'_>) -> Vec<u8> {
        let mut all = Vec::new();
        for attribute in self.device.attributes(place) {
            match self.device.read(place, attribute) {
                Ok(value) => {
                    all.extend((value.len() as i32 + 1).to_be_bytes());
                    all.extend(value.as_bytes());
                    all.push(0);
                    all.resize(all.len().next_multiple_of(4), 0);
                }
                Err(Errno(errno)) => all.extend((-errno).to_be_bytes()),
            }
        }
        all
    }

    /// Prepares to write. Even if the write is refused, the client sends the value, so the value must be read.
    fn write(&mut self, device: &str, place: Place<'_>, attribute: &str, bytes: usize) -> Step {
        if bytes > LONGEST_VALUE {
            return Step::HangUp(refusal(Errno::TOO_LARGE));
        }
        let is_known = self.device.is_called(device);
        let axis = if is_known { self.device.writable_axis(place, attribute) } else { Err(Errno::NOT_FOUND) };
        self.writing = Some(axis);
        Step::Take(bytes)
    }

    fn open(&mut self, device: &str, samples: usize, mask: u32) -> Result<Step, Errno> {
        self.named(device)?;
        if self.buffer.is_some() {
            return Err(Errno::BUSY);
        }
        if self.device.is_gone() {
            return Err(Errno::NO_DEVICE);
        }
        if samples > MOST_SAMPLES {
            return Err(Errno::TOO_LARGE);
        }
        let packing = Packing::new(&self.device.table, mask).filter(|_| samples > 0).ok_or(Errno::NONSENSE)?;
        let open = Open { packing, mask };
        self.buffer = Some(open.clone());
        Ok(Step::Open(open))
    }

    fn close(&mut self, device: &str) -> Result<Step, Errno> {
        self.named(device)?;
        self.buffer.take().map(|_| Step::Close).ok_or(Errno::NOT_OPENED)
    }

    /// Reads whole samples from the buffer, as many as fit into `bytes`.
    fn fill(&self, device: &str, bytes: usize) -> Result<Step, Errno> {
        self.named(device)?;
        let size = self.buffer.as_ref().ok_or(Errno::NOT_OPEN)?.packing.size;
        match bytes - bytes % size {
            0 => Ok(Step::Reply(number(0))),
            whole => Ok(Step::Fill(whole)),
        }
    }
}

/// True if the line is an HTTP request. A web page can make a browser send one to this port, with requests to this
/// server in the lines after it.
fn is_http(line: &[u8]) -> bool {
    line.windows(7).any(|word| word == b" HTTP/1")
}

const HELP: &str = "Commands: HELP, EXIT, VERSION, PRINT, TIMEOUT, READ, WRITE, OPEN, CLOSE, READBUF, GETTRIG, \
    SETTRIG, SET. docs/libiio.md of zerorate has them.\n";

fn version() -> Vec<u8> {
    let (major, minor, git) = VERSION;
    format!("{major}.{minor}.{git:<7.7}\n").into_bytes()
}

pub fn number(value: usize) -> Vec<u8> {
    format!("{value}\n").into_bytes()
}

/// A line with the negative error number.
pub fn refusal(Errno(errno): Errno) -> Vec<u8> {
    format!("-{errno}\n").into_bytes()
}

/// A line with the length, then the bytes and a line end.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&number(bytes.len()), bytes, b"\n"].concat()
}
