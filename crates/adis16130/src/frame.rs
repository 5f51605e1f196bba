//! Converts commands to the bytes on the wire, without a bus.

use crate::codes::Width;
use crate::registers::{Address, Readable, Writable};

/// The software reset: one CS-low frame with 32 ones in a row, in either framing (F-23).
pub const RESET_FRAME: [u8; 5] = [0x00, 0xFF, 0xFF, 0xFF, 0xFF];

/// The framing of the bytes of a command by CS. The part accepts both ways. AN-1042 prescribes the default (F-22).
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Framing {
    /// CS rises between all 8-bit words, as AN-1042 prescribes: each byte is its own `SpiDevice` transaction.
    #[default]
    PerByte,
    /// CS stays low for the whole command, as with the Linux driver: one transfer per command. Faster on every host.
    Command,
}

/// The COM byte of a read: b7 = 0, b6 = 1, b5–0 the address (F-24).
pub const fn com_read(address: Address) -> u8 {
    0x40 | address as u8
}

/// The COM byte of a write: b7 = 0, b6 = 0, b5–0 the address (F-24).
pub const fn com_write(address: Address) -> u8 {
    address as u8
}

/// A command: the COM byte and up to three data bytes, full duplex.
///
/// A read sends zeros after the COM byte, since 32 ones in a row would reset the part (F-23). The bytes of the answer
/// then replace the zeros.
///
/// ```
/// use adis16130::{Width, frame::Frame, registers::{ConversionTime, RateConv, RateData}};
/// assert_eq!(Frame::write::<RateConv>(ConversionTime::new(5)).bytes(), [0x30, 0x05]);
/// let mut read = Frame::read::<RateData>(Width::Bits24);
/// assert_eq!(read.bytes(), [0x48, 0, 0, 0]);
/// read.bytes_mut().copy_from_slice(&[0xFF, 0x80, 0x00, 0x01]); // the bus replaces the bytes
/// assert_eq!(read.answer(), 0x80_0001);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Frame {
    bytes: [u8; 4],
    len: usize,
}

impl Frame {
    /// The command that reads register `R` while the data registers are `width` wide.
    #[inline]
    pub const fn read<R: Readable>(width: Width) -> Self {
        Self { bytes: [com_read(R::ADDRESS), 0, 0, 0], len: 1 + R::SIZE.bytes(width) }
    }

    pub(crate) const fn read_byte(address: Address) -> Self {
        Self { bytes: [com_read(address), 0, 0, 0], len: 2 }
    }

    pub(crate) const fn write_byte(address: Address, value: u8) -> Self {
        Self { bytes: [com_write(address), value, 0, 0], len: 2 }
    }

    /// The command that writes `value` to register `R`.
    pub fn write<R: Writable>(value: R::Value) -> Self {
        let len = 1 + R::SIZE.bytes(Width::Bits24);
        let data = R::encode(value) << (8 * (4 - len));
        let [_, high, middle, low] = data.to_be_bytes();
        Self { bytes: [com_write(R::ADDRESS), high, middle, low], len }
    }

    /// The bytes on the wire, in order.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&[])
    }

    /// The bytes on the wire, which the bus replaces with the bytes of the part.
    #[inline]
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        self.bytes.get_mut(..self.len).unwrap_or(&mut [])
    }

    /// The data bytes as a number, most significant byte first.
    #[inline]
    pub const fn answer(&self) -> u32 {
        let [_, high, middle, low] = self.bytes;
        u32::from_be_bytes([0, high, middle, low]) >> (8 * (4 - self.len))
    }
}
