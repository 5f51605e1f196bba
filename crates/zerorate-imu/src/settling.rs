//! Preparation of a column before the analysis: its temperature and its beginning.

use crate::span;
use std::path::Path;
use zerorate_allan::{AllanWarning, DetrendError, Follows, Preparation, detrend, follows_temperature};
use zerorate_logs::{Column, LogError, Names, Series, Setting};

/// Preparation of a record before the analysis.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settling {
    /// Time left out at its beginning, s.
    pub skip_s: f64,
    /// Order of the polynomial over temperature that is taken out; none: nothing is.
    pub order: Option<usize>,
    /// The names of these options in messages.
    pub names: Names,
}

/// Why it cannot be done.
#[derive(Debug, thiserror::Error)]
pub enum SettlingError {
    /// Nothing would be left of the record.
    #[error("{0}")]
    NothingLeft(String),
    /// The polynomial cannot be found, for this column and this temperature.
    #[error("{0}: {1}")]
    Detrend(String, DetrendError),
    /// The column cannot be written out.
    #[error(transparent)]
    Log(#[from] LogError),
}

impl Settling {
    /// Does it to a column of `file`, whose temperature is another column.
    ///
    /// # Errors
    /// Returns an error if nothing would be left, or the temperature does not fit.
    pub fn apply(
        &self,
        column: &mut Column,
        file: &Path,
        temperature: Option<&Column>,
    ) -> Result<Preparation, SettlingError> {
        let skipped_s = self.skip(column, file)?;
        let Some(temperature) = temperature.filter(|temperature| temperature.name != column.name) else {
            return Ok(Preparation { skipped_s, ..Preparation::default() });
        };
        let rates = match column.points(file) {
            // so many are lost that the record cannot be written out; nothing was asked that needs it
            Err(_) if self.order.is_none() => return Ok(Preparation { skipped_s, ..Preparation::default() }),
            rates => rates?,
        };
        let mut temps = temperature.points(file)?;
        temps.iter_mut().for_each(|temp| *temp *= temperature.scale);
        // what was skipped of a gap is not in the column
        let temps = &temps[temps.len().saturating_sub(rates.len())..];
        let Some(order) = self.order else {
            return Ok(Preparation {
                follows: follows(&rates, temps, column.scale),
                skipped_s,
                ..Preparation::default()
            });
        };
        let of_columns = || {
            let setting = self.names.of(Setting::Detrend);
            format!("{setting}: {}, columns {} and {}", file.display(), column.name, temperature.name)
        };
        let mut detrended = detrend(&rates, temps, order).map_err(|why| SettlingError::Detrend(of_columns(), why))?;
        column.replace(Series::Numbers(std::mem::take(&mut detrended.residual)));
        detrended.coefficients.iter_mut().for_each(|coefficient| *coefficient *= column.scale);
        Ok(Preparation { detrended: Some(detrended), follows: None, skipped_s })
    }

    /// Leaves the beginning out. Returns how long it was, s.
    fn skip(&self, column: &mut Column, file: &Path) -> Result<f64, SettlingError> {
        let samples = (self.skip_s * column.rate_hz).round() as u64;
        if samples > 0 {
            let whole = column.points(file)?.len() as u64;
            if samples >= whole {
                let (length, setting) = (span(whole as f64 / column.rate_hz), self.names.of(Setting::Skip));
                let why = format!("{setting} leaves nothing of {}, which is {length} long", file.display());
                return Err(SettlingError::NothingLeft(why));
            }
            column.skip(samples);
        }
        Ok(samples as f64 / column.rate_hz)
    }
}

fn follows(rates: &[f64], temps: &[f64], scale: f64) -> Option<AllanWarning> {
    let Follows { explained, slope_per_c, span_c } = follows_temperature(rates, temps)?;
    Some(AllanWarning::FollowsTemperature { explained, slope: slope_per_c * scale, span_c })
}
