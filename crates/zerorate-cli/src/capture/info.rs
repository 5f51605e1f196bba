//! The description of a capture, and its form as metadata (docs/formats/capture.md).

use super::CaptureError;
use adis16130::Width;
use arrow::datatypes::Metadata;
use std::path::Path;

/// Version of the format that this program writes, and the highest it reads.
pub const SCHEMA_VERSION: u32 = 1;

/// Marks a corrected capture.
pub const CALIBRATION_ID: &str = "zerorate.calibration_id";

const CAPTURE_SCHEMA: &str = "zerorate.capture_schema";
const WIDTH_BITS: &str = "zerorate.width_bits";
const RATE_CONVERSION: &str = "zerorate.rate_conversion";
const TEMP_CONVERSION: &str = "zerorate.temp_conversion";
const PART: &str = "zerorate.part";
const DEVICE: &str = "zerorate.device";
const SERIAL: &str = "zerorate.serial";
const EVERY_TEMP: &str = "zerorate.every_temp";
const DIVIDER: &str = "zerorate.divider";
const SOFTWARE: &str = "zerorate.software";
const CREATED: &str = "zerorate.created";
const SUPPLY_NOTE: &str = "zerorate.supply_note";

/// How a capture was taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaptureInfo {
    /// Where the samples came from, as given on the command line.
    pub device: String,
    /// Serial number, as given.
    pub serial: Option<String>,
    /// Width of both codes.
    pub width: Width,
    /// RATECONV as configured: b7 chop, b6–0 FW (F-31).
    pub rate_conversion: u8,
    /// TEMPCONV, likewise.
    pub temp_conversion: u8,
    /// Temperature was read with every N-th rate sample (F-55).
    pub every_temp: u16,
    /// The part was read on every N-th data-ready edge (F-56).
    pub divider: u16,
    /// What wrote the capture.
    pub software: String,
    /// When, RFC 3339; empty on a simulated device, whose files depend on nothing but the seed.
    pub created: String,
    /// The supply, as noted by whoever measured.
    pub supply_note: Option<String>,
}

impl CaptureInfo {
    /// The metadata that states this.
    pub fn to_metadata(&self) -> Metadata {
        let known = [
            (CAPTURE_SCHEMA, Some(SCHEMA_VERSION.to_string())),
            (WIDTH_BITS, Some(self.width.bits().to_string())),
            (RATE_CONVERSION, Some(self.rate_conversion.to_string())),
            (TEMP_CONVERSION, Some(self.temp_conversion.to_string())),
            (PART, Some("ADIS16130".to_owned())),
            (DEVICE, Some(self.device.clone())),
            (SERIAL, self.serial.clone()),
            (EVERY_TEMP, Some(self.every_temp.to_string())),
            (DIVIDER, Some(self.divider.to_string())),
            (SOFTWARE, Some(self.software.clone())),
            (CREATED, Some(self.created.clone()).filter(|created| !created.is_empty())),
            (SUPPLY_NOTE, self.supply_note.clone()),
        ];
        known.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
    }

    /// Reads the description of the capture at `path` out of its metadata.
    pub fn from_metadata(path: &Path, metadata: &Metadata) -> Result<Self, CaptureError> {
        check_version(path, metadata)?;
        let text = |key: &str| metadata.get(key).cloned();
        Ok(Self {
            device: text(DEVICE).unwrap_or_default(),
            serial: text(SERIAL),
            width: width(path, number(path, metadata, WIDTH_BITS)?)?,
            rate_conversion: number(path, metadata, RATE_CONVERSION)?,
            temp_conversion: number(path, metadata, TEMP_CONVERSION)?,
            every_temp: number_or(path, metadata, EVERY_TEMP, 1)?,
            divider: number_or(path, metadata, DIVIDER, 1)?,
            software: text(SOFTWARE).unwrap_or_default(),
            created: text(CREATED).unwrap_or_default(),
            supply_note: text(SUPPLY_NOTE),
        })
    }
}

/// Whether `metadata` claims to describe a capture, of whatever version.
pub fn is_capture(metadata: &Metadata) -> bool {
    metadata.contains_key(CAPTURE_SCHEMA)
}

fn check_version(path: &Path, metadata: &Metadata) -> Result<(), CaptureError> {
    if !is_capture(metadata) {
        let why =
            format!("it carries no `{CAPTURE_SCHEMA}` (a converter may have dropped the metadata; use the original)");
        return Err(CaptureError::not_a_capture(path, why));
    }
    match number(path, metadata, CAPTURE_SCHEMA)? {
        SCHEMA_VERSION => Ok(()),
        found => Err(CaptureError::Newer { path: path.to_owned(), found }),
    }
}

fn width(path: &Path, bits: u32) -> Result<Width, CaptureError> {
    [Width::Bits16, Width::Bits24]
        .into_iter()
        .find(|width| width.bits() == bits)
        .ok_or_else(|| CaptureError::damaged(path, "metadata", format!("{WIDTH_BITS} = {bits}, expected 16 or 24")))
}

fn number<T: std::str::FromStr>(path: &Path, metadata: &Metadata, key: &str) -> Result<T, CaptureError> {
    let wrong = |what: String| CaptureError::damaged(path, "metadata", what);
    let text = metadata.get(key).ok_or_else(|| wrong(format!("`{key}` is missing")))?;
    text.parse().map_err(|_| wrong(format!("{key} = {text}, which is no number in its range")))
}

fn number_or<T: std::str::FromStr>(path: &Path, metadata: &Metadata, key: &str, default: T) -> Result<T, CaptureError> {
    if metadata.contains_key(key) { number(path, metadata, key) } else { Ok(default) }
}
