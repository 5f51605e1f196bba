//! The axes of an IMU in a log.

#[cfg(test)]
mod tests;

use super::codes::{self, Codes};
use super::{ImuWarning, Kind, plausible};
use crate::triads::{are_one_sensor, triads};
use crate::{increment_names, increments, kalibr};
use std::path::Path;
use zerorate_logs::{
    Column, ColumnOptions, ColumnSelection, LogError, LogWarning, Parts, Quantity, Setting, TimeUnit, Unit,
    states_codes, states_factor,
};

/// The user's description of the axes, for logs that do not describe them.
#[derive(Clone, Debug, Default)]
pub struct ImuOptions {
    /// The columns, by name or number. `None` takes the columns of `gyro` and `accel`. A kind without listed columns
    /// takes those that its names or units show.
    pub columns: Option<Vec<String>>,
    /// Columns, unit and scale of the gyroscope.
    pub gyro: KindOptions,
    /// Columns, unit and scale of the accelerometer.
    pub accel: KindOptions,
    /// The options of the log (topic, rate, time), and the names of options in messages.
    pub log: ColumnOptions,
    /// Further topics of the same IMU, such as the one of its accelerometer.
    pub more_topics: Vec<String>,
}

/// The columns, unit and scale of a kind of axis, as the user states them.
#[derive(Clone, Debug, Default)]
pub struct KindOptions {
    /// The columns of this kind, by name or number, whatever their names suggest.
    pub columns: Vec<String>,
    /// The unit of these columns.
    pub unit: Option<Unit>,
    /// The size of a step of 1 in these columns, in `unit`, or in °/s or m/s² if `unit` is `None`.
    pub scale: Option<f64>,
    /// The codes in these columns; `None` if the user does not state that they hold codes.
    pub codes: Option<Codes>,
}

/// The axes of a log.
pub struct Axes {
    /// The axes, gyroscopes first, and otherwise in the order of the file or of the user's list. Each has its
    /// quantity.
    pub columns: Vec<Column>,
    /// The temperature columns, found by unit or name.
    pub temperatures: Vec<Column>,
    /// The topic in the name of the first axis, or of the first gyroscope if there are several topics. `None` if the
    /// log is not a ROS bag.
    pub topic: Option<String>,
    /// The warnings about the log.
    pub warnings: Vec<LogWarning>,
}

type OfKind = (Kind, Column);

/// Endings of the column names of the first axis of each kind in a ROS bag.
const FIRST: [&str; 2] = [".angular_velocity.x", ".linear_acceleration.x"];

impl Axes {
    /// Reads all axes of a log, in one pass for each topic. `path` names the log in messages.
    ///
    /// # Errors
    /// Returns the errors of [`zerorate_logs::read_parts`] and of [`Axes::of`].
    pub fn read(path: &Path, parts: impl Into<Parts>, options: &ImuOptions) -> zerorate_logs::Result<Self> {
        let parts = parts.into();
        let mut topics: Vec<String> = options.log.topic.iter().chain(&options.more_topics).cloned().collect();
        if topics.len() < 2 {
            match Self::of_topic(path, parts.try_clone()?, options) {
                Err(LogError::Merged { groups, has_own_times, .. }) if options.listed().is_none() => {
                    let time_column = options.log.time_column.clone().filter(|_| !has_own_times);
                    let log = ColumnOptions { time_column, ..options.log.clone() };
                    return Self::of_groups(path, &parts, &groups, &ImuOptions { log, ..options.clone() });
                }
                Err(LogError::Choose { question, table, topics: all }) if topics.is_empty() => match halves(&all) {
                    Some(pair) => topics = pair,
                    None => return Err(LogError::Choose { question, table, topics: all }),
                },
                found => return found,
            }
        }
        let of_topic = |topic: String| {
            let log = ColumnOptions { topic: Some(topic), ..options.log.clone() };
            Self::of_topic(path, parts.try_clone()?, &ImuOptions { log, ..options.clone() })
        };
        let each = topics.iter().cloned().map(of_topic).collect::<zerorate_logs::Result<Vec<Self>>>()?;
        Self::together(path, each, options)
    }

    /// The axes of a table that has the columns of several sensors in groups. Each sensor is read alone.
    fn of_groups(
        path: &Path,
        parts: &Parts,
        groups: &[Vec<String>],
        options: &ImuOptions,
    ) -> zerorate_logs::Result<Self> {
        let is_axis = |name: &&String| Kind::is_axis(name, true) && Kind::of_name(name).is_some();
        let of_group = |columns: Vec<String>| {
            Self::of_topic(path, parts.try_clone()?, &ImuOptions { columns: Some(columns), ..options.clone() })
        };
        let is_read = |name: &&String| is_axis(name) || is_temperature_name(name);
        let with_axes = groups.iter().filter(|names| names.iter().any(|name| is_axis(&name)));
        let axes = with_axes.map(|names| names.iter().filter(is_read).cloned().collect::<Vec<String>>());
        let each = axes.map(of_group).collect::<zerorate_logs::Result<Vec<Self>>>()?;
        if each.is_empty() {
            return Err(no_axes(path, &groups.concat(), options));
        }
        Self::together(path, each, options)
    }

    /// Joins the axes of several topics, or of several groups of columns, to one IMU.
    fn together(path: &Path, each: Vec<Self>, options: &ImuOptions) -> zerorate_logs::Result<Self> {
        let has_gyroscope = |of: &&Self| of.columns.iter().any(|axis| axis.quantity == Some(Quantity::AngularRate));
        let topic = each.iter().find(has_gyroscope).or(each.first()).and_then(|of| of.topic.clone());
        let (mut columns, mut temperatures, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
        for of in each {
            columns.extend(of.columns);
            temperatures.extend(of.temperatures);
            warnings.extend(of.warnings);
        }
        columns.sort_by_key(|column| column.quantity != Some(Quantity::AngularRate));
        for kind in Kind::ALL {
            let count = columns.iter().filter(|column| column.quantity == Some(kind.quantity())).count();
            if count > AXES {
                let (path, name, option) = (path.display(), kind.name(), options.log.names.of(Setting::Topic));
                return Err(LogError::Ask(format!(
                    "{path}: the topics have {count} {name}s together, and an IMU has three; give one {option}"
                )));
            }
        }
        Ok(Self { columns, temperatures, topic, warnings })
    }

    fn of_topic(path: &Path, parts: Parts, options: &ImuOptions) -> zerorate_logs::Result<Self> {
        let listed = options.listed();
        let wanted = options.selection(listed.as_deref());
        let (columns, no_rate) = zerorate_logs::read_without_rate(path, parts, wanted, &options.log)?;
        match (no_rate, Self::of(path, columns, options)) {
            (None, axes) => axes,
            (Some(no_rate), Err(more)) => Err(both(path, no_rate, more)),
            (Some(no_rate), Ok(_)) => Err(no_rate),
        }
    }

    /// A warning for each kind of which no axis was read. It names the option by which the user listed columns, if
    /// any.
    pub fn absent(&self, options: &ImuOptions) -> impl Iterator<Item = ImuWarning> {
        let has = |kind: &Kind| self.columns.iter().any(|column| column.quantity == Some(kind.quantity()));
        let chosen_by = match options.columns {
            Some(_) => Some(options.log.names.of(Setting::Column)),
            None => options.listed().map(|_| options.log.names.of(Setting::Gyro)),
        };
        let absent: Vec<Kind> = Kind::ALL.into_iter().filter(|kind| !has(kind)).collect();
        absent.into_iter().map(move |kind| ImuWarning::KindAbsent(kind, chosen_by))
    }

    /// True if any column of a log is an axis by its name or unit alone.
    #[must_use]
    pub fn are_among(columns: &[Column]) -> bool {
        columns.iter().any(|column| Kind::is_axis(&column.name, false) && Kind::of_column(column).is_some())
    }

    /// The axes among the columns of a log.
    ///
    /// # Errors
    /// Returns an error if no column is an axis, or the unit of an axis is not known, or a question if the choice of
    /// axes or their meaning is unclear.
    pub fn of(path: &Path, mut columns: Vec<Column>, options: &ImuOptions) -> zerorate_logs::Result<Self> {
        // the first column carries the warnings about the log, and need not be an axis
        let of_log = |column: &mut Column| column.warnings.extract_if(.., |warning| warning.is_of_log()).collect();
        let mut warnings: Vec<LogWarning> = columns.iter_mut().flat_map::<Vec<_>, _>(of_log).collect();
        if options.columns.is_none() && kalibr::give_units(&mut columns) {
            let what = "omega in rad/s and alpha in m/s², as in the files of Kalibr's tools";
            warnings.push(LogWarning::UnitsTaken { path: path.display().to_string(), what });
        }
        let (mut axes, others) = Self::among(path, columns, options)?;
        if options.listed().is_none() {
            let others: Vec<&Column> = others.iter().collect();
            ask_for_missing(path, &axes, &others, options)?;
        }
        let mut left_out: Vec<String> = others.iter().map(|column| column.name.clone()).collect();
        let temperatures: Vec<Column> = others.into_iter().filter(is_temperature).collect();
        if axes.is_empty() {
            return Err(no_axes(path, &left_out, options));
        }
        let topic = axes.first().and_then(|(_, column)| topic_of(&column.name));
        let is_open = options.listed().is_none();
        if options.columns.is_none() {
            left_out.extend(without_strangers(path, &mut axes, options)?);
        }
        if is_open {
            warnings.extend(without_blanks(path, &mut axes, topic.is_some()));
        }
        check(options, path, &axes)?;
        let give_unit = |(kind, column)| give_unit(options, kind, column, &mut warnings);
        let mut axes: Vec<Column> = axes.into_iter().map(give_unit).collect();
        axes.sort_by_key(|column| column.quantity != Some(Quantity::AngularRate));
        if options.gyro.scale.or(options.accel.scale).is_some() {
            warnings.retain(|warning| !matches!(warning, LogWarning::ScaleUnused { .. }));
        }
        if let (None, Some(seen)) = (options.log.increments, plausible::increments(&axes)) {
            return Err(increments::question(path, &seen, &options.log));
        }
        warnings.extend(plausible::doubts(path, &axes, &options.log));
        left_out.retain(|name| !temperatures.iter().any(|column: &Column| column.name == *name));
        if !left_out.is_empty() {
            let (path, names) = (path.display().to_string(), left_out.join(", "));
            warnings.push(LogWarning::ColumnsLeftOut { path, names });
        }
        Ok(Self { columns: axes, temperatures, topic, warnings })
    }

    /// The columns that are axes, each with its kind, and the others.
    fn among(
        path: &Path,
        columns: Vec<Column>,
        options: &ImuOptions,
    ) -> zerorate_logs::Result<(Vec<OfKind>, Vec<Column>)> {
        let (mut axes, mut others) = (Vec::new(), Vec::new());
        let said = options.kinds();
        let sure = columns.iter().filter(|column| Kind::is_axis(&column.name, true)).filter_map(Kind::of_column);
        let sure: Vec<Kind> = sure.collect();
        for (index, column) in columns.into_iter().enumerate() {
            let is_meant = |kind: &Kind| {
                let is_axis = options.columns.is_some() || Kind::is_axis(&column.name, sure.contains(kind));
                is_axis && options.may_be(*kind, &column)
            };
            let kind = match said.get(index) {
                Some(kind) => Some(options.agreed(path, *kind, &column)?),
                None => Kind::of_column(&column).filter(is_meant),
            };
            match kind {
                Some(kind) => axes.push((kind, column)),
                None => others.push(column),
            }
        }
        Ok((axes, others))
    }
}

fn is_temperature(column: &Column) -> bool {
    column.quantity.map_or_else(|| is_temperature_name(&column.name), |quantity| quantity == Quantity::Temperature)
}

/// True if a name says a temperature: `temp_c`, `imu_temp`, `Temperature`, `T`.
fn is_temperature_name(name: &str) -> bool {
    let is_time = name == "t" || TimeUnit::of_column(name).is_some();
    let name = name.rsplit('.').next().unwrap_or_default().to_lowercase();
    let is_word =
        |word: &str| matches!(word, "t" | "temps" | "temperature" | "temperatures") || word.ends_with("temp");
    !is_time && (name.split(|c: char| !c.is_alphabetic()).any(is_word) || name.contains("temperature"))
}

/// Asks for the columns of a kind if the user states its unit, scale or codes, but no column is known as an axis of
/// the kind, and three others may be. Asks for the third axis if a sensor has only two and other columns are left.
fn ask_for_missing(
    path: &Path,
    axes: &[OfKind],
    others: &[&Column],
    options: &ImuOptions,
) -> zerorate_logs::Result<()> {
    let may_be = |column: &&&Column| {
        Kind::is_axis(&column.name, true) && !Kind::is_of_others(&column.name) && !is_temperature(column)
    };
    let free: Vec<&&Column> = others.iter().filter(may_be).collect();
    let path = path.display();
    for kind in Kind::ALL {
        let (name, option) = (kind.name(), options.log.names.of(kind.setting()));
        let own: Vec<&str> =
            axes.iter().filter(|(of, _)| *of == kind).map(|(_, column)| column.name.as_str()).collect();
        let KindOptions { unit, scale, codes, .. } = options.said(kind);
        let fits = |column: &&&&Column| codes.is_none() || codes::are_whole(column);
        let names: Vec<&str> = free.iter().filter(fits).map(|column| column.name.as_str()).collect();
        let triad = triads(&names).first().map(|triad| triad.map(|at| names[at]).join(","));
        match (&own[..], triad) {
            ([], Some(triad)) if !axes.is_empty() && (unit.is_some() || scale.is_some() || codes.is_some()) => {
                let why = format!("{path}: no column is an axis of the {name} by its name, but you state its unit");
                return Err(LogError::Ask(format!("{why}; if {triad} are its axes, give {option} '{triad}'")));
            }
            ([one, other], _) if !names.is_empty() && are_one_sensor(&own) => {
                let (found, rest) = (format!("{one},{other}"), names.join(", "));
                return Err(LogError::Ask(format!(
                    "{path}: {found} are two axes of the {name}; name its third of {rest} with {option}, or give \
                     {option} '{found}'"
                )));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Joins two questions, so that the user is asked for everything at once. Returns the first error if one of the two is
/// not a question.
fn both(path: &Path, first: LogError, second: LogError) -> LogError {
    match (first, second) {
        (LogError::Ask(first), LogError::Ask(more)) => {
            let more = more.strip_prefix(&path.display().to_string()).unwrap_or(&more);
            let more = more.strip_prefix(": ").map_or_else(|| format!("it{more}"), str::to_owned);
            LogError::Ask(format!("{first}. Also: {more}"))
        }
        (first, _) => first,
    }
}

/// Leaves out blank axes, which are 0 in every row, unless all are blank. A ROS message has three axes of each kind,
/// even from a sensor with fewer. A blank axis of a table may be broken, and stays if others of its kind have values.
fn without_blanks(path: &Path, axes: &mut Vec<OfKind>, is_message: bool) -> Option<LogWarning> {
    let is_alive = |kind: Kind| axes.iter().any(|(of, column)| *of == kind && !column.is_blank());
    let dead: Vec<Kind> = Kind::ALL.into_iter().filter(|kind| !is_alive(*kind)).collect();
    let is_left = |(kind, column): &OfKind| column.is_blank() && (is_message || dead.contains(kind));
    let names: Vec<&str> = axes.iter().filter(|axis| is_left(axis)).map(|(_, column)| column.name.as_str()).collect();
    if names.is_empty() || names.len() == axes.len() {
        return None;
    }
    let (path, names) = (path.display().to_string(), names.join(", "));
    axes.retain(|axis| !is_left(axis));
    Some(LogWarning::BlanksLeftOut { path, names })
}

/// Removes the columns beside the three axes of one sensor, and returns their names.
///
/// # Errors
/// Returns a question if several sensors fit, or if it is unclear which columns are the three axes of one.
fn without_strangers(path: &Path, axes: &mut Vec<OfKind>, options: &ImuOptions) -> zerorate_logs::Result<Vec<String>> {
    let mut left_out = Vec::new();
    let mut several: Vec<(Kind, Vec<Vec<String>>)> = Vec::new();
    for kind in Kind::ALL.into_iter().filter(|kind| options.said(*kind).columns.is_empty()) {
        let names: Vec<String> =
            axes.iter().filter(|(of, _)| *of == kind).map(|(_, column)| column.name.clone()).collect();
        let shown: Vec<&str> = names.iter().map(String::as_str).collect();
        let sensors: Vec<Vec<String>> =
            triads(&shown).iter().map(|triad| triad.map(|at| names[at].clone()).to_vec()).collect();
        match &sensors[..] {
            _ if names.len() <= AXES && are_one_sensor(&shown) => {}
            [only] => {
                let strangers = axes.extract_if(.., |(of, column)| *of == kind && !only.contains(&column.name));
                left_out.extend(strangers.map(|(_, column)| column.name));
            }
            [] => several.push((kind, names.into_iter().map(|name| vec![name]).collect())),
            _ => several.push((kind, sensors)),
        }
    }
    let line = |names: &Vec<String>| format!("  {}", names.join(","));
    let (setting, table) = match &several[..] {
        [] => return Ok(left_out),
        [(kind, sensors)] => (kind.setting(), sensors.iter().map(line).collect()),
        [(_, gyros), (_, accels), ..] => {
            let both = |at: usize| [gyros.get(at), accels.get(at)].into_iter().flatten().flatten().cloned().collect();
            (Setting::Column, (0..gyros.len().max(accels.len())).map(|at| line(&both(at))).collect())
        }
    };
    let option = options.log.names.of(setting);
    let is_twice = |at: &usize| axes[..*at].iter().any(|(_, other)| other.name == axes[*at].1.name);
    if let Some(at) = (0..axes.len()).find(is_twice) {
        let why = format!("{} has several columns `{}`", path.display(), axes[at].1.name);
        return Err(LogError::Ask(format!("{why}; choose the axes of one sensor with {option}, by number from 0")));
    }
    let what = if setting == Setting::Column { "several IMUs" } else { "columns of several sensors" };
    let question = format!("{} has {what}; choose the axes of one with {option}:", path.display());
    Err(LogError::Choose { question, table, topics: Vec::new() })
}

impl ImuOptions {
    fn said(&self, kind: Kind) -> &KindOptions {
        match kind {
            Kind::Gyroscope => &self.gyro,
            Kind::Accelerometer => &self.accel,
        }
    }

    /// The columns that the user listed: `columns`, or else the columns of the two kinds, gyroscopes first. `None` if
    /// none are listed.
    #[must_use]
    pub fn listed(&self) -> Option<Vec<String>> {
        let of_kinds = || Kind::ALL.into_iter().flat_map(|kind| self.said(kind).columns.clone()).collect::<Vec<_>>();
        self.columns.clone().or_else(|| Some(of_kinds()).filter(|columns| !columns.is_empty()))
    }

    /// Selects the columns to read. `listed` is the result of [`Self::listed`]. If it has one kind only, all other
    /// columns are read too, so that axes of the other kind can be found.
    #[must_use]
    pub fn selection<'a>(&self, listed: Option<&'a [String]>) -> ColumnSelection<'a> {
        let are_all = self.columns.is_some() || Kind::ALL.iter().all(|kind| !self.said(*kind).columns.is_empty());
        match listed {
            None => ColumnSelection::All,
            Some(names) if are_all => ColumnSelection::Listed(names),
            Some(names) => ColumnSelection::First(names),
        }
    }

    /// True if a column that is not listed by kind may be an axis of this kind. If the user listed columns by kind,
    /// this kind must be the one without a list, and the unit or the scale of the column must be known.
    fn may_be(&self, kind: Kind, column: &Column) -> bool {
        let KindOptions { columns, unit, scale, .. } = self.said(kind);
        let is_known = column.quantity.is_some() || unit.is_some() || scale.is_some();
        self.listed().is_none() || self.columns.is_some() || columns.is_empty() && is_known
    }

    /// The kinds of the listed columns, in their order. Empty if the user does not state kinds.
    fn kinds(&self) -> Vec<Kind> {
        let of_kind = |kind: Kind| std::iter::repeat_n(kind, self.said(kind).columns.len());
        if self.columns.is_some() { Vec::new() } else { Kind::ALL.into_iter().flat_map(of_kind).collect() }
    }

    /// The kind that the user states. Returns an error if the unit of the column contradicts it, unless the user
    /// forces another unit.
    fn agreed(&self, path: &Path, kind: Kind, column: &Column) -> zerorate_logs::Result<Kind> {
        let is_forced = self.log.force_unit && self.said(kind).unit.is_some();
        match column.quantity.filter(|quantity| *quantity != kind.quantity() && !is_forced) {
            None => Ok(kind),
            Some(quantity) => Err(LogError::Ask(format!(
                "{}: column {} is in {}, which is not a unit of {}s; leave it out of {}",
                path.display(),
                column.name,
                quantity.unit(),
                kind.name(),
                self.log.names.of(kind.setting())
            ))),
        }
    }

    /// The question for the unit of columns, with a hint from their numbers.
    fn ask_unit(&self, kind: Kind, columns: &[&Column]) -> String {
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        let has = |states: fn(&str) -> bool| names.iter().any(|name| states(name));
        let (stated, scale) = match () {
            () if has(states_factor) => ("a factor or a range beside the unit", Some(Setting::Scale)),
            () if has(states_codes) => ("codes and no unit", Some(Setting::Scale)),
            () if has(|name| increment_names::by_unit(name).is_some()) => ("no unit of a rate", None),
            () => ("no unit", None),
        };
        let seen = match &names[..] {
            [only] => format!("column {only} ({}) states {stated}", kind.name()),
            several => format!("columns {} ({}) state {stated}", several.join(", "), kind.name()),
        };
        let scale = scale.map_or_else(String::new, |scale| format!(" with {}", self.log.names.of(scale)));
        let told = match kind {
            Kind::Accelerometer => codes::of_gravity(columns, &self.log),
            Kind::Gyroscope if columns.iter().all(|column| codes::are_whole(column)) => {
                Some(codes::of_gyroscope(self.log.names))
            }
            Kind::Gyroscope => None,
        };
        let told = told.map_or_else(String::new, |told| format!(" ({told})"));
        format!("{seen}; {}{scale}{told}", self.remedy(kind))
    }

    fn remedy(&self, kind: Kind) -> String {
        let units = Unit::ALL.into_iter().filter(|unit| unit.quantity() == kind.quantity()).map(Unit::name);
        let units = units.collect::<Vec<_>>().join("|");
        format!("give {} {units}", self.log.names.of(kind.unit_setting()))
    }
}

impl Kind {
    fn setting(self) -> Setting {
        match self {
            Self::Gyroscope => Setting::Gyro,
            Self::Accelerometer => Setting::Accel,
        }
    }

    fn unit_setting(self) -> Setting {
        match self {
            Self::Gyroscope => Setting::GyroUnit,
            Self::Accelerometer => Setting::AccelUnit,
        }
    }
}

/// Checks that the axes do not have the names of increments, unless the user said whether they are increments. Checks
/// their units too.
fn check(options: &ImuOptions, path: &Path, axes: &[OfKind]) -> zerorate_logs::Result<()> {
    let columns: Vec<&Column> = axes.iter().map(|(_, column)| column).collect();
    let asked = increments::ask_axes(path, &columns, &options.log);
    match (asked, check_units(options, path, axes)) {
        (Err(asked), Err(more)) => Err(both(path, asked, more)),
        (asked, units) => asked.and(units),
    }
}

/// Checks that the unit of each kind is known and is a unit of that kind, and that columns of codes can hold codes.
fn check_units(options: &ImuOptions, path: &Path, axes: &[OfKind]) -> zerorate_logs::Result<()> {
    let mut unknown = Vec::new();
    for kind in Kind::ALL {
        let &KindOptions { unit, scale, codes, .. } = options.said(kind);
        for (_, column) in axes.iter().filter(|(of, _)| *of == kind) {
            match codes {
                Some(codes) => codes.check(path, column, options.log.names)?,
                None => unit
                    .filter(|_| column.quantity.is_some())
                    .map_or(Ok(()), |unit| options.log.agrees(path, &column.name, unit, kind.unit_setting()))?,
            }
            if column.is_scaled && scale.is_none() {
                options.log.leaves_scale(path, &column.name, unit, kind.unit_setting())?;
            }
        }
        let mut of_kind = axes.iter().filter(|(of, _)| *of == kind).map(|(_, column)| column).peekable();
        if of_kind.peek().is_none() {
            continue;
        }
        if let Some(unit) = unit.filter(|unit| unit.quantity() != kind.quantity()) {
            return Err(LogError::Ask(format!("{unit} is not a unit for {}s; {}", kind.name(), options.remedy(kind))));
        }
        let unstated: Vec<&Column> = of_kind.filter(|column| column.quantity.is_none()).collect();
        if unit.is_none() && scale.is_none() && !unstated.is_empty() {
            unknown.push(options.ask_unit(kind, &unstated));
        }
    }
    match unknown.is_empty() {
        true => Ok(()),
        false => Err(LogError::Ask(format!("{}: {}", path.display(), unknown.join("; ")))),
    }
}

/// Number of axes of each kind in an IMU.
const AXES: usize = 3;

/// Gives an axis its quantity and the unit and scale that the user states. Moves its warnings to `warnings`.
fn give_unit(options: &ImuOptions, kind: Kind, mut column: Column, warnings: &mut Vec<LogWarning>) -> Column {
    let &KindOptions { unit, scale, .. } = options.said(kind);
    if unit.is_some() || scale.is_some() {
        let is_answered =
            |warning: &LogWarning| matches!(warning, LogWarning::UnitUnknown { .. } | LogWarning::UnitsTaken { .. });
        column.warnings.retain(|warning| !is_answered(warning));
        let step = unit.map_or(1.0, Unit::in_results) * scale.unwrap_or(column.step);
        column.scale = step * options.log.per_second(column.rate_hz);
    }
    // several axes have the same warning about their log
    for warning in column.warnings.drain(..) {
        if !warnings.contains(&warning) {
            warnings.push(warning);
        }
    }
    column.quantity = Some(kind.quantity());
    column
}

fn no_axes(path: &Path, found: &[String], options: &ImuOptions) -> LogError {
    let [gyro, accel] = [Setting::Gyro, Setting::Accel].map(|setting| options.log.names.of(setting));
    let found = if found.is_empty() { "no numbers at all".to_owned() } else { found.join(", ") };
    LogError::Ask(format!(
        "{} has no column whose name or unit says that it is an axis of an IMU (such as gyro_x, wx, `ax [m/s^2]`); it \
         has: {found}. Say which are axes with {gyro} and {accel}, by name or by number from 0",
        path.display(),
    ))
}

/// The two topics of a bag, if their names differ only in `gyro` and `accel`, as on a RealSense: `/camera/gyro/sample`
/// and `/camera/accel/sample`.
fn halves(topics: &[String]) -> Option<Vec<String>> {
    let [one, other] = topics else { return None };
    let of_pair = |gyro: &str, accel: &str| gyro.contains("gyro") && gyro.replacen("gyro", "accel", 1) == accel;
    (of_pair(one, other) || of_pair(other, one)).then(|| topics.to_vec())
}

/// The topic in a column name: `/imu0` for `/imu0.angular_velocity.x` or `/imu0.linear_acceleration.x`.
fn topic_of(column: &str) -> Option<String> {
    let topic = FIRST.into_iter().find_map(|first| column.strip_suffix(first))?;
    topic.starts_with('/').then(|| topic.to_owned())
}
