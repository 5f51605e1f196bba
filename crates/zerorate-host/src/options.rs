//! Parses the options in device addresses: `/dev/spidev0.0?rdy=gpiochip0:25&hz=4000000`.

use adis16130::{Config, ConversionTime, Framing, MAX_SCLK_HZ, RdyEdge, Width};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use zerorate::Axis;

/// Options of a device address that concern the part itself, whatever the connection.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct PartOptions {
    /// Configuration of the part, and the edge of its data-ready line.
    pub config: Config,
    /// The divisor N of a counter in the RDY line, which passes every N-th edge (F-56); 1 without a counter.
    pub divided: u16,
    /// −3 dB bandwidth of the rate, Hz, if it differs from the part's own (F-04).
    pub bandwidth_hz: Option<f64>,
}

/// Default SPI clock, Hz: half of the part's fastest (F-21).
pub const DEFAULT_HZ: u32 = MAX_SCLK_HZ / 2;
pub const SLOWEST_HZ: u32 = 10_000;
pub const MCLK_RANGE_HZ: RangeInclusive<u32> = 1_000..=10_000_000;

pub fn split(text: &str) -> (&str, impl Iterator<Item = &str>) {
    let (name, options) = text.split_once('?').unwrap_or((text, ""));
    (name, options.split('&').filter(|option| !option.is_empty()))
}

/// Describes the options that [`PartOptions::with`] accepts.
pub const PART_OPTIONS: &str = "framing=command|byte (F-22), width=24|16, fw=RATE or fw=RATE:TEMP (F-31), chop=0|1, \
     edge=falling|rising (F-32), divided=N (a counter passes every N-th edge, F-56), roa=none|10nf or \
     bandwidth_hz=HZ (F-04)";
/// Allowed filter words, which have seven bits.
const FW_RANGE: RangeInclusive<u32> = 0..=0x7F;
const DIVIDED_RANGE: RangeInclusive<u32> = 1..=u16::MAX as u32;

impl PartOptions {
    /// The settings of the application note (F-22, F-30), without a counter in the RDY line.
    pub const fn new() -> Self {
        Self { config: Config::new(), divided: 1, bandwidth_hz: None }
    }

    /// Settings for a host that is too slow for the framing of the application note. CS stays low for a whole command
    /// (F-22).
    pub const fn of_host() -> Self {
        Self { config: Config::new().with_framing(Framing::Command), ..Self::new() }
    }

    /// Applies an option of an address. `None` if it is not an option of the part.
    pub fn with(self, option: &str) -> Result<Option<Self>, String> {
        if let Some(text) = option.strip_prefix("divided=") {
            let divided = number("divided", text, DIVIDED_RANGE)? as u16;
            return Ok(Some(Self { divided, ..self }));
        }
        if let Some(bandwidth_hz) = bandwidth(option)? {
            return Ok(Some(Self { bandwidth_hz, ..self }));
        }
        Ok(config_with(self.config, option)?.map(|config| Self { config, ..self }))
    }
}

/// The bandwidth that an option sets, Hz. `Some(None)` means the part's own bandwidth; `None` means that the option
/// does not set the bandwidth.
pub fn bandwidth(option: &str) -> Result<Option<Option<f64>>, String> {
    match option.split_once('=') {
        Some(("roa", "none")) => Ok(Some(None)),
        Some(("roa", "10nf")) => Ok(Some(Some(Axis::ADIS16130_ROA_10NF_HZ))),
        Some(("roa", _)) => Err(format!("`{option}`: there are roa=none and roa=10nf (F-04)")),
        Some(("bandwidth_hz", text)) => {
            let hz = text.parse::<f64>().ok().filter(|hz| (0.01..=1e5).contains(hz));
            let wrong = || format!("`{option}`: bandwidth_hz takes a number from 0.01 to 100000");
            hz.map(|hz| Some(Some(hz))).ok_or_else(wrong)
        }
        _ => Ok(None),
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

/// Parses a GPIO line: `gpiochip0:25` or `/dev/gpiochip0:25`.
pub fn gpio_line(text: &str) -> Result<(PathBuf, u32), String> {
    let parts = text.rsplit_once(':').and_then(|(chip, line)| Some((chip, line.parse().ok()?)));
    let (chip, line) = parts
        .filter(|(chip, _)| !chip.is_empty())
        .ok_or_else(|| format!("`{text}` is not CHIP:LINE, as in gpiochip0:25 (gpioinfo lists them)"))?;
    let chip = if chip.starts_with('/') { chip.into() } else { PathBuf::from("/dev").join(chip) };
    Ok((chip, line))
}

pub fn number(key: &str, text: &str, range: RangeInclusive<u32>) -> Result<u32, String> {
    let value = text.parse().ok().filter(|value| range.contains(value));
    value.ok_or_else(|| format!("{key}={text}: {key} takes a whole number from {} to {}", range.start(), range.end()))
}
