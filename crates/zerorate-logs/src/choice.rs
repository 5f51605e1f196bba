//! Chooses the columns to read from a file.

use crate::error::{LogError, Result};
use crate::options::ColumnOptions;
use crate::setting::{Names, Setting};
use crate::time_names::{
    fraction_of_clock_s, fraction_s, is_bare_unit, is_in_longer_unit, is_like_time, is_named_time, is_step,
    states_time,
};
use crate::warning::LogWarning;
use std::path::Path;
use zerorate_input::{Quantity, Unit, is_celsius};

/// Largest number of columns that an error message lists.
const LISTED: usize = 100;

/// Least number of numeric columns behind a time column that count as a sensor with its own time.
const BLOCK: usize = 3;

/// The wanted columns of a log, each by its name or its number counted from 0.
#[derive(Clone, Copy, Debug)]
pub enum ColumnSelection<'a> {
    /// One column; `None` selects the rate of a capture or, in another log, the only column.
    One(Option<&'a str>),
    /// These columns, in this order.
    Listed(&'a [String]),
    /// These columns, in this order, and then all other numeric columns except the time. Logs of PX4, ArduPilot and
    /// ROS give only the columns that are named here.
    First(&'a [String]),
    /// The rates of a capture, the axes of an IMU of PX4, ArduPilot or ROS, or all numeric columns except the time.
    All,
    /// The columns that fit these descriptions, in this order.
    Described(&'a [ColumnSpec]),
}

/// Name of the temperature column of a sensor, unless another is stated.
pub const TEMPERATURE_COLUMN: &str = "temp";

/// A description of a column, such as the column of a sensor's axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnSpec {
    /// The role of the column in messages: `axis x`.
    pub what: String,
    /// The name of the column.
    pub name: String,
    /// True if the name must match to the letter, except for a unit in brackets that the file does not have. If false,
    /// `_code` or a unit may follow the name, as in `x_dps` or `x [rad/s]`.
    pub is_exact: bool,
}

impl ColumnSpec {
    /// The name without its unit, if the name is exact and states a unit: `GyrX` of `GyrX [rad/s]`.
    pub fn without_unit(&self) -> Option<&str> {
        let (name, _) = self.name.rsplit_once(['[', '(']).filter(|_| self.is_exact)?;
        let name = name.trim_end();
        (Quantity::of_column(&self.name).is_some() && !name.is_empty()).then_some(name)
    }

    /// True if the name is not exact, and `column` is the name followed by `_code` or a unit.
    fn fits(&self, column: &str) -> bool {
        let rest = column.strip_prefix(&self.name).filter(|_| !self.is_exact);
        let states_unit = Unit::of_column(column).is_some() || is_celsius(column);
        rest.is_some_and(|rest| rest == "_code" || states_unit && rest.starts_with(['_', ' ', '[', '(']))
    }
}

pub struct Columns<'a> {
    pub path: &'a Path,
    /// The names of the columns, or their numbers.
    pub names: Vec<&'a str>,
    pub numeric: Vec<bool>,
    /// True for each column that holds times by its content or its type; may be empty if none does.
    pub clocks: Vec<bool>,
    pub settings: Names,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The columns with the numbers, in the requested order. If no time column was given, an unrequested column with
    /// the fractions of a second that `time` lacks comes last.
    pub values: Vec<usize>,
    /// The time column; `None` if none was found or, as in a capture, is needed, or if only the rate is given.
    pub time: Option<usize>,
    /// The columns of the conditions that select rows.
    pub only: Vec<usize>,
}

impl Columns<'_> {
    /// If the request names no column, those in `default` have precedence over all others.
    pub fn choose(&self, wanted: ColumnSelection<'_>, args: &ColumnOptions, default: &[usize]) -> Result<Choice> {
        let lacks_rate = args.rate.is_none() && args.time_column.is_none() && self.stated_time(&[]).is_none();
        let asks_rate = lacks_rate && default.is_empty() && !matches!(wanted, ColumnSelection::Described(_));
        self.chosen(wanted, args, default).map_err(|error| match error {
            // the rate is missing too, so one message asks for both
            LogError::Ask(question) if asks_rate => {
                let [rate, time] = [Setting::Rate, Setting::TimeColumn].map(|setting| self.settings.of(setting));
                LogError::Ask(format!("{question}. Also give {rate} in Hz, or {time}"))
            }
            other => other,
        })
    }

    fn chosen(&self, wanted: ColumnSelection<'_>, args: &ColumnOptions, default: &[usize]) -> Result<Choice> {
        let time = args.time_column.as_deref().map(|wanted| self.position(wanted, Setting::TimeColumn)).transpose()?;
        let conditions = args.only.iter().flat_map(|only| &only.conditions);
        let only = conditions.map(|condition| self.position(&condition.column, Setting::Where));
        let only = only.collect::<Result<Vec<usize>>>()?;
        let is_open = args.rate.is_none() && time.is_none();
        let first = match wanted {
            ColumnSelection::First(names) => self.positions(names)?,
            _ => Vec::new(),
        };
        if let (ColumnSelection::All, [], None) = (wanted, default, args.rate) {
            self.check_blocks(time)?;
        }
        let time = match (wanted, default) {
            (ColumnSelection::First(_), []) if is_open => self.time(&first),
            (ColumnSelection::All, []) if is_open => self.time(&[]),
            // a column whose name merely suggests a time may be the wanted column
            (ColumnSelection::One(None), []) if is_open => self.stated_time(&[]),
            _ => time,
        };
        let values = match (wanted, default) {
            (ColumnSelection::One(Some(wanted)), _) => vec![self.position(wanted, Setting::Column)?],
            (ColumnSelection::One(None), [only]) => vec![*only],
            (ColumnSelection::One(None), _) => vec![self.only(time)?],
            (ColumnSelection::Listed(names), _) => self.positions(names)?,
            (ColumnSelection::First(_), _) => {
                let others = self.all(time).into_iter().filter(|at| !only.contains(at) && !first.contains(at));
                first.iter().copied().chain(others).collect()
            }
            (ColumnSelection::All, []) => self.all(time).into_iter().filter(|at| !only.contains(at)).collect(),
            (ColumnSelection::All, rates) => rates.to_vec(),
            (ColumnSelection::Described(columns), _) => {
                columns.iter().map(|column| self.described(column)).collect::<Result<_>>()?
            }
        };
        // a capture needs no time column, because it counts its samples
        let are_named = matches!(
            (wanted, default),
            (ColumnSelection::Described(_), _) | (ColumnSelection::Listed(_) | ColumnSelection::One(Some(_)), [])
        );
        let time = if is_open && are_named { self.time(&values) } else { time };
        self.check(&values, time)?;
        let is_rest = |at: &usize| time.is_some_and(|time| self.is_fraction(*at, time));
        let rest =
            (0..self.names.len()).filter(|at| is_open && self.numeric[*at] && !values.contains(at)).find(is_rest);
        let values = values.into_iter().chain(rest).collect();
        Ok(Choice { values, time, only })
    }

    /// The warning about columns without numbers, if all columns were requested.
    pub fn left_out(&self, wanted: ColumnSelection<'_>, time: Option<usize>) -> Option<LogWarning> {
        // a given rate is compared with the times
        let time = time.or_else(|| self.time(&[]));
        let is_left = |at: &usize| !self.numeric[*at] && Some(*at) != time;
        let left: Vec<&str> = (0..self.names.len()).filter(is_left).map(|at| self.names[at]).collect();
        let is_said = matches!(wanted, ColumnSelection::All) && !left.is_empty();
        is_said.then(|| LogWarning::NoNumbers { path: self.path.display().to_string(), names: left.join(", ") })
    }

    /// The column outside `values` with the time: the only one whose name states a unit of time, the only one with the
    /// name of a time, or the time column of the sensor that `values` belong to.
    pub fn time(&self, values: &[usize]) -> Option<usize> {
        let is_likely = |at: &usize| !values.contains(at) && self.numeric[*at] && is_named_time(self.names[*at]);
        let likely: Vec<usize> = (0..self.names.len()).filter(is_likely).collect();
        let is_of_sensor = |at: &&usize| self.names[**at].ends_with("header.stamp");
        let only = || match likely[..] {
            [only] => Some(only),
            // prefers the sensor's stamp, because `rostopic echo -p` writes the time of arrival as well
            _ => likely.iter().find(is_of_sensor).copied(),
        };
        let has_others = self.numeric.iter().filter(|is_numeric| **is_numeric).count() > 1;
        self.stated_time(values).or_else(|| only().filter(|_| has_others)).or_else(|| self.time_of_block(values))
    }

    /// The time column in front of `values`, if the file has several sensors and each has a time column.
    fn time_of_block(&self, values: &[usize]) -> Option<usize> {
        let blocks = self.blocks();
        let (time, _) = blocks.iter().find(|(_, block)| values.iter().all(|at| block.contains(at)))?;
        (blocks.len() > 1 && !values.is_empty()).then_some(*time)
    }

    /// Each time column that at least three columns of numbers follow, with these columns, as in
    /// `t_gyro,gx,gy,gz,t_accel,ax,ay,az`. Empty if the first column of numbers is not a time.
    fn blocks(&self) -> Vec<(usize, Vec<usize>)> {
        let is_time = |at: usize| states_time(self.names[at]) || is_like_time(self.names[at]);
        let mut blocks: Vec<(usize, Vec<usize>)> = Vec::new();
        for at in (0..self.names.len()).filter(|at| self.numeric[*at]) {
            match blocks.last_mut() {
                _ if is_time(at) => blocks.push((at, Vec::new())),
                Some((_, block)) => block.push(at),
                None => return Vec::new(),
            }
        }
        blocks.retain(|(_, block)| block.len() >= BLOCK);
        blocks
    }

    /// Refuses a choice of all columns if several sensors have times of their own, unless the user gave another time
    /// column, `given`, or a time column of the whole log is found.
    fn check_blocks(&self, given: Option<usize>) -> Result<()> {
        let blocks = self.blocks();
        let is_alone = given.is_none_or(|given| blocks.iter().all(|(time, _)| *time != given));
        if blocks.len() < 2 || is_alone && (given.is_some() || self.time(&[]).is_some()) {
            return Ok(());
        }
        let name = |at: &usize| match self.names.iter().filter(|name| **name == self.names[*at]).count() {
            1 => self.names[*at].to_owned(),
            _ => at.to_string(),
        };
        let groups = blocks.iter().map(|(_, block)| block.iter().map(name).collect()).collect();
        let (path, option) = (self.path.display(), self.settings.of(Setting::Column));
        let question = format!("{path}: it has a time for each sensor; choose one of them with {option}:");
        Err(LogError::Merged { question, groups, has_own_times: true })
    }

    /// The only column outside `values` whose name states a unit of time, or the seconds of a stamp in two columns. A
    /// column whose name is a unit alone, such as `ms`, counts only if no other column is called a time. Without
    /// these, the column that holds times by content or type.
    fn stated_time(&self, values: &[usize]) -> Option<usize> {
        let states = |index: &usize| {
            let name = self.names[*index];
            !values.contains(index) && states_time(name)
        };
        let (bare, clear): (Vec<usize>, Vec<usize>) =
            (0..self.names.len()).filter(states).partition(|at| is_bare_unit(self.names[*at]));
        // a time in minutes may have fewer digits than another
        let (longer, shorter): (Vec<usize>, Vec<usize>) =
            clear.into_iter().partition(|at| is_in_longer_unit(self.names[*at]));
        let mut clear = if shorter.is_empty() { longer } else { shorter };
        if clear.iter().any(|at| !is_step(self.names[*at])) {
            clear.retain(|at| !is_step(self.names[*at]));
        }
        let pair = |of: &[usize]| match *of {
            [one, other] if self.is_fraction(other, one) => Some(one),
            [one, other] if self.is_fraction(one, other) => Some(other),
            _ => None,
        };
        let is_alone = !self.names.iter().any(|name| is_like_time(name));
        let stated = match (&clear[..], &bare[..]) {
            ([only], _) => Some(*only),
            ([], [only]) if is_alone => Some(*only),
            ([], bare) => pair(bare).filter(|_| is_alone),
            (clear, _) => pair(clear),
        };
        stated.or_else(|| self.clock(values).filter(|_| clear.is_empty()))
    }

    /// The only column outside `values` that holds times by content or type, if no numeric column is named a time.
    fn clock(&self, values: &[usize]) -> Option<usize> {
        let is_other = |(at, name): (usize, &&str)| self.numeric[at] && is_named_time(name);
        let mut clocks = (0..self.clocks.len()).filter(|at| self.clocks[*at] && !values.contains(at));
        let only = clocks.next().filter(|_| clocks.next().is_none())?;
        (!self.names.iter().enumerate().any(is_other)).then_some(only)
    }

    /// True if column `at` holds the fractions of a second that the times in column `time` lack.
    fn is_fraction(&self, at: usize, time: usize) -> bool {
        let is_clock = self.clocks.get(time) == Some(&true);
        fraction_s(self.names[at], self.names[time]).is_some()
            || is_clock && fraction_of_clock_s(self.names[at]).is_some()
    }

    fn check(&self, values: &[usize], time: Option<usize>) -> Result<()> {
        let fails = |why: &str, column: usize| {
            Err(self.ambiguous(&format!("{why} `{}`", self.names.get(column).unwrap_or(&"")), Setting::Column))
        };
        if values.is_empty() {
            return Err(self.without_numbers());
        }
        for (at, value) in values.iter().enumerate() {
            if !self.numeric[*value] {
                return fails("holds no numbers in", *value);
            }
            if time == Some(*value) {
                return fails("cannot have both time and rate in", *value);
            }
            if values[..at].contains(value) {
                return fails("is asked twice for", *value);
            }
        }
        Ok(())
    }

    /// All columns of numbers, except the time, its fraction of a second, and an index. A column without a name among
    /// named ones is an index.
    fn all(&self, time: Option<usize>) -> Vec<usize> {
        let are_named = self.names.iter().any(|name| !name.is_empty());
        let is_fraction = |index: usize| time.is_some_and(|time| self.is_fraction(index, time));
        let is_meant = |index: &usize| !(are_named && self.names[*index].is_empty() || is_fraction(*index));
        (0..self.names.len()).filter(|index| self.numeric[*index] && Some(*index) != time).filter(is_meant).collect()
    }

    /// The only column with numbers that is not the time.
    fn only(&self, time: Option<usize>) -> Result<usize> {
        match self.all(time)[..] {
            [only] => Ok(only),
            [] => Err(self.without_numbers()),
            _ => Err(self.ambiguous("has several columns", Setting::Column)),
        }
    }

    /// The column that fits a description. An exact name has precedence over a name followed by a unit.
    fn described(&self, wanted: &ColumnSpec) -> Result<usize> {
        let all = || self.names.iter().enumerate();
        let exact: Vec<usize> = all().filter(|(_, name)| **name == wanted.name).map(|(at, _)| at).collect();
        let bare = || all().filter(|(_, name)| wanted.without_unit() == Some(**name)).map(|(at, _)| at);
        let found: Vec<usize> = match exact[..] {
            [] => bare().chain(all().filter(|(_, name)| wanted.fits(name)).map(|(at, _)| at)).collect(),
            _ => exact,
        };
        let ColumnSpec { what, name, .. } = wanted;
        match found[..] {
            [only] => Ok(only),
            [] => Err(self.unknown(&format!("has no column `{name}` for the {what}"))),
            _ => Err(self.unknown(&format!("has several columns that may be the {what}"))),
        }
    }

    fn positions(&self, wanted: &[String]) -> Result<Vec<usize>> {
        wanted.iter().map(|wanted| self.position(wanted, Setting::Column)).collect()
    }

    /// The column of this name or number. A name has precedence over a number.
    fn position(&self, wanted: &str, setting: Setting) -> Result<usize> {
        // if the header is a comment, the user may give a name with the mark of that comment: `# gx`
        let bare = wanted.trim_start_matches(['#', '%', ' ']);
        let is_named = |(_, name): &(usize, &&str)| **name == wanted || !bare.is_empty() && **name == bare;
        let mut named = self.names.iter().enumerate().filter(is_named).map(|(at, _)| at);
        match (named.next(), named.next()) {
            (Some(at), None) => Ok(at),
            (Some(_), Some(_)) => {
                Err(self.ambiguous(&format!("has several columns `{wanted}`, so it takes their number"), setting))
            }
            (None, _) => {
                let number = wanted.parse().ok().filter(|number| *number < self.names.len());
                number.ok_or_else(|| {
                    let meant = self.nearest(wanted).map(|name| format!(" (did you mean `{name}`?)"));
                    self.ambiguous(&format!("has no column `{wanted}`{}", meant.unwrap_or_default()), setting)
                })
            }
        }
    }

    /// The column whose name begins or ends with `wanted`, or with whose name `wanted` begins or ends. Only letters
    /// and digits count. Of several such columns, the one whose name has the nearest length.
    fn nearest(&self, wanted: &str) -> Option<&str> {
        let plain = |name: &str| name.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "");
        let wanted = plain(wanted);
        let is_near = |name: &&&str| {
            let name = plain(name);
            let holds = |one: &str, other: &str| other.len() > 1 && (one.starts_with(other) || one.ends_with(other));
            holds(&name, &wanted) || holds(&wanted, &name)
        };
        self.names.iter().filter(is_near).min_by_key(|name| name.len().abs_diff(wanted.len())).copied()
    }

    fn without_numbers(&self) -> LogError {
        if self.names.len() < 2 {
            return self.ambiguous("has no column of numbers", Setting::Column);
        }
        let path = self.path.display();
        LogError::Ask(format!("{path} has no column of numbers that is not a time; it has: {}", self.listed()))
    }

    fn ambiguous(&self, why: &str, setting: Setting) -> LogError {
        let (path, option) = (self.path.display(), self.settings.of(setting));
        LogError::Ask(match self.names[..] {
            [] => format!("{path} {why}: it has no column at all"),
            [only] if is_number(only, 0) => format!("{path} {why}: it has one column, without a name"),
            [only] => format!("{path} {why}: its only column is `{only}`"),
            _ => format!("{path} {why}; choose with {option} one of: {}", self.listed()),
        })
    }

    fn unknown(&self, why: &str) -> LogError {
        let remedy = "say in the file of the part which it is, as `column = \"…\"`; there are";
        LogError::Ask(format!("{} {why}; {remedy} {}", self.path.display(), self.listed()))
    }

    fn listed(&self) -> String {
        let listed = self.names.iter().enumerate().map(|(number, name)| match is_number(name, number) {
            true => format!("{number}"),
            false => format!("{number} `{name}`"),
        });
        let listed = listed.take(LISTED).collect::<Vec<_>>().join(", ");
        match self.names.len().saturating_sub(LISTED) {
            0 => listed,
            more => format!("{listed} … and {more} more"),
        }
    }
}

#[cfg(any(feature = "hdf5", feature = "matlab", feature = "numpy"))]
impl Columns<'_> {
    /// Chooses columns of equal length, and returns that length. `rows` is the number of rows of each column.
    pub fn choose_alike(
        &self,
        wanted: ColumnSelection<'_>,
        args: &ColumnOptions,
        rows: impl Fn(usize) -> u64,
    ) -> Result<(Choice, u64)> {
        let choice = self.choose(wanted, args, &[])?;
        let mut wanted = choice.values.iter().chain(&choice.time).copied();
        let Some(one) = wanted.next() else { return Ok((choice, 0)) };
        if let Some(other) = wanted.find(|other| rows(*other) != rows(one)) {
            let [one, other] = [one, other].map(|at| format!("`{}` has {}", self.names[at], rows(at)));
            let why = format!("{one} rows and {other}: they are not of one log");
            return Err(LogError::Ask(format!("{}: {why}; read one at a time", self.path.display())));
        }
        Ok((choice, rows(one)))
    }
}

/// True if the name of a column is only its number.
fn is_number(name: &str, number: usize) -> bool {
    name.parse() == Ok(number)
}
