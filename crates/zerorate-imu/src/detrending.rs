//! Preparation of a column before the analysis: its temperature.

use std::path::Path;
use zerorate_allan::{AllanWarning, DetrendError, Follows, Preparation, detrend, follows_temperature};
use zerorate_logs::{Column, LogError, Names, Series, Setting};

/// The removal of what follows the temperature.
#[derive(Clone, Copy, Debug, Default)]
pub struct Detrending {
    /// Order of the polynomial over temperature that is taken out; none: nothing is.
    pub order: Option<usize>,
    /// The names of these options in messages.
    pub names: Names,
}

/// Why it cannot be done.
#[derive(Debug, thiserror::Error)]
pub enum DetrendingError {
    /// The polynomial cannot be found, for this column and this temperature.
    #[error("{0}: {1}")]
    Detrend(String, DetrendError),
    /// The column cannot be written out.
    #[error(transparent)]
    Log(#[from] LogError),
}

impl Detrending {
    /// Removes it from a column of `file`, whose temperature is another column.
    ///
    /// # Errors
    /// Returns an error if the temperature does not fit.
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
            // so many are lost that the record cannot be written out; nothing was asked that needs it
            Err(_) if self.order.is_none() => return Ok(Preparation::default()),
            rates => rates?,
        };
        let mut temps = temperature.points(file)?;
        temps.iter_mut().for_each(|temp| *temp *= temperature.scale);
        // samples that are missing at the start are not in the column
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
