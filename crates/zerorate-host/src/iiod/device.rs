//! The served device: its attributes, their current values, and writes to them.

use super::request::{Errno, Place};
use super::scan::{Scan, Scanner, corrected};
use super::table::{CORRECTED_RAD_PER_S, Channel, Quantity, Table};
use crate::WatchedBatch;
use crate::source::DeviceInfo;
use std::sync::{Mutex, MutexGuard, PoisonError};
use zerorate::calibration::OtherPart;
use zerorate::{Axis, Calibration, Correction, Corrector, MAX_AXES, Scale, Tally};
use zerorate_record::Layout;

/// The id that libiio gives to the first device.
pub const ID: &str = "iio:device0";

/// The attributes of the device itself.
pub const ATTRIBUTES: [&str; 4] = ["sampling_frequency", "samples_lost", "calibration", "current_timestamp_clock"];

pub const BUFFER_ATTRIBUTES: [&str; 1] = ["samples_lost"];

/// The only attribute that can be written, if writing is allowed.
const WRITABLE: &str = "calibbias";

/// Largest bias that a client may write, rad/s. No gyroscope has a larger bias.
const LARGEST_BIAS_RAD_PER_S: f64 = 100.0;

#[derive(Debug)]
pub struct Device {
    /// The name for clients: the name of the part in lower case.
    pub name: String,
    /// The attributes of the libiio context.
    pub context: Vec<(&'static str, String)>,
    pub table: Table,
    pub layout: Layout,
    axes: Vec<Axis>,
    corrector: Option<Corrector<Vec<Correction>>>,
    calibration: Option<String>,
    nominal_hz: Option<f64>,
    may_be_written: bool,
    live: Mutex<Live>,
}

#[derive(Debug)]
struct Live {
    scanner: Scanner,
    scan: Option<Scan>,
    /// Counts of samples, from which the sample rate is computed. Samples that the server missed count as lost here.
    tally: Tally,
    /// Number of samples that were lost between the part and the hub.
    lost: u64,
    /// True if the samples have ended.
    is_gone: bool,
    /// Number of samples that did not fit into the buffers of clients.
    missed: u64,
    /// Offsets that clients added to the corrected rate of each axis, °/s.
    trims_dps: [f64; MAX_AXES],
}

impl Device {
    /// Describes the device that a hub reads. With a calibration, the device also has channels of corrected rates.
    pub fn new(facts: &DeviceInfo, calibration: Option<&Calibration>) -> Result<Self, OtherPart> {
        let DeviceInfo { info, part, .. } = facts;
        let names = || part.axes.iter().map(|axis| &*axis.name);
        let corrector = calibration.map(|calibration| calibration.corrector(&part.name, names())).transpose()?;
        let axes: Vec<Axis> = part.axes.iter().map(|axis| axis.axis).collect();
        let scanner = Scanner::new(&info.layout, &axes, corrector.clone());
        let stated = [
            ("hw_model", Some(part.name.to_string())),
            ("hw_serial", info.serial.clone()),
            ("zerorate,device", Some(facts.name.clone())),
            ("zerorate,software", Some(info.software.clone())),
            ("zerorate,calibration", calibration.map(Calibration::id)),
        ];
        let is_there = |(key, value): (&'static str, Option<String>)| Some((key, value.filter(|it| !it.is_empty())?));
        Ok(Self {
            name: part.name.to_ascii_lowercase(),
            context: stated.into_iter().filter_map(is_there).collect(),
            table: Table::new(&info.layout, corrector.is_some()),
            layout: info.layout.clone(),
            axes,
            corrector,
            calibration: calibration.map(Calibration::id),
            nominal_hz: facts.rate_hz,
            may_be_written: false,
            live: Mutex::new(Live {
                scanner,
                scan: None,
                tally: Tally::default(),
                lost: 0,
                is_gone: false,
                missed: 0,
                trims_dps: [0.0; MAX_AXES],
            }),
        })
    }

    /// Allows clients to write `calibbias`.
    pub fn writable(self) -> Self {
        Self { may_be_written: true, ..self }
    }

    pub fn is_called(&self, name: &str) -> bool {
        name == ID || name == self.name
    }

    /// A scanner for a buffer that begins now.
    pub fn scanner(&self) -> Scanner {
        Scanner::new(&self.layout, &self.axes, self.corrector.clone()).with_temp_of(&self.live().scanner)
    }

    pub fn trims_dps(&self) -> [f64; MAX_AXES] {
        self.live().trims_dps
    }

    /// Adds rows. Rows that the queue of the server dropped count for the sample rate, but not as lost.
    pub fn take(&self, watched: &WatchedBatch) {
        let live = &mut *self.live();
        let (mut missed, mut lost) = (watched.missed, watched.lost);
        for row in &watched.batch.rows {
            let absent = u64::from(row.lost).saturating_add(missed).saturating_add(lost);
            if let Some(reading) = self.layout.reading(row, 0) {
                live.tally.count(&zerorate::Reading { lost: u32::try_from(absent).unwrap_or(u32::MAX), ..reading });
            }
            live.lost = live.lost.saturating_add(lost).saturating_add(row.lost.into());
            live.scan = live.scanner.push(row, lost, &live.trims_dps).or(live.scan);
            (missed, lost) = (0, 0);
        }
    }

    pub fn note_missed(&self, missed: u64) {
        let live = &mut *self.live();
        live.missed = live.missed.saturating_add(missed);
    }

    pub fn note_gone(&self) {
        self.live().is_gone = true;
    }

    pub fn is_gone(&self) -> bool {
        self.live().is_gone
    }

    /// True if there is a sample for the attributes to show. With a correction, the first sample needs three rows.
    pub fn has_readings(&self) -> bool {
        self.live().scan.is_some()
    }

    /// Reads an attribute. Returns an error if there is no such attribute, if its value needs a sample and there is
    /// none yet, or if it is `raw` and the samples have ended.
    pub fn read(&self, place: Place<'_>, attribute: &str) -> Result<String, Errno> {
        match place {
            Place::Device => self.read_own(attribute),
            Place::Buffer if BUFFER_ATTRIBUTES.contains(&attribute) => Ok(self.live().missed.to_string()),
            Place::Input(name) => self.read_channel(self.channel(name, attribute)?, attribute),
            Place::Buffer | Place::Debug | Place::Output(_) => Err(Errno::NOT_FOUND),
        }
    }

    /// The attributes of a place, in the order of the XML description.
    pub fn attributes(&self, place: Place<'_>) -> &'static [&'static str] {
        match place {
            Place::Device => &ATTRIBUTES,
            Place::Buffer => &BUFFER_ATTRIBUTES,
            Place::Input(name) => self.table.channel(name).map_or(&[], |channel| channel.attributes),
            Place::Debug | Place::Output(_) => &[],
        }
    }

    /// The axis whose correction this attribute sets. An error if there is no such attribute, or if it cannot or may
    /// not be written.
    pub fn writable_axis(&self, place: Place<'_>, attribute: &str) -> Result<usize, Errno> {
        if !self.attributes(place).contains(&attribute) {
            return Err(Errno::NOT_FOUND);
        }
        let channel = if let Place::Input(name) = place { self.table.channel(name) } else { None };
        match channel.map(|channel| channel.quantity) {
            Some(Quantity::Rate(axis)) if attribute == WRITABLE && self.may_be_written => Ok(axis),
            _ => Err(Errno::DENIED),
        }
    }

    /// Sets the correction of an axis at the current temperature to `value`, rad/s, by adding a constant. The
    /// correction still follows the temperature.
    pub fn trim(&self, axis: usize, value: &[u8]) -> Result<(), Errno> {
        let text = std::str::from_utf8(value).map_err(|_| Errno::NONSENSE)?;
        let wanted: f64 = text.trim_end_matches('\0').trim().parse().map_err(|_| Errno::NONSENSE)?;
        // this comparison also rejects NaN
        if wanted.abs() <= LARGEST_BIAS_RAD_PER_S {
            let live = &mut *self.live();
            live.trims_dps[axis] += wanted.to_degrees() - self.bias_dps(live, axis)?;
            return Ok(());
        }
        Err(Errno::NONSENSE)
    }

    fn live(&self) -> MutexGuard<'_, Live> {
        self.live.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn channel(&self, name: &str, attribute: &str) -> Result<&Channel, Errno> {
        let channel = self.table.channel(name).filter(|channel| channel.attributes.contains(&attribute));
        channel.ok_or(Errno::NOT_FOUND)
    }

    fn read_own(&self, attribute: &str) -> Result<String, Errno> {
        let live = self.live();
        match attribute {
            "sampling_frequency" => {
                let measured_hz = (live.tally.samples > 1).then(|| live.tally.sampling_hz());
                measured_hz.or(self.nominal_hz).map(|hz| hz.to_string()).ok_or(Errno::TRY_AGAIN)
            }
            "samples_lost" => Ok(live.lost.to_string()),
            "calibration" => Ok(self.calibration_now(&live)),
            "current_timestamp_clock" => Ok("monotonic".to_owned()),
            _ => Err(Errno::NOT_FOUND),
        }
    }

    /// The id of the applied calibration, marked if clients added offsets; `none` without a calibration.
    fn calibration_now(&self, live: &Live) -> String {
        let id = self.calibration.as_deref().unwrap_or("none");
        let is_shifted = live.trims_dps.iter().any(|dps| *dps != 0.0);
        format!("{id}{}", if is_shifted { " shifted" } else { "" })
    }

    fn read_channel(&self, channel: &Channel, attribute: &str) -> Result<String, Errno> {
        match (channel.quantity, attribute) {
            (Quantity::Corrected(_), "scale") => Ok(CORRECTED_RAD_PER_S.to_string()),
            (Quantity::Rate(axis), "calibbias") => Ok(self.bias_dps(&self.live(), axis)?.to_radians().to_string()),
            (quantity, "raw") => self.raw(quantity),
            (quantity, attribute) => {
                let (lsb, offset) = self.scale(quantity).ok_or(Errno::NOT_FOUND)?;
                Ok(if attribute == "scale" { lsb.to_string() } else { offset.to_string() })
            }
        }
    }

    fn raw(&self, quantity: Quantity) -> Result<String, Errno> {
        let live = self.live();
        if live.is_gone {
            return Err(Errno::NO_DEVICE);
        }
        let scan = live.scan.as_ref().ok_or(Errno::TRY_AGAIN)?;
        let value = match quantity {
            Quantity::Rate(axis) => scan.row.codes().get(axis).map(ToString::to_string),
            Quantity::Temp => scan.row.temp_code.map(|code| code.to_string()),
            Quantity::Corrected(axis) => scan.corrected_dps[axis].map(|dps| corrected(Some(dps)).to_string()),
            Quantity::Lost => Some(scan.lost.to_string()),
            Quantity::Time => None,
        };
        value.ok_or(Errno::TRY_AGAIN)
    }

    /// Scale and offset of a quantity. (raw + offset) · scale is in the kernel's unit, rad/s or 0.001 °C.
    fn scale(&self, quantity: Quantity) -> Option<(f64, f64)> {
        let scale_in = |scale: &Scale, per_unit: f64| {
            let zero = scale.zero_code as f64 - scale.zero_value * scale.lsb_per_unit;
            (per_unit / scale.lsb_per_unit, -zero)
        };
        match quantity {
            Quantity::Rate(axis) => Some(scale_in(&self.layout.axes().get(axis)?.scale_dps(), 1f64.to_radians())),
            Quantity::Temp => Some(scale_in(self.layout.temp(), 1000.0)),
            Quantity::Corrected(_) | Quantity::Lost | Quantity::Time => None,
        }
    }

    /// The offset that is currently added to the rate of an axis, °/s.
    fn bias_dps(&self, live: &Live, axis: usize) -> Result<f64, Errno> {
        Ok(live.scanner.correction_dps(axis).ok_or(Errno::TRY_AGAIN)? + live.trims_dps[axis])
    }
}
