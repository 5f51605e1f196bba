//! The interface of every kind of device.

use crate::Result;
use crate::chamber::AmbientProfile;
use crate::clock;
use crate::error::UserError;
use crate::options::PartOptions;
use crate::warning::SourceWarning;
use adis16130::registers::Address;
use adis16130::{Config, ConversionTime, Framing, SamplerConfig, SelfTest};
use adis16130_twin::Truth;
use zerorate::calibration::Notes;
use zerorate::{Part, Setting, SettingNames};
use zerorate_record::{CaptureInfo, Converter, Row};

/// The sampling of a part. For a recording it is already decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sampling {
    /// Temperature with every N-th rate sample (F-55); `None`: with each.
    pub every_temp: Option<u16>,
    /// Read on every N-th edge that is seen (F-56); `None`: on each.
    pub divider: Option<u16>,
}

impl Sampling {
    /// The configuration of the driver, behind a counter that lets every `divided`-th edge through.
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
    /// The sampling.
    pub sampling: Sampling,
    /// The known facts about the part; `None`: an ADIS16130, or the part that a recording states.
    pub part: Option<Part>,
    /// The temperature around a simulated part; `None`: as its address says.
    pub ambient: Option<AmbientProfile>,
    /// The names that the front end uses for the settings, for errors.
    pub names: SettingNames,
}

impl Default for Setup {
    fn default() -> Self {
        Self { sampling: Sampling::default(), part: None, ambient: None, names: Setting::name }
    }
}

/// An open device. It need not be `Send`: the [`Hub`](crate::Hub) opens it in the thread that reads it.
pub trait Source {
    /// The facts that do not change while the device is read.
    fn facts(&self) -> DeviceInfo;

    /// Resets the part, initialises it, and reads everything back. Returns the revision. A recording has none, and the
    /// kernel's drivers do not tell it.
    fn initialise(&mut self) -> Result<Option<u8>> {
        Ok(None)
    }

    /// The next sample; `None` at the end of a recording.
    fn next(&mut self) -> Result<Option<Row>>;

    /// Tests the bus, if there is one, and leaves the part configured. Call it before the first sample.
    fn try_bus(&mut self) -> Result<Option<Bus>> {
        Ok(None)
    }

    /// The registers of the part, if it has some and we can read them; for several parts, the registers of the first.
    /// Call it before the first sample.
    fn registers(&mut self) -> Result<Option<Registers>> {
        Ok(None)
    }

    /// Measures the change of the rate under self-test (F-11). `gpio` is the line of the self-test pins, if this host
    /// has one. Call it before the first sample. Errors call settings by `names`.
    fn self_test(&mut self, gpio: &str, names: SettingNames) -> Result<SelfTest> {
        let _ = gpio;
        let option = names(Setting::SelfTest);
        Err(UserError::request(format!("{option} needs the part itself: twin:, spi:, bridge: or tcp:")).into())
    }

    /// Losses between the part and this program.
    fn losses(&self) -> Losses {
        Losses::default()
    }

    /// The twin's truth about its slow bias now, for each axis; empty for a part that is not a twin.
    fn truths(&self) -> Vec<Truth> {
        Vec::new()
    }

    /// The warnings since the last call.
    fn take_notes(&mut self) -> Vec<SourceWarning> {
        Vec::new()
    }
}

/// The facts that do not change while a device is read.
#[derive(Clone, Debug)]
pub struct DeviceInfo {
    /// Name of the device.
    pub name: String,
    /// The description of the capture.
    pub info: CaptureInfo,
    /// The known facts about the part, as configured.
    pub part: Part,
    /// Framing of the bytes by CS (F-22), if this program decides it.
    pub framing: Option<Framing>,
    /// Whether the time of the part is the time of the wall clock.
    pub is_real: bool,
    /// Nominal samples per second; `None` for a recording of any other part.
    pub rate_hz: Option<f64>,
    /// The nominal master clock of an ADIS16130, Hz.
    pub mclk_hz: u32,
}

impl DeviceInfo {
    /// The facts of an ADIS16130 that the driver reads.
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

/// The part of a device or a recording, with the other known facts about it.
pub(crate) fn part_of(info: &CaptureInfo, known: Option<&Part>) -> Result<Part> {
    let Some(known) = known else { return Ok(info.part()) };
    info.part_from(known).map_err(|error| UserError::request(error.to_string()).into())
}

/// The rate at the nominal master clock: one of 2/(N + 1) conversion pairs if every N-th edge is read (F-31, F-56).
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
    /// Each register with its bits, in the order of their addresses.
    pub values: Vec<(Address, u32)>,
}

/// The findings about an SPI bus.
#[derive(Clone, Copy, Debug)]
pub struct Bus {
    /// The requested clock, Hz.
    pub sclk_hz: u32,
    /// The fastest tried clock at which the configuration reads back right; `None` if there is no such clock.
    pub fastest_clean_hz: Option<u32>,
    /// Time from one read of a register to the next, s; `None` behind a bridge.
    pub read_s: Option<f64>,
}

/// Losses between the part and this program. The samples' `lost` counts them as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Samples that were read but not taken in time.
    pub overflowed: u64,
    /// Frames of a bridge that arrived damaged.
    pub damaged: u64,
}
