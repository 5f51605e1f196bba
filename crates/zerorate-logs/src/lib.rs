//! Columns of numbers out of any gyroscope's log, with their rate, their gaps and their units: all that are wanted in
//! one pass over the file.
//!
//! Nothing is guessed: what a file does not state must be given as an option, or is said to be unknown. Each form is
//! recognised by its content, not by its name, and nothing here opens a file ([`Input`]).
//!
//! Text, raw numbers, Arrow, PX4's logs and captures are always read. A feature adds each other form, and a file of a
//! form that is not built in says so ([`NotBuiltIn`](zerorate_input::NotBuiltIn)).

mod arrow_file;
#[cfg(all(test, feature = "full"))]
mod checks;
mod choice;
mod clock;
mod column;
mod column_checks;
mod dataflash;
#[cfg(all(test, feature = "full"))]
mod foreign;
#[cfg(test)]
mod fuzz;
mod given_rate;
#[cfg(feature = "hdf5")]
mod hdf5;
#[cfg(feature = "hdf5")]
mod hdf5_index;
#[cfg(any(feature = "mcap", feature = "ros", feature = "sqlite"))]
mod imu_messages;
#[cfg(all(test, feature = "full"))]
mod joined;
#[cfg(feature = "hdf5")]
mod lzf;
#[cfg(feature = "matlab")]
mod mat;
#[cfg(feature = "mcap")]
mod mcap_bag;
#[cfg(any(feature = "mcap", feature = "ros", feature = "sqlite"))]
mod message;
#[cfg(all(test, not(feature = "full")))]
mod missing;
mod mixed_rows;
#[cfg(any(feature = "mcap", feature = "ros", feature = "sqlite"))]
mod nested;
#[cfg(feature = "numpy")]
mod npy;
#[cfg(feature = "npz")]
mod npz;
mod number;
mod only;
mod open;
mod order;
mod pace;
#[cfg(feature = "parquet")]
mod parquet;
mod parts;
mod raw;
#[cfg(feature = "ros")]
mod rosbag;
mod sample;
mod series;
mod setting;
#[cfg(all(test, feature = "full"))]
mod several;
#[cfg(feature = "sqlite")]
mod sqlite_bag;
mod tabular;
mod temperature;
#[cfg(test)]
mod tests;
mod text;
mod time_unit;
mod timed;
mod topics;
mod ulog;
mod unsigned;
mod warning;
mod wide;

pub use choice::{ColumnSpec, TEMPERATURE_COLUMN, Wanted};
pub use column::Column;
pub use column_checks::stopped;
pub use only::Only;
pub use open::kind;
pub use parts::{Parts, read_parts, read_with_temperature, read_without_rate};
pub use raw::RawType;
pub use series::Series;
pub use setting::{Names, Setting};
pub use temperature::{TEMPERATURE_NAMES, temperature};
pub use timed::{TimedColumn, TimedColumns, read_timed};
pub use warning::LogWarning;
pub use zerorate_input::{InputError, InputWarning, Quantity, STANDARD_GRAVITY, TimeUnit, Unit};

use arrow_array::RecordBatch;
use arrow_file::ArrowFile;
use clock::{Beat, Times};
use column_checks::ColumnChecks;
use open::{Log, LogForm};
use sample::Sampled;
use series::SeriesBuilder;
use std::path::Path;
use zerorate_allan::Gap;
use zerorate_input::table::{DESCRIPTION, DescribedTable, OpenDescribed};
use zerorate_input::{Input, limits::MemoryBudget};
use zerorate_input::{Opened, open_table};

/// The wanted numbers of a log, and facts that the log does not state itself.
#[derive(Clone, Debug, Default)]
pub struct ColumnOptions {
    /// The column, by its name or its number counted from 0; none: the rate of a capture, or the only column.
    ///
    /// In a ROS bag x, y or z (of angular_velocity), or TOPIC.angular_velocity.z where there are several IMUs.
    pub column: Option<String>,

    /// The topic of the log that columns are of; none: the only one with an IMU.
    pub topic: Option<String>,

    /// The column with the time of each row: it tells the rate, and where samples are missing.
    pub time_column: Option<String>,

    /// The rows that are read; none: all.
    pub only: Option<Only>,

    /// The unit of the time column; none: the one that its name or type states, as in t_ns or `timestamp [ms]`.
    pub time_unit: Option<TimeUnit>,

    /// Samples per second; none: as the time column, the timestamps of a capture or the stamps of a bag tell. With it,
    /// the stamps of a bag are not looked at.
    pub rate: Option<f64>,

    /// The unit of the column; none: the one that its name states, as in gyro_z_dps or `gz [rad/s]`.
    pub unit: Option<Unit>,

    /// The size of a step of 1 in the column, in its unit: the one that is given, or else the one that its name or the
    /// log states, or else °/s. None: 1, or the scale of the part for the codes of a capture.
    pub scale: Option<f64>,

    /// Whether each value is the angle or the velocity of a sample, in place of its rate; none: not, but names and
    /// gravity that tell of it become a question. The unit is then that of the increment in a second: rad/s for rad.
    pub increments: Option<bool>,

    /// Takes the unit that is given where the name of a column states another; without it that is an error.
    pub force_unit: bool,

    /// The decimal mark of a text file; none: a point, or a comma where nothing else is possible.
    pub decimal: Option<Decimal>,

    /// The file is nothing but numbers of this type, little endian.
    pub raw: Option<RawType>,

    /// Broken lines of a text file that are skipped and counted, as a share of all; none: [`MAX_BAD`].
    pub max_bad: Option<f64>,

    /// Opens tables that describe themselves, such as captures; none: they are tables like any other.
    pub described: Option<OpenDescribed>,

    /// The names of these options in messages.
    pub names: Names,
}

/// Broken lines of a text file that are skipped by default, as a share of all. A bad cable breaks fewer lines; more
/// broken lines mean that the file has another form.
pub const MAX_BAD: f64 = 0.01;

/// Why a column cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read, or is damaged.
    #[error(transparent)]
    File(#[from] InputError),
    /// It does not say enough, or has nothing of what was asked for.
    #[error("{0}")]
    Ask(String),
    /// It has several of what was asked for: the question, and a table with a head to choose from.
    #[error("{0}\n{table}", table = .1.join("\n"))]
    Choose(String, Vec<String>),
    /// The numbers are there, but must not become a result: a code for scripts, and why.
    #[error("{1}")]
    Refused(&'static str, String),
}

/// The result of reading a log.
pub type Result<T, E = LogError> = std::result::Result<T, E>;

/// A decimal mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Decimal {
    /// 1.5
    Point,
    /// 1,5
    Comma,
}

/// Reads a column of a log in any form, packed or not; `path` names it in messages.
pub fn read(path: &Path, input: Input, args: &ColumnOptions) -> Result<Column> {
    let columns = read_all(path, input, Wanted::One(args.column.as_deref()), args)?;
    columns.into_iter().next().ok_or_else(|| LogError::Ask(format!("{} has no column", path.display())))
}

/// Reads the `wanted` columns in one pass over the file and ignores `args.column`. All have one rate. The first
/// carries the warnings about the file as a whole.
pub fn read_all(path: &Path, input: Input, wanted: Wanted<'_>, args: &ColumnOptions) -> Result<Vec<Column>> {
    find(path, input, &ColumnQuery::of(wanted, args))?.finish(path, args)
}

/// Reads columns of a table in memory; `path` is what messages call them.
///
/// # Errors
/// The same errors as for a file.
pub fn read_table(path: &Path, table: &RecordBatch, wanted: Wanted<'_>, args: &ColumnOptions) -> Result<Vec<Column>> {
    let room = MemoryBudget::of(table.get_array_memory_size() as u64);
    let query = ColumnQuery::of(wanted, args);
    let mut columns = tabular::TableColumns::start(path, &table.schema(), room, &query, None)?;
    columns.take(table)?;
    columns.finish(None)?.finish(path, args)
}

/// The columns as they stand in the file.
fn find(path: &Path, input: Input, asked: &ColumnQuery<'_>) -> Result<Found> {
    let log = open::open(path, input)?;
    match asked.args.raw {
        Some(raw) => raw::read(log, raw, asked.args.names),
        None => found(log, asked),
    }
}

/// The wanted columns, and the known facts about them.
struct ColumnQuery<'a> {
    wanted: Wanted<'a>,
    args: &'a ColumnOptions,
    /// Whether the temperature of a capture is to be read in the same pass. It comes last.
    with_temperature: bool,
}

impl<'a> ColumnQuery<'a> {
    fn of(wanted: Wanted<'a>, args: &'a ColumnOptions) -> Self {
        Self { wanted, args, with_temperature: false }
    }
}

fn found(mut log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<Found> {
    let form = log.form()?;
    if form == LogForm::Other {
        log.input = wide::narrowed(log.path, log.input, log.room)?;
    }
    if let Some(table) = described(&log, form, asked)? {
        return tabular::read_described(log.path, table, log.room, asked);
    }
    if asked.args.only.is_some() && !matches!(form, LogForm::Other | LogForm::ArrowFile | LogForm::Parquet) {
        return Err(asked.args.only_of_tables(log.path));
    }
    match (reader(form), form.missing()) {
        (Some(read), _) => read(log, asked),
        (None, Some(missing)) => Err(InputError::not_built_in(log.path, missing).into()),
        (None, None) => read_table_or_text(log, asked),
    }
}

/// The reader of a form that needs a reader of its own, where it is built in.
fn reader(form: LogForm) -> Option<fn(Log<'_>, &ColumnQuery<'_>) -> Result<Found>> {
    match form {
        LogForm::ArrowFile => Some(read_arrow_file),
        LogForm::ULog => Some(ulog::read),
        LogForm::DataFlash => Some(dataflash::read),
        #[cfg(feature = "hdf5")]
        LogForm::Hdf5 => Some(hdf5::read),
        #[cfg(feature = "matlab")]
        LogForm::Mat => Some(mat::read),
        #[cfg(feature = "mcap")]
        LogForm::Mcap => Some(mcap_bag::read),
        #[cfg(feature = "numpy")]
        LogForm::Npy => Some(npy::read),
        #[cfg(feature = "npz")]
        LogForm::Npz => Some(npz::read),
        #[cfg(feature = "parquet")]
        LogForm::Parquet => Some(parquet::read),
        #[cfg(feature = "ros")]
        LogForm::RosBag => Some(rosbag::read),
        #[cfg(feature = "sqlite")]
        LogForm::Sqlite => Some(sqlite_bag::read),
        _ => None,
    }
}

fn read_arrow_file(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<Found> {
    let source = ArrowFile::open(log.path, log.input, log.room)?;
    tabular::read(log.path, Box::new(source), log.room, asked)
}

fn read_table_or_text(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<Found> {
    let path = log.path;
    match open_table(path, log.input)? {
        Opened::Table(source) => tabular::read(path, source, log.room, asked),
        Opened::Other(input) => text::read(path, input, log.room, asked),
    }
}

/// The log as a table that describes itself, if it is one.
fn described(log: &Log<'_>, form: LogForm, asked: &ColumnQuery<'_>) -> Result<Option<Box<dyn DescribedTable>>> {
    let is_possible = form == LogForm::Other || form == LogForm::Parquet && form.missing().is_none();
    let Some(open) = asked.args.described.filter(|_| is_possible) else {
        let describes_itself = log.start.starts_with(format!("# {DESCRIPTION}").as_bytes());
        return if describes_itself { Err(tabular::needs_reader(log.path)) } else { Ok(None) };
    };
    let input = log.input.try_clone().map_err(|error| InputError::io("read", log.path, error))?;
    Ok(open(log.path, input)?)
}

/// Columns as they stand in their file.
struct Found {
    columns: Vec<FoundColumn>,
    clock: Clock,
    warnings: Vec<LogWarning>,
    /// The first rows in all columns of the file, where its reader sees all; empty: those of `columns`.
    sample: Vec<Sampled>,
}

/// One of them.
struct FoundColumn {
    name: String,
    values: SeriesBuilder,
    /// Its quantity, and a step in the unit of its results, where the form defines them.
    stated: Option<(Quantity, f64)>,
    /// The size of a step of 1 that the log states, in its unit.
    step: f64,
    warnings: Vec<LogWarning>,
    /// Whether it was not wanted, and is the temperature beside those that were.
    is_beside: bool,
}

impl ColumnOptions {
    /// A rate in one of its values.
    pub fn per_second(&self, rate_hz: f64) -> f64 {
        if self.increments == Some(true) { rate_hz } else { 1.0 }
    }

    /// Rows cannot be chosen in a log of another form.
    fn only_of_tables(&self, path: &Path) -> LogError {
        let option = self.names.of(Setting::Where);
        LogError::Ask(format!("{}: {option} chooses rows of text and of tables only; leave it out", path.display()))
    }

    /// That a `unit`, given by `setting`, is the one that the name of the column states, if it states one.
    pub fn agrees(&self, path: &Path, column: &str, unit: Unit, setting: Setting) -> Result<()> {
        let Some(stated) = Unit::of_column(column).filter(|stated| *stated != unit && !self.force_unit) else {
            return Ok(());
        };
        let differs = match unit.quantity() == stated.quantity() {
            true => {
                let factor = unit.in_results() / stated.in_results();
                format!(", {factor:.*} times as large", (2.0 - factor.log10().floor()).max(0.0) as usize)
            }
            false => String::new(),
        };
        let [given, force] = [setting, Setting::ForceUnit].map(|of| self.names.of(of));
        Err(LogError::Ask(format!(
            "{}: the name of column `{column}` states {stated}, and {given} says {unit}{differs}; leave {given} out, \
             or {force}",
            path.display()
        )))
    }
}

impl FoundColumn {
    fn new(name: String, values: SeriesBuilder) -> Self {
        Self { name, values, stated: None, step: 1.0, warnings: Vec::new(), is_beside: false }
    }

    /// The column of a log that states its unit and the size of its steps.
    fn in_steps(self, unit: Unit, step: f64) -> Self {
        Self { stated: Some((unit.quantity(), unit.in_results() * step)), step, ..self }
    }
}

/// The statements of a file about time.
enum Clock {
    /// Nothing.
    Silent,
    /// The name of a column, and the times in it.
    Column(String, Times),
    /// Rate and gaps, as the writer of the file counted them.
    Counted { rate_hz: Option<f64>, gaps: Vec<Gap> },
}

impl Clock {
    /// The unit of the times, and what they tell.
    fn beat(&self, path: &Path, args: &ColumnOptions) -> Result<Option<(TimeUnit, Beat)>> {
        let Self::Column(name, times) = self else { return Ok(None) };
        if let (Some(asked), Some(stated)) = (args.time_unit, times.unit)
            && asked != stated
        {
            let setting = args.names.of(Setting::TimeUnit);
            let why = format!("column {name} states by its type that it is in {}", stated.name());
            return Err(LogError::Ask(format!(
                "{}: {why}, not in {}; leave {setting} out",
                path.display(),
                asked.name()
            )));
        }
        let unit = times.unit.or(args.time_unit).or_else(|| TimeUnit::of_column(name));
        let unit = unit.ok_or_else(|| no_time_unit(path, name, args.names))?;
        let beat = times.beat(unit, args.names).map_err(|why| unsteady(path, name, &why))?;
        if args.rate.is_none() {
            time_unit::check((path, name), times, unit, beat.rate_hz, args.names)?;
        }
        Ok(Some((unit, beat)))
    }
}

impl Found {
    /// Puts the rows in the order of their times, and says what of those is not as it should be.
    fn mend(&mut self, path: &Path, args: &ColumnOptions) -> Result<()> {
        mixed_rows::check(self, path, args.names)?;
        let Clock::Column(name, times) = &mut self.clock else { return Ok(()) };
        let said = order::mend(times, &mut self.columns).map_err(|why| {
            let rate = args.names.of(Setting::Rate);
            let remedy = "two logs in one file, or a clock that was set? Cut the log there";
            let or = format!("give {rate} and no time column if the samples are evenly spaced all the same");
            LogError::Refused(
                "times-disordered",
                format!("{}, column {name}: {why} ({remedy}, or {or})", path.display()),
            )
        })?;
        let (path, column) = (path.display().to_string(), &*name);
        let warning = |how| LogWarning::TimesMended { path: path.clone(), column: column.clone(), how };
        self.warnings.extend(said.into_iter().map(warning));
        Ok(())
    }

    fn finish(self, path: &Path, args: &ColumnOptions) -> Result<Vec<Column>> {
        let (columns, no_rate) = self.finish_without_rate(path, args)?;
        no_rate.map_or(Ok(columns), Err)
    }

    /// The columns, and the question for the rate where nothing tells it. Their rate is then 1 Hz, so that the caller
    /// can find out what else it has to ask.
    fn finish_without_rate(mut self, path: &Path, args: &ColumnOptions) -> Result<(Vec<Column>, Option<LogError>)> {
        self.mend(path, args)?;
        let beat = self.clock.beat(path, args)?;
        if let (Some((unit, beat)), Clock::Column(_, times)) = (&beat, &self.clock) {
            let path = || path.display().to_string();
            let jitter = beat.jitter_text().map(|how| LogWarning::TimesJitter { path: path(), how });
            let pace = pace::doubt(times.since_first(), &beat.gaps, *unit);
            self.warnings.extend(jitter);
            self.warnings.extend(pace.map(|how| LogWarning::RateChanges { path: path(), how }));
        }
        let Self { columns, clock, mut warnings, sample } = self;
        let (measured, lost) = match (beat, clock) {
            (Some((_, Beat { rate_hz, gaps, .. })), _) => (Some(rate_hz), gaps),
            (None, Clock::Counted { rate_hz, gaps }) => (rate_hz, gaps),
            (None, _) => (None, Vec::new()),
        };
        let stamps = || given_rate::of_stamps(measured, &Sampled::of(&sample, &columns));
        warnings.extend(args.rate.and_then(|rate_hz| given_rate::doubt(path, rate_hz, stamps()?)));
        let told = args.rate.or(measured);
        let no_rate = told.is_none().then(|| {
            let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
            no_rate(path, &names, args.names)
        });
        let rate_hz = told.unwrap_or(1.0);
        let mut of_file = warnings;
        let finish = |mut column: FoundColumn| {
            // what is of the file is said once, with its first column
            column.warnings.splice(..0, of_file.drain(..));
            column.finish(path, rate_hz, &lost, args)
        };
        Ok((columns.into_iter().map(finish).collect::<Result<_>>()?, no_rate))
    }
}

impl FoundColumn {
    fn finish(self, path: &Path, rate_hz: f64, lost: &[Gap], args: &ColumnOptions) -> Result<Column> {
        let Self { name, values, stated, step, mut warnings, .. } = self;
        let (mut series, gaps) = values.finish(lost).map_err(|missing| too_many(path, missing, args.names))?;
        warnings.extend(unsigned::unwrap(&mut series).map(|bits| {
            let (path, column) = (path.display().to_string(), name.clone());
            LogWarning::CodesUnsigned { path, column, bits }
        }));
        let stated = stated.or_else(|| Quantity::of_column(&name));
        if let Some(unit) = args.unit {
            args.agrees(path, &name, unit, Setting::Unit)?;
        }
        let given = args.unit.map(|unit| (unit.quantity(), unit.in_results() * step));
        let declared = match args.scale {
            None => given.or(stated),
            Some(scale) => {
                // what a capture states of its codes is a scale, and no unit
                let of_file = stated.map(|(quantity, per_step)| match &series {
                    Series::Codes(_) if step == 1.0 => (quantity, 1.0),
                    _ => (quantity, per_step / step),
                });
                let given = args.unit.map(|unit| (unit.quantity(), unit.in_results()));
                let unit = given.or_else(|| Quantity::of_column(&name)).or(of_file);
                let (quantity, per_unit) = unit.unwrap_or((Quantity::AngularRate, 1.0));
                Some((quantity, scale * per_unit))
            }
        };
        let (of_samples, facts) = ColumnChecks::of(&series.input(&gaps)).finish(path, &name);
        warnings.extend(of_samples);
        warnings.extend(declared.is_none().then(|| {
            let [unit, scale] = [Setting::Unit, Setting::Scale].map(|of| args.names.of(of));
            let (path, column) = (path.display().to_string(), name.clone());
            LogWarning::UnitUnknown { path, column, unit, scale }
        }));
        Ok(Column {
            name,
            series,
            gaps,
            rate_hz,
            quantity: declared.map(|(quantity, _)| quantity),
            scale: declared.map_or(1.0, |(quantity, scale)| match quantity {
                Quantity::Temperature => scale,
                _ => scale * args.per_second(rate_hz),
            }),
            step,
            warnings,
            facts: Some(facts),
        })
    }
}

fn no_time_unit(path: &Path, column: &str, names: Names) -> LogError {
    let why = format!("does not state the unit of its time column `{column}`");
    LogError::Ask(format!("{} {why}; give {} s, ms, us or ns", path.display(), names.of(Setting::TimeUnit)))
}

fn unsteady(path: &Path, column: &str, why: &str) -> LogError {
    LogError::Refused("times-uneven", format!("{}, column {column}: {why}", path.display()))
}

/// The error where the rate is missing. It names the columns that may hold the time.
fn no_rate(path: &Path, columns: &[&str], names: Names) -> LogError {
    let [rate, time, unit] = [Setting::Rate, Setting::TimeColumn, Setting::TimeUnit].map(|setting| names.of(setting));
    let is_like_time = |name: &str| {
        let name = name.to_lowercase();
        name == "t" || name.contains("time") || name.contains("stamp")
    };
    let remedy = match columns.iter().find(|name| is_like_time(name)) {
        Some(column) => format!("give {rate} in Hz, or {time} with {unit} if `{column}` is the time"),
        None => format!("give {rate} in Hz, or {time} if a column holds the time"),
    };
    LogError::Ask(format!("{} does not say how fast it was sampled: {remedy}", path.display()))
}

/// More samples are missing than can be written out.
fn too_many(path: &Path, missing: u64, names: Names) -> LogError {
    let remedy = format!("cut the log at its longest gap, or give {} and no time column", names.of(Setting::Rate));
    LogError::Refused(
        "mostly-missing",
        format!("{}: {missing} samples are missing between its rows; {remedy}", path.display()),
    )
}

/// An error in a column of the file at `path`.
fn wrong(path: &Path, place: std::fmt::Arguments<'_>, what: impl Into<String>) -> InputError {
    InputError::damaged(path, place.to_string(), what)
}
