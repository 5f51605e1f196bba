//! IIO channels: the scale of raw values, and the layout in the buffer.

use super::sysfs::{first, read, read_text};
use anyhow::{Context, Result, ensure};
use std::path::Path;
use zerorate::Scale;

#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The common prefix of the channel's attributes: `in_anglvel_x`.
    pub name: String,
    /// Conversion of raw values to °/s, or to °C.
    pub scale: Scale,
    /// The layout in the buffer, if the driver has a buffer with this channel.
    pub element: Option<Element>,
}

/// The layout of a channel in a scan. A scan is one set of simultaneous samples in the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Element {
    /// Position of the channel in the order of the scan.
    pub index: u32,
    /// Size of the channel in bytes. Its offset in the scan is a multiple of the size.
    pub bytes: usize,
    big_endian: bool,
    signed: bool,
    bits: u32,
    shift: u32,
}

impl Channel {
    /// Reads the attributes of a channel. `name` is its name such as `in_anglvel_x`; `kind` is the prefix of
    /// attributes that all channels of its kind share (`in_anglvel`). `per_unit` is 1 °/s or 1 °C in the kernel's unit
    /// (rad/s or 0.001 °C).
    pub fn read(folder: &Path, name: &str, kind: &str, per_unit: f64) -> Result<Self> {
        let attribute = |what: &str| [format!("{name}_{what}"), format!("{kind}_{what}")];
        let number = |what: &str| first(folder, &attribute(what).each_ref().map(String::as_str));
        let scale: f64 = number("scale")?.with_context(|| format!("{name} states no scale"))?;
        ensure!(scale.is_finite() && scale != 0.0, "{name}_scale is {scale}, with which nothing can be converted");
        let offset: f64 = number("offset")?.unwrap_or(0.0);
        let element = Element::read(folder, name)?;
        // without a buffer, the driver states no width: take the largest for which raw + offset fits into 32 bits
        let untyped = if offset == 0.0 { (32, true) } else { (31, true) };
        let (width_bits, signed) = element.map_or(untyped, |element| (element.bits.min(32) as u8, element.signed));
        // the value in the kernel's unit is (raw + offset) · scale
        let scale = Scale {
            lsb_per_unit: per_unit / scale,
            zero_code: (-offset).round() as i64,
            zero_value: 0.0,
            width_bits,
            signed,
        };
        Ok(Self { name: name.to_owned(), scale, element })
    }

    pub fn poll(&self, folder: &Path) -> Result<i64> {
        read(folder, &format!("{}_raw", self.name))
    }
}

impl Element {
    /// Reads the buffer layout of a channel. `None` if there is no buffer, or the buffer lacks the channel.
    pub fn read(folder: &Path, channel: &str) -> Result<Option<Self>> {
        let elements = folder.join("scan_elements");
        if !elements.join(format!("{channel}_type")).exists() {
            return Ok(None);
        }
        let index = read(&elements, &format!("{channel}_index"))?;
        let text = read_text(&elements, &format!("{channel}_type"))?;
        let parsed = Self::parse(&text, index);
        parsed.map(Some).with_context(|| format!("{channel}_type reads {text:?}, which is not the type of a channel"))
    }

    /// Parses a layout such as `le:s16/32>>4`: little endian, signed, 16 bits of 32, shifted up by 4.
    fn parse(text: &str, index: u32) -> Option<Self> {
        let (endian, rest) = text.split_once(':')?;
        let signed = match rest.chars().next()? {
            's' => true,
            'u' => false,
            _ => return None,
        };
        let (bits, rest) = rest[1..].split_once('/')?;
        let (storage, shift) = rest.split_once(">>").unwrap_or((rest, "0"));
        let (bits, storage, shift): (u32, u32, u32) = (bits.parse().ok()?, storage.parse().ok()?, shift.parse().ok()?);
        let whole = matches!(storage, 8 | 16 | 32 | 64) && (1..=storage).contains(&bits) && bits + shift <= storage;
        let big_endian = match endian {
            "be" => true,
            "le" => false,
            _ => return None,
        };
        whole.then_some(Self { index, bytes: storage as usize / 8, big_endian, signed, bits, shift })
    }

    /// Decodes the value in these bytes; their number must be [`Element::bytes`].
    pub fn value(&self, bytes: &[u8]) -> i64 {
        let fold = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
        let stored = if self.big_endian { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) };
        let unused = 64 - self.bits;
        let top = (stored >> self.shift) << unused;
        if self.signed { top as i64 >> unused } else { (top >> unused) as i64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_those_of_the_kernel() {
        let value = |text: &str, bytes: &[u8]| Element::parse(text, 0).expect("a type").value(bytes);
        assert_eq!(value("le:s16/16>>0", &[0xFE, 0xFF]), -2);
        assert_eq!(value("be:u24/32>>8", &[0x80, 0x00, 0x01, 0xFF]), 0x80_0001);
        assert_eq!(value("le:s12/16>>4", &[0x10, 0x80]), -2047);
        assert_eq!(value("le:s64/64>>0", &(-7i64).to_le_bytes()), -7);
        assert_eq!(value("le:u8/8", &[200]), 200);
        for wrong in ["", "le:s16", "xe:s16/16>>0", "le:f32/32>>0", "le:s24/16>>0", "le:s16/16>>8", "le:s16/24>>0"] {
            assert!(Element::parse(wrong, 0).is_none(), "{wrong}");
        }
    }
}
