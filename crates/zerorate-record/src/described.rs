//! Presents a capture as a self-describing table: codes have scales, invalid readings are null, losses are counted.

use crate::columns::Rows;
use crate::layout::{CodedAxis, Layout};
use crate::succession::Mark;
use crate::table::recognise;
use crate::{CaptureInfo, CaptureWarning, Checked, valid};
use arrow_array::{Array, ArrayRef, BooleanArray, RecordBatch};
use arrow_schema::{ArrowError, SchemaRef};
use arrow_select::concat::concat;
use arrow_select::nullif::nullif;
use std::path::{Path, PathBuf};
use zerorate::Tally;
use zerorate::health::{Health, Judged};
use zerorate_input::Opened;
use zerorate_input::table::{Described, DescribedTable, Source, describes_itself};
use zerorate_input::{InputError, Quantity};

const TEMP_CODE: &str = "temp_code";

/// Opens a capture as a self-describing table; `None` if the file is not a capture.
///
/// # Errors
/// Returns an error if the file cannot be read, or if its description is not valid.
pub fn open_described(path: &Path, source: Source) -> Result<Option<Box<dyn DescribedTable>>, InputError> {
    let opened = match source {
        Source::File(input) => recognise(path, input)?,
        Source::Table(source) => Opened::Table(source),
    };
    let Opened::Table(source) = opened else { return Ok(None) };
    if !describes_itself(&source.stated().schema) {
        return Ok(None);
    }
    let capture = Checked::new(path, source)?;
    Ok(Some(Box::new(DescribedCapture { path: path.to_owned(), capture })))
}

struct DescribedCapture {
    path: PathBuf,
    capture: Checked,
}

impl DescribedTable for DescribedCapture {
    fn schema(&self) -> SchemaRef {
        self.capture.schema()
    }

    /// One column for each axis: its corrected rate or, in a capture without corrected rates, its codes.
    fn default_columns(&self) -> Vec<usize> {
        let schema = self.schema();
        let position = |name: String| schema.index_of(&name).ok();
        let rate = |axis: &CodedAxis| position(axis.corrected_column()).or_else(|| position(axis.code_column()));
        self.capture.info().layout.axes().iter().filter_map(rate).collect()
    }

    fn temperature(&self) -> Option<usize> {
        self.schema().index_of(TEMP_CODE).ok()
    }

    fn step(&self, column: usize) -> Option<(Quantity, f64)> {
        let (schema, layout) = (self.schema(), &self.capture.info().layout);
        let name = schema.field(column).name();
        let of_axis = layout.axes().iter().find(|axis| axis.code_column() == *name);
        let of_axis = of_axis.map(|axis| (Quantity::AngularRate, 1.0 / axis.scale_dps().lsb_per_unit));
        of_axis.or_else(|| (name == TEMP_CODE).then(|| (Quantity::Temperature, 1.0 / layout.temp().lsb_per_unit)))
    }

    fn read(
        mut self: Box<Self>,
        columns: &[usize],
        validates: bool,
        take: &mut (dyn FnMut(&[ArrayRef]) -> Result<(), InputError> + Send),
    ) -> Result<Described, InputError> {
        let Self { path, capture } = &mut *self;
        let mut validation = Validation::new(path, capture, columns, validates);
        read_beside(capture, &mut |batch, rows| take(&validation.take(batch, rows)?))?;
        take(&validation.rest()?)?;
        let of_file = capture.warnings().into_iter().map(|warning| coded(&warning)).collect();
        Ok(Described { warnings: of_file, ..validation.finish() })
    }
}

fn coded(warning: &CaptureWarning) -> (&'static str, String) {
    (warning.code(), warning.to_string())
}

type TakeRows<'a> = &'a mut (dyn FnMut(&RecordBatch, &Rows) -> Result<(), InputError> + Send);

/// Largest number of checked batches that wait for the thread that takes them.
#[cfg(not(target_family = "wasm"))]
const AHEAD: usize = 4;

/// Passes the rows of a capture to `take` on another thread, while this thread checks the next rows. The two tasks
/// take about the same time.
#[cfg(not(target_family = "wasm"))]
fn read_beside(capture: &mut Checked, take: TakeRows<'_>) -> Result<(), InputError> {
    std::thread::scope(|scope| {
        let (checked, to_take) = std::sync::mpsc::sync_channel(AHEAD);
        let taking = scope.spawn(move || to_take.into_iter().try_for_each(|(batch, rows)| take(&batch, &rows)));
        while let Some(next) = capture.next_rows()? {
            // `take` failed, and the join below returns its error
            if checked.send(next).is_err() {
                break;
            }
        }
        drop(checked);
        taking.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Passes the rows of a capture to `take`, on the same thread, because a browser has only one.
#[cfg(target_family = "wasm")]
fn read_beside(capture: &mut Checked, take: TakeRows<'_>) -> Result<(), InputError> {
    while let Some((batch, rows)) = capture.next_rows()? {
        take(&batch, &rows)?;
    }
    Ok(())
}

/// The requested columns, with the validation of their readings.
struct Validation<'a> {
    path: &'a Path,
    columns: Vec<(usize, Option<Readings>)>,
    axes: Vec<AxisValidation>,
    /// The count of rows and losses; `None` if it is not requested.
    count: Option<RowCount>,
}

impl<'a> Validation<'a> {
    fn new(path: &'a Path, capture: &Checked, columns: &[usize], validates: bool) -> Self {
        let (schema, mut axes) = (capture.schema(), Vec::new());
        let mut readings = |column: usize| Readings::of_column(schema.field(column).name(), capture.info(), &mut axes);
        let column = |column: &usize| (*column, validates.then(|| readings(*column)).flatten());
        let columns = columns.iter().map(column).collect();
        Self { path, columns, axes, count: validates.then(RowCount::default) }
    }

    /// Adds rows. Returns the newly validated values of each column of readings, and all new values of other columns.
    fn take(&mut self, batch: &RecordBatch, rows: &Rows) -> Result<Vec<ArrayRef>, InputError> {
        if let Some(count) = &mut self.count {
            count.take(rows);
        }
        let valid: Vec<Valid> = self.axes.iter_mut().map(|axis| axis.take(rows)).collect();
        let judged = |(column, readings): &mut (usize, Option<Readings>)| {
            let values = batch.column(*column);
            readings.as_mut().map_or_else(|| Ok(values.clone()), |readings| readings.take(values, &valid))
        };
        self.columns.iter_mut().map(judged).collect::<Result<_, _>>().map_err(|error| failed(self.path, &error))
    }

    /// Returns the remaining values of each column, which are validated only at the end.
    fn rest(&mut self) -> Result<Vec<ArrayRef>, InputError> {
        let valid: Vec<Valid> = self.axes.iter_mut().map(AxisValidation::rest).collect();
        let empty = || Ok(arrow_array::new_empty_array(&arrow_schema::DataType::Int64));
        let judged = |(_, readings): &mut (usize, Option<Readings>)| {
            readings.as_mut().and_then(|readings| readings.rest(&valid)).unwrap_or_else(empty)
        };
        self.columns.iter_mut().map(judged).collect::<Result<_, _>>().map_err(|error| failed(self.path, &error))
    }

    fn finish(self) -> Described {
        let Self { path, columns, axes, count } = self;
        let RowCount { span_ns, rows, lost } = count.unwrap_or_default();
        let all = lost.iter().fold(rows.saturating_sub(1), |sum, (_, lost)| sum.saturating_add(*lost));
        let rate = |(first, last): (u64, u64)| all as f64 * 1e9 / (last - first) as f64;
        let of_axis = |readings: &Readings| axes[readings.axis].warnings();
        Described {
            rate_hz: span_ns.filter(|(first, last)| first < last).map(rate),
            lost,
            warnings: Vec::new(),
            of_columns: columns.iter().map(|(_, of)| of.as_ref().map(of_axis).unwrap_or_default()).collect(),
            refused: axes.iter().find_map(|axis| axis.refusal(path)),
        }
    }
}

/// Validates the readings of an axis. All columns with its readings share the result.
struct AxisValidation {
    axis: usize,
    layout: Layout,
    health: Health,
    tally: Tally,
    start_ns: Option<u64>,
}

/// The validity of consecutive readings of an axis, one value per reading.
#[derive(Default)]
struct Valid {
    rates: Vec<bool>,
    temps: Vec<bool>,
}

impl AxisValidation {
    /// Starts the validation of an axis, by its index; `None` if the part has no such axis.
    fn new(axis: usize, info: &CaptureInfo) -> Option<Self> {
        let health = Health::new(&info.part().axes.get(axis)?.axis);
        Some(Self { axis, layout: info.layout.clone(), health, tally: Tally::default(), start_ns: None })
    }

    /// Adds rows. Returns the validity of each reading that can be judged now. The last two readings wait for the
    /// readings after them.
    fn take(&mut self, rows: &Rows) -> Valid {
        let mut valid = Valid::with_capacity(rows.len());
        self.tally.samples += rows.len() as u64;
        self.start_ns = self.start_ns.or(rows.marks().next().map(|mark| mark.t_ns));
        let judged = rows.readings(&self.layout, self.axis).filter_map(|reading| self.health.push(&reading));
        judged.for_each(|judged| valid.push(&judged));
        valid
    }

    /// Returns the validity of the remaining readings, which is known only at the end.
    fn rest(&mut self) -> Valid {
        let mut valid = Valid::default();
        while let Some(judged) = self.health.finish() {
            valid.push(&judged);
        }
        valid
    }

    /// The warnings about the readings. Complete once all are validated.
    fn warnings(&self) -> Vec<(&'static str, String)> {
        let found = valid::of_axes([("", &self.health)], &self.tally, self.start_ns.unwrap_or_default());
        found.iter().map(coded).collect()
    }

    /// The code and the text of the refusal if the readings were frozen at the end; `None` if they were not.
    fn refusal(&self, path: &Path) -> Option<(&'static str, String)> {
        let why = valid::frozen_text(&self.health.frozen_at_end()?, self.start_ns.unwrap_or_default());
        Some(("frozen", format!("{}: {why}; or cut the recording before that", path.display())))
    }
}

impl Valid {
    fn with_capacity(rows: usize) -> Self {
        let some = || Vec::with_capacity(rows + 2);
        Self { rates: some(), temps: some() }
    }

    fn push(&mut self, judged: &Judged) {
        self.rates.push(judged.flags.rate_is_good());
        self.temps.push(judged.flags.temp_is_good());
    }
}

#[derive(Clone, Copy, Debug)]
enum Channel {
    Rate,
    Temp,
}

/// A column of readings. Invalid readings become null.
struct Readings {
    /// Index of the axis among the validated axes.
    axis: usize,
    channel: Channel,
    /// Values of rows that are not validated yet; `None` before the first rows and after the last.
    tail: Option<ArrayRef>,
}

impl Readings {
    /// The readings in the column of this name; `None` if it does not hold readings. Adds their axis to `axes` if it
    /// is missing. A temperature is validated with the first axis.
    fn of_column(name: &str, info: &CaptureInfo, axes: &mut Vec<AxisValidation>) -> Option<Self> {
        let of_axis = info.layout.axes().iter().position(|axis| {
            [axis.code_column(), axis.rate_column(), axis.corrected_column()].contains(&name.to_owned())
        });
        let (channel, number) = match (of_axis, name) {
            (Some(axis), _) => (Channel::Rate, axis),
            (None, TEMP_CODE | "temp_c") => (Channel::Temp, 0),
            (None, _) => return None,
        };
        let axis = match axes.iter().position(|axis| axis.axis == number) {
            Some(place) => place,
            None => {
                axes.push(AxisValidation::new(number, info)?);
                axes.len() - 1
            }
        };
        Some(Self { axis, channel, tail: None })
    }

    /// Adds the values of more rows. Returns the newly validated values, in order.
    fn take(&mut self, values: &ArrayRef, valid: &[Valid]) -> Result<ArrayRef, ArrowError> {
        let valid = self.of_channel(valid);
        let values = match self.tail.take() {
            Some(tail) => concat(&[&tail, values])?,
            None => values.clone(),
        };
        self.tail = Some(values.slice(valid.len(), values.len() - valid.len()));
        masked(&values.slice(0, valid.len()), valid)
    }

    /// Returns the remaining values, which are validated only at the end; `None` if there are none.
    fn rest(&mut self, valid: &[Valid]) -> Option<Result<ArrayRef, ArrowError>> {
        Some(masked(&self.tail.take()?, self.of_channel(valid)))
    }

    fn of_channel<'a>(&self, valid: &'a [Valid]) -> &'a [bool] {
        let valid = &valid[self.axis];
        match self.channel {
            Channel::Rate => &valid.rates,
            Channel::Temp => &valid.temps,
        }
    }
}

fn masked(values: &ArrayRef, valid: &[bool]) -> Result<ArrayRef, ArrowError> {
    if valid.iter().all(|valid| *valid) {
        return Ok(values.clone());
    }
    nullif(values, &BooleanArray::from_iter(valid.iter().map(|valid| Some(!valid))))
}

fn failed(path: &Path, error: &ArrowError) -> InputError {
    InputError::damaged(path, "raw columns", error.to_string())
}

/// The time span of the rows, their number, and the losses: each with the index of the row that reported it.
#[derive(Default)]
struct RowCount {
    span_ns: Option<(u64, u64)>,
    rows: u64,
    lost: Vec<(usize, u64)>,
}

impl RowCount {
    fn take(&mut self, rows: &Rows) {
        for Mark { t_ns, lost, .. } in rows.marks() {
            self.span_ns = Some((self.span_ns.map_or(t_ns, |(start, _)| start), t_ns));
            // the losses of the first row were before the recording
            if lost > 0 && self.rows > 0 {
                self.lost.push((self.rows as usize, u64::from(lost)));
            }
            self.rows += 1;
        }
    }
}
