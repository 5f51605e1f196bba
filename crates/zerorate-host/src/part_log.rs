//! Reads a part's log as rows of a capture: finds the columns by the names of the axes, converts values to codes,
//! and counts gaps as losses.

use std::path::Path;
use zerorate::{MAX_AXES, Part, Scale};
use zerorate_allan::Gap;
use zerorate_input::{Input, Quantity};
use zerorate_logs::{
    ColumnOptions, ColumnSpec, LogError, LogWarning, Result, TEMPERATURE_COLUMN, TimedColumn, TimedColumns, read_timed,
};
use zerorate_record::{CaptureInfo, Layout, Row};

/// Largest distance from a whole code without a warning, in codes. Rounded decimals cause smaller distances.
const ON_GRID: f64 = 1e-4;

/// A log whose columns are the axes and the temperature of a part.
///
/// Integers without a unit are codes; values with a unit are rounded to codes. A row that lacks an axis is not a
/// reading, and the next row counts it as lost.
#[derive(Debug)]
pub struct PartLog {
    info: CaptureInfo,
    t_ns: Vec<u64>,
    /// The codes of each axis, and in `temps` those of the temperature; NaN if a value is missing.
    axes: Vec<Vec<f64>>,
    temps: Vec<f64>,
    /// The gaps: positions of rows, and the number of readings that were lost before each of these rows.
    gaps: std::iter::Peekable<std::vec::IntoIter<Gap>>,
    next_row: usize,
    edge_seq: u32,
    lost: u64,
    warnings: Vec<LogWarning>,
}

impl PartLog {
    /// Reads a log in any supported format, and checks all of it. `path` names the log in messages. If neither a time
    /// column nor a rate is given, the time is the only other column whose name states a unit of time, as in `t_ns`.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, if it lacks an axis, the temperature, a unit or the time, or if it
    /// has values that the part cannot have measured.
    pub fn open(path: &Path, input: Input, part: &Part, args: &ColumnOptions) -> Result<Self> {
        let layout = Layout::of_part(part)
            .map_err(|what| LogError::Ask(format!("no capture can have the part {}: {what}", part.name)))?;
        let specs = specs(part);
        let TimedColumns { mut columns, t_ns, gaps, mut warnings } = read_timed(path, input, &specs, args)?;
        let temp = columns.pop().filter(|_| columns.len() == part.axes.len());
        let temp = temp.ok_or_else(|| LogError::Ask(format!("{} has one column only", path.display())))?;
        let axes = columns.into_iter().zip(&part.axes[..]).zip(&specs).map(|((column, axis), spec)| {
            let given = args.unit.map(|unit| (unit.quantity(), unit.in_results()));
            let stated = column.stated.or(given).or_else(|| stated(&column.name, spec));
            let unit = rate_unit(path, &column.name, stated)?;
            Coding { path, scale: axis.axis.rate, unit, name: "°/s", remedy: "`gx [rad/s]` or `x_dps`" }
                .codes(column, &mut warnings)
        });
        let axes: Vec<Vec<f64>> = axes.collect::<Result<_>>()?;
        let unit = temp.stated.or_else(|| stated(&temp.name, specs.last()?));
        let unit = unit.filter(|(quantity, _)| *quantity == Quantity::Temperature).map(|(_, celsius)| celsius);
        let scale = *layout.temp();
        let coding = Coding { path, scale, unit, name: "°C", remedy: "`temp_c` or `T [°C]`" };
        let temps = coding.codes(temp, &mut warnings)?;
        if temps.iter().all(|code| code.is_nan()) {
            return Err(LogError::Refused(
                "no-temperature",
                format!("{} holds no temperature in any row", path.display()),
            ));
        }
        let info = CaptureInfo {
            device: path.display().to_string(),
            software: zerorate::SOFTWARE.to_owned(),
            ..CaptureInfo::new(layout)
        };
        let gaps = gaps.into_iter().peekable();
        let log = Self { info, t_ns, axes, temps, gaps, next_row: 0, edge_seq: 0, lost: 0, warnings };
        log.checked(path)
    }

    /// The description of the rows as a capture. The caller may add facts that the log does not state.
    #[must_use]
    pub fn info(&self) -> &CaptureInfo {
        &self.info
    }

    /// The warnings about the log, for example about rounded values or rows with missing values.
    #[must_use]
    pub fn warnings(&self) -> &[LogWarning] {
        &self.warnings
    }

    fn checked(mut self, path: &Path) -> Result<Self> {
        let lacking = (0..self.temps.len()).filter(|row| self.lacks(*row)).count();
        if lacking == self.temps.len() {
            return Err(LogError::Refused(
                "rows-incomplete",
                format!("{} holds no row with all axes", path.display()),
            ));
        }
        if lacking > 0 {
            let (path, rows) = (path.display().to_string(), self.temps.len());
            self.warnings.push(LogWarning::RowsIncomplete { path, lacking, rows });
        }
        Ok(self)
    }

    fn lacks(&self, row: usize) -> bool {
        self.axes.iter().any(|codes| codes[row].is_nan())
    }
}

impl Iterator for PartLog {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        loop {
            let row = self.next_row;
            let t_ns = *self.t_ns.get(row)?;
            while let Some(gap) = self.gaps.next_if(|gap| gap.at <= row) {
                self.lost = self.lost.saturating_add(gap.missing);
            }
            self.next_row += 1;
            if self.lacks(row) {
                self.lost = self.lost.saturating_add(1);
                continue;
            }
            let mut codes = [0; MAX_AXES];
            codes.iter_mut().zip(&self.axes).for_each(|(code, column)| *code = column[row] as i64);
            let lost = u32::try_from(std::mem::take(&mut self.lost)).unwrap_or(u32::MAX);
            self.edge_seq = self.edge_seq.wrapping_add(lost);
            let found = Row::new(t_ns, self.edge_seq, &codes[..self.axes.len().min(MAX_AXES)])?;
            self.edge_seq = self.edge_seq.wrapping_add(1);
            let temp = self.temps[row];
            return Some(found.with_lost(lost).with_temp_code((!temp.is_nan()).then_some(temp as i64)));
        }
    }
}

/// The columns to find: the axes, then the temperature.
fn specs(part: &Part) -> Vec<ColumnSpec> {
    let column = |what: String, stated: Option<&str>, name: &str| ColumnSpec {
        what,
        name: stated.unwrap_or(name).to_owned(),
        is_exact: stated.is_some(),
    };
    let axis = |axis: &zerorate::NamedAxis| column(format!("axis {}", axis.name), axis.column.as_deref(), &axis.name);
    let temp = column("temperature".to_owned(), part.temp_column.as_deref(), TEMPERATURE_COLUMN);
    part.axes.iter().map(axis).chain([temp]).collect()
}

/// The quantity and its unit, in °/s or °C, as the column's name states them, or else as the name in the part file
/// does. `None` if neither name states a unit.
fn stated(column: &str, spec: &ColumnSpec) -> Option<(Quantity, f64)> {
    let by_part = || spec.without_unit().and_then(|_| Quantity::of_column(&spec.name));
    Quantity::of_column(column).or_else(by_part)
}

/// The column's unit in °/s; `None` if the unit is not stated. Returns an error if the unit is not a unit of rate.
fn rate_unit(path: &Path, column: &str, stated: Option<(Quantity, f64)>) -> Result<Option<f64>> {
    match stated {
        Some((Quantity::AngularRate, dps)) => Ok(Some(dps)),
        Some((other, _)) => {
            let why = format!("is in {}, and the axis of a gyroscope in °/s", other.unit());
            Err(LogError::Ask(format!(
                "{}: column {column} {why}; name another in the file of the part",
                path.display()
            )))
        }
        None => Ok(None),
    }
}

/// The conversion of the values of a column to codes.
struct Coding<'a> {
    path: &'a Path,
    scale: Scale,
    /// The column's unit as a multiple of the unit of the scale; `None` if the column holds codes.
    unit: Option<f64>,
    /// Name of the unit of the scale.
    name: &'static str,
    /// Examples of column names that state their unit, for the error message.
    remedy: &'static str,
}

impl Coding<'_> {
    fn codes(&self, column: TimedColumn, warnings: &mut Vec<LogWarning>) -> Result<Vec<f64>> {
        let TimedColumn { name, values: mut codes, warnings: said, .. } = column;
        warnings.extend(said);
        let mut off = 0.0_f64;
        for (row, value) in codes.iter_mut().enumerate().filter(|(_, value)| !value.is_nan()) {
            let code = self.unit.map_or(*value, |unit| self.scale.code(*value * unit));
            let nearest = code.round();
            if self.unit.is_none() && nearest != code {
                return Err(self.no_codes(&name, row, *value));
            }
            off = off.max((code - nearest).abs());
            *value = self.checked(&name, row, *value, nearest)?;
        }
        if off > ON_GRID {
            let by = off / self.scale.lsb_per_unit;
            let (path, unit) = (self.path.display().to_string(), self.name);
            warnings.push(LogWarning::OffCodes { path, column: name, by, unit, codes: off });
        }
        Ok(codes)
    }

    fn no_codes(&self, name: &str, row: usize, value: f64) -> LogError {
        let remedy = format!("state its unit in its name, as in {}", self.remedy);
        LogError::Ask(format!(
            "{}, column {name}, row {row}: {value} is not a code, and no unit is stated; {remedy}",
            self.path.display()
        ))
    }

    fn checked(&self, name: &str, row: usize, value: f64, code: f64) -> Result<f64> {
        let (first, last) = self.scale.codes();
        if (first as f64..=last as f64).contains(&code) {
            return Ok(code);
        }
        let bits = self.scale.width_bits;
        Err(LogError::Refused(
            "beyond-codes",
            format!(
                "{}, column {name}, row {row}: {value} is beyond the codes of the part, which have {bits} bits and go \
                 from {first} to {last}; is it the column, and the unit?",
                self.path.display()
            ),
        ))
    }
}
