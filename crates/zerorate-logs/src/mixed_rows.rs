//! Detects rows of several sensors in one table, in which the values of a column tell the sensors apart.
//!
//! Columns of flags, counters and coarse readings also have few values. So a column must meet two conditions. First,
//! the rows of each value come in even steps. A flag is set within the rows of one sensor, and leaves holes in them.
//! Second, there is other evidence: words, a name such as `SensorId`, times that overlap, or axes whose level or noise
//! differs from value to value. Two columns together may tell the sensors apart, as `bus` and `sensor` do. If the rows
//! come in groups or in no order, or if all rows of one sensor are above those of the next, the name of the column
//! must suggest a sensor.
//!
//! A counter of the samples in a packet looks the same as the number of a sensor. The user then states with [`ANY`]
//! that the rows are of one sensor.

use crate::clock::Times;
use crate::error::{LogError, Result};
use crate::middle::median;
use crate::only::{ANY, Condition, RowFilter};
use crate::options::ColumnOptions;
use crate::raw_columns::{Clock, RawColumns, first_rows};
use crate::sample::{Cell, Sampled};
use crate::setting::{Setting, quoted};
use std::collections::BTreeSet;
use std::path::Path;
use zerorate_input::TimeUnit;

/// Largest number of values in a column that tells sensors apart.
const MOST: usize = 16;

/// Least number of rows with a value for the value to count, and their least share of all rows.
const FEWEST: usize = 8;
const SHARE: f64 = 0.02;

/// Largest share of rows whose values are too rare to count.
const OTHERS: f64 = 0.05;

/// Largest number of uneven steps of a value per interruption of its rows. A flag has one for each interruption. Also
/// the largest share of groups of another length.
const UNEVEN: f64 = 0.25;

/// If more than this share of the rows have an earlier time than the row above, the times of several sensors overlap.
const OVERLAP: f64 = 0.05;

/// Least number of rows of a value whose level and noise are compared.
const COMPARED: usize = 50;

/// Least difference between the levels of two sensors, in standard deviations of a sample.
const LEVELS: f64 = 0.5;

/// Least ratio between the noise of two sensors.
const NOISES: f64 = 1.4;

/// A difference of level or noise counts only above this many of its own standard deviations.
const SURE: f64 = 6.0;

/// The median of n Gaussian samples of standard deviation σ scatters by `OF_MEDIAN`·σ/√n. Their noise, which is
/// [`PER_MEDIAN`] times the median absolute deviation, scatters by `OF_NOISE`/√n of itself.
const OF_MEDIAN: f64 = 1.253;
const OF_NOISE: f64 = 1.167;

/// Standard deviation of Gaussian noise over its median absolute deviation.
const PER_MEDIAN: f64 = 1.4826;

/// Words in the names of columns that tell sensors apart. They suffice even if the rows of a sensor come in no order,
/// or are not interrupted.
const SENSORS: &str = "id sensor device dev instance inst imu unit node source src addr address serial sn mac topic \
                       tag label module board chip port probe bus";

/// Further words in the names of columns that tell sensors apart.
const IDS: &str = "channel chan name type kind slot i slave ch idx index mux num nr side position stream";

/// Words in the names of columns that do not tell sensors apart.
const NO_IDS: &str = "seq sequence packet sample count counter cnt fifo tick toggle parity flag flags status state \
                      mode temp temperature";

/// Refuses a table that mixes the rows of several sensors.
///
/// # Errors
/// Returns a question that names the columns that tell the sensors apart. It states how many rows repeat the stamp of
/// the row before.
pub fn check(found: &RawColumns, path: &Path, args: &ColumnOptions) -> Result<()> {
    let conditions = || args.only.iter().flat_map(|only| &only.conditions);
    let is_open = |name: &str| !conditions().any(|one| one.value == ANY && one.column == name);
    let sample = first_rows(&found.sample, &found.columns);
    let sample: Vec<Sampled> = sample.iter().filter(|column| is_open(&column.name)).cloned().collect();
    let stated = sample.iter().find(|column| column.stated_time().is_some()).and_then(Sampled::times);
    let times = if let Clock::Column(_, times) = &found.clock { Some(times) } else { stated.as_ref() };
    let read = found.columns.iter().map(|column| &*column.name).collect();
    let per_s = found.clock.unit(args).map(TimeUnit::per_s);
    let mixed = find(&sample, &read, times.map(Times::since_first)).or_else(|| in_blocks(found, &sample));
    let Some(Mixed { columns, values, steps, in_groups }) = mixed else { return Ok(()) };
    let rate_hz = |at: usize| -> Option<f64> {
        let step = steps.get(at).filter(|step| **step > 0.0)?;
        Some((1000.0 * per_s? / step).round() / 1000.0)
    };
    let series = |(at, value): (usize, &Vec<String>)| match rate_hz(at) {
        Some(rate_hz) => format!("{} ({rate_hz} Hz)", value.join("-")),
        None => value.join("-"),
    };
    let series = values.iter().enumerate().map(series).collect::<Vec<_>>().join(", ");
    let same = times.map(|times| {
        let rows = times.since_first();
        let same = rows.windows(2).filter(|pair| pair[0] == pair[1]).count();
        let said = format!(", and {same} of {} rows repeat the stamp of the row before", rows.len());
        if same == 0 { String::new() } else { said }
    });
    let only = |of: &dyn Fn(usize) -> String| {
        let told = columns.iter().enumerate().map(|(at, column)| Condition { column: column.clone(), value: of(at) });
        quoted(&RowFilter { conditions: conditions().cloned().chain(told).collect() }.to_string())
    };
    let (option, rate) = (args.names.of(Setting::Where), args.names.of(Setting::Rate));
    // the times of a group are those of a bus, and not those of the sensor
    let with_rate = rate_hz(0).filter(|_| in_groups && args.rate.is_none());
    let with_rate = with_rate.map_or_else(String::new, |rate_hz| format!(" (with {rate} {rate_hz})"));
    let (plural, are) = if columns.len() == 1 { ("", "is") } else { ("s", "are") };
    Err(LogError::Ask(format!(
        "{}: column{plural} `{}` {are} {series} in turn{}: rows of {} sensors, which are not one record; give \
         {option} {} to read one{with_rate}, or {option} {} if all rows are of one sensor",
        path.display(),
        columns.join("`, `"),
        same.unwrap_or_default(),
        values.len(),
        only(&|at| values[0][at].clone()),
        only(&|_| ANY.to_owned()),
    )))
}

/// The columns that tell the sensors of a table apart.
struct Mixed {
    columns: Vec<String>,
    /// The values of these columns for each sensor, in the order of the file.
    values: Vec<Vec<String>>,
    /// The usual time between two rows of each sensor, in the unit of the file. Empty if all rows of one sensor are
    /// above those of the next.
    steps: Vec<f64>,
    in_groups: bool,
}

/// The columns that tell sensors apart in the first rows of a table. `columns` are the names of the columns that are
/// read. `times` are the times of the rows, if they are known.
fn find(sample: &[Sampled], columns: &BTreeSet<&str>, times: Option<&[f64]>) -> Option<Mixed> {
    let rows = sample.iter().map(|column| column.cells.len()).min()?;
    let numbers: Vec<f64> = (0..rows).map(|row| row as f64).collect();
    let times = times.filter(|times| times.len() >= rows).map_or(&numbers[..], |times| &times[..rows]);
    let overlap = times.windows(2).filter(|pair| pair[1] < pair[0]).count() as f64 > OVERLAP * rows as f64;
    let labels: Vec<Option<Labels<'_>>> = sample.iter().map(|column| Labels::of(&column.cells[..rows])).collect();
    let is_read = |at: &usize| labels[*at].is_none() && columns.contains(sample[*at].name.as_str());
    let readings: Vec<&[Cell]> = (0..sample.len()).filter(is_read).map(|at| &sample[at].cells[..rows]).collect();
    let is_even = |labels: &Labels<'_>| labels.are_even(times) || labels.are_even(&numbers);
    let differ = |labels: &Labels<'_>| readings.iter().any(|cells| labels.differ(cells));
    let tells = |name: &str, labels: &Labels<'_>| {
        let is_said = || is_id(name, labels) || labels.share_stamps(times) || differ(labels);
        let are_sure = || is_even(labels) || is_known(name, SENSORS) && (labels.are_in_groups() || differ(labels));
        (overlap || !is_known(name, NO_IDS) && is_said()) && are_sure()
    };
    let all: Vec<(&str, &Labels<'_>)> =
        sample.iter().zip(&labels).filter_map(|(column, labels)| Some((&*column.name, labels.as_ref()?))).collect();
    let single = all.iter().find(|(name, labels)| tells(name, labels));
    let ids: Vec<_> = all.iter().filter(|(name, labels)| !is_known(name, NO_IDS) && is_id(name, labels)).collect();
    let pairs = ids.iter().enumerate().flat_map(|(at, one)| ids[at + 1..].iter().map(move |other| (*one, *other)));
    let pairs = pairs.map(|(one, other)| (vec![one.0, other.0], one.1.beside(other.1)));
    let least = single.map_or(1, |(_, labels)| labels.values.len());
    let pair = pairs.into_iter().find(|(_, labels)| labels.values.len() > least && is_even(labels));
    let single = single.map(|(name, labels)| (vec![*name], (*labels).clone()));
    let (names, labels) = pair.or(single)?;
    let in_groups = !is_even(&labels);
    let step = |value: usize| match in_groups {
        true => labels.mean_step(value, times),
        false => median(&mut labels.steps(value, times).0),
    };
    let steps = (0..labels.values.len()).map(step).collect();
    let worded = |value: &Vec<&Cell>| value.iter().map(|cell| worded(cell)).collect();
    let columns = names.into_iter().map(str::to_owned).collect();
    Some(Mixed { columns, values: labels.values.iter().map(worded).collect(), steps, in_groups })
}

/// True if a name has one of the `known` words, between which are blanks.
fn is_known(name: &str, known: &str) -> bool {
    words(name).iter().any(|word| known.split(' ').any(|known| known == word))
}

/// True if words in the name or in the values of a column suggest that the column tells sensors apart.
fn is_id(name: &str, labels: &Labels<'_>) -> bool {
    let ends_so = || words(name).iter().any(|word| word.ends_with("id"));
    labels.are_words() || is_known(name, SENSORS) || is_known(name, IDS) || ends_so()
}

/// The column whose name says that it tells sensors apart, and in which all rows of one value are above those of the
/// next.
fn in_blocks(found: &RawColumns, sample: &[Sampled]) -> Option<Mixed> {
    let is_sensor = |name: &str| is_known(name, SENSORS) && !is_known(name, NO_IDS);
    let read = found.columns.iter().filter(|column| is_sensor(&column.name)).map(|column| {
        let numbers = column.values.rows_as_numbers();
        let runs = numbers.chunk_by(|one, next| one == next);
        (&column.name, runs.map(|run| (Cell::number(run[0]), run.len())).collect::<Vec<_>>())
    });
    let seen = sample.iter().filter(|column| is_sensor(&column.name)).map(|column| {
        let runs = column.cells.chunk_by(|one, next| one == next);
        (&column.name, runs.map(|run| (run[0].clone(), run.len())).collect())
    });
    let is_whole = |cell: &Cell| match cell {
        Cell::Number(number) => number.fract() == 0.0,
        Cell::Word(_) => true,
        Cell::Missing => false,
    };
    let are_blocks = |runs: &[(Cell, usize)]| {
        (2..=MOST).contains(&runs.len())
            && runs.iter().all(|(cell, rows)| is_whole(cell) && *rows >= FEWEST)
            && (1..runs.len()).all(|at| runs[..at].iter().all(|(cell, _)| *cell != runs[at].0))
    };
    let (name, runs) = read.chain(seen).find(|(_, runs)| are_blocks(runs))?;
    let values = runs.iter().map(|(cell, _)| vec![worded(cell)]).collect();
    Some(Mixed { columns: vec![name.clone()], values, steps: Vec::new(), in_groups: false })
}

fn worded(cell: &Cell) -> String {
    match cell {
        Cell::Number(number) => number.to_string(),
        Cell::Word(word) => word.clone(),
        Cell::Missing => String::new(),
    }
}

/// The words of a name, in lower case: `sensor` and `id` of `SensorId` or `sensor_id`.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars() {
        if !letter.is_alphabetic() || letter.is_uppercase() && was_small {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphabetic()) {
            word.extend(letter.to_lowercase());
        }
        was_small = letter.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

/// A column with few different values, or several such columns combined.
#[derive(Clone)]
struct Labels<'a> {
    /// The values that count, in the order of the file. Each has one cell per combined column.
    values: Vec<Vec<&'a Cell>>,
    /// The index of each row's value; `None` if the value does not count.
    rows: Vec<Option<usize>>,
}

impl<'a> Labels<'a> {
    /// Returns `None` if a value is not whole, if there are too many values, if fewer than two of them count, or if
    /// too many rows have a value that does not count.
    fn of(cells: &'a [Cell]) -> Option<Self> {
        let (mut all, mut rows): (Vec<(&Cell, usize)>, Vec<usize>) = (Vec::new(), Vec::new());
        for cell in cells {
            if cell.as_number().is_some_and(|number| number.fract() != 0.0) {
                return None;
            }
            let at = all.iter().position(|(value, _)| *value == cell).unwrap_or(all.len());
            match all.get_mut(at) {
                Some((_, count)) => *count += 1,
                None if at == MOST => return None,
                None => all.push((cell, 1)),
            }
            rows.push(at);
        }
        let least = FEWEST.max((SHARE * cells.len() as f64) as usize);
        let counts = |(value, count): &(&Cell, usize)| **value != Cell::Missing && *count >= least;
        let values: Vec<Vec<&Cell>> = all.iter().filter(|one| counts(one)).map(|(value, _)| vec![*value]).collect();
        let places: Vec<Option<usize>> =
            all.iter().map(|(value, _)| values.iter().position(|one| one[0] == *value)).collect();
        let rows: Vec<Option<usize>> = rows.into_iter().map(|at| places[at]).collect();
        let others = rows.iter().filter(|row| row.is_none()).count();
        (values.len() > 1 && others as f64 <= OTHERS * cells.len() as f64).then_some(Self { values, rows })
    }

    /// Combines two columns into one column of pairs of values.
    fn beside(&self, other: &Self) -> Self {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        let rows = self.rows.iter().zip(&other.rows).map(|(one, other)| {
            let pair = ((*one)?, (*other)?);
            let at = pairs.iter().position(|one| *one == pair);
            at.or_else(|| {
                pairs.push(pair);
                Some(pairs.len() - 1)
            })
        });
        let rows = rows.collect();
        let values = pairs.iter().map(|(one, at)| [&self.values[*one][..], &other.values[*at][..]].concat());
        Self { values: values.collect(), rows }
    }

    fn are_words(&self) -> bool {
        self.values.iter().flatten().any(|value| matches!(value, Cell::Word(_)))
    }

    /// The times between consecutive rows with a value, and the number of these steps that other rows interrupt.
    fn steps(&self, value: usize, times: &[f64]) -> (Vec<f64>, usize) {
        let at: Vec<usize> = (0..times.len()).filter(|row| self.rows[*row] == Some(value)).collect();
        let interrupted = at.windows(2).filter(|pair| pair[1] > pair[0] + 1).count();
        (at.windows(2).map(|pair| times[pair[1]] - times[pair[0]]).collect(), interrupted)
    }

    /// The mean time between rows with a value, from the start of their first group to that of their last.
    fn mean_step(&self, value: usize, times: &[f64]) -> f64 {
        let is_value = |row: usize| self.rows[row] == Some(value);
        let starts = (0..times.len()).filter(|row| is_value(*row) && (*row == 0 || !is_value(row - 1)));
        let (first, last) = starts.fold((None, 0), |(first, _), row| (first.or(Some(row)), row));
        let first = first.unwrap_or_default();
        (times[last] - times[first]) / (first..last).filter(|row| is_value(*row)).count().max(1) as f64
    }

    /// True if the rows of each value come in even steps, measured by `times`.
    fn are_even(&self, times: &[f64]) -> bool {
        (0..self.values.len()).all(|value| {
            let (steps, interrupted) = self.steps(value, times);
            let usual = median(&mut steps.clone());
            let is_even = |step: &&f64| (0.5 * usual < **step) && (**step < 1.5 * usual);
            let uneven = steps.iter().filter(|step| !is_even(step)).count();
            usual > 0.0 && interrupted > 0 && uneven as f64 <= UNEVEN * interrupted as f64
        })
    }

    /// True if the rows of each value come in many groups of about the same length, such as the content of a FIFO.
    fn are_in_groups(&self) -> bool {
        let groups: Vec<&[Option<usize>]> = self.rows.chunk_by(|one, next| one == next).collect();
        (0..self.values.len()).all(|value| {
            let of_value = groups.iter().filter(|group| group[0] == Some(value));
            let mut rows: Vec<f64> = of_value.map(|group| group.len() as f64).collect();
            let usual = median(&mut rows);
            let uneven = rows.iter().filter(|rows| !(0.5 * usual..=1.5 * usual).contains(*rows)).count();
            rows.len() >= FEWEST && uneven as f64 <= UNEVEN * rows.len() as f64
        })
    }

    /// True if nearly all stamps have one row of each value, as if several sensors were read at once.
    fn share_stamps(&self, times: &[f64]) -> bool {
        let repeated = times.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64;
        let expected = 1.0 - 1.0 / self.values.len() as f64;
        let rows = times.len() as f64;
        (repeated / rows - expected).abs() < SHARE
            && times
                .windows(2)
                .zip(self.rows.windows(2))
                .all(|(pair, values)| pair[0] != pair[1] || values[0] != values[1])
    }

    /// True if the level or the noise of the readings in `cells` differs from value to value.
    fn differ(&self, cells: &[Cell]) -> bool {
        let of_value = |value: usize| {
            let rows = cells.iter().zip(&self.rows).filter(|(_, row)| **row == Some(value));
            let mut numbers: Vec<f64> = rows.filter_map(|(cell, _)| cell.as_number()).collect();
            let level = median(&mut numbers);
            let mut off: Vec<f64> = numbers.iter().map(|number| (number - level).abs()).collect();
            let noise = PER_MEDIAN * median(&mut off);
            let count = numbers.len() as f64;
            (numbers.len() >= COMPARED && noise > 0.0).then_some((level, noise, count))
        };
        let all: Vec<(f64, f64, f64)> = (0..self.values.len()).filter_map(of_value).collect();
        let differ = |one: &(f64, f64, f64), other: &(f64, f64, f64)| {
            let chance = SURE * (1.0 / one.2 + 1.0 / other.2).sqrt();
            let levels = (one.0 - other.0).abs() / one.1.max(other.1);
            let noises = (one.1 / other.1).ln();
            levels > LEVELS.max(OF_MEDIAN * chance) || noises > NOISES.ln().max(OF_NOISE * chance)
        };
        all.iter().any(|one| all.iter().any(|other| differ(one, other)))
    }
}
