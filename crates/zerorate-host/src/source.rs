//! What every kind of device gives.

use crate::Result;
use crate::chamber::Air;
use crate::clock;
use crate::error::UserError;
use crate::options::PartOptions;
use crate::warning::SourceWarning;
use adis16130::registers::Address;
use adis16130::{Config, ConversionTime, Framing, SamplerConfig, SelfTest};
use adis16130_twin::Truth;
use zerorate::calibration::Notes;
use zerorate::{Names, Part, Setting};
use zerorate_record::{CaptureInfo, Converter, Row};

/// How often a part is read. A recording has decided that already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sampling {
    /// Temperature with every N-th rate sample (F-55); none: with each.
    pub every_temp: Option<u16>,
    /// On every N-th edge that is seen (F-56); none: on each.
    pub divider: Option<u16>,
}

impl Sampling {
    /// For the driver, behind a counter that lets every `divided`-th edge through.
    pub(crate) fn config(self, divided: u16) -> SamplerConfig {
        SamplerConfig::new()
            .with_every_temp(self.every_temp.unwrap_or(1))
            .with_divider(self.divider.unwrap_or(1))
            .with_divided(divided)
    }
}

/// How a device is to be read.
#[derive(Clone, Debug)]
pub struct Setup {
    /// How often.
    pub sampling: Sampling,
    /// What is known of the part; none: an ADIS16130, or what a recording states of its own.
    pub part: Option<Part>,
    /// The air around a simulated part; none: as its address says.
    pub air: Option<Air>,
    /// What the front end calls settings, for errors.
    pub names: Names,
}

impl Default for Setup {
    fn default() -> Self {
        Self { sampling: Sampling::default(), part: None, air: None, names: Setting::name }
    }
}

/// An open device. It need not be `Send`: the [`Hub`](crate::Hub) opens it in the thread that reads it.
pub trait Source {
    /// What does not change while it is read.
    fn facts(&self) -> DeviceInfo;

    /// Resets the part, initialises it, and reads everything back. Returns the revision; a recording has none, and the
    /// kernel's drivers keep it to themselves.
    fn initialise(&mut self) -> Result<Option<u8>> {
        Ok(None)
    }

    /// The next sample; `None` at the end of a recording.
    fn next(&mut self) -> Result<Option<Row>>;

    /// Tries the bus, if there is one. To be called before the first sample; leaves the part configured.
    fn try_bus(&mut self) -> Result<Option<Bus>> {
        Ok(None)
    }

    /// The registers of the part, as they are, if it has some and we can read them; of several parts, those of the
    /// first. To be called before the first sample.
    fn registers(&mut self) -> Result<Option<Registers>> {
        Ok(None)
    }

    /// What the self-test does to the rate (F-11). `gpio` is the line that its pins are on, where this host has them.
    /// To be called before the first sample. Errors call settings by `names`.
    fn self_test(&mut self, gpio: &str, names: Names) -> Result<SelfTest> {
        let _ = gpio;
        let option = names(Setting::SelfTest);
        Err(UserError::request(format!("{option} needs the part itself: twin:, spi:, bridge: or tcp:")).into())
    }

    /// What was lost on its way here.
    fn losses(&self) -> Losses {
        Losses::default()
    }

    /// The twin's truth about its slow bias now, of each axis; of a part that is no twin, none.
    fn truths(&self) -> Vec<Truth> {
        Vec::new()
    }

    /// What there is to say since this was asked last.
    fn take_notes(&mut self) -> Vec<SourceWarning> {
        Vec::new()
    }
}

/// What does not change while a device is read.
#[derive(Clone, Debug)]
pub struct DeviceInfo {
    /// What is read.
    pub name: String,
    /// How the samples are taken.
    pub info: CaptureInfo,
    /// What is known of the part, as it is set.
    pub part: Part,
    /// How CS frames the bytes (F-22), where it is this program that decides.
    pub framing: Option<Framing>,
    /// Whether it is a part whose time is that of the wall clock.
    pub is_real: bool,
    /// Samples per second, nominally; not known of a recording of any other part.
    pub rate_hz: Option<f64>,
    /// The nominal master clock of an ADIS16130, Hz.
    pub mclk_hz: u32,
}

impl DeviceInfo {
    /// Of an ADIS16130 that the driver reads.
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

/// The part that a device or a recording is of, with what is known of it beside.
pub(crate) fn part_of(info: &CaptureInfo, known: Option<&Part>) -> Result<Part> {
    let Some(known) = known else { return Ok(info.part()) };
    info.part_from(known).map_err(|error| UserError::request(error.to_string()).into())
}

/// At the nominal master clock: one of 2/(N + 1) conversion pairs where every N-th edge is read (F-31, F-56).
pub(crate) fn nominal_rate_hz(info: &CaptureInfo, mclk_hz: u32) -> Option<f64> {
    let set = info.converter?;
    let cycles = [set.rate_conversion, set.temp_conversion].map(|bits| ConversionTime::new(bits).cycles(true));
    let pairs_hz = f64::from(mclk_hz) / f64::from(cycles[0] + cycles[1]);
    Some(pairs_hz * 2.0 / (f64::from(info.edges_per_reading()) + 1.0))
}

/// What stands in the registers of an ADIS16130.
#[derive(Clone, Debug)]
pub struct Registers {
    /// What was written to it.
    pub config: Config,
    /// Each with its bits, in the order of their addresses.
    pub values: Vec<(Address, u32)>,
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

/// What was lost between the part and here; it is counted in the samples' `lost` as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Samples that were read, but nobody took in time.
    pub overflowed: u64,
    /// Frames of a bridge that arrived damaged.
    pub damaged: u64,
}
