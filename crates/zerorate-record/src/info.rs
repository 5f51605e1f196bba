//! The description of a capture, and its entries in the file's metadata (docs/formats/capture.md).

use super::CaptureError;
use super::layout::{Layout, PART, number, number_or, stated};
use adis16130::Width;
use arrow_schema::Metadata;
use std::path::Path;
use zerorate::calibration::{Notes, Origin, SIMULATED, is_rfc3339, is_twin};
use zerorate::{Axis, NamedAxis, Part, Warning};

/// Version of the format that this program writes, and the highest version that it reads.
pub const SCHEMA_VERSION: u32 = 2;

/// Metadata key of the calibration id, which only a corrected capture has.
pub const CALIBRATION_ID: &str = "zerorate.calibration_id";

const CAPTURE_SCHEMA: &str = "zerorate.capture_schema";
const WIDTH_BITS: &str = "zerorate.width_bits";
const RATE_CONVERSION: &str = "zerorate.rate_conversion";
const TEMP_CONVERSION: &str = "zerorate.temp_conversion";
const DEVICE: &str = "zerorate.device";
const SERIAL: &str = "zerorate.serial";
const EVERY_TEMP: &str = "zerorate.every_temp";
const DIVIDER: &str = "zerorate.divider";
/// Metadata key of [`CaptureInfo::divided`]. The entry is left out for 1, as in all files of older programs.
const DIVIDED: &str = "zerorate.divided";
const BANDWIDTH_HZ: &str = "zerorate.bandwidth_hz";
const EARTH: &str = "zerorate.earth_dps";
const SOFTWARE: &str = "zerorate.software";
const CREATED: &str = "zerorate.created";
const SUPPLY_NOTE: &str = "zerorate.supply_note";
const AMBIENT_NOTE: &str = "zerorate.ambient_note";
const OPERATOR: &str = "zerorate.operator";
const HOST: &str = "zerorate.host";

/// The facts that a capture states about itself, besides its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureInfo {
    /// Format version of the file.
    pub schema: u32,
    /// The part, its axes, and the scales of their codes.
    pub layout: Layout,
    /// The source of the samples, as the user named it.
    pub device: String,
    /// Serial number, as the user stated it; `None` if it is unknown.
    pub serial: Option<String>,
    /// Converter settings of an ADIS16130; `None` for another part.
    pub converter: Option<Converter>,
    /// The temperature was read with every N-th rate sample, where N is this number (F-55).
    pub every_temp: u16,
    /// The part was read on every N-th data-ready edge that the host saw, where N is this number (F-56).
    pub divider: u16,
    /// A counter passed every N-th data-ready edge to the host, where N is this number; 1 without a counter (F-56).
    pub divided: u16,
    /// −3 dB bandwidth of the rate, Hz, if it differs from the part's own (F-04).
    pub bandwidth_hz: Option<f64>,
    /// Component of the Earth's rotation along the axis, °/s (F-16); `None` if none was stated for the measurement.
    pub earth_dps: Option<f64>,
    /// The software that wrote the capture.
    pub software: String,
    /// Time of creation, RFC 3339. Empty for a simulated device, so that its files do not depend on the time.
    pub created: String,
    /// Circumstances of the measurement, as the user described them.
    pub notes: Notes,
}

/// Converter settings of an ADIS16130.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Converter {
    /// Width of the rate and temperature codes.
    pub width: Width,
    /// The RATECONV register as configured: b7 chop, b6–0 FW (F-31).
    pub rate_conversion: u8,
    /// The TEMPCONV register as configured, with bits as in RATECONV.
    pub temp_conversion: u8,
}

/// The error for a part file that does not match the part of a capture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the device is an {found} with the axes {axes}, but the given file describes an {given}")]
pub struct NotThePart {
    found: String,
    axes: String,
    given: String,
}

impl CaptureInfo {
    /// A description with this layout and defaults: every reading has a temperature, and no edge is skipped.
    #[must_use]
    pub fn new(layout: Layout) -> Self {
        Self {
            schema: SCHEMA_VERSION,
            layout,
            device: String::new(),
            serial: None,
            converter: None,
            every_temp: 1,
            divider: 1,
            divided: 1,
            bandwidth_hz: None,
            earth_dps: None,
            software: String::new(),
            created: String::new(),
            notes: Notes::default(),
        }
    }

    /// A description of a capture of an ADIS16130 with these settings.
    #[must_use]
    pub fn adis16130(converter: Converter) -> Self {
        Self { converter: Some(converter), ..Self::new(Layout::adis16130(converter.width)) }
    }

    /// Number of data-ready edges from one reading to the next: the product of both dividers.
    pub fn edges_per_reading(&self) -> u16 {
        self.divider.max(1).saturating_mul(self.divided.max(1))
    }

    /// True if the name of the device is that of the simulated sensor, `twin` or `twin:…`.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        is_twin(&self.device)
    }

    /// Warns if the Earth's rotation is subtracted from a simulated sensor that does not rotate.
    #[must_use]
    pub fn twin_at_rest(&self, earth_dps: Option<f64>) -> Option<Warning> {
        let earth_dps = earth_dps.filter(|dps| *dps != 0.0)?;
        let is_at_rest = self.is_simulated() && !self.device.contains("rotation_dps=");
        is_at_rest.then_some(Warning::TwinAtRest { earth_dps })
    }

    /// The origin to state in a calibration that was made from these samples. `capture_sha256` is their
    /// [`SampleHash`](super::SampleHash).
    #[must_use]
    pub fn origin(self, capture_sha256: String) -> Origin {
        let Self { converter, every_temp, divider, divided, bandwidth_hz, .. } = self;
        let converter = converter.map_or(String::new(), |Converter { width, rate_conversion, temp_conversion }| {
            format!("{} bit, RATECONV {rate_conversion:02X}h, TEMPCONV {temp_conversion:02X}h, ", width.bits())
        });
        let divided = if divided > 1 { format!(", divided {divided}") } else { String::new() };
        let bandwidth = bandwidth_hz.map_or(String::new(), |hz| format!(", bandwidth {hz} Hz"));
        let created = match self.is_simulated() {
            true => Some(SIMULATED.to_owned()),
            false => Some(self.created).filter(|created| is_rfc3339(created)),
        };
        Origin {
            config: format!("{converter}every_temp {every_temp}, divider {divider}{divided}{bandwidth}"),
            serial: self.serial,
            created,
            software: zerorate::SOFTWARE.to_owned(),
            device: self.device,
            capture_sha256,
            notes: self.notes,
        }
    }

    /// Converts the description to metadata entries. In texts, line breaks become spaces.
    pub fn to_metadata(&self) -> Metadata {
        let converter = self.converter.as_ref();
        let known = [
            (CAPTURE_SCHEMA, Some(SCHEMA_VERSION.to_string())),
            (WIDTH_BITS, converter.map(|set| set.width.bits().to_string())),
            (RATE_CONVERSION, converter.map(|set| set.rate_conversion.to_string())),
            (TEMP_CONVERSION, converter.map(|set| set.temp_conversion.to_string())),
            (DEVICE, Some(self.device.clone())),
            (SERIAL, self.serial.clone()),
            (EVERY_TEMP, Some(self.every_temp.to_string())),
            (DIVIDER, Some(self.divider.to_string())),
            (DIVIDED, (self.divided > 1).then(|| self.divided.to_string())),
            (BANDWIDTH_HZ, self.bandwidth_hz.map(|hz| hz.to_string())),
            (EARTH, self.earth_dps.map(|dps| dps.to_string())),
            (SOFTWARE, Some(self.software.clone())),
            (CREATED, Some(self.created.clone()).filter(|created| !created.is_empty())),
            (SUPPLY_NOTE, self.notes.supply.clone()),
            (AMBIENT_NOTE, self.notes.ambient.clone()),
            (OPERATOR, self.notes.operator.clone()),
            (HOST, self.notes.host.clone()),
        ];
        let known = known.into_iter().filter_map(|(key, value)| Some((key.to_owned(), one_line(&value?))));
        known.chain(self.layout.to_metadata()).collect()
    }

    /// Parses the description of the capture at `path` from its metadata.
    pub fn from_metadata(path: &Path, metadata: &Metadata) -> Result<Self, CaptureError> {
        let schema = version(path, metadata)?;
        let text = |key: &str| metadata.get(key).cloned();
        let is_adis16130 = schema == 1 || *stated(path, metadata, PART)? == Part::ADIS16130.name;
        let converter = is_adis16130.then(|| Converter::from_metadata(path, metadata)).transpose()?;
        let layout = match converter {
            Some(converter) => Layout::adis16130(converter.width),
            None => Layout::from_metadata(path, metadata)?,
        };
        if schema > 1 && is_adis16130 {
            check_layout(path, metadata, &layout)?;
        }
        Ok(Self {
            schema,
            layout,
            device: text(DEVICE).unwrap_or_default(),
            serial: text(SERIAL),
            converter,
            every_temp: number_or(path, metadata, EVERY_TEMP, 1)?,
            divider: number_or(path, metadata, DIVIDER, 1)?,
            divided: number_or(path, metadata, DIVIDED, 1)?,
            bandwidth_hz: if_stated(path, metadata, BANDWIDTH_HZ, |hz| hz > 0.0)?,
            earth_dps: if_stated(path, metadata, EARTH, |_| true)?,
            software: text(SOFTWARE).unwrap_or_default(),
            created: text(CREATED).unwrap_or_default(),
            notes: Notes {
                supply: text(SUPPLY_NOTE),
                ambient: text(AMBIENT_NOTE),
                operator: text(OPERATOR),
                host: text(HOST),
            },
        })
    }

    /// The recorded part, with its settings. If the part is not built in, only the facts in the capture are known:
    /// the scales of its codes, and its bandwidth if that was set.
    #[must_use]
    pub fn part(&self) -> Part {
        self.set(self.layout.part())
    }

    /// The recorded part, completed by facts from `known`. Scales, and the bandwidth if set, come from the capture.
    ///
    /// # Errors
    /// Returns [`NotThePart`] if the capture has another part, or an axis that `known` lacks.
    pub fn part_from(&self, known: &Part) -> Result<Part, NotThePart> {
        let mut part = self.layout.part();
        let of_name = |name: &str| known.axes.iter().find(|axis| axis.name == name);
        if part.name != known.name || part.axes.iter().any(|axis| of_name(&axis.name).is_none()) {
            return Err(NotThePart {
                found: part.name.to_string(),
                axes: axis_names(&part),
                given: format!("{} with the axes {}", known.name, axis_names(known)),
            });
        }
        for here in part.axes.to_mut() {
            if let Some(NamedAxis { axis, sources, .. }) = of_name(&here.name) {
                here.axis = Axis { rate: here.axis.rate, temp: here.axis.temp, ..*axis };
                here.sources = sources.clone();
            }
        }
        part.operating_c = known.operating_c;
        Ok(self.set(part))
    }

    fn set(&self, mut part: Part) -> Part {
        if let Some(hz) = self.bandwidth_hz {
            part.axes.to_mut().iter_mut().for_each(|axis| axis.axis.bandwidth_hz = Some(hz));
        }
        part
    }
}

fn axis_names(part: &Part) -> String {
    part.axes.iter().map(|axis| &*axis.name).collect::<Vec<_>>().join(", ")
}

impl Converter {
    fn from_metadata(path: &Path, metadata: &Metadata) -> Result<Self, CaptureError> {
        Ok(Self {
            width: width(path, number(path, metadata, WIDTH_BITS)?)?,
            rate_conversion: number(path, metadata, RATE_CONVERSION)?,
            temp_conversion: number(path, metadata, TEMP_CONVERSION)?,
        })
    }
}

/// A number in the metadata; `None` if the entry is absent.
fn if_stated(
    path: &Path,
    metadata: &Metadata,
    key: &str,
    can_be: fn(f64) -> bool,
) -> Result<Option<f64>, CaptureError> {
    if !metadata.contains_key(key) {
        return Ok(None);
    }
    match number::<f64>(path, metadata, key)? {
        value if value.is_finite() && can_be(value) => Ok(Some(value)),
        value => Err(CaptureError::damaged(path, "metadata", format!("{key} = {value}, which no part has"))),
    }
}

/// Converts a value to a single trimmed line, which every format can hold.
fn one_line(value: &str) -> String {
    value.replace(['\r', '\n'], " ").trim().to_owned()
}

/// Checks that the metadata of an ADIS16130 states the axes and scales of its layout.
fn check_layout(path: &Path, metadata: &Metadata, layout: &Layout) -> Result<(), CaptureError> {
    let wrong = layout.to_metadata().find(|(key, expected)| metadata.get(key) != Some(expected));
    wrong.map_or(Ok(()), |(key, expected)| {
        let found = metadata.get(&key).map_or("absent", |value| value);
        let what = format!("{key} is {found}, where an {} has {expected}", layout.part_name());
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
        found => Err(CaptureError::Newer { path: path.to_owned(), found, reads: SCHEMA_VERSION }),
    }
}

fn width(path: &Path, bits: u32) -> Result<Width, CaptureError> {
    [Width::Bits16, Width::Bits24]
        .into_iter()
        .find(|width| width.bits() == bits)
        .ok_or_else(|| CaptureError::damaged(path, "metadata", format!("{WIDTH_BITS} = {bits}, expected 16 or 24")))
}
