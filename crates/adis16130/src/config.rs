//! The configuration of the part, without a bus. `Default` is exactly F-30.

use crate::codes::Width;
use crate::frame::{Frame, Framing};
use crate::registers::{
    Address, ChannelSetup, ConversionTime, Iop, Mode, Operation, Range, RateConv, RateCs, Register, TempConv, TempCs,
    Writable,
};

/// The channels that are converted.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Channels {
    /// Rate and temperature in turn (F-30).
    #[default]
    Both,
    /// Rate only, with more than twice as many samples if both conversions take equally long (F-30).
    Rate,
    /// Temperature only. A [`Sampler`](crate::Sampler) then has nothing to do.
    Temp,
}

/// The edge of the RDY line, as the host sees it, that announces new data.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RdyEdge {
    /// The pin falls, and stays low while data waits (F-32).
    #[default]
    Falling,
    /// The pin rises, and stays high while data waits: behind an inverting level shifter.
    Rising,
}

/// The configuration of the part and of its wiring. Every builder is `const`.
///
/// ```
/// use adis16130::{Config, Framing, Width};
/// const CONFIG: Config = Config::new().with_width(Width::Bits16).with_framing(Framing::Command);
/// assert_eq!(Config::new(), Config::default()); // F-30: 24 bits, both channels, conversion word 5
/// assert_eq!(Config::new().conversion_cycles(), (527, 527));
/// # let _ = CONFIG;
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "Settings", into = "Settings")
)]
pub struct Config {
    iop: Iop,
    rate_setup: ChannelSetup,
    temp_setup: ChannelSetup,
    rate_conversion: ConversionTime,
    temp_conversion: ConversionTime,
    mode: Mode,
    framing: Framing,
    rdy_edge: RdyEdge,
}

impl Default for Config {
    fn default() -> Self {
        Self::new()
    }
}

impl Config {
    /// The configuration of F-30: RDYFN, both channels with conversion word 5, continuous conversion, 24 bits.
    pub const fn new() -> Self {
        let setup = ChannelSetup::new(0).with_enabled(true).with_range(Range::Bits10);
        Self {
            iop: Iop::RESET.with_rdyfn(true),
            rate_setup: setup,
            temp_setup: setup,
            rate_conversion: ConversionTime::new(5),
            temp_conversion: ConversionTime::new(5),
            mode: Mode::RESET.with_operation(Operation::Continuous).with_width(Width::Bits24),
            framing: Framing::PerByte,
            rdy_edge: RdyEdge::Falling,
        }
    }

    /// Sets the width of the data registers: 24 bits by default.
    pub const fn with_width(mut self, width: Width) -> Self {
        self.mode = self.mode.with_width(width);
        self
    }

    /// Sets the filter word and the chopping of the rate channel: word 5 without chopping by default.
    pub const fn with_rate_conversion(mut self, conversion: ConversionTime) -> Self {
        self.rate_conversion = conversion;
        self
    }

    /// Sets the filter word and the chopping of the temperature channel: word 5 without chopping by default.
    pub const fn with_temp_conversion(mut self, conversion: ConversionTime) -> Self {
        self.temp_conversion = conversion;
        self
    }

    /// Sets the channels that are converted: both by default.
    pub const fn with_channels(mut self, channels: Channels) -> Self {
        let rate = !matches!(channels, Channels::Temp);
        let temp = !matches!(channels, Channels::Rate);
        self.rate_setup = self.rate_setup.with_enabled(rate);
        self.temp_setup = self.temp_setup.with_enabled(temp);
        self
    }

    /// Sets RDYFN. With `true` (F-30), RDY signals unread data in all enabled channels, with `false` in any (F-32).
    pub const fn with_rdyfn(mut self, all_channels: bool) -> Self {
        self.iop = self.iop.with_rdyfn(all_channels);
        self
    }

    /// Sets SYNC: whether the SYNC pin is in use. Off by default.
    pub const fn with_sync(mut self, on: bool) -> Self {
        self.iop = self.iop.with_sync(on);
        self
    }

    /// Sets CLAMP. With `true`, out-of-range codes saturate, with `false` (F-30) they wrap (F-35).
    pub const fn with_clamp(mut self, on: bool) -> Self {
        self.mode = self.mode.with_clamp(on);
        self
    }

    /// Sets the input range of both channels. F-40 and F-41 hold for the default only.
    pub const fn with_range(mut self, range: Range) -> Self {
        self.rate_setup = self.rate_setup.with_range(range);
        self.temp_setup = self.temp_setup.with_range(range);
        self
    }

    /// Sets how CS frames the bytes: per byte by default (F-22).
    pub const fn with_framing(mut self, framing: Framing) -> Self {
        self.framing = framing;
        self
    }

    /// Sets the edge of RDY that announces new data: falling by default (F-32).
    pub const fn with_rdy_edge(mut self, edge: RdyEdge) -> Self {
        self.rdy_edge = edge;
        self
    }

    /// The width of the data registers.
    pub const fn width(&self) -> Width {
        self.mode.width()
    }

    /// Filter word and chopping of the rate channel.
    pub const fn rate_conversion(&self) -> ConversionTime {
        self.rate_conversion
    }

    /// Filter word and chopping of the temperature channel.
    pub const fn temp_conversion(&self) -> ConversionTime {
        self.temp_conversion
    }

    /// The channels that are converted.
    pub const fn channels(&self) -> Channels {
        match (self.rate_setup.enabled(), self.temp_setup.enabled()) {
            (true, false) => Channels::Rate,
            (false, _) => Channels::Temp,
            (true, true) => Channels::Both,
        }
    }

    /// Whether RDYFN is set, so that RDY signals unread data in all enabled channels (F-32).
    pub const fn rdyfn(&self) -> bool {
        self.iop.rdyfn()
    }

    /// The framing of the bytes by CS.
    pub const fn framing(&self) -> Framing {
        self.framing
    }

    /// The edge of RDY that announces new data.
    pub const fn rdy_edge(&self) -> RdyEdge {
        self.rdy_edge
    }

    /// The value of MODE that this configuration writes last.
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Duration of one conversion of rate and of temperature in MCLK cycles, 0 for a disabled channel (F-31).
    /// With both enabled the channels take turns, so each has a new reading once per sum of the two.
    pub const fn conversion_cycles(&self) -> (u32, u32) {
        match self.channels() {
            Channels::Both => (self.rate_conversion.cycles(true), self.temp_conversion.cycles(true)),
            Channels::Rate => (self.rate_conversion.cycles(false), 0),
            Channels::Temp => (0, self.temp_conversion.cycles(false)),
        }
    }

    /// The commands that configure the part, in the order of F-30.
    ///
    /// The setup of a disabled channel is written too, since the part may have been configured otherwise before. Its
    /// conversion time is not written. So with one channel the twelve bytes of F-30 become ten.
    pub fn writes(&self) -> impl Iterator<Item = Write> + use<> {
        let values = [
            (true, Iop::ADDRESS, self.iop.bits()),
            (true, RateCs::ADDRESS, self.rate_setup.bits()),
            (self.rate_setup.enabled(), RateConv::ADDRESS, self.rate_conversion.bits()),
            (true, TempCs::ADDRESS, self.temp_setup.bits()),
            (self.temp_setup.enabled(), TempConv::ADDRESS, self.temp_conversion.bits()),
            (true, Mode::ADDRESS, self.mode.bits()),
        ];
        let wanted = values.into_iter().filter(|(wanted, ..)| *wanted);
        wanted.map(|(_, address, value)| Write { address, frame: Frame::write_byte(address, value) })
    }
}

/// A write of one register, as a command for the bus.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Write {
    /// The register that is written.
    pub address: Address,
    /// The command that writes the register.
    pub frame: Frame,
}

impl Write {
    /// The write of `value` to register `R`.
    pub fn of<R: Writable>(value: R::Value) -> Self {
        Self { address: R::ADDRESS, frame: Frame::write::<R>(value) }
    }
}

/// A [`Config`] as it is stored: the arguments of its builders. So it can hold only values that the builders can set.
/// A missing field has its value of F-30.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Settings {
    width: Width,
    channels: Channels,
    rate_conversion: ConversionTime,
    temp_conversion: ConversionTime,
    range: Range,
    rdyfn: bool,
    sync: bool,
    clamp: bool,
    framing: Framing,
    rdy_edge: RdyEdge,
}

#[cfg(feature = "serde")]
impl Default for Settings {
    fn default() -> Self {
        Config::new().into()
    }
}

#[cfg(feature = "serde")]
impl From<Config> for Settings {
    fn from(config: Config) -> Self {
        Self {
            width: config.width(),
            channels: config.channels(),
            rate_conversion: config.rate_conversion,
            temp_conversion: config.temp_conversion,
            range: config.rate_setup.range(),
            rdyfn: config.rdyfn(),
            sync: config.iop.sync(),
            clamp: config.mode.clamp(),
            framing: config.framing,
            rdy_edge: config.rdy_edge,
        }
    }
}

#[cfg(feature = "serde")]
impl From<Settings> for Config {
    fn from(settings: Settings) -> Self {
        Self::new()
            .with_width(settings.width)
            .with_channels(settings.channels)
            .with_rate_conversion(settings.rate_conversion)
            .with_temp_conversion(settings.temp_conversion)
            .with_range(settings.range)
            .with_rdyfn(settings.rdyfn)
            .with_sync(settings.sync)
            .with_clamp(settings.clamp)
            .with_framing(settings.framing)
            .with_rdy_edge(settings.rdy_edge)
    }
}
