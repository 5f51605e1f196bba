//! The description of a capture, and its form as metadata (docs/formats/capture.md).

use super::CaptureError;
use adis16130::{RATE_LSB_PER_DPS, TEMP_LSB_PER_C, Width};
use arrow_schema::Metadata;
use std::path::Path;
use zerorate::Axis;

/// Version of the format that this program writes, and the highest it reads.
pub const SCHEMA_VERSION: u32 = 2;

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
/// Left out where it is 1, as in every file of programs that did not know it.
const DIVIDED: &str = "zerorate.divided";
const BANDWIDTH_HZ: &str = "zerorate.bandwidth_hz";
const SOFTWARE: &str = "zerorate.software";
const CREATED: &str = "zerorate.created";
const SUPPLY_NOTE: &str = "zerorate.supply_note";

/// Names of the axes. Version 1 has none.
pub const AXES: &str = "zerorate.axes";

/// The part and the axis that this program writes and reads.
const PART_NAME: &str = "ADIS16130";
const AXIS: &str = "rate";

/// How a capture was taken.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureInfo {
    /// Version of the format that the file has.
    pub schema: u32,
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
    /// The part was read on every N-th data-ready edge that the host saw (F-56).
    pub divider: u16,
    /// The host saw every N-th data-ready edge, because a counter divided them (F-56).
    pub divided: u16,
    /// −3 dB of the rate, Hz, where it is not the part's own (F-04).
    pub bandwidth_hz: Option<f64>,
    /// What wrote the capture.
    pub software: String,
    /// When, RFC 3339; empty on a simulated device, whose files depend on nothing but the seed.
    pub created: String,
    /// The supply, as noted by whoever measured.
    pub supply_note: Option<String>,
}

impl CaptureInfo {
    /// Edges of the part's data ready from one reading to the next, all in all.
    pub fn edges_per_reading(&self) -> u16 {
        self.divider.max(1).saturating_mul(self.divided.max(1))
    }

    /// The metadata that states this.
    pub fn to_metadata(&self) -> Metadata {
        let known = [
            (CAPTURE_SCHEMA, Some(SCHEMA_VERSION.to_string())),
            (WIDTH_BITS, Some(self.width.bits().to_string())),
            (RATE_CONVERSION, Some(self.rate_conversion.to_string())),
            (TEMP_CONVERSION, Some(self.temp_conversion.to_string())),
            (PART, Some(PART_NAME.to_owned())),
            (DEVICE, Some(self.device.clone())),
            (SERIAL, self.serial.clone()),
            (EVERY_TEMP, Some(self.every_temp.to_string())),
            (DIVIDER, Some(self.divider.to_string())),
            (DIVIDED, (self.divided > 1).then(|| self.divided.to_string())),
            (BANDWIDTH_HZ, self.bandwidth_hz.map(|hz| hz.to_string())),
            (SOFTWARE, Some(self.software.clone())),
            (CREATED, Some(self.created.clone()).filter(|created| !created.is_empty())),
            (SUPPLY_NOTE, self.supply_note.clone()),
        ];
        let known = known.into_iter().filter_map(|(key, value)| Some((key.to_owned(), one_line(&value?))));
        known.chain(channels(self.width)).collect()
    }

    /// Reads the description of the capture at `path` out of its metadata.
    pub fn from_metadata(path: &Path, metadata: &Metadata) -> Result<Self, CaptureError> {
        let schema = version(path, metadata)?;
        let text = |key: &str| metadata.get(key).cloned();
        if schema > 1 {
            check_part(path, metadata)?;
        }
        let width = width(path, number(path, metadata, WIDTH_BITS)?)?;
        if schema > 1 {
            check_channels(path, metadata, width)?;
        }
        Ok(Self {
            schema,
            device: text(DEVICE).unwrap_or_default(),
            serial: text(SERIAL),
            width,
            rate_conversion: number(path, metadata, RATE_CONVERSION)?,
            temp_conversion: number(path, metadata, TEMP_CONVERSION)?,
            every_temp: number_or(path, metadata, EVERY_TEMP, 1)?,
            divider: number_or(path, metadata, DIVIDER, 1)?,
            divided: number_or(path, metadata, DIVIDED, 1)?,
            bandwidth_hz: bandwidth_hz(path, metadata)?,
            software: text(SOFTWARE).unwrap_or_default(),
            created: text(CREATED).unwrap_or_default(),
            supply_note: text(SUPPLY_NOTE),
        })
    }
}

impl CaptureInfo {
    /// The axis that was read, as it was set.
    pub fn axis(&self) -> Axis {
        Axis { bandwidth_hz: self.bandwidth_hz.or(Axis::ADIS16130.bandwidth_hz), ..Axis::ADIS16130 }
    }
}

fn bandwidth_hz(path: &Path, metadata: &Metadata) -> Result<Option<f64>, CaptureError> {
    if !metadata.contains_key(BANDWIDTH_HZ) {
        return Ok(None);
    }
    match number::<f64>(path, metadata, BANDWIDTH_HZ)? {
        hz if hz > 0.0 && hz.is_finite() => Ok(Some(hz)),
        hz => Err(CaptureError::damaged(path, "metadata", format!("{BANDWIDTH_HZ} = {hz}, which no part has"))),
    }
}

/// Whether `metadata` claims to describe a capture, of whatever version.
pub fn is_capture(metadata: &Metadata) -> bool {
    metadata.iter().any(|(key, _)| key.starts_with("zerorate."))
}

/// A value as every form can hold it: CSV has one line for it, and no blanks around.
fn one_line(value: &str) -> String {
    value.replace(['\r', '\n'], " ").trim().to_owned()
}

/// What the codes of each channel mean (F-40, F-41, F-43).
fn channels(width: Width) -> impl Iterator<Item = (String, String)> {
    let dropped = f64::from(1u32 << (24 - width.bits()));
    let channel = |name: String, unit: &str, lsb_per_unit: u32| {
        [
            (format!("{name}.unit"), unit.to_owned()),
            (format!("{name}.width_bits"), width.bits().to_string()),
            (format!("{name}.zero_code"), (1u32 << (width.bits() - 1)).to_string()),
            (format!("{name}.lsb_per_unit"), (f64::from(lsb_per_unit) / dropped).to_string()),
        ]
    };
    let rate = channel(format!("zerorate.axis.{AXIS}"), "dps", RATE_LSB_PER_DPS);
    let temp = channel("zerorate.temp".to_owned(), "c", TEMP_LSB_PER_C);
    let whole = [(AXES.to_owned(), AXIS.to_owned()), ("zerorate.temp.zero_value".to_owned(), "25".to_owned())];
    rate.into_iter().chain(temp).chain(whole)
}

fn check_part(path: &Path, metadata: &Metadata) -> Result<(), CaptureError> {
    let stated = |key: &str| metadata.get(key).map_or("", |value| value).to_owned();
    let (part, axes) = (stated(PART), stated(AXES));
    if part == PART_NAME && axes == AXIS {
        return Ok(());
    }
    Err(CaptureError::OtherPart { path: path.to_owned(), part, axes })
}

fn check_channels(path: &Path, metadata: &Metadata, width: Width) -> Result<(), CaptureError> {
    let wrong = channels(width).find(|(key, expected)| metadata.get(key) != Some(expected));
    wrong.map_or(Ok(()), |(key, expected)| {
        let found = metadata.get(&key).map_or("absent", |value| value);
        let what = format!("{key} is {found}, where an {PART_NAME} has {expected}");
        Err(CaptureError::damaged(path, "metadata", what))
    })
}

fn version(path: &Path, metadata: &Metadata) -> Result<u32, CaptureError> {
    if !metadata.contains_key(CAPTURE_SCHEMA) {
        let why =
            format!("it carries no `{CAPTURE_SCHEMA}` (a converter may have dropped the metadata; use the original)");
        return Err(CaptureError::not_a_capture(path, why));
    }
    match number(path, metadata, CAPTURE_SCHEMA)? {
        0 => Err(CaptureError::damaged(path, "metadata", format!("{CAPTURE_SCHEMA} = 0, which there never was"))),
        known if known <= SCHEMA_VERSION => Ok(known),
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

fn number_or<T: std::str::FromStr>(
    path: &Path,
    metadata: &Metadata,
    key: &str,
    default: T,
) -> Result<T, CaptureError> {
    if metadata.contains_key(key) { number(path, metadata, key) } else { Ok(default) }
}
