//! The checksum over the bits written to the part (F-34).

/// The 16-bit shift register over every written bit, as in the CHECKSUM register (F-34, not verified on silicon).
///
/// The checksum covers the COM byte of every command and the data bytes of writes. The zeros clocked out during a read
/// are not written bits. The bits enter most significant first. Each bit changes the register s as follows: `fb = s >>
/// 15`, `s <<= 1`, `if fb { s ^= 2Dh }`, `s ^= bit`.
///
/// ```
/// use adis16130::registers::Checksum;
/// // The first read of CHECKSUM after a reset: the register covers the COM byte of this read of 05h.
/// assert_eq!(Checksum::RESET_VALUE.fed(&[0x45]).bits(), 0xE45E);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Checksum(u16);

impl Checksum {
    /// FFFFh, the value after a reset (F-34).
    pub const RESET_VALUE: Self = Self(0xFFFF);

    /// Makes the value of the CHECKSUM register from its 16 bits.
    pub const fn new(bits: u16) -> Self {
        Self(bits)
    }

    /// The 16 bits of the CHECKSUM register.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// The value after these bytes have been written, the first one first.
    pub fn fed(self, bytes: &[u8]) -> Self {
        bytes.iter().fold(self, |state, &byte| state.fed_byte(byte))
    }

    /// Takes in eight bits at once. This is possible because the degree of the polynomial 2Dh is low: no bit that the
    /// feedback changes is shifted out within the same byte.
    const fn fed_byte(self, byte: u8) -> Self {
        let out = self.0 >> 8;
        Self(((self.0 << 8) | byte as u16) ^ out ^ (out << 2) ^ (out << 3) ^ (out << 5))
    }
}

/// Compares CHECKSUM after a series of writes with the value computed from the written bytes. A difference is a hint,
/// not an error (F-34).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WriteCheck {
    /// The value that CHECKSUM must have if the part has received every bit.
    pub expected: Checksum,
    /// The value that was read from CHECKSUM.
    pub got: Checksum,
}

impl WriteCheck {
    /// Whether CHECKSUM has the expected value, which means that the part has received every bit.
    pub fn agrees(&self) -> bool {
        self.expected == self.got
    }
}
