//! Corrects the gyroscope in a log with a calibration that was made from logs of the same unit.

use super::{TempcalOptions, UnitLog, reading};
use crate::{InvalidOptions, JobWarning};
use anyhow::Result;
use std::io::{self, Write};
use zerorate::calibration::CalibratedAxis;
use zerorate::temperature::{FollowedTemperature, LagAndPlay};
use zerorate::{Calibration, Corrector, CorrectorConfig};
use zerorate_imu::Kind;
use zerorate_logs::{Column, Setting};
use zerorate_view::tempcal::{ImuColumns, axis_name, values};

/// The gyroscope of a log with its corrected rates. All lists are equally long.
pub struct CorrectedLog {
    rate_hz: f64,
    temps_c: Vec<f64>,
    axes: Vec<CorrectedAxis>,
    /// Warnings about the log, with their codes.
    pub notes: Vec<String>,
    /// A warning if a temperature lies outside the span of the calibration.
    pub outside: Option<JobWarning>,
}

struct CorrectedAxis {
    name: String,
    rates_dps: Vec<f64>,
    corrected_dps: Vec<f64>,
}

impl CorrectedLog {
    /// Reads the axes of `calibration` from a log and corrects them. The temperature is delayed by the lag of the
    /// calibration; at the start of the log, the sensor counts as warmed through.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, has no temperature, or has none of the axes or several IMUs with
    /// them.
    pub fn new(log: &UnitLog, options: &TempcalOptions, calibration: &Calibration) -> Result<Self> {
        let (mut notes, mut found) = (Vec::new(), Vec::new());
        for mut imu in reading::imus(log, options, &mut notes)? {
            let columns = std::mem::take(&mut imu.columns);
            let axes = columns.into_iter().filter_map(|column| Some((calibrated(&column, calibration)?, column)));
            let axes: Vec<_> = axes.collect();
            if !axes.is_empty() {
                found.push((imu, axes));
            }
        }
        let path = log.path().display();
        let (imu, axes) = match found.len() {
            1 => found.remove(0),
            0 => {
                let names: Vec<&str> = calibration.axes.iter().map(|axis| axis.name.as_str()).collect();
                let why =
                    format!("{path} has none of the gyroscope's axes that were calibrated: {}", names.join(", "));
                return Err(InvalidOptions(why).into());
            }
            count => {
                let option = options.axes.log.names.of(Setting::Topic);
                return Err(
                    InvalidOptions(format!("{path} has {count} calibrated IMUs; choose one with {option}")).into()
                );
            }
        };
        let rate_hz = axes[0].1.rate_hz;
        let mut corrected = Self { rate_hz, temps_c: Vec::new(), axes: Vec::new(), notes, outside: None };
        for (axis, column) in axes {
            corrected.push(log, &imu, (axis, column), calibration)?;
        }
        Ok(corrected)
    }

    fn push(
        &mut self,
        log: &UnitLog,
        imu: &ImuColumns,
        (axis, column): (&CalibratedAxis, Column),
        calibration: &Calibration,
    ) -> Result<()> {
        let (name, rate_hz, start_s) = (column.name.clone(), column.rate_hz, column.start_s);
        let rates_dps = values(column, log.path())?;
        let temps_c: Vec<f64> = imu.temps_of(rates_dps.len(), rate_hz, start_s).collect();
        let (corrected_dps, warning) = correct((&rates_dps, &temps_c, rate_hz), axis, calibration);
        self.outside = self.outside.take().or(warning);
        self.temps_c = temps_c;
        self.axes.push(CorrectedAxis { name, rates_dps, corrected_dps });
        Ok(())
    }

    /// The number of samples of each axis.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.temps_c.len()
    }

    /// Writes a table with the time since the first sample, the temperature, and the rates of each axis before and
    /// after the correction, °/s. A cell is empty where the rate or every temperature before it is missing.
    ///
    /// # Errors
    /// Returns the error of the writer.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "t_s,temp_c")?;
        for axis in &self.axes {
            let stem = stem(&axis.name);
            write!(out, ",{stem}_dps,{stem}_corrected_dps")?;
        }
        for (row, temp_c) in self.temps_c.iter().enumerate() {
            write!(out, "\n{:.6}", row as f64 / self.rate_hz)?;
            let rates = self.axes.iter().flat_map(|axis| [axis.rates_dps[row], axis.corrected_dps[row]]);
            for (value, digits) in std::iter::once((*temp_c, 4)).chain(rates.map(|rate| (rate, 7))) {
                match value.is_finite() {
                    true => write!(out, ",{value:.digits$}")?,
                    false => write!(out, ",")?,
                }
            }
        }
        writeln!(out)?;
        out.flush()
    }
}

/// The axis of the calibration that was made from this column.
fn calibrated<'a>(column: &Column, calibration: &'a Calibration) -> Option<&'a CalibratedAxis> {
    let is_gyroscope = column.quantity.and_then(Kind::of) == Some(Kind::Gyroscope);
    calibration.axis(&axis_name(&column.name)).filter(|_| is_gyroscope)
}

/// Corrects the rates of an axis, and warns if a temperature lies outside the span of the calibration. A missing
/// temperature is replaced by the last one before it.
fn correct(
    (rates_dps, temps_c, rate_hz): (&[f64], &[f64], f64),
    axis: &CalibratedAxis,
    calibration: &Calibration,
) -> (Vec<f64>, Option<JobWarning>) {
    let following = axis
        .curve
        .as_ref()
        .map_or_else(LagAndPlay::default, |curve| LagAndPlay { lag_s: curve.lag_s, play_c: curve.play_c });
    let config = CorrectorConfig { corrections: [axis.correction], validity: calibration.validity };
    let (mut corrector, mut followed) = (Corrector::new(config), None);
    let of_row = |(row, (rate_dps, temp_c)): (usize, (&f64, &f64))| {
        let at_s = row as f64 / rate_hz;
        let read_c = temp_c.is_finite().then(|| {
            let start = || FollowedTemperature::new(following, at_s, *temp_c);
            followed.get_or_insert_with(start).push(at_s, *temp_c)
        });
        corrector.take(Some(*rate_dps), read_c).rate_dps.unwrap_or(f64::NAN)
    };
    let corrected = rates_dps.iter().zip(temps_c).enumerate().map(of_row).collect();
    (corrected, corrector.warning().map(JobWarning::from))
}

/// The name of a column without the unit that it states.
fn stem(name: &str) -> &str {
    let name = name.split(['[', '(']).next().unwrap_or_default().trim_end();
    name.strip_suffix("_dps").or(name.strip_suffix("_rad_s")).unwrap_or(name)
}
