//! The registers (docs/facts.md section 3). Each except COM is a type with address, size, reset value and direction.
//!
//! [`Readable`] and [`Writable`] are separate traits, so that writing a read-only register does not compile:
//!
//! ```compile_fail
//! # use adis16130::{blocking::Adis16130, registers::Revision};
//! # fn f<SPI: embedded_hal::spi::SpiDevice, RDY>(gyro: &mut Adis16130<SPI, RDY>) {
//! gyro.write_register::<Revision>(Revision::new(0)).ok();
//! # }
//! ```

mod field;
mod values;

pub use crate::checksum::Checksum;
pub use field::{Field, Meaning};
pub use values::{AdcStatus, ChannelSetup, ChannelStatus, ConversionTime, Iop, Mode, Operation, Range, Revision};

use crate::codes::{RateCode, TempCode, Width};

impl core::fmt::Display for Address {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} ({:02X}h)", self.name(), *self as u8)
    }
}

/// The size of a register on the wire.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Size {
    /// One byte.
    Byte,
    /// Two bytes.
    Word,
    /// Two or three bytes. Bit 24/16 of MODE selects the size.
    Data,
}

impl Size {
    /// Number of bytes when the data registers are `width` wide.
    pub const fn bytes(self, width: Width) -> usize {
        match self {
            Self::Byte => 1,
            Self::Word => 2,
            Self::Data => width.bytes(),
        }
    }
}

/// A register: its address, its size and its value.
pub trait Register {
    /// The type of the register's value.
    type Value: Copy;
    /// The address of the register.
    const ADDRESS: Address;
    /// The size of the register on the wire.
    const SIZE: Size;
    /// The value after a reset. A read of IOP also shows the levels of its pins. The data registers are 16 bits wide
    /// after a reset.
    const RESET: Self::Value;
}

/// A register that can be read.
pub trait Readable: Register {
    /// Converts the bytes on the wire, most significant byte first. `width` is the width of the data registers.
    fn decode(raw: u32, width: Width) -> Self::Value;
}

/// A register that can be written.
pub trait Writable: Register {
    /// Converts the value to the bytes on the wire, most significant byte first.
    fn encode(value: Self::Value) -> u32;
}

/// The directions in which a register can be used.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Access {
    /// The register can only be read.
    ReadOnly,
    /// The register can only be written.
    WriteOnly,
    /// The register can be read and written.
    ReadWrite,
}

/// One row per register, as in the table of docs/facts.md section 3: description, address, name and access. In braces
/// follow the type of its value, size, value after reset, fields, decoder, and the encoder if it is writable. `struct`
/// declares a type for the register if the type of its value has another name.
macro_rules! registers {
    ($(
        #[doc = $description:literal]
        $register:ident = $address:literal $name:literal $access:ident $($struct:ident)?
        $({ $value:ty, $size:ident, $reset:expr, $fields:expr, $decode:expr $(, $encode:expr)? })?;
    )*) => {
        /// The address of every register (docs/facts.md section 3).
        #[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[repr(u8)]
        pub enum Address {$(
            #[doc = $description]
            $register = $address,
        )*}

        impl Address {
            /// The name of the register, as messages show it.
            pub const fn name(self) -> &'static str {
                match self {$(Self::$register => $name,)*}
            }

            /// The purpose of the register, in one sentence.
            pub const fn description(self) -> &'static str {
                match self {$(Self::$register => $description.trim_ascii(),)*}
            }

            /// Whether the register can be read, written or both.
            pub const fn access(self) -> Access {
                match self {$(Self::$register => Access::$access,)*}
            }

            /// The size on the wire. For COM, the size of a command byte.
            pub const fn size(self) -> Size {
                match self {
                    $($(Self::$register => Size::$size,)?)*
                    Self::Com => Size::Byte,
                }
            }

            /// The fields of the register, in the order in which to show them.
            pub const fn fields(self) -> &'static [Field] {
                match self {
                    $($(Self::$register => { const FIELDS: &[Field] = $fields; FIELDS })?)*
                    Self::Com => &[],
                }
            }
        }

        $($(
            #[doc = $description]
            #[derive(Copy, Clone, Debug)]
            pub $struct $register;
        )?)*

        $($(
            impl Register for $register {
                type Value = $value;
                const ADDRESS: Address = Address::$register;
                const SIZE: Size = Size::$size;
                const RESET: $value = $reset;
            }

            impl Readable for $register {
                fn decode(raw: u32, width: Width) -> $value {
                    let decode: fn(u32, Width) -> $value = $decode;
                    decode(raw, width)
                }
            }

            $(impl Writable for $register {
                fn encode(value: $value) -> u32 {
                    let encode: fn($value) -> u32 = $encode;
                    encode(value)
                }
            })?
        )?)*
    };
}

const fn code(name: &'static str, meaning: Meaning) -> Field {
    Field { name, mask: 0xFF_FFFF, meaning }
}

registers! {
    /// Communications register: the first byte of every command (F-24).
    Com = 0x00 "COM" WriteOnly;
    /// I/O port: pins P0 and P1, RDYFN, SYNC.
    Iop = 0x01 "IOP" ReadWrite {
        Iop, Byte, Iop::new(0x30), Iop::FIELDS, |raw, _| Iop::new(raw as u8), |value| value.bits().into()
    };
    /// Chip revision.
    Revision = 0x02 "REVISION" ReadOnly {
        Revision, Byte, Revision::new(0x24), Revision::FIELDS, |raw, _| Revision::new(raw as u8)
    };
    /// The channels that hold unread data.
    AdcStatus = 0x04 "ADC STATUS" ReadOnly {
        AdcStatus, Byte, AdcStatus::new(0), AdcStatus::FIELDS, |raw, _| AdcStatus::new(raw as u8)
    };
    /// Checksum over the written bits (F-34).
    Checksum = 0x05 "CHECKSUM" ReadWrite {
        Checksum, Word, Checksum::RESET_VALUE,
        &[Field {
            name: "CHECKSUM",
            mask: 0xFFFF,
            meaning: Meaning::Number("over all bits written since the reset (F-34)"),
        }],
        |raw, _| Checksum::new(raw as u16), |value| value.bits().into()
    };
    /// Rate data.
    RateData = 0x08 "RATEDATA" ReadOnly struct {
        RateCode, Data, RateCode::new(0x8000, Width::Bits16), &[code("RATE", Meaning::Rate)], RateCode::new
    };
    /// Temperature data.
    TempData = 0x0A "TEMPDATA" ReadOnly struct {
        TempCode, Data, TempCode::new(0x8000, Width::Bits16), &[code("TEMP", Meaning::Temp)], TempCode::new
    };
    /// Status of the rate channel.
    RateStatus = 0x20 "RATE STATUS" ReadOnly struct {
        ChannelStatus, Byte, ChannelStatus::new(0x00), ChannelStatus::FIELDS, |raw, _| ChannelStatus::new(raw as u8)
    };
    /// Status of the temperature channel.
    TempStatus = 0x22 "TEMP STATUS" ReadOnly struct {
        ChannelStatus, Byte, ChannelStatus::new(0x40), ChannelStatus::FIELDS, |raw, _| ChannelStatus::new(raw as u8)
    };
    /// Setup of the rate channel.
    RateCs = 0x28 "RATECS" ReadWrite struct {
        ChannelSetup, Byte, ChannelSetup::new(0), ChannelSetup::FIELDS,
        |raw, _| ChannelSetup::new(raw as u8), |value| value.bits().into()
    };
    /// Setup of the temperature channel.
    TempCs = 0x2A "TEMPCS" ReadWrite struct {
        ChannelSetup, Byte, ChannelSetup::new(0), ChannelSetup::FIELDS,
        |raw, _| ChannelSetup::new(raw as u8), |value| value.bits().into()
    };
    /// Conversion time of the rate channel.
    RateConv = 0x30 "RATECONV" ReadWrite struct {
        ConversionTime, Byte, ConversionTime::new(0x91), ConversionTime::FIELDS,
        |raw, _| ConversionTime::new(raw as u8), |value| value.bits().into()
    };
    /// Conversion time of the temperature channel.
    TempConv = 0x32 "TEMPCONV" ReadWrite struct {
        ConversionTime, Byte, ConversionTime::new(0x91), ConversionTime::FIELDS,
        |raw, _| ConversionTime::new(raw as u8), |value| value.bits().into()
    };
    /// Operating mode.
    Mode = 0x38 "MODE" ReadWrite {
        Mode, Byte, Mode::new(0), Mode::FIELDS, |raw, _| Mode::new(raw as u8), |value| value.bits().into()
    };
}
