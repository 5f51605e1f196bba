//! The interface that every kind of device implements.

use crate::chamber::AmbientProfile;
use crate::clock;
use crate::error::UserError;
use crate::options::PartOptions;
use crate::warning::SourceWarning;
use crate::{DeviceError, Result};
use adis16130::registers::Address;
use adis16130::{Config, ConversionTime, Framing, SamplerConfig, SelfTest};
use adis16130_twin::Truth;
use zerorate::calibration::Notes;
use zerorate::{Part, Setting, SettingNames};
use zerorate_record::{CaptureInfo, Converter, Row};

/// The requested sampling of a part. It does not apply to recordings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sampling {
    /// Read the temperature with every N-th rate sample (F-55); `None` reads it with each sample.
    pub every_temp: Option<u16>,
    /// Read on every N-th edge that reaches the host (F-56); `None` reads on each.
    pub divider: Option<u16>,
}

impl Sampling {
    /// The sampling as the driver's configuration. A counter in the RDY line passes every `divided`-th edge; `divided`
    /// is 1 without a counter.
    pub(crate) fn config(self, divided: u16) -> SamplerConfig {
        SamplerConfig::new()
            .with_every_temp(self.every_temp.unwrap_or(1))
            .with_divider(self.divider.unwrap_or(1))
            .with_divided(divided)
    }
}

/// The settings for reading a device.
#[derive(Clone, Debug)]
pub struct Setup {
    /// How often the rate and the temperature are read.
    pub sampling: Sampling,
    /// The known facts about the part; `None` means an ADIS16130, or what a recording or a kernel driver states.
    pub part: Option<Part>,
    /// The ambient temperature of a simulated part; `None` takes it from the address of the device.
    pub ambient: Option<AmbientProfile>,
    /// The front end's names for the settings, for error messages.
    pub names: SettingNames,
}

impl Default for Setup {
    fn default() -> Self {
        Self { sampling: Sampling::default(), part: None, ambient: None, names: Setting::name }
    }
}

/// An open device. It need not be `Send`: the [`Hub`](crate::Hub) opens it in its own thread.
pub trait Source {
    /// The facts about the device, which do not change while it is read.
    fn facts(&self) -> DeviceInfo;

    /// Resets the part, initialises it, and reads the configuration back. Returns the revision; `None` if it is
    /// unknown, as for a recording or a kernel driver.
    fn initialise(&mut self) -> Result<Option<u8>> {
        Ok(None)
    }

    /// Returns the next sample; `None` at the end of a recording, or after a stop.
    fn next(&mut self) -> Result<Option<Row>>;

    /// Tests the bus and leaves the part configured; `None` if there is no bus. Call it before the first sample.
    fn try_bus(&mut self) -> Result<Option<Bus>> {
        Ok(None)
    }

    /// Reads the registers of the part, or of the first of several parts; `None` if no registers are accessible. Call
    /// it before the first sample.
    fn registers(&mut self) -> Result<Option<Registers>> {
        Ok(None)
    }

    /// Measures the change of the rate under self-test (F-11). `gpio` is the line of the self-test pins, if this
    /// host drives them. Call it before the first sample. Error messages use `names` for the settings.
    fn self_test(&mut self, gpio: &str, names: SettingNames) -> Result<SelfTest> {
        let _ = gpio;
        Err(no_self_test(names))
    }

    /// Losses between the part and this program since the device was opened.
    fn losses(&self) -> Losses {
        Losses::default()
    }

    /// The true state of each axis of a simulated part at this time; empty for any other device.
    fn truths(&self) -> Vec<Truth> {
        Vec::new()
    }

    /// Returns the warnings since the last call.
    fn take_notes(&mut self) -> Vec<SourceWarning> {
        Vec::new()
    }
}

/// The error of a self-test of a device that has none.
pub(crate) fn no_self_test(names: SettingNames) -> DeviceError {
    let option = names(Setting::SelfTest);
    UserError::request(format!("{option} needs the part itself: twin:, spi:, bridge: or tcp:")).into()
}

/// The facts about a device, which do not change while it is read.
#[derive(Clone, Debug)]
pub struct DeviceInfo {
    /// The name that is shown to the user: the address, or `recording of` and the recorded device.
    pub name: String,
    /// The description that a capture of this device gets.
    pub info: CaptureInfo,
    /// The known facts about the part, with its current settings.
    pub part: Part,
    /// How CS frames the bytes (F-22); `None` if this program does not control CS.
    pub framing: Option<Framing>,
    /// True if the device runs in real time; false for simulated and replayed time.
    pub is_real: bool,
    /// Nominal samples per second; `None` if it is unknown, as for a recording of a part other than the ADIS16130.
    pub rate_hz: Option<f64>,
    /// The nominal master clock of an ADIS16130, Hz.
    pub mclk_hz: u32,
}

impl DeviceInfo {
    /// The facts about an ADIS16130 with these options and this sampling.
    pub(crate) fn of_part(
        name: &str,
        options: &PartOptions,
        sampling: SamplerConfig,
        mclk_hz: u32,
        known: Option<&Part>,
    ) -> Result<Self> {
        let PartOptions { config, bandwidth_hz, .. } = *options;
        let converter = Converter {
            width: config.width(),
            rate_conversion: config.rate_conversion().bits(),
            temp_conversion: config.temp_conversion().bits(),
        };
        let info = CaptureInfo {
            device: name.to_owned(),
            every_temp: sampling.every_temp,
            divider: sampling.divider,
            divided: sampling.divided,
            software: zerorate::SOFTWARE.to_owned(),
            created: clock::text(),
            notes: Notes { host: clock::host(), ..Notes::default() },
            bandwidth_hz,
            ..CaptureInfo::adis16130(converter)
        };
        let part = part_of(&info, known)?;
        let rate_hz = nominal_rate_hz(&info, mclk_hz);
        let framing = Some(config.framing());
        Ok(Self { name: name.to_owned(), info, part, framing, is_real: true, rate_hz, mclk_hz })
    }
}

/// The part of a device or a recording. Properties that `info` does not state come from `known`, if it is given.
pub(crate) fn part_of(info: &CaptureInfo, known: Option<&Part>) -> Result<Part> {
    let Some(known) = known else { return Ok(info.part()) };
    info.part_from(known).map_err(|error| UserError::request(error.to_string()).into())
}

/// The sample rate at the nominal master clock, Hz: 2/(N + 1) readings per conversion pair, with a reading on every
/// N-th edge (F-31, F-56). `None` if the conversion times are unknown.
pub(crate) fn nominal_rate_hz(info: &CaptureInfo, mclk_hz: u32) -> Option<f64> {
    let set = info.converter?;
    let cycles = [set.rate_conversion, set.temp_conversion].map(|bits| ConversionTime::new(bits).cycles(true));
    let pairs_hz = f64::from(mclk_hz) / f64::from(cycles[0] + cycles[1]);
    Some(pairs_hz * 2.0 / (f64::from(info.edges_per_reading()) + 1.0))
}

/// The registers of an ADIS16130.
#[derive(Clone, Debug)]
pub struct Registers {
    /// The configuration that was written to the part.
    pub config: Config,
    /// Each register with its value, by ascending address.
    pub values: Vec<(Address, u32)>,
}

/// The results of testing an SPI bus.
#[derive(Clone, Copy, Debug)]
pub struct Bus {
    /// The actual SPI clock when the requested clock is set, Hz.
    pub sclk_hz: u32,
    /// The fastest tested clock at which the configuration reads back correctly, Hz; `None` if there is none.
    pub fastest_clean_hz: Option<u32>,
    /// Mean time from one register read to the next, s; `None` behind a bridge.
    pub read_s: Option<f64>,
}

/// Losses between the part and this program. Lost samples are also counted in [`Row::lost`] of the samples after them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Number of samples that were read but dropped because the queue was full.
    pub overflowed: u64,
    /// Number of frames from a bridge that arrived damaged.
    pub damaged: u64,
}
