//! Raw output codes and their exact conversions (F-40 … F-43).

use crate::{RATE_LSB_PER_DPS, TEMP_AT_ZERO_CODE_C, TEMP_LSB_PER_C, ZERO_CODE};

/// The width of a data register in bits. Bit 24/16 of MODE sets it.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Width {
    /// 16 bits: the 24-bit code divided by 256, rounded to nearest (F-43).
    Bits16,
    /// 24 bits (F-30).
    Bits24,
}

impl Width {
    /// Number of bits of a code: 16 or 24.
    pub const fn bits(self) -> u32 {
        match self {
            Self::Bits16 => 16,
            Self::Bits24 => 24,
        }
    }

    /// Number of low bits of a 24-bit code that a code of this width lacks (F-43).
    pub const fn dropped_bits(self) -> u32 {
        24 - self.bits()
    }

    /// Number of bytes of a code on the wire: 2 or 3.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Bits16 => 2,
            Self::Bits24 => 3,
        }
    }

    /// The largest code, which is also all ones on the wire.
    pub const fn max_code(self) -> u32 {
        (1 << self.bits()) - 1
    }
}

/// Converts a 24-bit code to 16 bits: divided by 256, rounded to nearest, ties away from 2¹⁵, at most 65 535 (F-43).
///
/// ```
/// assert_eq!(adis16130::round_to_16_bits(14_260_608), 55_706); // +250 °/s
/// assert_eq!(adis16130::round_to_16_bits(2_516_608), 9_830); // −250 °/s
/// ```
pub const fn round_to_16_bits(code24: u32) -> u16 {
    let code24 = code24 & Width::Bits24.max_code();
    // A tie is 128 codes above a multiple of 256. It is rounded up above the zero code, and down below the zero code.
    let half = if code24 >= ZERO_CODE { 128 } else { 127 };
    let code = (code24 + half) >> 8;
    if code > u16::MAX as u32 { u16::MAX } else { code as u16 }
}

/// An angular rate as the part delivers it, in offset binary. Positive for a rotation along the data sheet's arrow.
///
/// rate \[°/s\] = (code24 − 2²³) / 23 488 (F-40).
///
/// ```
/// use adis16130::{RateCode, Width};
/// let rate = RateCode::new(8_623_488, Width::Bits24);
/// assert_eq!(rate.to_dps(), 10.0);
/// assert_eq!(rate.to_udps(), 10_000_000);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RateCode(Code);

impl RateCode {
    /// A code of `width` bits. Bits above the width do not exist on the wire and are dropped.
    pub const fn new(code: u32, width: Width) -> Self {
        Self(Code::new(code, width))
    }

    /// The code as it was read.
    pub const fn code(self) -> u32 {
        self.0.code
    }

    /// The width in which the code was read.
    pub const fn width(self) -> Width {
        self.0.width
    }

    /// The code on the 24-bit scale: a 16-bit code times 256.
    pub const fn code24(self) -> u32 {
        self.0.code24()
    }

    /// Whether the code is the lowest or the highest of its width. Such a code may be saturated (CLAMP = 1, F-35), or
    /// come from a dead line.
    pub const fn is_at_rail(self) -> bool {
        self.0.is_at_rail()
    }

    /// Angular rate in °/s, correctly rounded: one division of two exact values (F-40).
    pub fn to_dps(self) -> f32 {
        self.0.signed() as f32 / RATE_LSB_PER_DPS as f32
    }

    /// Angular rate in µ°/s, rounded to nearest, ties away from zero (F-40). From −357 144 414 to +357 144 372.
    pub const fn to_udps(self) -> i32 {
        self.0.scaled(1_000_000, RATE_LSB_PER_DPS) as i32
    }
}

/// A temperature of the sensor as the part delivers it, in offset binary.
///
/// temperature \[°C\] = (code24 − 2²³) / 14 093 + 25 (F-41).
///
/// ```
/// use adis16130::{TempCode, Width};
/// let temp = TempCode::new(9_234_188, Width::Bits24);
/// assert_eq!(temp.to_celsius(), 85.0);
/// assert_eq!(temp.to_millicelsius(), 85_000);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TempCode(Code);

impl TempCode {
    /// A code of `width` bits. Bits above the width do not exist on the wire and are dropped.
    pub const fn new(code: u32, width: Width) -> Self {
        Self(Code::new(code, width))
    }

    /// The code as it was read.
    pub const fn code(self) -> u32 {
        self.0.code
    }

    /// The width in which the code was read.
    pub const fn width(self) -> Width {
        self.0.width
    }

    /// The code on the 24-bit scale: a 16-bit code times 256.
    pub const fn code24(self) -> u32 {
        self.0.code24()
    }

    /// Whether the code is the lowest or highest of its width. It stands for −570 °C or +620 °C, not for a reading.
    pub const fn is_at_rail(self) -> bool {
        self.0.is_at_rail()
    }

    /// Temperature in °C, correctly rounded (F-41). The 25 °C are added as codes, so that only the division rounds.
    pub fn to_celsius(self) -> f32 {
        let offset = TEMP_AT_ZERO_CODE_C * TEMP_LSB_PER_C as i32;
        (self.0.signed() + offset) as f32 / TEMP_LSB_PER_C as f32
    }

    /// Temperature in m°C, rounded to nearest, ties away from 25 °C (F-41). From −570 232 to +620 232.
    pub const fn to_millicelsius(self) -> i32 {
        self.0.scaled(1_000, TEMP_LSB_PER_C) as i32 + TEMP_AT_ZERO_CODE_C * 1_000
    }
}

#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "stored::Code"))]
struct Code {
    code: u32,
    width: Width,
}

impl Code {
    const fn new(code: u32, width: Width) -> Self {
        Self { code: code & width.max_code(), width }
    }

    const fn code24(self) -> u32 {
        self.code << self.width.dropped_bits()
    }

    /// The difference from the zero code on the 24-bit scale: code24 − 2²³.
    const fn signed(self) -> i32 {
        self.code24() as i32 - ZERO_CODE as i32
    }

    /// `signed · scale / lsb`, rounded to nearest, ties away from zero.
    const fn scaled(self, scale: i64, lsb: u32) -> i64 {
        let doubled = 2 * self.signed() as i64 * scale;
        let lsb = lsb as i64;
        let half = if doubled < 0 { -lsb } else { lsb };
        (doubled + half) / (2 * lsb)
    }

    const fn is_at_rail(self) -> bool {
        self.code == 0 || self.code == self.width.max_code()
    }
}

#[cfg(feature = "serde")]
mod stored {
    use super::Width;

    /// A code as it is stored, which may be too large for its width.
    #[derive(serde::Deserialize)]
    pub(super) struct Code {
        code: u32,
        width: Width,
    }

    impl TryFrom<Code> for super::Code {
        type Error = &'static str;

        fn try_from(Code { code, width }: Code) -> Result<Self, Self::Error> {
            if code > width.max_code() { Err("the code does not fit its width") } else { Ok(Self { code, width }) }
        }
    }
}
