//! The fields of the one-byte registers, bit by bit (docs/facts.md section 3).

use super::field::Field;
use super::field::Meaning::{Alarm, Bit, Channel, Choice, FilterWord, Level, Number};
use crate::codes::Width;

/// The texts for a clear and for a set RDY bit of a channel.
const WAITING: [&str; 2] = ["nothing waits to be read", "a reading waits"];

const fn with(bits: u8, mask: u8, on: bool) -> u8 {
    if on { bits | mask } else { bits & !mask }
}

/// Defines a one-byte register value by its fields, in the order in which to show them. Each field has a mask, a name
/// and a meaning. A single bit can also have a method that reads it, and one that sets it.
macro_rules! byte_value {
    ($(#[$doc:meta])* $name:ident {$(
        $mask:literal $label:literal $meaning:expr
        $(, $(#[$get_doc:meta])* $get:ident $(, $(#[$set_doc:meta])* $set:ident)?)?;
    )*}) => {
        $(#[$doc])*
        #[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(u8);

        impl $name {
            /// The fields, in the order in which to show them.
            pub const FIELDS: &'static [Field] =
                &[$(Field { name: $label, mask: $mask, meaning: $meaning }),*];

            /// The value with these raw bits. Every byte is valid.
            pub const fn new(bits: u8) -> Self {
                Self(bits)
            }

            /// The raw bits.
            pub const fn bits(self) -> u8 {
                self.0
            }

            $($(
                $(#[$get_doc])*
                pub const fn $get(self) -> bool {
                    self.0 & $mask != 0
                }

                $(
                    $(#[$set_doc])*
                    pub const fn $set(self, on: bool) -> Self {
                        Self(with(self.0, $mask, on))
                    }
                )?
            )?)*
        }
    };
}

byte_value! {
    /// IOP, 01h: the pins P0 and P1, the condition for RDY, and the SYNC pin.
    Iop {
        0x80 "P0" Level(["pin P0 is low", "pin P0 is high"]),
            /// Level of pin P0 (b7).
            p0,
            /// Sets the level that P0 drives as an output.
            with_p0;
        0x40 "P1" Level(["pin P1 is low", "pin P1 is high"]),
            /// Level of pin P1 (b6).
            p1,
            /// Sets the level that P1 drives as an output.
            with_p1;
        0x20 "P0DIR" Bit(["output", "input"]),
            /// Whether P0 is an input (b5).
            p0_is_input,
            /// Sets P0DIR (b5): `true` makes P0 an input, `false` an output.
            with_p0_input;
        0x10 "P1DIR" Bit(["output", "input"]),
            /// Whether P1 is an input (b4).
            p1_is_input,
            /// Sets P1DIR (b4): `true` makes P1 an input, `false` an output.
            with_p1_input;
        0x08 "RDYFN" Bit([
            "data ready (RDY) tells that any channel has new data",
            "data ready (RDY) tells that all channels have",
        ]),
            /// RDYFN (b3): `true` = RDY is low only when all enabled channels hold unread data (F-32).
            rdyfn,
            /// Sets RDYFN (b3): `true` makes RDY wait for unread data in all enabled channels (F-32).
            with_rdyfn;
        0x01 "SYNC" Bit(["the pin SYNC is not used", "the pin SYNC is in use"]),
            /// SYNC (b0): the SYNC pin is in use.
            sync,
            /// Sets SYNC (b0): `true` puts the SYNC pin in use.
            with_sync;
    }
}

impl Iop {
    /// The bits that show pin levels when read, not the written bits. Mask them at a read-back (docs/facts.md section
    /// 3).
    pub const PIN_LEVELS: u8 = 0xC0;
}

byte_value! {
    /// REVISION, 02h. The value is 24h for the AD7732 inside (not verified on an ADIS16130).
    Revision {
        0xFF "REVISION" Number("of the converter inside");
    }
}

byte_value! {
    /// ADC STATUS, 04h: bit n is set while channel n holds unread data. Rate is channel 0, temperature channel 2.
    AdcStatus {
        0x01 "RATE" Bit(WAITING),
            /// Whether rate data waits to be read.
            rate_ready;
        0x04 "TEMP" Bit(WAITING),
            /// Whether temperature data waits to be read.
            temp_ready;
    }
}

byte_value! {
    /// Channel status, 20h and 22h: the state of the newest reading of a channel.
    ChannelStatus {
        0xE0 "CHANNEL" Channel;
        0x08 "RDY" Bit(WAITING),
            /// RDY (b3): the data register holds a reading that has not been read.
            ready;
        0x04 "NOREF" Alarm(["the reference is there", "no reference: readings mean nothing"]),
            /// NOREF (b2): there is no reference voltage, so the reading has no meaning.
            no_reference;
        0x02 "SIGN" Bit(["the input is positive", "the input is negative"]),
            /// SIGN (b1): the input was negative. OVR and SIGN show on which side the reading left the range (F-35).
            negative;
        0x01 "OVR" Alarm(["in range", "the input is beyond the range"]),
            /// OVR (b0): the input was outside the range. The code is saturated (CLAMP = 1) or wrapped (CLAMP = 0,
            /// F-35).
            out_of_range;
    }
}

impl ChannelStatus {
    /// The channel number (b7–5): 0 is rate, 2 is temperature.
    pub const fn channel(self) -> u8 {
        self.0 >> 5
    }

    /// Whether the status names the rate channel and shows an unread rate: channel 000, RDY set.
    pub const fn announces_rate(self) -> bool {
        self.0 & 0xE8 == 0x08
    }
}

/// The input range of a channel (b1–0 of RATECS, TEMPCS). F-40 and F-41 hold only for [`Range::Bits10`] (F-30).
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Range {
    /// 00, the value after a reset: F-40 and F-41 do not hold.
    Bits00,
    /// 01: F-40 and F-41 do not hold.
    Bits01,
    /// 10, the range that the scale of the part refers to (F-30).
    Bits10,
    /// 11: F-40 and F-41 do not hold.
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
}

byte_value! {
    /// Channel setup, RATECS 28h and TEMPCS 2Ah.
    ChannelSetup {
        0x10 "STATOPT" Bit(["the status describes the channel alone", "the status is extended"]),
            /// STATOPT (b4): the channel status is extended.
            statopt,
            /// Sets STATOPT (b4): `true` extends the channel status.
            with_statopt;
        0x08 "ENABLE" Bit(["the channel is not converted", "the channel is converted"]),
            /// ENABLE (b3): the channel is converted in continuous mode.
            enabled,
            /// Sets ENABLE (b3): `true` = the channel is converted in continuous mode.
            with_enabled;
        0x03 "RANGE" Choice(&[
            "not the range that the part's scale is for",
            "not the range that the part's scale is for",
            "the range that the part's scale is for",
            "not the range that the part's scale is for",
        ]);
    }
}

impl ChannelSetup {
    /// The input range (b1–0).
    pub const fn range(self) -> Range {
        Range::from_bits(self.0)
    }

    /// Sets the input range (b1–0).
    pub const fn with_range(self, range: Range) -> Self {
        Self((self.0 & !0x03) | range as u8)
    }
}

byte_value! {
    /// Conversion time, RATECONV 30h and TEMPCONV 32h: chopping and the filter word (F-31).
    ConversionTime {
        0x80 "CHOP" Bit(["one conversion for each reading", "the mean of two, with exchanged inputs"]),
            /// CHOP (b7): each result is the mean of two conversions with exchanged inputs.
            chop,
            /// Sets CHOP (b7): `true` = each result is the mean of two conversions (F-31).
            with_chop;
        0x7F "FW" FilterWord;
    }
}

impl ConversionTime {
    /// The filter word FW (b6–0), 0 … 127.
    pub const fn filter_word(self) -> u8 {
        self.0 & 0x7F
    }

    /// Sets the filter word. `None` if the word does not fit into seven bits.
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
    /// 001: the enabled channels are converted in turn, again and again.
    Continuous,
    /// 010: one conversion.
    Single,
    /// 011: power-down.
    PowerDown,
    /// The bits 1xx: not described for this part.
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
    Mode {
        0xE0 "MD" Choice(&[
            "idle: nothing is converted",
            "all enabled channels are converted in turn",
            "one conversion",
            "powered down",
        ]);
        0x10 "CLKDIS" Bit(["the clock is given out", "the clock is not given out"]),
            /// CLKDIS (b4): the converter does not put out its clock.
            clkdis,
            /// Sets CLKDIS (b4): `true` = the converter does not put out its clock.
            with_clkdis;
        0x08 "DUMP" Bit(["readings come alone", "readings come with their status"]),
            /// DUMP (b3): each reading comes with its status.
            dump,
            /// Sets DUMP. The driver does not read in dump mode.
            with_dump;
        0x04 "CONTRD" Bit(["each reading is asked for", "readings come without being asked for"]),
            /// CONTRD (b2): readings come without a command.
            contrd,
            /// Sets CONTRD. The driver does not read in continuous-read mode.
            with_contrd;
        0x02 "24/16" Bit(["16 bits a reading", "24 bits a reading"]);
        0x01 "CLAMP" Bit(["a code out of range wraps (F-35)", "a code out of range stays at the end (F-35)"]),
            /// CLAMP (b0): `true` = out-of-range codes saturate, `false` = they wrap (F-35).
            clamp,
            /// Sets CLAMP (b0): `true` = out-of-range codes saturate, `false` = they wrap (F-35).
            with_clamp;
    }
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

    /// The width of the data registers (b1: 1 = 24 bits).
    pub const fn width(self) -> Width {
        if self.0 & 0x02 != 0 { Width::Bits24 } else { Width::Bits16 }
    }

    /// Sets the width of the data registers.
    pub const fn with_width(self, width: Width) -> Self {
        Self(with(self.0, 0x02, matches!(width, Width::Bits24)))
    }
}
