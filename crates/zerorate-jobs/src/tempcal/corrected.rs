//! Corrects the gyroscope in a log with a calibration that was made from logs of the same unit.

use super::{TempcalOptions, UnitLog, reading};
use crate::{InvalidOptions, JobWarning};
use anyhow::Result;
use std::io::{self, Write};
use zerorate::calibration::CalibratedAxis;
use zerorate::temperature::curve::MeansBuilder;
use zerorate::temperature::{FollowedTemperature, LagAndPlay, u_dps};
use zerorate::{Calibration, Corrector, CorrectorConfig};
use zerorate_imu::Kind;
use zerorate_logs::{Column, Quantity, Setting};
use zerorate_view::tempcal::{ImuColumns, axis_name, values};

/// A temperature counts for this time after it was read, s.
const HOLD_S: f64 = 60.0;
/// The correction of a lagging sensor may be off for this many lags after the start.
const LAGS: f64 = 3.0;
/// The error at the start is worth a warning if it exceeds this many standard uncertainties.
const WORTH: f64 = 2.0;

/// The gyroscope of a log with its corrected rates. Each sample has one temperature, and one rate of each axis.
pub struct CorrectedLog {
    rate_hz: f64,
    temps_c: Vec<f64>,
    axes: Vec<CorrectedAxis>,
    /// Warnings about the log, with their codes.
    pub notes: Vec<String>,
    /// Warnings about the correction.
    pub warnings: Vec<JobWarning>,
}

struct CorrectedAxis {
    name: String,
    rates_dps: Vec<f64>,
    corrected_dps: Vec<f64>,
}

impl CorrectedLog {
    /// Reads the axes of `calibration` from a log and corrects them. Columns that the options name stand for these
    /// axes in their order. The temperature follows with the lag and the play of each axis. At the start of the log
    /// and after rows without a temperature, the sensor counts as warmed through.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, lacks a temperature or axis, or has several IMUs with these axes.
    pub fn new(log: &UnitLog, options: &TempcalOptions, calibration: &Calibration) -> Result<Self> {
        let mut notes = Vec::new();
        let (imu, columns) = gyroscope(log, options, calibration, &mut notes)?;
        if let Some(column) = columns.iter().find(|column| column.name.contains("_corrected")) {
            let (path, name) = (log.path().display(), &column.name);
            return Err(InvalidOptions(format!("{path}: {name} is corrected already; take the rate before it")).into());
        }
        let (rate_hz, start_s) = (columns[0].rate_hz, columns[0].start_s);
        let mut axes = Vec::new();
        for column in columns {
            let (name, rates_dps) = (column.name.clone(), values(column, log.path())?);
            axes.push(CorrectedAxis { name, rates_dps, corrected_dps: Vec::new() });
        }
        let mut temps_c: Vec<f64> = imu.temps_of(axes[0].rates_dps.len(), rate_hz, start_s).collect();
        let missing = hold(&mut temps_c, rate_hz);
        if missing == temps_c.len() as u64 {
            return Err(InvalidOptions(format!("{} holds no temperature at all", log.path().display())).into());
        }
        let mut warnings: Vec<JobWarning> =
            (missing > 0).then_some(JobWarning::TemperatureMissing(missing)).into_iter().collect();
        let held_s = stuck_s(&axes[0].rates_dps, &temps_c, rate_hz);
        warnings.extend((held_s > 0.0).then_some(JobWarning::TemperatureHeld(held_s)));
        let (mut outside, mut at_start) = (None, None::<(f64, f64)>);
        for (axis, of) in axes.iter_mut().zip(&calibration.axes) {
            let applied = Applied { calibration, of, temps_c: &temps_c, rate_hz };
            let warning;
            (axis.corrected_dps, warning) = applied.to(&axis.rates_dps);
            outside = outside.or(warning);
            let off = applied.off_at_starts();
            at_start = at_start.filter(|most| off.is_none_or(|off| most.1 >= off.1)).or(off);
        }
        warnings.extend(at_start.map(|(for_s, most_dps)| JobWarning::LagAtStart { for_s, most_dps }));
        warnings.extend(outside);
        Ok(Self { rate_hz, temps_c, axes, notes, warnings })
    }

    /// The number of samples of each axis.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.temps_c.len()
    }

    /// Writes a table with the time since the first sample at the mean rate, the temperature, and the rates of each
    /// axis before and after the correction, °/s. A cell is empty where its value is missing.
    ///
    /// # Errors
    /// Returns the error of the writer.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "t_s,temp_c")?;
        for name in stems(self.axes.iter().map(|axis| &*axis.name).collect()) {
            write!(out, ",{name}_dps,{name}_corrected_dps")?;
        }
        for (row, temp_c) in self.temps_c.iter().enumerate() {
            write!(out, "\n{:.6}", row as f64 / self.rate_hz)?;
            let rates = self.axes.iter().flat_map(|axis| [axis.rates_dps.get(row), axis.corrected_dps.get(row)]);
            for (value, digits) in std::iter::once((Some(temp_c), 4)).chain(rates.map(|rate| (rate, 7))) {
                match value.filter(|value| value.is_finite()) {
                    Some(value) => write!(out, ",{value:.digits$}")?,
                    None => write!(out, ",")?,
                }
            }
        }
        writeln!(out)?;
        out.flush()
    }
}

/// Finds the IMU of the calibrated gyroscope, and its columns in the order of the calibration.
fn gyroscope(
    log: &UnitLog,
    options: &TempcalOptions,
    calibration: &Calibration,
    notes: &mut Vec<String>,
) -> Result<(ImuColumns, Vec<Column>)> {
    let names: Vec<&str> = calibration.axes.iter().map(|axis| axis.name.as_str()).collect();
    let is_gyroscope = |column: &Column| column.quantity.and_then(Kind::of) == Some(Kind::Gyroscope);
    let (mut found, mut others) = (Vec::new(), Vec::new());
    for mut imu in reading::imus(log, options, notes)? {
        let columns: Vec<Column> = std::mem::take(&mut imu.columns).into_iter().filter(is_gyroscope).collect();
        others.extend(columns.iter().map(|column| column.name.clone()));
        let named = |name: &&str| columns.iter().find(|column| axis_name(&column.name) == **name).cloned();
        let in_order = !options.axes.gyro.columns.is_empty() && columns.len() == names.len();
        let axes: Vec<Column> = if in_order { columns } else { names.iter().filter_map(named).collect() };
        found.extend((axes.len() == names.len()).then_some((imu, axes)));
    }
    let path = log.path().display();
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => Err(InvalidOptions(format!(
            "{path} lacks axes of the calibration, {}; its gyroscope has {}. Name the columns of these axes with \
             --gyro, in the same order",
            names.join(", "),
            others.join(", ")
        ))
        .into()),
        count => {
            let option = options.axes.log.names.of(Setting::Topic);
            Err(InvalidOptions(format!("{path} has {count} calibrated IMUs; choose one with {option}")).into())
        }
    }
}

/// Replaces each missing temperature by the last one of the minute before. Returns the number of those still missing.
fn hold(temps_c: &mut [f64], rate_hz: f64) -> u64 {
    let (mut last_c, mut left, mut missing) = (f64::NAN, 0, 0);
    for temp_c in temps_c {
        if temp_c.is_finite() {
            (last_c, left) = (*temp_c, (HOLD_S * rate_hz) as u64);
        } else if left > 0 {
            (*temp_c, left) = (last_c, left - 1);
        }
        missing += u64::from(!temp_c.is_finite());
    }
    missing
}

/// The total time for which the thermometer stuck, s, as `tempcal` finds it.
fn stuck_s(rates_dps: &[f64], temps_c: &[f64], rate_hz: f64) -> f64 {
    let mut means = MeansBuilder::new(rates_dps.len(), rate_hz);
    rates_dps.iter().zip(temps_c).for_each(|(rate_dps, temp_c)| means.push(*rate_dps, *temp_c));
    means.finish().thermometer().stuck_s
}

/// The correction of an axis, for the temperatures of a log.
struct Applied<'a> {
    calibration: &'a Calibration,
    of: &'a CalibratedAxis,
    temps_c: &'a [f64],
    rate_hz: f64,
}

impl Applied<'_> {
    /// The corrected rates, and a warning if a temperature lies outside the span of the calibration.
    fn to(&self, rates_dps: &[f64]) -> (Vec<f64>, Option<JobWarning>) {
        let following = self
            .of
            .curve
            .as_ref()
            .map_or_else(LagAndPlay::default, |curve| LagAndPlay { lag_s: curve.lag_s, play_c: curve.play_c });
        let config = CorrectorConfig { corrections: [self.of.correction], validity: self.calibration.validity };
        let (mut corrector, mut followed) = (Corrector::new(config), None);
        let of_row = |(row, (rate_dps, temp_c)): (usize, (&f64, &f64))| {
            if !temp_c.is_finite() {
                followed = None;
                return f64::NAN;
            }
            let at_s = row as f64 / self.rate_hz;
            let start = || FollowedTemperature::new(following, at_s, *temp_c);
            let followed_c = followed.get_or_insert_with(start).push(at_s, *temp_c);
            corrector.take(Some(*rate_dps), Some(followed_c)).rate_dps.unwrap_or(f64::NAN)
        };
        let corrected = rates_dps.iter().zip(self.temps_c).enumerate().map(of_row).collect();
        (corrected, corrector.warning().map(JobWarning::from))
    }

    /// The time for which the correction may be off after a start, s, and the largest error, °/s, if the temperature
    /// changed before as it does after. `None` without a lag, or if no error exceeds [`WORTH`] standard uncertainties.
    fn off_at_starts(&self) -> Option<(f64, f64)> {
        let curve = self.of.curve.as_ref().filter(|curve| curve.lag_s > 0.0)?;
        let ahead = ((curve.lag_s * self.rate_hz) as usize).max(1);
        let is_start = |row: &usize| *row == 0 || !self.temps_c[row - 1].is_finite();
        let starts = (0..self.temps_c.len()).filter(|row| self.temps_c[*row].is_finite()).filter(is_start);
        let off = |row: usize| {
            let (now_c, later_c) = (self.temps_c[row], *self.temps_c.get(row + ahead)?);
            let off_dps = (self.of.correction.at(now_c) - self.of.correction.at(2.0 * now_c - later_c)).abs();
            let u_dps = u_dps(&curve.covariance, now_c - self.of.correction.t3_c);
            (off_dps > WORTH * u_dps).then_some(off_dps)
        };
        let most_dps = starts.filter_map(off).reduce(f64::max)?;
        Some((LAGS * curve.lag_s, most_dps))
    }
}

/// The names of columns without the units that they state, unless two would then be alike.
fn stems(names: Vec<&str>) -> Vec<&str> {
    let stem = |name: &&'_ str| -> usize {
        let bracket = name.ends_with([']', ')']).then(|| name.rfind(['[', '('])).flatten();
        let unit = ["_mdps", "_dps", "_rad_s"].into_iter().find_map(|unit| Some(name.strip_suffix(unit)?.len()));
        bracket.filter(|at| *at > 0 && Quantity::of_column(name).is_some()).or(unit).unwrap_or(name.len())
    };
    let short: Vec<&str> = names.iter().map(|name| name[..stem(name)].trim_end()).collect();
    let is_unique = short.iter().enumerate().all(|(index, name)| !short[..index].contains(name));
    if is_unique { short } else { names }
}
