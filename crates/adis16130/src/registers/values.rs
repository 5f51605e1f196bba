//! What the one-byte registers hold, bit by bit (docs/facts.md section 3).

use crate::codes::Width;

/// `bits` with the bits of `mask` set or cleared.
const fn with(bits: u8, mask: u8, on: bool) -> u8 {
    if on { bits | mask } else { bits & !mask }
}

/// Defines a one-byte register value: construction from and access to the raw bits.
macro_rules! byte_value {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(u8);

        impl $name {
            /// The value with these raw bits; every byte is one.
            pub const fn new(bits: u8) -> Self {
                Self(bits)
            }

            /// The raw bits.
            pub const fn bits(self) -> u8 {
                self.0
            }
        }
    };
}

byte_value! {
    /// IOP, 01h: the pins P0 and P1, when RDY falls, and the SYNC pin.
    Iop
}

impl Iop {
    /// The bits that show pin levels when read, whatever was written: mask them when reading back (docs/facts.md
    /// section 3).
    pub const PIN_LEVELS: u8 = 0xC0;

    /// Level of pin P0 (b7).
    pub const fn p0(self) -> bool {
        self.0 & 0x80 != 0
    }

    /// Level of pin P1 (b6).
    pub const fn p1(self) -> bool {
        self.0 & 0x40 != 0
    }

    /// Sets the level that P0 drives as an output.
    pub const fn with_p0(self, high: bool) -> Self {
        Self(with(self.0, 0x80, high))
    }

    /// Sets the level that P1 drives as an output.
    pub const fn with_p1(self, high: bool) -> Self {
        Self(with(self.0, 0x40, high))
    }

    /// Whether P0 is an input (b5).
    pub const fn p0_is_input(self) -> bool {
        self.0 & 0x20 != 0
    }

    /// Whether P1 is an input (b4).
    pub const fn p1_is_input(self) -> bool {
        self.0 & 0x10 != 0
    }

    /// Makes P0 an input or an output.
    pub const fn with_p0_input(self, input: bool) -> Self {
        Self(with(self.0, 0x20, input))
    }

    /// Makes P1 an input or an output.
    pub const fn with_p1_input(self, input: bool) -> Self {
        Self(with(self.0, 0x10, input))
    }

    /// RDYFN (b3): `true` = RDY is low only when all enabled channels hold unread data (F-32).
    pub const fn rdyfn(self) -> bool {
        self.0 & 0x08 != 0
    }

    /// Sets RDYFN.
    pub const fn with_rdyfn(self, all_channels: bool) -> Self {
        Self(with(self.0, 0x08, all_channels))
    }

    /// SYNC (b0): the SYNC pin is in use.
    pub const fn sync(self) -> bool {
        self.0 & 0x01 != 0
    }

    /// Sets SYNC.
    pub const fn with_sync(self, on: bool) -> Self {
        Self(with(self.0, 0x01, on))
    }
}

byte_value! {
    /// REVISION, 02h. 24h for the AD7732 inside (not verified on an ADIS16130).
    Revision
}

byte_value! {
    /// ADC STATUS, 04h: bit n is set while channel n holds unread data. Rate is channel 0, temperature channel 2.
    AdcStatus
}

impl AdcStatus {
    /// Whether rate data waits to be read.
    pub const fn rate_ready(self) -> bool {
        self.0 & 0x01 != 0
    }

    /// Whether temperature data waits to be read.
    pub const fn temp_ready(self) -> bool {
        self.0 & 0x04 != 0
    }
}

byte_value! {
    /// Channel status, 20h and 22h: what is known about the newest reading of a channel.
    ChannelStatus
}

impl ChannelStatus {
    /// The channel number (b7–5): 0 is rate, 2 is temperature.
    pub const fn channel(self) -> u8 {
        self.0 >> 5
    }

    /// RDY (b3): the data register holds a reading that has not been read.
    pub const fn ready(self) -> bool {
        self.0 & 0x08 != 0
    }

    /// NOREF (b2): no reference voltage; the reading means nothing.
    pub const fn no_reference(self) -> bool {
        self.0 & 0x04 != 0
    }

    /// SIGN (b1): the input was negative. With OVR it says on which side the reading left the range (F-35).
    pub const fn negative(self) -> bool {
        self.0 & 0x02 != 0
    }

    /// Whether it is that of the rate channel and says that an unread rate waits: channel 000, RDY set.
    pub const fn announces_rate(self) -> bool {
        self.0 & 0xE8 == 0x08
    }

    /// OVR (b0): the input was outside the range. The code is saturated (CLAMP = 1) or wrapped (CLAMP = 0) (F-35).
    pub const fn out_of_range(self) -> bool {
        self.0 & 0x01 != 0
    }
}

/// The input range of a channel (b1–0 of RATECS and TEMPCS). F-40 and F-41 hold for [`Range::Bits10`] only, which is
/// what F-30 writes.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Range {
    /// 00, the value after reset.
    Bits00,
    /// 01.
    Bits01,
    /// 10, the range that the scale of the part refers to (F-30).
    Bits10,
    /// 11.
    Bits11,
}

impl Range {
    const fn from_bits(bits: u8) -> Self {
        match bits & 0x03 {
            0 => Self::Bits00,
            1 => Self::Bits01,
            2 => Self::Bits10,
            _ => Self::Bits11,
        }
    }

    const fn bits(self) -> u8 {
        match self {
            Self::Bits00 => 0,
            Self::Bits01 => 1,
            Self::Bits10 => 2,
            Self::Bits11 => 3,
        }
    }
}

byte_value! {
    /// Channel setup, RATECS 28h and TEMPCS 2Ah.
    ChannelSetup
}

impl ChannelSetup {
    /// STATOPT (b4).
    pub const fn statopt(self) -> bool {
        self.0 & 0x10 != 0
    }

    /// Sets STATOPT.
    pub const fn with_statopt(self, on: bool) -> Self {
        Self(with(self.0, 0x10, on))
    }

    /// ENABLE (b3): the channel is converted in continuous mode.
    pub const fn enabled(self) -> bool {
        self.0 & 0x08 != 0
    }

    /// Sets ENABLE.
    pub const fn with_enabled(self, on: bool) -> Self {
        Self(with(self.0, 0x08, on))
    }

    /// The input range (b1–0).
    pub const fn range(self) -> Range {
        Range::from_bits(self.0)
    }

    /// Sets the input range.
    pub const fn with_range(self, range: Range) -> Self {
        Self((self.0 & !0x03) | range.bits())
    }
}

byte_value! {
    /// Conversion time, RATECONV 30h and TEMPCONV 32h: chopping and the filter word (F-31).
    ConversionTime
}

impl ConversionTime {
    /// CHOP (b7): each result is the mean of two conversions with exchanged inputs.
    pub const fn chop(self) -> bool {
        self.0 & 0x80 != 0
    }

    /// Sets CHOP.
    pub const fn with_chop(self, on: bool) -> Self {
        Self(with(self.0, 0x80, on))
    }

    /// The filter word FW (b6–0), 0 … 127.
    pub const fn filter_word(self) -> u8 {
        self.0 & 0x7F
    }

    /// Sets the filter word; `None` if it does not fit into seven bits.
    pub const fn with_filter_word(self, word: u8) -> Option<Self> {
        if word > 0x7F { None } else { Some(Self((self.0 & 0x80) | word)) }
    }

    /// Duration of one conversion in MCLK cycles, with one channel enabled or with both (F-31):
    /// FW·64 + 206 or 207 with chop off, FW·128 + 248 or 249 with chop on.
    ///
    /// ```
    /// use adis16130::registers::ConversionTime;
    /// assert_eq!(ConversionTime::new(5).cycles(true), 527); // 87.83 µs at 6.000 MHz
    /// ```
    pub const fn cycles(self, both_channels: bool) -> u32 {
        let word = self.filter_word() as u32;
        let cycles = if self.chop() { word * 128 + 248 } else { word * 64 + 206 };
        cycles + both_channels as u32
    }
}

/// The operating mode (MD, b7–5 of MODE).
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Operation {
    /// 000: idle, the state after reset.
    Idle,
    /// 001: the enabled channels are converted in turn, for ever.
    Continuous,
    /// 010: one conversion.
    Single,
    /// 011: power-down.
    PowerDown,
    /// 1xx: not described for this part.
    Other(u8),
}

impl Operation {
    const fn from_bits(bits: u8) -> Self {
        match bits & 0x07 {
            0 => Self::Idle,
            1 => Self::Continuous,
            2 => Self::Single,
            3 => Self::PowerDown,
            other => Self::Other(other),
        }
    }

    const fn bits(self) -> u8 {
        match self {
            Self::Idle => 0,
            Self::Continuous => 1,
            Self::Single => 2,
            Self::PowerDown => 3,
            Self::Other(bits) => bits & 0x07,
        }
    }
}

byte_value! {
    /// MODE, 38h. Reads 00h after a reset, and so after a brown-out.
    Mode
}

impl Mode {
    /// The operating mode (b7–5).
    pub const fn operation(self) -> Operation {
        Operation::from_bits(self.0 >> 5)
    }

    /// Sets the operating mode.
    pub const fn with_operation(self, operation: Operation) -> Self {
        Self((self.0 & 0x1F) | (operation.bits() << 5))
    }

    /// CLKDIS (b4).
    pub const fn clkdis(self) -> bool {
        self.0 & 0x10 != 0
    }

    /// Sets CLKDIS.
    pub const fn with_clkdis(self, on: bool) -> Self {
        Self(with(self.0, 0x10, on))
    }

    /// DUMP (b3).
    pub const fn dump(self) -> bool {
        self.0 & 0x08 != 0
    }

    /// Sets DUMP. The driver does not read in dump mode.
    pub const fn with_dump(self, on: bool) -> Self {
        Self(with(self.0, 0x08, on))
    }

    /// CONTRD (b2).
    pub const fn contrd(self) -> bool {
        self.0 & 0x04 != 0
    }

    /// Sets CONTRD. The driver does not read in continuous-read mode.
    pub const fn with_contrd(self, on: bool) -> Self {
        Self(with(self.0, 0x04, on))
    }

    /// The width of the data registers (b1: 1 = 24 bits).
    pub const fn width(self) -> Width {
        if self.0 & 0x02 != 0 { Width::Bits24 } else { Width::Bits16 }
    }

    /// Sets the width of the data registers.
    pub const fn with_width(self, width: Width) -> Self {
        Self(with(self.0, 0x02, matches!(width, Width::Bits24)))
    }

    /// CLAMP (b0): `true` = out-of-range codes saturate, `false` = they wrap (F-35).
    pub const fn clamp(self) -> bool {
        self.0 & 0x01 != 0
    }

    /// Sets CLAMP.
    pub const fn with_clamp(self, on: bool) -> Self {
        Self(with(self.0, 0x01, on))
    }
}
