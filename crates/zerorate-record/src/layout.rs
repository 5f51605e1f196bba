//! The columns of a capture: the axes of its part, and the scales of their codes (docs/formats/capture.md, "Axes").

use super::CaptureError;
use super::row::Row;
use super::succession::Mark;
use adis16130::{ChannelStatus, Width};
use arrow_schema::{DataType, Field, Metadata};
use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;
use zerorate::{Axis, MAX_AXES, NamedAxis, NoiseSources, Part, Reading, Scale, Scan};
use zerorate_input::{Quantity, Unit};

/// Metadata key of the axis names. Version 1 of the format does not have it.
pub const AXES: &str = "zerorate.axes";

pub(super) const PART: &str = "zerorate.part";
const STATUS_BITS: &str = "zerorate.status_bits";
const TEMP: &str = "zerorate.temp";

/// The longest name of a part or of an axis, bytes (docs/formats/part.md).
const LONGEST_NAME: usize = 40;

/// The axes of a part, and the scales of its codes.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    part: String,
    axes: Vec<CodedAxis>,
    temp: Scale,
    status_bits: u8,
    /// Number of low bits that codes lack compared with a [`Reading`]: 8 for the 16-bit codes of an ADIS16130 (F-43).
    dropped_bits: u8,
}

/// An axis of the recorded part, with the scale of its codes.
#[derive(Clone, Debug, PartialEq)]
pub struct CodedAxis {
    /// Name of the axis. The names of its columns begin with it.
    pub name: String,
    /// The unit of the scaled codes.
    pub unit: Unit,
    /// The scale from codes to `unit`.
    pub scale: Scale,
}

/// The reasons why a capture cannot have a layout.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "the fields are the words of the message")]
pub enum LayoutError {
    /// The number of axes is out of range.
    #[error("{0} axes; a capture has 1 to {MAX_AXES}")]
    Axes(usize),
    /// The name of the part or of an axis is invalid.
    #[error("{0:?} is not a name; use up to {LONGEST_NAME} letters, digits, -, _ and .")]
    Name(String),
    /// Two columns have the same name.
    #[error("two columns would be called `{0}`: give the axes other names")]
    Column(String),
    /// Codes are too far from the zero code for 32 bits.
    #[error("the codes of `{name}` go from {first} to {last}: so far from the zero code {zero} none can be taken")]
    Codes { name: String, first: i64, last: i64, zero: i64 },
    /// A status register cannot have this width.
    #[error("a status of {0} bits; it has 8, 16 or 32")]
    Status(u8),
    /// The part has the name of the built-in part, ADIS16130.
    #[error("an {0} is built in, and its captures state how its converter was set: give the part another name")]
    BuiltIn(String),
}

impl Layout {
    /// The layout of an ADIS16130 with codes of this width (F-40, F-41, F-43).
    #[must_use]
    pub fn adis16130(width: Width) -> Self {
        let Part { name, axes, .. } = Part::ADIS16130;
        let dropped_bits = width.dropped_bits() as u8;
        let coded = |NamedAxis { name, axis, .. }: &NamedAxis| CodedAxis {
            name: name.to_string(),
            unit: Unit::Dps,
            scale: axis.rate.without_low_bits(dropped_bits),
        };
        Self {
            part: name.into_owned(),
            axes: axes.iter().map(coded).collect(),
            temp: Axis::ADIS16130.temp.without_low_bits(dropped_bits),
            status_bits: 8,
            dropped_bits,
        }
    }

    /// The layout of a part other than the ADIS16130, with the scales of the part. The status has 8 bits.
    ///
    /// # Errors
    /// Returns [`LayoutError`] if a capture cannot hold the part.
    pub fn of_part(part: &Part) -> Result<Self, LayoutError> {
        if part.name == Part::ADIS16130.name {
            return Err(LayoutError::BuiltIn(part.name.to_string()));
        }
        let temp = part.axes.first().ok_or(LayoutError::Axes(0))?.axis.temp;
        let coded = |NamedAxis { name, axis, .. }: &NamedAxis| CodedAxis {
            name: name.to_string(),
            unit: Unit::Dps,
            scale: axis.rate,
        };
        Self::new(part.name.to_string(), part.axes.iter().map(coded).collect(), temp, 8)
    }

    pub(super) fn new(part: String, axes: Vec<CodedAxis>, temp: Scale, status_bits: u8) -> Result<Self, LayoutError> {
        let layout = Self { part, axes, temp, status_bits, dropped_bits: 0 };
        if !(1..=MAX_AXES).contains(&layout.axes.len()) {
            return Err(LayoutError::Axes(layout.axes.len()));
        }
        let names = layout.axes.iter().map(|axis| &axis.name).chain([&layout.part]);
        if let Some(name) = names.into_iter().find(|name| !is_name(name)) {
            return Err(LayoutError::Name(name.clone()));
        }
        let mut columns = [layout.raw_fields(), layout.derived_fields()].concat();
        columns.sort_by(|one, next| one.name().cmp(next.name()));
        if let Some(pair) = columns.windows(2).find(|pair| pair[0].name() == pair[1].name()) {
            return Err(LayoutError::Column(pair[0].name().clone()));
        }
        let scales = layout.axes.iter().map(|axis| (axis.name.as_str(), &axis.scale)).chain([("temp", &layout.temp)]);
        for (name, scale) in scales {
            let ((first, last), zero) = (scale.codes(), scale.zero_code);
            if [first, last].iter().any(|code| i32::try_from(code.saturating_sub(zero)).is_err()) {
                return Err(LayoutError::Codes { name: name.to_owned(), first, last, zero });
            }
        }
        if matches!(status_bits, 8 | 16 | 32) { Ok(layout) } else { Err(LayoutError::Status(status_bits)) }
    }

    /// The type name of the part, such as `ADIS16130`.
    #[must_use]
    pub fn part_name(&self) -> &str {
        &self.part
    }

    /// The axes, in the order of their columns.
    #[must_use]
    pub fn axes(&self) -> &[CodedAxis] {
        &self.axes
    }

    /// The direction of each axis: 0, 1 or 2 for x, y or z, by the last letter of its name. A single axis without
    /// such a letter is z. `None` if the names do not give each axis its own direction.
    #[must_use]
    pub fn directions(&self) -> Option<Vec<usize>> {
        let direction = |axis: &CodedAxis| {
            let last = axis.name.chars().last()?.to_ascii_lowercase();
            ['x', 'y', 'z'].iter().position(|letter| *letter == last)
        };
        let found: Vec<Option<usize>> = self.axes.iter().map(direction).collect();
        match (found.iter().copied().collect::<Option<Vec<usize>>>(), found.len()) {
            (Some(all), _) if (1..all.len()).all(|at| !all[..at].contains(&all[at])) => Some(all),
            (_, 1) => Some(vec![2]),
            _ => None,
        }
    }

    /// The scale from temperature codes to °C.
    #[must_use]
    pub fn temp(&self) -> &Scale {
        &self.temp
    }

    /// Number of bits of the status register.
    #[must_use]
    pub fn status_bits(&self) -> u8 {
        self.status_bits
    }

    /// The part, with the scales of its codes. All other properties are unknown, except those of an ADIS16130.
    #[must_use]
    pub fn part(&self) -> Part {
        if self.is_adis16130() {
            return Part::ADIS16130;
        }
        let axis = |coded: &CodedAxis| NamedAxis {
            name: coded.name.clone().into(),
            column: None,
            axis: Axis::unknown(coded.scale_dps(), self.temp),
            sources: NoiseSources::default(),
        };
        Part {
            name: self.part.clone().into(),
            axes: self.axes.iter().map(axis).collect(),
            temp_column: None,
            operating_c: None,
        }
    }

    fn is_adis16130(&self) -> bool {
        self.part == Part::ADIS16130.name
    }

    /// Converts a row to a [`Scan`], in the scales of [`Layout::part`].
    #[must_use]
    #[inline]
    pub fn scan(&self, row: &Row) -> Scan {
        let mut rates = [0; MAX_AXES];
        let axes = rates.iter_mut().zip(&self.axes).zip(row.codes());
        axes.for_each(|((rate, axis), code)| *rate = self.core_code(&axis.scale, *code));
        let scan = Scan::new(row.t_ns, row.edge_seq, &rates[..self.axes.len().min(row.codes().len())]);
        // cannot fail: a scan holds as many axes as a row
        let scan = scan.unwrap_or_else(|| Scan::from(&NO_READING)).with_lost(row.lost);
        let axes = self.axes.iter().zip(row.codes()).enumerate();
        let outside = axes.filter(|(_, (axis, code))| self.is_out_of_range(axis, **code, row.status));
        let temp = row.temp_code.map(|code| self.core_code(&self.temp, code));
        outside.fold(scan.with_temp(temp), |scan, (axis, _)| scan.with_out_of_range(axis))
    }

    /// The reading of one axis; `None` if the layout has no such axis.
    #[must_use]
    #[inline]
    pub fn reading(&self, row: &Row, axis: usize) -> Option<Reading> {
        let (axis, code) = (self.axes.get(axis)?, *row.codes().get(axis)?);
        Some(self.reading_of(axis, code, row.temp_code, row.status, row.mark()))
    }

    #[inline]
    pub(super) fn reading_of(
        &self,
        axis: &CodedAxis,
        code: i64,
        temp_code: Option<i64>,
        status: Option<u32>,
        mark: Mark,
    ) -> Reading {
        Reading {
            t_ns: mark.t_ns,
            seq: mark.edge_seq,
            rate: self.core_code(&axis.scale, code),
            temp: temp_code.map(|code| self.core_code(&self.temp, code)),
            out_of_range: self.is_out_of_range(axis, code, status),
            lost: mark.lost,
        }
    }

    #[inline]
    fn core_code(&self, scale: &Scale, code: i64) -> i32 {
        ((code - scale.zero_code) << self.dropped_bits) as i32
    }

    /// True if a reading is out of range: by a code at an end of the scale, or by an ADIS16130's status (OVR, F-35).
    #[inline]
    fn is_out_of_range(&self, axis: &CodedAxis, code: i64, status: Option<u32>) -> bool {
        let (first, last) = axis.scale.codes();
        let told = |status: u32| self.is_adis16130() && ChannelStatus::new(status as u8).out_of_range();
        code <= first || code >= last || status.is_some_and(told)
    }

    /// Checks that the row fits this layout. The error states what is wrong.
    #[inline]
    pub(super) fn check_row(&self, row: &Row) -> Result<(), String> {
        let fits = |scale: &Scale, code: i64| {
            let (first, last) = scale.codes();
            (first..=last).contains(&code)
        };
        let codes = row.codes();
        let all = codes.len() == self.axes.len()
            && self.axes.iter().zip(codes).all(|(axis, code)| fits(&axis.scale, *code))
            && row.temp_code.is_none_or(|code| fits(&self.temp, code))
            && row.status.is_none_or(|status| u64::from(status) >> self.status_bits == 0);
        if all { Ok(()) } else { Err(self.misfit(row)) }
    }

    #[cold]
    fn misfit(&self, row: &Row) -> String {
        let (part, axes, found) = (&self.part, self.axes.len(), row.codes());
        format!("{row:?} is not a row of part {part}, for it has {found:?} in place of {axes} codes of its width")
    }

    /// The raw columns, in their order in the file.
    #[must_use]
    pub fn raw_fields(&self) -> Vec<Field> {
        let codes = self.axes.iter().map(|axis| Field::new(axis.code_column(), code_type(&axis.scale), false));
        let before = [Field::new("t_ns", DataType::UInt64, false), Field::new("edge_seq", DataType::UInt32, false)];
        let status = match self.status_bits {
            16 => DataType::UInt16,
            32 => DataType::UInt32,
            _ => DataType::UInt8,
        };
        let after = [
            Field::new("status", status, true),
            Field::new("temp_code", code_type(&self.temp), true),
            Field::new("lost", DataType::UInt32, false),
        ];
        before.into_iter().chain(codes).chain(after).collect()
    }

    /// The derived columns, which follow the raw columns in a corrected capture.
    #[must_use]
    pub fn derived_fields(&self) -> Vec<Field> {
        let rates = self.axes.iter().map(|axis| Field::new(axis.rate_column(), DataType::Float64, false));
        let temp = Field::new("temp_c", DataType::Float64, true);
        let corrected = self.axes.iter().map(|axis| Field::new(axis.corrected_column(), DataType::Float64, true));
        let flags: Vec<String> = match &self.axes[..] {
            [_] => vec!["flags".to_owned()],
            axes => axes.iter().map(|axis| format!("{}_flags", axis.name)).collect(),
        };
        let flags = flags.into_iter().map(|name| Field::new(name, DataType::UInt8, false));
        rates.chain([temp]).chain(corrected).chain(flags).collect()
    }

    /// The metadata entries of the part, its axes, the scales of all codes, and the width of the status.
    pub(super) fn to_metadata(&self) -> impl Iterator<Item = (String, String)> {
        let scale = |key: String, unit: &str, scale: &Scale| {
            let signed = scale.signed.then(|| (format!("{key}.signed"), "true".to_owned()));
            let stated = [
                (format!("{key}.unit"), unit.to_owned()),
                (format!("{key}.width_bits"), scale.width_bits.to_string()),
                (format!("{key}.zero_code"), scale.zero_code.to_string()),
                (format!("{key}.lsb_per_unit"), scale.lsb_per_unit.to_string()),
            ];
            stated.into_iter().chain(signed)
        };
        let names: Vec<&str> = self.axes.iter().map(|axis| axis.name.as_str()).collect();
        let status = (self.status_bits != 8).then(|| (STATUS_BITS.to_owned(), self.status_bits.to_string()));
        let whole = [
            (PART.to_owned(), self.part.clone()),
            (AXES.to_owned(), names.join(",")),
            (format!("{TEMP}.zero_value"), self.temp.zero_value.to_string()),
        ];
        let axes = self.axes.iter().flat_map(move |axis| scale(axis.key(), axis.unit.name(), &axis.scale));
        axes.chain(scale(TEMP.to_owned(), "c", &self.temp)).chain(whole).chain(status)
    }

    /// Parses the entries of [`Layout::to_metadata`], for a part other than an ADIS16130.
    pub(super) fn from_metadata(path: &Path, metadata: &Metadata) -> Result<Self, CaptureError> {
        let names = stated(path, metadata, AXES)?.split(',').map(str::trim);
        let axes = names.map(|name| CodedAxis::from_metadata(path, metadata, name)).collect::<Result<_, _>>()?;
        let zero_c = number(path, metadata, &format!("{TEMP}.zero_value"))?;
        let temp = scale(path, metadata, TEMP, zero_c)?;
        let status_bits = number_or(path, metadata, STATUS_BITS, 8)?;
        let layout = Self::new(stated(path, metadata, PART)?.clone(), axes, temp, status_bits);
        layout.map_err(|what| CaptureError::damaged(path, "metadata", what.to_string()))
    }
}

const NO_READING: Reading = Reading { t_ns: 0, seq: 0, rate: 0, temp: None, out_of_range: false, lost: 0 };

impl CodedAxis {
    fn key(&self) -> String {
        format!("zerorate.axis.{}", self.name)
    }

    fn from_metadata(path: &Path, metadata: &Metadata, name: &str) -> Result<Self, CaptureError> {
        let key = format!("zerorate.axis.{name}");
        let unit = stated(path, metadata, &format!("{key}.unit"))?;
        let known = Unit::from_str(unit).ok().filter(|unit| unit.quantity() == Quantity::AngularRate);
        let known = known.ok_or_else(|| CaptureError::OtherQuantity {
            path: path.to_owned(),
            axis: name.to_owned(),
            unit: unit.clone(),
        });
        Ok(Self { name: name.to_owned(), unit: known?, scale: scale(path, metadata, &key, 0.0)? })
    }

    /// The scale from codes to °/s.
    #[must_use]
    pub fn scale_dps(&self) -> Scale {
        Scale { lsb_per_unit: self.scale.lsb_per_unit / self.unit.in_results(), ..self.scale }
    }

    /// Name of the column of raw codes.
    #[must_use]
    pub fn code_column(&self) -> String {
        format!("{}_code", self.name)
    }

    /// Name of the column of the measured rate, °/s. Only a corrected capture has this column.
    #[must_use]
    pub fn rate_column(&self) -> String {
        format!("{}_dps", self.name)
    }

    /// Name of the column of the corrected rate, °/s. Only a corrected capture has this column.
    #[must_use]
    pub fn corrected_column(&self) -> String {
        format!("{}_corrected_dps", self.name)
    }
}

fn is_name(name: &str) -> bool {
    let good = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(good)
}

fn code_type(scale: &Scale) -> DataType {
    if scale.signed { DataType::Int32 } else { DataType::UInt32 }
}

fn scale(path: &Path, metadata: &Metadata, key: &str, zero_value: f64) -> Result<Scale, CaptureError> {
    let entry = |name: &str| format!("{key}.{name}");
    let scale = Scale {
        lsb_per_unit: number(path, metadata, &entry("lsb_per_unit"))?,
        zero_code: number(path, metadata, &entry("zero_code"))?,
        zero_value,
        width_bits: number(path, metadata, &entry("width_bits"))?,
        signed: number_or(path, metadata, &entry("signed"), false)?,
    };
    let has_scale = scale.lsb_per_unit > 0.0 && scale.lsb_per_unit.is_finite() && scale.zero_value.is_finite();
    if !(has_scale && (1..=32).contains(&scale.width_bits)) {
        let (lsb, bits) = (scale.lsb_per_unit, scale.width_bits);
        let what = format!("`{key}`: {lsb} codes of {bits} bits per unit do not make a scale");
        return Err(CaptureError::damaged(path, "metadata", what));
    }
    Ok(scale)
}

pub(super) fn stated<'a>(path: &Path, metadata: &'a Metadata, key: &str) -> Result<&'a String, CaptureError> {
    metadata.get(key).ok_or_else(|| CaptureError::damaged(path, "metadata", format!("`{key}` is missing")))
}

pub(super) fn number<T: FromStr>(path: &Path, metadata: &Metadata, key: &str) -> Result<T, CaptureError> {
    let text = stated(path, metadata, key)?;
    let wrong =
        || CaptureError::damaged(path, "metadata", format!("{key} = {text}, which is not a number in its range"));
    text.parse().map_err(|_| wrong())
}

pub(super) fn number_or<T: FromStr + Display>(
    path: &Path,
    metadata: &Metadata,
    key: &str,
    default: T,
) -> Result<T, CaptureError> {
    if metadata.contains_key(key) { number(path, metadata, key) } else { Ok(default) }
}
