//! Encodes and decodes messages as frames: postcard with a CRC-32, then COBS, and a zero at the end.

use core::fmt::{Display, Formatter, Result as Printed};
use crc::{CRC_32_ISO_HDLC, Crc};
use postcard::ser_flavors::crc::CrcModifier;
use postcard::ser_flavors::{Cobs, Slice};
use serde::{Deserialize, Serialize};

/// Largest number of bytes in a frame, including the zero at its end.
pub const MAX_FRAME: usize = 64;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The error for a message that is too long for a frame.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct TooLong;

impl Display for TooLong {
    fn fmt(&self, f: &mut Formatter<'_>) -> Printed {
        write!(f, "the message is longer than a frame of {MAX_FRAME} bytes")
    }
}

impl core::error::Error for TooLong {}

/// The error for bytes between two zeros that are not a message: they are too many, their CRC is wrong, or this
/// version does not know the message.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct DamagedFrame;

impl Display for DamagedFrame {
    fn fmt(&self, f: &mut Formatter<'_>) -> Printed {
        f.write_str("a frame was damaged on the way")
    }
}

impl core::error::Error for DamagedFrame {}

/// Writes a message as a frame to the front of `room`.
pub fn encode<'a>(message: &impl Serialize, room: &'a mut [u8; MAX_FRAME]) -> Result<&'a [u8], TooLong> {
    let cobs = Cobs::try_new(Slice::new(room)).map_err(|_| TooLong)?;
    let frame = postcard::serialize_with_flavor(message, CrcModifier::new(cobs, CRC.digest()));
    frame.map(|frame| &*frame).map_err(|_| TooLong)
}

/// Finds the messages in a stream of bytes.
#[derive(Clone, Debug)]
pub struct Decoder {
    bytes: [u8; MAX_FRAME],
    /// Number of bytes since the last zero. Bytes beyond [`MAX_FRAME`] are counted, but not kept.
    len: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// Makes a decoder that expects the beginning of a frame.
    pub const fn new() -> Self {
        Self { bytes: [0; MAX_FRAME], len: 0 }
    }

    /// Takes a byte, and returns the message that ends with it. Two zeros in a row give no message and no error.
    pub fn push<'a, M: Deserialize<'a>>(&'a mut self, byte: u8) -> Option<Result<M, DamagedFrame>> {
        if byte != 0 {
            if let Some(place) = self.bytes.get_mut(self.len) {
                *place = byte;
            }
            self.len = self.len.saturating_add(1);
            return None;
        }
        match core::mem::take(&mut self.len) {
            0 => None,
            len => Some(self.bytes.get_mut(..len).ok_or(DamagedFrame).and_then(decode)),
        }
    }
}

fn decode<'a, M: Deserialize<'a>>(frame: &'a mut [u8]) -> Result<M, DamagedFrame> {
    let len = cobs::decode_in_place(frame).map_err(|_| DamagedFrame)?;
    let body = frame.get(..len).ok_or(DamagedFrame)?;
    postcard::from_bytes_crc32(body, CRC.digest()).map_err(|_| DamagedFrame)
}
