//! The kinds of devices, and their addresses.

use crate::address::Address;
use crate::bridge::BridgeAddress;
use crate::replay::ReplayAddress;
use crate::source::{Setup, Source};
use crate::twin::TwinAddress;
use crate::{Result, Stop};
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

#[cfg(target_os = "linux")]
use crate::{iio::IioAddress, spi::SpiAddress};

/// A kind of device, with the prefix and the syntax of its addresses.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The prefix of the addresses, before the colon.
    pub name: &'static str,
    /// The syntax of the addresses.
    pub form: &'static str,
    parse: fn(&str) -> ParseResult,
}

type ParseResult = Result<Arc<dyn Address>, String>;

/// All kinds of devices. To add a kind, add a file with its address and its source, and a row here.
pub const KINDS: &[Kind] = &[
    Kind { name: "twin", form: "twin:, twin:KEY=VALUE,…", parse: |keys| shared(TwinAddress::read(keys)) },
    Kind { name: "replay", form: "replay:FILE", parse: |path| shared(ReplayAddress::read(path)) },
    #[cfg(target_os = "linux")]
    Kind { name: "spi", form: "spi:/dev/spidevB.C?rdy=CHIP:LINE", parse: |text| shared(SpiAddress::read(text)) },
    #[cfg(not(target_os = "linux"))]
    Kind { name: "spi", form: "spi:/dev/spidevB.C?rdy=CHIP:LINE (Linux)", parse: only_linux },
    #[cfg(target_os = "linux")]
    Kind { name: "iio", form: "iio:NAME", parse: |text| shared(IioAddress::read(text)) },
    #[cfg(not(target_os = "linux"))]
    Kind { name: "iio", form: "iio:NAME (Linux)", parse: only_linux },
    Kind { name: "bridge", form: "bridge:/dev/ttyACM0", parse: |text| shared(BridgeAddress::read_serial(text)) },
    Kind { name: "tcp", form: "tcp:HOST:PORT", parse: |text| shared(BridgeAddress::read_tcp(text)) },
];

fn shared<A: Address + 'static>(address: Result<A, String>) -> ParseResult {
    Ok(Arc::new(address?))
}

#[cfg(not(target_os = "linux"))]
fn only_linux(_: &str) -> ParseResult {
    Err("spi: and iio: devices are read through the kernel of Linux; on this system use bridge:, tcp:, twin: or \
        replay:"
        .to_owned())
}

/// The device that `--device` names.
#[derive(Clone, Debug)]
pub struct DeviceSpec {
    /// The address as the user wrote it.
    text: String,
    address: Arc<dyn Address>,
}

impl DeviceSpec {
    /// The address of a recording.
    #[must_use]
    pub fn replay(path: PathBuf) -> Self {
        Self { text: format!("replay:{}", path.display()), address: Arc::new(ReplayAddress { path }) }
    }

    /// The path of the recording; `None` for any other device.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.address.file()
    }

    /// True if the device is simulated, so that it can follow the ambient temperature of its [`Setup`].
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        self.address.is_simulated()
    }

    /// Opens the device. [`Source::initialise`] initialises the part later. `stop` ends every long wait.
    pub fn open(&self, setup: &Setup, stop: &Stop) -> Result<Box<dyn Source>> {
        self.address.open(&self.text, setup, stop)
    }
}

impl FromStr for DeviceSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once(':');
        let kind = parts.and_then(|(name, rest)| Some((KINDS.iter().find(|kind| kind.name == name)?, rest)));
        match (kind, meant(text)) {
            (Some((kind, rest)), _) => Ok(Self { text: text.to_owned(), address: (kind.parse)(rest)? }),
            (None, _) if text == "twin" => Err("write twin: with the colon".to_owned()),
            (None, Some(meant)) => Err(format!("did you mean {meant}?")),
            (None, None) if Path::new(text).is_file() => {
                Err(format!("that is a file; to replay it write replay:{text}"))
            }
            (None, None) => {
                let forms: Vec<&str> = KINDS.iter().map(|kind| kind.form).collect();
                Err(format!("no such kind of device; there are {}", forms.join(", ")))
            }
        }
    }
}

/// Suggests the full address if the user wrote a port, a bus, an IIO folder or a host without the kind.
fn meant(text: &str) -> Option<String> {
    let is_number = |text: &str| text.parse::<u16>().is_ok();
    let ports = ["/dev/tty", "/dev/cu.", "/dev/serial/", "/dev/rfcomm"];
    if ports.iter().any(|start| text.starts_with(start)) || text.strip_prefix("COM").is_some_and(is_number) {
        return Some(format!("bridge:{text}"));
    }
    if text.starts_with("/dev/spidev") {
        let rdy = if text.contains("rdy=") { "" } else { "?rdy=CHIP:LINE" };
        return Some(format!("spi:{text}{rdy}"));
    }
    if let Some(name) = text.strip_prefix("/sys/bus/iio/devices/") {
        return Some(format!("iio:{name}"));
    }
    let (host, port) = text.rsplit_once(':')?;
    // a host has a dot or is this computer; `usb:1` is an unknown kind
    let is_host = host == "localhost" || host.contains('.');
    (is_host && is_number(port)).then(|| format!("tcp:{text}"))
}

impl fmt::Display for DeviceSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
