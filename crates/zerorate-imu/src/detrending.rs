//! Preparation of a column before the analysis: the dependence on temperature is removed or detected.

use std::path::Path;
use zerorate_allan::{AllanWarning, DetrendError, Follows, Preparation, detrend, follows_temperature};
use zerorate_logs::{Column, LogError, Names, Series, Setting};

/// The settings for the removal of the dependence on temperature.
#[derive(Clone, Copy, Debug, Default)]
pub struct Detrending {
    /// Order of the polynomial over temperature to remove; `None` removes nothing.
    pub order: Option<usize>,
    /// The names of these options in messages.
    pub names: Names,
}

/// The reason why the dependence on temperature cannot be removed.
#[derive(Debug, thiserror::Error)]
pub enum DetrendingError {
    /// The polynomial cannot be fitted for this column and this temperature.
    #[error("{0}: {1}")]
    Detrend(String, DetrendError),
    /// The column cannot be expanded to evenly spaced samples.
    #[error(transparent)]
    Log(#[from] LogError),
}

impl Detrending {
    /// Removes the polynomial over `temperature` from a column of `file`; without an order, detects the dependence.
    /// Does nothing without a temperature from another column.
    ///
    /// # Errors
    /// Returns an error if the polynomial cannot be fitted, or if the temperature, or a column to remove it from,
    /// cannot be expanded.
    pub fn apply(
        &self,
        column: &mut Column,
        file: &Path,
        temperature: Option<&Column>,
    ) -> Result<Preparation, DetrendingError> {
        let Some(temperature) = temperature.filter(|temperature| temperature.name != column.name) else {
            return Ok(Preparation::default());
        };
        let rates = match column.points(file) {
            // too many samples are lost to expand the record, and no removal was requested
            Err(_) if self.order.is_none() => return Ok(Preparation::default()),
            rates => rates?,
        };
        let mut temps = temperature.points(file)?;
        temps.iter_mut().for_each(|temp| *temp *= temperature.scale);
        // the column begins with its first sample, so the temperatures before it are dropped
        let temps = &temps[temps.len().saturating_sub(rates.len())..];
        let Some(order) = self.order else {
            return Ok(Preparation { detrended: None, follows: follows(&rates, temps, column.scale) });
        };
        let of_columns = || {
            let setting = self.names.of(Setting::Detrend);
            format!("{setting}: {}, columns {} and {}", file.display(), column.name, temperature.name)
        };
        let mut detrended =
            detrend(&rates, temps, order).map_err(|why| DetrendingError::Detrend(of_columns(), why))?;
        column.replace(Series::Numbers(std::mem::take(&mut detrended.residual)));
        detrended.coefficients.iter_mut().for_each(|coefficient| *coefficient *= column.scale);
        Ok(Preparation { detrended: Some(detrended), follows: None })
    }
}

fn follows(rates: &[f64], temps: &[f64], scale: f64) -> Option<AllanWarning> {
    let Follows { explained, slope_per_c, span_c } = follows_temperature(rates, temps)?;
    Some(AllanWarning::FollowsTemperature { explained, slope: slope_per_c * scale, span_c })
}
