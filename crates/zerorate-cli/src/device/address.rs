//! Addresses of devices with options: `/dev/spidev0.0?rdy=gpiochip0:25&hz=4000000`.

use adis16130::{Config, ConversionTime, Framing, MAX_SCLK_HZ, MCLK_HZ, RdyEdge, Width};
use std::fmt;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use zerorate::Axis;

/// A part on a Linux SPI bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SpiAddress {
    /// The spidev file.
    pub spi: PathBuf,
    /// The file of the GPIO chip that RDY is connected to.
    pub chip: PathBuf,
    /// Its line there.
    pub line: u32,
    /// SPI clock, Hz.
    pub hz: u32,
    /// How the part is configured, and how it is wired.
    pub part: PartOptions,
    /// Nominal master clock of the part, Hz.
    pub mclk_hz: u32,
}

/// A part that the kernel's IIO driver reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IioAddress {
    /// The device's folder in sysfs.
    pub folder: PathBuf,
    /// How often it is polled, per second.
    pub hz: u32,
}

/// A part behind a bridge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BridgeAddress {
    /// Where the bridge is.
    pub port: Port,
    /// SPI clock of the bridge, Hz.
    pub hz: u32,
    /// How the part is configured, and how it is wired.
    pub part: PartOptions,
    /// Nominal master clock of the part, Hz.
    pub mclk_hz: u32,
}

/// What an address says of the part itself, whatever it is connected to.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct PartOptions {
    /// How it is configured, and how its wires are heard.
    pub config: Config,
    /// A counter in the line lets every N-th edge of RDY through (F-56).
    pub divided: u16,
}

/// Where a bridge is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Port {
    /// At a serial port; USB ignores the baud rate.
    Serial {
        /// Its file, or its name on systems where ports are no files.
        path: String,
        /// Of a UART.
        baud: u32,
    },
    /// At HOST:PORT.
    Tcp(String),
}

impl fmt::Display for BridgeAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.port {
            Port::Serial { path, .. } => write!(f, "bridge:{path}"),
            Port::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

/// SPI clock unless given, Hz: half of what the part can (F-21).
const DEFAULT_HZ: u32 = MAX_SCLK_HZ / 2;
const SLOWEST_HZ: u32 = 10_000;
const MCLK_RANGE_HZ: RangeInclusive<u32> = 1_000..=10_000_000;
const SPI_EXAMPLE: &str = "spi:/dev/spidev0.0?rdy=gpiochip0:25&hz=4000000";
const POLL_RANGE_HZ: RangeInclusive<u32> = 1..=10_000;
const DEFAULT_POLL_HZ: u32 = 100;
/// Baud rate unless given: enough for the full rate with every temperature.
const DEFAULT_BAUD: u32 = 3_000_000;
const BAUD_RANGE: RangeInclusive<u32> = 9_600..=12_000_000;

impl SpiAddress {
    /// Reads what follows `spi:`.
    pub fn parse(text: &str) -> Result<Self, String> {
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
                            "`{option}` is no option; there are rdy=CHIP:LINE, hz=SCLK, mclk=HZ, {PART_OPTIONS}, as \
                             in {SPI_EXAMPLE}"
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

impl BridgeAddress {
    /// Reads what follows `bridge:`.
    pub fn parse_serial(text: &str) -> Result<Self, String> {
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
        Self::with_options(Port::Serial { path: path.to_owned(), baud }, &rest, "baud=N, hz=SCLK, mclk=HZ")
    }

    /// Reads what follows `tcp:`.
    pub fn parse_tcp(text: &str) -> Result<Self, String> {
        let (address, options) = split(text);
        let port = address.rsplit_once(':').filter(|(host, _)| !host.is_empty());
        if port.and_then(|(_, port)| port.parse::<u16>().ok()).is_none() {
            return Err("tcp: needs host and port of the bridge, as in tcp:127.0.0.1:16130".to_owned());
        }
        Self::with_options(Port::Tcp(address.to_owned()), &options.collect::<Vec<_>>(), "hz=SCLK, mclk=HZ")
    }

    fn with_options(port: Port, options: &[&str], known: &str) -> Result<Self, String> {
        let mut address = Self { port, hz: DEFAULT_HZ, part: PartOptions::of_host(), mclk_hz: MCLK_HZ };
        for option in options {
            match option.split_once('=') {
                Some(("hz", text)) => address.hz = number("hz", text, SLOWEST_HZ..=MAX_SCLK_HZ)?,
                Some(("mclk", text)) => address.mclk_hz = number("mclk", text, MCLK_RANGE_HZ)?,
                _ => match address.part.with(option)? {
                    Some(changed) => address.part = changed,
                    None => return Err(format!("`{option}` is no option; there are {known}, {PART_OPTIONS}")),
                },
            }
        }
        Ok(address)
    }
}

impl IioAddress {
    /// Reads what follows `iio:`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, options) = split(text);
        if name.is_empty() || name.contains('/') {
            return Err("iio: needs the device's name, as in iio:iio:device0 (ls /sys/bus/iio/devices)".to_owned());
        }
        let mut hz = DEFAULT_POLL_HZ;
        for option in options {
            match option.split_once('=') {
                Some(("hz", text)) => hz = number("hz", text, POLL_RANGE_HZ)?,
                _ => {
                    return Err(format!(
                        "`{option}` is no option; there are hz=POLLS_PER_SECOND, roa=none|10nf and bandwidth_hz=HZ \
                         (F-04)"
                    ));
                }
            }
        }
        Ok(Self { folder: PathBuf::from("/sys/bus/iio/devices").join(name), hz })
    }
}

fn split(text: &str) -> (&str, impl Iterator<Item = &str>) {
    let (name, options) = text.split_once('?').unwrap_or((text, ""));
    (name, options.split('&').filter(|option| !option.is_empty()))
}

/// The address without what is said of the bandwidth, and that in Hz: `roa=none`, `roa=10nf` (F-04) or
/// `bandwidth_hz=HZ`.
pub fn without_bandwidth(text: &str) -> Result<(String, Option<f64>), String> {
    let Some((name, options)) = text.split_once('?') else { return Ok((text.to_owned(), None)) };
    let mut bandwidth_hz = None;
    let mut rest = Vec::new();
    for option in options.split('&') {
        match option.split_once('=') {
            Some(("roa", "none")) => bandwidth_hz = None,
            Some(("roa", "10nf")) => bandwidth_hz = Some(Axis::ADIS16130_ROA_10NF_HZ),
            Some(("roa", _)) => return Err(format!("`{option}`: there are roa=none and roa=10nf (F-04)")),
            Some(("bandwidth_hz", text)) => {
                let hz = text.parse::<f64>().ok().filter(|hz| (0.01..=1e5).contains(hz));
                let wrong = || format!("`{option}`: bandwidth_hz takes a number from 0.01 to 100000");
                bandwidth_hz = Some(hz.ok_or_else(wrong)?);
            }
            _ => rest.push(option),
        }
    }
    let rest = rest.join("&");
    Ok((if rest.is_empty() { name.to_owned() } else { format!("{name}?{rest}") }, bandwidth_hz))
}

/// What [`PartOptions::with`] knows, in words.
const PART_OPTIONS: &str = "framing=command|byte (F-22), width=24|16, fw=RATE or fw=RATE:TEMP (F-31), chop=0|1, \
     edge=falling|rising (F-32), divided=N (a counter in the line lets every N-th edge through, F-56), \
     roa=none|10nf or bandwidth_hz=HZ (F-04)";
/// Filter words fit into seven bits.
const FW_RANGE: RangeInclusive<u32> = 0..=0x7F;
const DIVIDED_RANGE: RangeInclusive<u32> = 1..=u16::MAX as u32;

impl PartOptions {
    /// As the note prescribes (F-22, F-30), with nothing in the line of RDY.
    pub const fn new() -> Self {
        Self { config: Config::new(), divided: 1 }
    }

    /// F-22: a host that cannot keep the note's framing at the full rate keeps CS low for a whole command.
    const fn of_host() -> Self {
        Self { config: Config::new().with_framing(Framing::Command), divided: 1 }
    }

    /// These, changed by an option; `None` = that is no option of the part.
    pub fn with(self, option: &str) -> Result<Option<Self>, String> {
        if let Some(text) = option.strip_prefix("divided=") {
            let divided = number("divided", text, DIVIDED_RANGE)? as u16;
            return Ok(Some(Self { divided, ..self }));
        }
        Ok(config_with(self.config, option)?.map(|config| Self { config, ..self }))
    }
}

fn config_with(config: Config, option: &str) -> Result<Option<Config>, String> {
    let Some((key, text)) = option.split_once('=') else { return Ok(None) };
    let changed = match (key, text) {
        ("framing", "byte") => config.with_framing(Framing::PerByte),
        ("framing", "command") => config.with_framing(Framing::Command),
        ("width", "16") => config.with_width(Width::Bits16),
        ("width", "24") => config.with_width(Width::Bits24),
        ("edge", "falling") => config.with_rdy_edge(RdyEdge::Falling),
        ("edge", "rising") => config.with_rdy_edge(RdyEdge::Rising),
        ("chop", "0" | "1") => with_conversions(config, |word| word.with_chop(text == "1")),
        ("fw", _) => {
            let (rate, temp) = text.split_once(':').unwrap_or((text, text));
            let (rate, temp) = (number("fw", rate, FW_RANGE)?, number("fw", temp, FW_RANGE)?);
            let chop = config.rate_conversion().chop();
            let word = |word: u32| ConversionTime::new(word as u8).with_chop(chop);
            config.with_rate_conversion(word(rate)).with_temp_conversion(word(temp))
        }
        ("framing" | "width" | "edge" | "chop", _) => {
            return Err(format!("`{option}`: there are {PART_OPTIONS}"));
        }
        _ => return Ok(None),
    };
    Ok(Some(changed))
}

fn with_conversions(config: Config, change: impl Fn(ConversionTime) -> ConversionTime) -> Config {
    let (rate, temp) = (change(config.rate_conversion()), change(config.temp_conversion()));
    config.with_rate_conversion(rate).with_temp_conversion(temp)
}

/// `gpiochip0:25` or `/dev/gpiochip0:25`.
pub fn gpio_line(text: &str) -> Result<(PathBuf, u32), String> {
    let parts = text.rsplit_once(':').and_then(|(chip, line)| Some((chip, line.parse().ok()?)));
    let (chip, line) = parts
        .filter(|(chip, _)| !chip.is_empty())
        .ok_or_else(|| format!("`{text}` is no CHIP:LINE, as in gpiochip0:25 (gpioinfo lists them)"))?;
    let chip = if chip.starts_with('/') { chip.into() } else { PathBuf::from("/dev").join(chip) };
    Ok((chip, line))
}

fn number(key: &str, text: &str, range: RangeInclusive<u32>) -> Result<u32, String> {
    let value = text.parse().ok().filter(|value| range.contains(value));
    value.ok_or_else(|| format!("{key}={text}: {key} takes a whole number from {} to {}", range.start(), range.end()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_read_whole() {
        let address = SpiAddress::parse("/dev/spidev1.2?rdy=gpiochip4:25&hz=8000000&framing=byte&mclk=105400");
        let expected = SpiAddress {
            spi: "/dev/spidev1.2".into(),
            chip: "/dev/gpiochip4".into(),
            line: 25,
            hz: 8_000_000,
            part: PartOptions::new(),
            mclk_hz: 105_400,
        };
        assert_eq!(address, Ok(expected));
        let plain = SpiAddress::parse("/dev/spidev0.0?rdy=/dev/gpiochip0:3").expect("an address");
        assert_eq!((plain.hz, plain.part.config.framing(), plain.mclk_hz), (5_000_000, Framing::Command, 6_000_000));
        let iio = IioAddress::parse("iio:device0?hz=50").expect("an address");
        assert_eq!((iio.folder.to_str(), iio.hz), (Some("/sys/bus/iio/devices/iio:device0"), 50));
    }

    #[test]
    fn a_bridge_is_a_port_or_a_connection() {
        let serial = BridgeAddress::parse_serial("/dev/ttyUSB0?hz=8000000&baud=2000000").expect("an address");
        assert_eq!(serial.port, Port::Serial { path: "/dev/ttyUSB0".to_owned(), baud: 2_000_000 });
        assert_eq!((serial.hz, serial.mclk_hz), (8_000_000, 6_000_000));
        let tcp = BridgeAddress::parse_tcp("[::1]:16130?mclk=105000").expect("an address");
        assert_eq!((tcp.to_string().as_str(), tcp.mclk_hz), ("tcp:[::1]:16130", 105_000));
        for (wrong, hint) in
            [("", "bridge:/dev/ttyACM0"), ("/dev/ttyACM0?baud=1", "from 9600"), ("x?rdy=1", "`rdy=1`")]
        {
            assert!(BridgeAddress::parse_serial(wrong).unwrap_err().contains(hint), "{wrong}");
        }
        for (wrong, hint) in
            [("", "tcp:127.0.0.1:16130"), ("host", "tcp:127"), (":7", "tcp:127"), ("h:7?baud=9600", "`baud=9600`")]
        {
            assert!(BridgeAddress::parse_tcp(wrong).unwrap_err().contains(hint), "{wrong}");
        }
    }

    #[test]
    fn the_part_is_configured_alike_wherever_it_is() {
        let options = "framing=byte&width=16&fw=9:12&chop=1&edge=rising&divided=50";
        let chopped = |word: u8| ConversionTime::new(0x80 | word);
        let expected = Config::new()
            .with_width(Width::Bits16)
            .with_rate_conversion(chopped(9))
            .with_temp_conversion(chopped(12))
            .with_rdy_edge(RdyEdge::Rising);
        let spi = SpiAddress::parse(&format!("/dev/spidev0.0?rdy=gpiochip0:25&{options}")).expect("an address");
        let serial = BridgeAddress::parse_serial(&format!("/dev/ttyACM0?{options}")).expect("an address");
        let tcp = BridgeAddress::parse_tcp(&format!("localhost:1?{options}")).expect("an address");
        let expected = PartOptions { config: expected, divided: 50 };
        assert_eq!([spi.part, serial.part, tcp.part], [expected; 3]);
        for (wrong, hint) in [
            ("width=20", "width=24|16"),
            ("fw=200", "from 0 to 127"),
            ("edge=up", "falling|rising"),
            ("divided=0", "from 1 to 65535"),
        ] {
            let error = BridgeAddress::parse_serial(&format!("x?{wrong}")).unwrap_err();
            assert!(error.contains(hint), "{error}");
        }
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, hint) in [
            ("", "spi:/dev/spidev0.0"),
            ("/dev/spidev0.0", "rdy=CHIP:LINE"),
            ("/dev/spidev0.0?rdy=25", "gpiochip0:25"),
            ("/dev/spidev0.0?rdy=gpiochip0:25&hz=20000000", "10000000"),
            ("/dev/spidev0.0?rdy=gpiochip0:25&speed=1", "`speed=1`"),
            ("/dev/spidev0.0?rdy=gpiochip0:25&framing=bit", "`framing=bit`"),
        ] {
            let error = SpiAddress::parse(text).unwrap_err();
            assert!(error.contains(hint), "{text}: {error}");
        }
        assert!(IioAddress::parse("").unwrap_err().contains("iio:iio:device0"));
        assert!(IioAddress::parse("iio:device0?hz=0").unwrap_err().contains("from 1"));
    }
}
