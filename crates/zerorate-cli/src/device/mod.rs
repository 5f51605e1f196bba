//! Where samples come from: a part on a bus, the simulated part, or a recording of one.

mod address;
mod bridge;
mod iio;
mod live;
mod pin;
mod reader;
mod replay;
#[cfg(target_os = "linux")]
mod spi;
mod twin;

use crate::cli::SamplingArgs;
use crate::exit::Usage;
use crate::files;
use address::{BridgeAddress, IioAddress, PartOptions, SpiAddress, gpio_line, without_bandwidth};
use adis16130::{Config, ConversionTime, Framing, MCLK_HZ, Sample, SamplerConfig, SelfTest};
use adis16130_twin::{Roa, Spec, Truth};
use anyhow::Result;
use bridge::BridgePart;
use iio::IioDevice;
use replay::Replay;
#[cfg(target_os = "linux")]
use spi::SpiPart;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use twin::TwinDevice;
use zerorate::Axis;
use zerorate_data::capture::{CaptureInfo, SCHEMA_VERSION};

/// What `--device` names.
#[derive(Clone, Debug)]
pub struct DeviceSpec {
    /// As it was given.
    text: String,
    kind: Kind,
    /// −3 dB of the rate, Hz, where it is not the part's own (F-04).
    bandwidth_hz: Option<f64>,
}

#[derive(Clone, Debug)]
enum Kind {
    /// `twin:KEY=VALUE,…`
    Twin(Box<Spec>, PartOptions),
    /// `replay:FILE`
    Replay(PathBuf),
    /// `spi:/dev/spidevB.C?rdy=CHIP:LINE&…`
    Spi(SpiAddress),
    /// `iio:NAME`
    Iio(IioAddress),
    /// `bridge:PORT` or `tcp:HOST:PORT`
    Bridge(BridgeAddress),
}

const KINDS: &str = "there are twin:, twin:KEY=VALUE,…, replay:FILE, spi:/dev/spidevB.C?rdy=CHIP:LINE, iio:NAME, \
    bridge:/dev/ttyACM0 and tcp:HOST:PORT";

impl DeviceSpec {
    /// A recording.
    pub fn replay(path: PathBuf) -> Self {
        Self { text: format!("replay:{}", path.display()), kind: Kind::Replay(path), bandwidth_hz: None }
    }

    /// The file that is read, where it is a recording.
    pub fn file(&self) -> Option<&Path> {
        match &self.kind {
            Kind::Replay(path) => Some(path),
            _ => None,
        }
    }
}

impl FromStr for DeviceSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // a file may be called what it likes
        let (address, mut bandwidth_hz) =
            if text.starts_with("replay:") { (text.to_owned(), None) } else { without_bandwidth(text)? };
        let kind = match address.split_once(':') {
            Some(("twin", keys)) => {
                let (kind, hz) = twin(keys)?;
                bandwidth_hz = hz;
                kind
            }
            Some(("replay", "")) => return Err("replay: needs the file, as in replay:unit.arrows".to_owned()),
            Some(("replay", path)) => Kind::Replay(path.into()),
            Some(("spi", address)) => Kind::Spi(SpiAddress::parse(address)?),
            Some(("iio", address)) => Kind::Iio(IioAddress::parse(address)?),
            Some(("bridge", address)) => Kind::Bridge(BridgeAddress::parse_serial(address)?),
            Some(("tcp", address)) => Kind::Bridge(BridgeAddress::parse_tcp(address)?),
            _ if text == "twin" => return Err("write twin: with the colon".to_owned()),
            _ if std::path::Path::new(text).is_file() => {
                return Err(format!("that is a file; to replay it write replay:{text}"));
            }
            _ => return Err(format!("no such kind of device; {KINDS}")),
        };
        Ok(Self { text: text.to_owned(), kind, bandwidth_hz })
    }
}

impl fmt::Display for DeviceSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// What was found of an SPI bus.
#[derive(Clone, Copy, Debug)]
pub struct Bus {
    /// The clock that was asked for, Hz.
    pub sclk_hz: u32,
    /// The fastest clock tried at which the configuration reads back right; none if it does at no clock.
    pub fastest_clean_hz: Option<u32>,
    /// Time from one read of a register to the next, s; not known behind a bridge.
    pub read_s: Option<f64>,
}

/// A source of samples, opened.
pub struct Device {
    name: String,
    bandwidth_hz: Option<f64>,
    source: Source,
}

enum Source {
    Twin(Box<TwinDevice>),
    Replay(Box<Replay>),
    #[cfg(target_os = "linux")]
    Spi(Box<SpiPart>),
    Iio(Box<IioDevice>, SamplerConfig),
    Bridge(Box<BridgePart>),
}

impl Device {
    /// Opens the device; sends nothing to the part yet.
    pub fn open(spec: &DeviceSpec, sampling: SamplingArgs) -> Result<Self> {
        let name = spec.to_string();
        let source = match &spec.kind {
            Kind::Twin(unit, part) => {
                let sampling = sampler_config(sampling).with_divided(part.divided);
                Source::Twin(Box::new(TwinDevice::new((**unit).clone(), part.config, sampling)))
            }
            Kind::Replay(path) => {
                if sampling.every_temp.is_some() || sampling.divider.is_some() {
                    let why = "--every-temp and --divider were decided when the recording was made; leave them out";
                    return Err(Usage(why.to_owned()).into());
                }
                Source::Replay(Box::new(Replay::new(files::capture(path)?)))
            }
            Kind::Spi(address) => open_spi(address, sampling)?,
            Kind::Iio(address) => {
                if sampling.divider.is_some() {
                    let why = "--divider counts edges of data ready, which the kernel driver does not show; poll less \
                        often with ?hz=";
                    return Err(Usage(why.to_owned()).into());
                }
                let sampling = sampler_config(sampling);
                Source::Iio(Box::new(IioDevice::open(address, sampling.every_temp)?), sampling)
            }
            Kind::Bridge(address) => {
                let sampling = sampler_config(sampling).with_divided(address.part.divided);
                Source::Bridge(Box::new(BridgePart::open(address, sampling)?))
            }
        };
        Ok(Self { name, bandwidth_hz: spec.bandwidth_hz, source })
    }

    /// Resets the part, initialises it, and reads everything back. Returns the revision; a recording has none, and the
    /// kernel's driver keeps it to itself.
    pub fn initialise(&mut self) -> Result<Option<u8>> {
        match &mut self.source {
            Source::Twin(twin) => twin.live.initialise().map(Some),
            #[cfg(target_os = "linux")]
            Source::Spi(part) => part.initialise().map(Some),
            Source::Bridge(part) => part.initialise().map(Some),
            Source::Replay(_) | Source::Iio(..) => Ok(None),
        }
    }

    /// Tries the bus, if there is one. To be called before the first sample; leaves the part configured.
    pub fn try_bus(&mut self) -> Result<Option<Bus>> {
        match &mut self.source {
            #[cfg(target_os = "linux")]
            Source::Spi(part) => part.try_bus().map(Some),
            Source::Bridge(part) => part.try_bus().map(Some),
            _ => Ok(None),
        }
    }

    /// What the self-test does to the rate (F-11). `gpio` is the line that its pins are on, where this host has them.
    /// To be called before the first sample.
    pub fn self_test(&mut self, gpio: &str) -> Result<SelfTest> {
        let no_gpio = |what: &str| Usage(format!("--self-test takes no GPIO with {what}: leave `{gpio}` out"));
        match &mut self.source {
            Source::Twin(twin) if gpio.is_empty() => twin.self_test(),
            Source::Twin(_) => Err(no_gpio("the twin, whose pins are its own").into()),
            Source::Bridge(part) if gpio.is_empty() => part.self_test(),
            Source::Bridge(_) => Err(no_gpio("a bridge, whose firmware knows the pin").into()),
            #[cfg(target_os = "linux")]
            Source::Spi(part) => {
                let line = gpio_line(gpio).map_err(|why| Usage(format!("--self-test: {why}")))?;
                part.self_test(line)
            }
            Source::Replay(_) | Source::Iio(..) => {
                Err(Usage("--self-test needs the part itself: twin:, spi:, bridge: or tcp:".to_owned()).into())
            }
        }
    }

    /// How CS frames the bytes (F-22), where it is this program that decides.
    pub fn framing(&self) -> Option<Framing> {
        match &self.source {
            Source::Twin(twin) => Some(twin.live.config.framing()),
            #[cfg(target_os = "linux")]
            Source::Spi(part) => Some(part.settings().0.framing()),
            Source::Bridge(part) => Some(part.settings().0.framing()),
            Source::Replay(_) | Source::Iio(..) => None,
        }
    }

    /// The next sample; `None` at the end of a recording.
    #[inline]
    pub fn next(&mut self) -> Result<Option<Sample>> {
        match &mut self.source {
            Source::Twin(twin) => twin.next().map(Some),
            Source::Replay(replay) => replay.next(),
            #[cfg(target_os = "linux")]
            Source::Spi(part) => part.next().map(Some),
            Source::Iio(device, _) => device.next().map(Some),
            Source::Bridge(part) => part.next().map(Some),
        }
    }

    /// How the samples are taken; the serial number and the note are those given, or else those of the recording.
    pub fn info(&self, serial: Option<&str>, supply_note: Option<&str>) -> CaptureInfo {
        let mut info = match &self.source {
            Source::Twin(twin) => self.info_of((twin.live.config, twin.live.sampling), String::new()),
            Source::Replay(replay) => replay.reader.info().clone(),
            #[cfg(target_os = "linux")]
            Source::Spi(part) => self.info_of(part.settings(), now()),
            Source::Iio(_, sampling) => self.info_of((Config::new(), *sampling), now()),
            Source::Bridge(part) => self.info_of(part.settings(), now()),
        };
        info.serial = serial.map(str::to_owned).or(info.serial);
        info.supply_note = supply_note.map(str::to_owned).or(info.supply_note);
        info
    }

    fn info_of(&self, (config, sampling): (Config, SamplerConfig), created: String) -> CaptureInfo {
        CaptureInfo {
            schema: SCHEMA_VERSION,
            device: self.name.clone(),
            serial: None,
            width: config.width(),
            rate_conversion: config.rate_conversion().bits(),
            temp_conversion: config.temp_conversion().bits(),
            every_temp: sampling.every_temp,
            divider: sampling.divider,
            divided: sampling.divided,
            bandwidth_hz: self.bandwidth_hz,
            software: crate::SOFTWARE.to_owned(),
            created,
            supply_note: None,
        }
    }

    /// What is being read.
    pub fn name(&self) -> String {
        match &self.source {
            Source::Replay(replay) => format!("recording of {}", replay.reader.info().device),
            _ => self.name.clone(),
        }
    }

    /// Whether it is a part whose time is that of the wall clock.
    pub fn is_real(&self) -> bool {
        !matches!(self.source, Source::Twin(_) | Source::Replay(_))
    }

    /// Samples that were read, but lost because nobody took them in time. They are counted in `lost` as well.
    pub fn overflowed(&self) -> u64 {
        match &self.source {
            #[cfg(target_os = "linux")]
            Source::Spi(part) => part.overflowed(),
            _ => 0,
        }
    }

    /// Frames of a bridge that arrived damaged; the samples in them are counted in `lost`.
    pub fn damaged(&self) -> u64 {
        match &self.source {
            Source::Bridge(part) => part.damaged(),
            _ => 0,
        }
    }

    /// The twin's truth about its slow bias now.
    pub fn truth(&self) -> Option<Truth> {
        match &self.source {
            Source::Twin(twin) => Some(twin.truth()),
            _ => None,
        }
    }

    /// Rate samples per second at the nominal master clock: one of 2/(N + 1) conversion pairs where every N-th edge is
    /// read (F-31, F-56).
    pub fn nominal_rate_hz(&self) -> f64 {
        if let Source::Iio(device, _) = &self.source {
            return device.rate_hz();
        }
        let info = self.info(None, None);
        let cycles = [info.rate_conversion, info.temp_conversion].map(|bits| ConversionTime::new(bits).cycles(true));
        let pairs_hz = f64::from(self.mclk_hz()) / f64::from(cycles[0] + cycles[1]);
        pairs_hz * 2.0 / (f64::from(info.edges_per_reading()) + 1.0)
    }

    /// The nominal master clock, Hz.
    pub fn mclk_hz(&self) -> u32 {
        match &self.source {
            Source::Twin(twin) => twin.mclk_hz,
            #[cfg(target_os = "linux")]
            Source::Spi(part) => part.mclk_hz(),
            Source::Bridge(part) => part.mclk_hz(),
            _ => MCLK_HZ,
        }
    }
}

/// `KEY=VALUE,…`: those of the twin, and how the driver configures it; and its bandwidth, if that is not the part's
/// own.
fn twin(keys: &str) -> Result<(Kind, Option<f64>), String> {
    let (mut part, mut unit) = (PartOptions::new(), Vec::new());
    for item in keys.split(',') {
        match part.with(item.trim())? {
            Some(changed) => part = changed,
            None => unit.push(item),
        }
    }
    let unit = Spec::parse_keys(&unit.join(",")).map_err(|error| error.to_string())?;
    let bandwidth_hz = (unit.roa == Roa::TenNanofarad).then_some(Axis::ADIS16130_ROA_10NF_HZ);
    Ok((Kind::Twin(Box::new(unit), part), bandwidth_hz))
}

fn sampler_config(sampling: SamplingArgs) -> SamplerConfig {
    SamplerConfig::new().with_every_temp(sampling.every_temp.unwrap_or(1)).with_divider(sampling.divider.unwrap_or(1))
}

#[cfg(target_os = "linux")]
fn open_spi(address: &SpiAddress, sampling: SamplingArgs) -> Result<Source> {
    let sampling = sampler_config(sampling).with_divided(address.part.divided);
    Ok(Source::Spi(Box::new(SpiPart::open(address, sampling)?)))
}

#[cfg(not(target_os = "linux"))]
fn open_spi(_: &SpiAddress, _: SamplingArgs) -> Result<Source> {
    Err(Usage(
        "spi: devices are read through spidev, which is a part of Linux; on this system use twin: or replay:"
            .to_owned(),
    )
    .into())
}

/// The time of day, for the record.
fn now() -> String {
    let now = jiff::Timestamp::now();
    now.round(jiff::Unit::Second).unwrap_or(now).to_string()
}
