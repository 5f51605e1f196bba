//! Addresses of bridges, with the settings of the part behind the bridge.

use crate::options::{DEFAULT_HZ, MCLK_RANGE_HZ, PART_OPTIONS, PartOptions, SLOWEST_HZ, number, split};
use crate::wire::Port;
use adis16130::{MAX_SCLK_HZ, MCLK_HZ};
use std::fmt;
use std::ops::RangeInclusive;

#[derive(Clone, Debug, PartialEq)]
pub struct BridgeAddress {
    pub port: Port,
    /// SPI clock of the bridge, Hz.
    pub hz: u32,
    pub part: PartOptions,
    pub mclk_hz: u32,
}

impl fmt::Display for BridgeAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.port {
            Port::Serial { path, .. } => write!(f, "bridge:{path}"),
            Port::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

/// Default baud rate. It is enough for the full sample rate with a temperature in every sample.
const DEFAULT_BAUD: u32 = 3_000_000;
const BAUD_RANGE: RangeInclusive<u32> = 9_600..=12_000_000;

impl BridgeAddress {
    /// Parses the text after `bridge:`.
    pub fn read_serial(text: &str) -> Result<Self, String> {
        let (path, options) = split(text);
        if path.is_empty() {
            return Err("bridge: needs the serial port, as in bridge:/dev/ttyACM0".to_owned());
        }
        let mut baud = DEFAULT_BAUD;
        let rest: Vec<&str> = options.collect();
        let (bauds, rest): (Vec<&str>, Vec<&str>) = rest.into_iter().partition(|option| option.starts_with("baud="));
        for option in bauds {
            baud = number("baud", option.trim_start_matches("baud="), BAUD_RANGE)?;
        }
        let port = Port::Serial { path: path.to_owned(), baud };
        Self::with_options(port, &rest, "baud=N, hz=SCLK, mclk=HZ")
    }

    /// Parses the text after `tcp:`.
    pub fn read_tcp(text: &str) -> Result<Self, String> {
        let (address, options) = split(text);
        let port = address.rsplit_once(':').filter(|(host, _)| !host.is_empty());
        if port.and_then(|(_, port)| port.parse::<u16>().ok()).is_none() {
            return Err("tcp: needs host and port of the bridge, as in tcp:127.0.0.1:16130".to_owned());
        }
        let port = Port::Tcp(address.to_owned());
        Self::with_options(port, &options.collect::<Vec<_>>(), "hz=SCLK, mclk=HZ")
    }

    fn with_options(port: Port, options: &[&str], known: &str) -> Result<Self, String> {
        let part = PartOptions::of_host();
        let mut address = Self { port, hz: DEFAULT_HZ, part, mclk_hz: MCLK_HZ };
        for option in options {
            match option.split_once('=') {
                Some(("hz", text)) => address.hz = number("hz", text, SLOWEST_HZ..=MAX_SCLK_HZ)?,
                Some(("mclk", text)) => address.mclk_hz = number("mclk", text, MCLK_RANGE_HZ)?,
                _ => match address.part.with(option)? {
                    Some(changed) => address.part = changed,
                    None => return Err(format!("`{option}` is not an option; there are {known}, {PART_OPTIONS}")),
                },
            }
        }
        Ok(address)
    }
}
