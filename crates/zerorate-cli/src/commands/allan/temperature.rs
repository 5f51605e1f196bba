//! The influence of the temperature on a record: warned of, taken out, or skipped.

use super::units::{deviation_unit, span};
use crate::column::flag;
use crate::exit::Usage;
use clap::Args;
use serde::Serialize;
use zerorate_allan::{AllanWarning, MOST_ORDER};
use zerorate_imu::{Record, Settling};
use zerorate_logs::{LogWarning, Names};
use zerorate_view::duration::Seconds;

/// Options for a sensor that was warming.
#[derive(Args, Debug)]
pub struct TemperatureArgs {
    /// Remove a polynomial over temperature first, by least squares: of order 1, or up to 3 as in temp:2. Noise that
    /// it may have removed widens the intervals of long averages and of K.
    #[arg(long, value_name = "temp[:ORDER]", value_parser = order)]
    detrend: Option<usize>,

    /// The column with the temperature [default: temp_code of a capture, else temp, temp_c or temperature].
    #[arg(long, value_name = "NAME")]
    pub temp_column: Option<String>,

    /// Leave out the beginning while the sensor warms, such as 45m.
    #[arg(long, value_name = "TIME")]
    skip: Option<Seconds>,
}

fn order(text: &str) -> Result<usize, String> {
    let order = match text.split_once(':') {
        None if text == "temp" => Some(1),
        Some(("temp", order)) => order.parse().ok().filter(|order| (1..=MOST_ORDER).contains(order)),
        _ => None,
    };
    order.ok_or_else(|| "must be temp, temp:2 or temp:3".to_owned())
}

impl TemperatureArgs {
    pub fn settling(&self) -> Settling {
        Settling { skip_s: self.skip.map_or(0.0, |skip| skip.0), order: self.detrend, names: Names(flag) }
    }

    pub fn check(&self, is_pooled: bool, is_phase: bool) -> Result<(), Usage> {
        match self.detrend {
            Some(_) if is_pooled => Err(Usage(
                "--detrend and --pool exclude each other: the common model cannot tell what the polynomials removed \
                 from each record"
                    .to_owned(),
            )),
            Some(_) if is_phase => Err(Usage("--detrend works on a rate, not on --data phase".to_owned())),
            _ => Ok(()),
        }
    }
}

/// The warnings about a record, those about the log first.
pub fn warnings(record: &Record) -> Vec<String> {
    record.notes.iter().map(LogWarning::coded).chain(record.of_noise().map(text)).collect()
}

/// Formats a warning, with the options that help.
pub fn text(warning: &AllanWarning) -> String {
    let help = match warning {
        AllanWarning::FollowsTemperature { .. } => " (--detrend temp, --skip 45m)",
        _ => "",
    };
    format!("{}: {warning}{help}", warning.code())
}

/// Says what was done to the record, a line each.
pub fn said(record: &Record) -> Vec<String> {
    let skipped = (record.skipped_s > 0.0).then(|| format!("without the first {}", span(record.skipped_s)));
    let unit = deviation_unit(record).unwrap_or("");
    let detrended = record.detrended.as_ref().map(|detrended| {
        let terms = detrended.coefficients.iter().zip(["/°C", "/°C²", "/°C³"]);
        let terms = terms.map(|(value, per)| format!("{value:.4e} {unit}{per}")).collect::<Vec<_>>().join(", ");
        format!(
            "less a polynomial of order {} over temperature ({METHOD}): {terms}; it explains {:.1} % of the slow \
             variance and took {} of the degrees of freedom. Of a random walk {:.0} % are left, so K is stated \
             with what was lost, and long averages with fewer degrees of freedom",
            detrended.lost_dof,
            detrended.explained * 100.0,
            detrended.lost_dof,
            detrended.walk_kept() * 100.0
        )
    });
    skipped.into_iter().chain(detrended).collect()
}

const METHOD: &str = "least squares over means of 128 parts";

/// The polynomial, for scripts.
#[derive(Serialize)]
pub struct Json {
    over: &'static str,
    order: usize,
    method: &'static str,
    /// In the unit of the rate per °C, °C², °C³, about `mean_c`.
    coefficients: Vec<f64>,
    mean_c: f64,
    explained: f64,
    lost_dof: usize,
    /// Share of the variance of a random walk that is left.
    walk_kept: f64,
}

pub fn json(record: &Record) -> Option<Json> {
    let detrended = record.detrended.as_ref()?;
    Some(Json {
        over: "temperature",
        order: detrended.lost_dof,
        method: METHOD,
        coefficients: detrended.coefficients.clone(),
        mean_c: detrended.mean_c,
        explained: detrended.explained,
        lost_dof: detrended.lost_dof,
        walk_kept: detrended.walk_kept(),
    })
}
