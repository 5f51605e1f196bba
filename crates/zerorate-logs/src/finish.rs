//! Gives the columns of a file their unit, rate and gaps.

use crate::clock::{TimeBase, Times};
use crate::column::Column;
use crate::column_checks::ColumnChecks;
use crate::error::{LogError, Result, no_time_unit, rate_of_steps, too_many, unsteady};
use crate::middle::usual_step;
use crate::options::ColumnOptions;
use crate::rate_question::no_rate;
use crate::raw_columns::{Clock, RawColumn, RawColumns, first_rows};
use crate::sample::Sampled;
use crate::series::Series;
use crate::setting::{Names, Setting, quoted};
use crate::stated_rate::StatedRate;
use crate::time_names::{fraction_of_clock_s, fraction_s, is_step, states_time, ticks};
use crate::warning::LogWarning;
use crate::{clock_digits, given_rate, lost_digits, mixed_rows, order, rate_changes, time_unit, unsigned};
use std::path::Path;
use zerorate_allan::Gap;
use zerorate_input::{InputError, Quantity, TimeUnit, Unit};

impl Clock {
    /// The unit of the times, and the rate and gaps that follow from them; `None` without a time column, or if only
    /// the name of the column suggests a time.
    pub fn time_base(&self, path: &Path, args: &ColumnOptions) -> Result<Option<(TimeUnit, TimeBase)>> {
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
        if self.is_guess(args) {
            return Ok(None);
        }
        let unit = self.unit(args).ok_or_else(|| no_time_unit(path, name, args.names))?;
        let time_base = times.time_base(unit, args.names).map_err(|why| unsteady(path, name, &why))?;
        if args.rate.is_none() {
            let is_named = times.unit.or(args.time_unit).is_none();
            time_unit::check((path, name), times, (unit, is_named), time_base.rate_hz, args.names)?;
        }
        Ok(Some((unit, time_base)))
    }

    /// The unit of the times: by their type, by the caller, by the name of the column, or by their dates.
    pub fn unit(&self, args: &ColumnOptions) -> Option<TimeUnit> {
        let Self::Column(name, times) = self else { return None };
        let stated = times.unit.or(args.time_unit).or_else(|| TimeUnit::of_column(name));
        stated.or_else(|| time_unit::dated(times))
    }

    fn start_s(&self, args: &ColumnOptions) -> Option<f64> {
        let Self::Column(_, times) = self else { return None };
        Some(times.first() / self.unit(args)?.per_s())
    }

    /// True if only the name of the column suggests a time: the user did not name the column, and its unit is unknown.
    pub fn is_guess(&self, args: &ColumnOptions) -> bool {
        args.time_column.is_none() && self.unit(args).is_none()
    }

    /// Scales times that count in a multiple of s, ms, us or ns, as the name of their column states. A counter wraps
    /// around at a number of its own steps, so it is unwrapped before. Returns the warning about that.
    fn scale_ticks(&mut self, path: &Path, args: &ColumnOptions) -> Option<LogWarning> {
        let Self::Column(name, times) = self else { return None };
        let known = ticks(name).or_else(|| time_unit::of_xsens(name, times));
        let (unit, step) = known.filter(|_| args.time_unit.or(times.unit).is_none())?;
        let unwrapped = order::unwrap_ticks(times);
        times.scale(step);
        times.unit = Some(unit);
        let (path, column) = (path.display().to_string(), name.clone());
        unwrapped.map(|how| LogWarning::TimesRepaired { path, column, how })
    }

    /// Converts times with the digits of a clock to times of day. Returns the warning about that.
    fn read_digits(&mut self, path: &Path, args: &ColumnOptions) -> Option<LogWarning> {
        let Self::Column(name, times) = self else { return None };
        let mut of_day = if times.unit.is_none() { clock_digits::times_of_day(times)? } else { return None };
        let unit = args.time_unit.unwrap_or(TimeUnit::S);
        of_day.scale(unit.per_s());
        of_day.unit = Some(unit);
        *times = of_day;
        let how = "the digits of a clock are read as the time of day".to_owned();
        Some(LogWarning::TimesRepaired { path: path.display().to_string(), column: name.clone(), how })
    }

    /// The name of the time column and the rate in Hz, if the column holds the steps between rows instead of times.
    fn rate_of_steps(&self) -> Option<(&str, f64)> {
        let Self::Column(name, times) = self else { return None };
        let unit = TimeUnit::of_column(name).filter(|_| is_step(name))?;
        let is_even = times.since_first().iter().all(|since| *since == 0.0);
        let falls = is_even || times.since_first().windows(2).any(|pair| pair[1] < pair[0]);
        let steps = times.since_first().iter().map(|since| times.first() + since).collect();
        Some((name, unit.per_s() / usual_step(steps).filter(|_| falls)?))
    }

    fn dated(&self, path: &Path, args: &ColumnOptions) -> Option<LogWarning> {
        let Self::Column(name, times) = self else { return None };
        let is_stated = times.unit.or(args.time_unit).or_else(|| TimeUnit::of_column(name)).is_some();
        let unit = time_unit::dated(times).filter(|_| !is_stated)?;
        Some(LogWarning::TimeUnitTaken { path: path.display().to_string(), column: name.clone(), unit: unit.name() })
    }
}

impl RawColumns {
    /// Adds fractions of a second to the times, scales them, separates sensors, and sorts the rows by time. Adds
    /// warnings about irregular times.
    pub fn repair_times(&mut self, path: &Path, args: &ColumnOptions) -> Result<()> {
        self.add_fraction(path, args.names)?;
        let unwrapped = self.clock.scale_ticks(path, args);
        let read = self.clock.read_digits(path, args);
        self.warnings.extend(unwrapped.into_iter().chain(read));
        mixed_rows::check(self, path, args)?;
        self.separate_sensors(path, args)?;
        if self.clock.is_guess(args) {
            return Ok(());
        }
        self.warnings.extend(self.clock.dated(path, args));
        if let Some((name, rate_hz)) = self.clock.rate_of_steps() {
            return Err(rate_of_steps(path, name, rate_hz, args.names));
        }
        let unit = self.clock.unit(args);
        let Clock::Column(name, times) = &mut self.clock else { return Ok(()) };
        let mended = order::repair_times(times, &mut self.columns);
        let until = args.cut.until.zip(unit).filter(|_| mended.is_err());
        let mended = match until.and_then(|(until, unit)| times.rows_until(until, unit)) {
            Some(rows) => {
                times.keep(0, rows);
                self.columns.iter_mut().for_each(|column| column.values.keep(0, rows));
                order::repair_times(times, &mut self.columns)
            }
            None => mended,
        };
        let said = mended.map_err(|why| disordered((path, name), times, unit, &why, args.names))?;
        let (path, column) = (path.display().to_string(), &*name);
        let warning = |how| LogWarning::TimesRepaired { path: path.clone(), column: column.clone(), how };
        self.warnings.extend(said.into_iter().map(warning));
        Ok(())
    }

    /// Adds the fractions of a second in another column to times in whole seconds, and removes that column.
    fn add_fraction(&mut self, path: &Path, settings: Names) -> Result<()> {
        let Clock::Column(seconds, times) = &mut self.clock else { return Ok(()) };
        let is_date = times.unit == Some(TimeUnit::Ns);
        let unit_s = |name: &str| if is_date { fraction_of_clock_s(name) } else { fraction_s(name, seconds) };
        let found = self.columns.iter().enumerate().find_map(|(at, column)| Some((at, unit_s(&column.name)?)));
        let Some((at, unit_s)) = found.filter(|_| self.columns.len() > 1) else { return Ok(()) };
        let RawColumn { name, values, .. } = self.columns.remove(at);
        let rests = values.into_rows();
        let per_s = if is_date { TimeUnit::Ns.per_s() } else { 1.0 };
        let first = if is_date { 0.0 } else { times.first() };
        let are_whole = times.since_first().iter().all(|since| (first + since) % per_s == 0.0);
        let is_rest = |rest: &f64| (0.0..1.0).contains(&(rest * unit_s)) && (unit_s == 1.0 || rest.fract() == 0.0);
        let seconds = seconds.clone();
        if !are_whole || !rests.iter().filter(|rest| rest.is_finite()).all(is_rest) {
            let why = format!("`{seconds}` and `{name}` are not whole seconds and the parts of a second");
            let [time, unit] = [Setting::TimeColumn, Setting::TimeUnit].map(|setting| settings.of(setting));
            return Err(LogError::Ask(format!("{}: {why}; give {time} with {unit}", path.display())));
        }
        if let Some(row) = rests.iter().position(|rest| !rest.is_finite()) {
            let what = "no time; every row must have one";
            return Err(InputError::damaged(path, format!("row {row}, column {name}"), what).into());
        }
        let first = rests.first().copied().unwrap_or_default();
        let since = |(whole, rest): (&f64, &f64)| whole + per_s * unit_s * (rest - first);
        times.replace(times.since_first().iter().zip(&rests).map(since).collect());
        let minute = |column: &Sampled| ["min", "minute", "minutes"].contains(&&*column.name.to_lowercase());
        let is_of_minute = |since: &f64| (-1.0..61.0).contains(&((times.first() + since) / per_s));
        if !is_date && times.since_first().iter().all(is_of_minute) && self.sample.iter().any(minute) {
            let minutes = times.unwrap_minutes(per_s);
            let how = format!("the seconds start again {minutes} times, with each minute");
            let path = path.display().to_string();
            let warning = LogWarning::TimesRepaired { path, column: seconds, how };
            self.warnings.extend((minutes > 0).then_some(warning));
        }
        Ok(())
    }

    /// Refuses a time that was chosen because its name states a unit, if a column that is called a time tells another
    /// rate.
    fn check_clocks(&self, path: &Path, args: &ColumnOptions, rate_hz: f64) -> Result<()> {
        let Clock::Column(chosen, _) = &self.clock else { return Ok(()) };
        let is_open = args.rate.is_none() && args.time_column.is_none() && states_time(chosen);
        let rival = if is_open { given_rate::rival(&self.sample, rate_hz) } else { None };
        let Some((other, unit, other_hz)) = rival else { return Ok(()) };
        let [time, time_unit] = [Setting::TimeColumn, Setting::TimeUnit].map(|setting| args.names.of(setting));
        let (path, other, chosen, unit) = (path.display(), quoted(other), quoted(chosen), unit.name());
        Err(LogError::Ask(format!(
            "{path}: two columns may be the time; give {time} {chosen} ({rate_hz:.3} Hz), or {time} {other} with \
             {time_unit} {unit} ({other_hz:.3} Hz)"
        )))
    }

    /// Takes the unit g from columns such as `x_g` beside `x_a`, where the letter means the gyroscope.
    fn take_letters(&mut self) {
        let names = first_rows(&self.sample, &self.columns);
        let names: Vec<String> = names.iter().map(|column| column.name.to_lowercase()).collect();
        for column in &mut self.columns {
            let name = column.name.to_lowercase();
            let Some(axis) = name.strip_suffix('g') else { continue };
            let own = axis.strip_suffix(['_', '.', ' ']).and_then(|axis| axis.strip_suffix(['x', 'y', 'z']));
            let is_axis = own.is_some_and(|own| !own.ends_with(char::is_alphanumeric) && !own.contains("acc"));
            column.is_lettered = is_axis && names.contains(&format!("{axis}a"));
        }
    }

    pub fn finish(self, path: &Path, args: &ColumnOptions) -> Result<Vec<Column>> {
        let (columns, no_rate) = self.finish_without_rate(path, args)?;
        no_rate.map_or(Ok(columns), Err)
    }

    /// The columns, and the question for the rate if it is not known. The rate of the columns is then 1 Hz, so that
    /// the caller can find out what else to ask.
    pub fn finish_without_rate(
        mut self,
        path: &Path,
        args: &ColumnOptions,
    ) -> Result<(Vec<Column>, Option<LogError>)> {
        self.repair_times(path, args)?;
        self.take_letters();
        let skipped_s = self.cut(path, args)?;
        let time_base = self.clock.time_base(path, args)?;
        let start_s = self.clock.start_s(args);
        if let (Some((unit, time_base)), Clock::Column(_, times)) = (&time_base, &self.clock) {
            self.check_clocks(path, args, time_base.rate_hz)?;
            let path = || path.display().to_string();
            let jitter = time_base.jitter_text().map(|how| LogWarning::TimesJitter { path: path(), how });
            let rate_changes = rate_changes::find(times.since_first(), &time_base.gaps, *unit);
            self.warnings.extend(jitter);
            self.warnings.extend(rate_changes.map(|how| LogWarning::RateChanges { path: path(), how }));
        }
        let Self { columns, clock, mut warnings, sample, stated_rate } = self;
        let (measured, lost, guess) = match (time_base, clock) {
            (Some((_, TimeBase { rate_hz, gaps, .. })), _) => (Some(rate_hz), gaps, None),
            (None, Clock::Counted { rate_hz, gaps }) => (rate_hz, gaps, None),
            (None, Clock::Column(name, _)) => (None, Vec::new(), Some(name)),
            (None, Clock::Silent) => (None, Vec::new(), None),
        };
        let start_s = start_s.filter(|_| args.rate.is_none());
        let first_rows = first_rows(&sample, &columns);
        let stated = stated_rate.as_ref().map(|stated| stated.rate_hz);
        let stamps = |given_hz| given_rate::of_stamps(path, measured.or(stated), &first_rows, given_hz);
        let given = args.rate.or(stated.filter(|_| measured.is_some()));
        warnings.extend(given.and_then(|rate_hz| given_rate::doubt(path, rate_hz, stamps(rate_hz)?)));
        let told = args.rate.or(measured).or(stated);
        let taken = stated_rate.filter(|_| args.rate.or(measured).is_none());
        warnings.extend(taken.map(|StatedRate { name, rate_hz }| {
            let path = path.display().to_string();
            LogWarning::RateTaken { path, name, rate_hz }
        }));
        let no_rate = told.is_none().then(|| {
            let names = guess.iter().chain(columns.iter().map(|column| &column.name));
            let names: Vec<&str> = names.map(String::as_str).collect();
            no_rate(path, &names, &first_rows, args.names)
        });
        drop(first_rows);
        let rate_hz = told.unwrap_or(1.0);
        let mut of_file = warnings;
        let finish = |mut column: RawColumn| {
            // warnings about the file are given once, with its first column
            column.warnings.splice(..0, of_file.drain(..));
            Ok(Column { skipped_s, start_s, ..column.finish(path, rate_hz, &lost, args)? })
        };
        let mut columns = columns.into_iter().map(finish).collect::<Result<Vec<_>>>()?;
        unsigned::unwrap_others(path, &mut columns);
        Ok((columns, no_rate))
    }
}

/// The error for times that cannot be put in order. For two logs in one file, it states where the first ends.
fn disordered(
    (path, name): (&Path, &str),
    times: &Times,
    unit: Option<TimeUnit>,
    why: &str,
    names: Names,
) -> LogError {
    let [rate, until, only] = [Setting::Rate, Setting::Until, Setting::Where].map(|setting| names.of(setting));
    let rows = times.since_first();
    let falls = rows.windows(2).filter(|pair| pair[1] < pair[0]).count();
    let remedy = match lost_digits::reason(times, unit) {
        Some(seen) => format!("{seen}; export again with all digits, or give {rate}"),
        None if 10 * falls >= 9 * (rows.len() - 1) => format!("{why}: the newest row is first; reverse the rows"),
        None if why.ends_with(order::UNSORTED) => format!("{why}; sort them, or give {rate} and no time column"),
        None => {
            let end_s = unit.and_then(|unit| times.end_of_first_s(unit));
            let cut = end_s.map(|end_s| format!("{until} {end_s} reads the first"));
            let cut = cut.unwrap_or_else(|| "cut the log there".to_owned());
            format!(
                "{why} (two logs in one file, or a clock that was set? {cut}; {only}, if a column tells sensors \
                 apart; or give {rate} and no time column if the samples are evenly spaced all the same)"
            )
        }
    };
    LogError::Refused("times-disordered", format!("{}, column {name}: {remedy}", path.display()))
}

impl RawColumn {
    fn finish(self, path: &Path, rate_hz: f64, lost: &[Gap], args: &ColumnOptions) -> Result<Column> {
        let Self { name, values, stated, step, is_scaled, is_lettered, mut warnings, .. } = self;
        let of_name = Quantity::of_column(&name).filter(|_| !is_lettered);
        let (mut series, gaps) = values.finish(lost).map_err(|missing| too_many(path, missing, args.names))?;
        warnings.extend(unsigned::unwrap(&mut series).map(|bits| {
            let (path, column) = (path.display().to_string(), name.clone());
            LogWarning::CodesUnsigned { path, column, bits }
        }));
        let taken = Unit::taken_by_words(&name).filter(|_| stated.is_none() && args.unit.is_none());
        warnings.extend(taken.map(|unit| LogWarning::of_ros(path, unit)));
        let stated = stated.or(of_name);
        if let Some(unit) = args.unit.filter(|_| !is_lettered) {
            args.agrees(path, &name, unit, Setting::Unit)?;
        }
        let given = args.unit.map(|unit| (unit.quantity(), unit.in_results() * step));
        let declared = match args.scale {
            None => given.or(stated),
            Some(scale) => {
                // a capture states a scale of its codes, and not a unit
                let of_file = stated.map(|(quantity, per_step)| match &series {
                    Series::Codes(_) if step == 1.0 => (quantity, 1.0),
                    _ => (quantity, per_step / step),
                });
                let given = args.unit.map(|unit| (unit.quantity(), unit.in_results()));
                let unit = given.or(of_name).or(of_file);
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
            gaps,
            quantity: declared.map(|(quantity, _)| quantity),
            scale: declared.map_or(1.0, |(quantity, scale)| match quantity {
                Quantity::Temperature => scale,
                _ => scale * args.per_second(rate_hz),
            }),
            step,
            is_scaled,
            warnings,
            facts: Some(facts),
            ..Column::new(&name, series, rate_hz)
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::read_file;
    use zerorate_input::Quantity;

    #[test]
    fn a_letter_behind_the_axis_is_a_sensor_beside_the_other_letter() {
        let quantity = |head: &str, said: &str| read_file(format!("{head}\n1,2\n2,3\n"), said).unwrap().quantity;
        assert_eq!(quantity("x_g,x_a", "--rate 1 --column x_g"), None);
        assert_eq!(quantity("i.x_g,i.x_a", "--rate 1 --column i.x_g --unit dps"), Some(Quantity::AngularRate));
        for (head, column) in [("x_g,y_g", "x_g"), ("acc_x_g,acc_x_a", "acc_x_g"), ("ax_g,ax_a", "ax_g")] {
            assert_eq!(quantity(head, &format!("--rate 1 --column {column}")), Some(Quantity::Acceleration));
        }
    }
}
