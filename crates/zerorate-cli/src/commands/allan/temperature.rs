//! What the temperature has to do with a record: warned of, taken out, or left out.

use super::record::Record;
use super::units::{deviation_unit, span};
use crate::exit::Usage;
use anyhow::{Context, Result, anyhow};
use clap::Args;
use serde::Serialize;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use zerorate_allan::{self as allan, AllanWarning, Analysis, Detrended, Fit, Follows, MOST_ORDER};
use zerorate_logs::{Column, Series};
use zerorate_view::duration::Seconds;

/// What to do about a part that was warming.
#[derive(Args, Debug)]
pub struct TemperatureArgs {
    /// Take a polynomial over temperature out before anything else, by least squares: of order 1, or as in temp:2 up
    /// to 3. What it may have taken of the noise widens the intervals of long averages and of K.
    #[arg(long, value_name = "temp[:ORDER]", value_parser = order)]
    detrend: Option<usize>,

    /// The column with the temperature [default: temp_code of a capture, else temp, temp_c or temperature].
    #[arg(long, value_name = "NAME")]
    temp_column: Option<String>,

    /// Leave out the beginning, while the part warms: 45m.
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

/// What logs call their temperature.
pub const NAMES: [&str; 4] = ["temp_code", "temp_c", "temp", "temperature"];
/// Bytes at both ends of a file in which columns name themselves.
const ENDS: u64 = 1 << 16;

impl TemperatureArgs {
    pub fn settling(&self) -> Settling {
        Settling { skip_s: self.skip.map_or(0.0, |skip| skip.0), order: self.detrend }
    }

    pub fn check(&self, is_pooled: bool, is_phase: bool) -> Result<(), Usage> {
        match self.detrend {
            Some(_) if is_pooled => Err(Usage(
                "--detrend and --pool: what the polynomials took of each record is not known of the common model; \
                 take one of them"
                    .to_owned(),
            )),
            Some(_) if is_phase => Err(Usage("--detrend is of a rate, not of --data phase".to_owned())),
            _ => Ok(()),
        }
    }

    /// The temperature of a log, read by its name: the one that was named, or, where the log seems to have one, by the
    /// usual names.
    pub fn read(&self, file: &Path, read: impl Fn(&[&str]) -> Option<Column>) -> Result<Option<Column>> {
        if let Some(name) = &self.temp_column {
            let column = read(&[name]).ok_or_else(|| {
                Usage(format!("--temp-column: {} has no column {name:?} of numbers", file.display()))
            })?;
            return Ok(Some(column));
        }
        let column = usual(file, read);
        if column.is_none() && self.detrend.is_some() {
            let file = file.display();
            let why = format!("--detrend: {file} has no column {}; name it by --temp-column", NAMES.join(", "));
            return Err(Usage(why).into());
        }
        Ok(column)
    }
}

/// The temperature of a log by the usual names, where the log seems to have one.
pub fn usual(file: &Path, read: impl Fn(&[&str]) -> Option<Column>) -> Option<Column> {
    if speaks_of_temperature(file) { read(&NAMES) } else { None }
}

/// Whether a file names something like a temperature near its beginning or its end, so that a second look is worth it.
/// What is piped in is not read twice.
fn speaks_of_temperature(file: &Path) -> bool {
    let ends = || -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut file = File::open(file)?;
        let len = file.metadata()?.len();
        file.by_ref().take(ENDS).read_to_end(&mut bytes)?;
        if len > 2 * ENDS {
            file.seek(SeekFrom::Start(len - ENDS))?;
            file.take(ENDS).read_to_end(&mut bytes)?;
        }
        Ok(bytes)
    };
    ends().is_ok_and(|bytes| bytes.windows(4).any(|word| word.eq_ignore_ascii_case(b"temp")))
}

/// What is done with a record before it is analysed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settling {
    /// What is left out at its beginning, s.
    pub skip_s: f64,
    /// Of the polynomial over temperature that is taken out.
    pub order: Option<usize>,
}

/// What came of it.
#[derive(Default)]
pub struct Settled {
    /// The polynomial that was taken out.
    pub detrended: Option<Detrended>,
    /// That the rate follows the temperature, where it does and nothing was taken out.
    pub follows: Option<AllanWarning>,
    /// What was left out, s.
    pub skipped_s: f64,
}

impl Settling {
    /// Does it to a column of `file`, whose temperature is another column.
    ///
    /// # Errors
    /// [`Usage`] where nothing would be left, or what does not fit.
    pub fn apply(&self, column: &mut Column, file: &Path, temperature: Option<&Column>) -> Result<Settled> {
        let samples = (self.skip_s * column.rate_hz).round() as u64;
        if samples > 0 {
            let whole = column.points(file)?.len() as u64;
            if samples >= whole {
                let length = span(whole as f64 / column.rate_hz);
                let why = format!("--skip leaves nothing of {}, which is {length} long", file.display());
                return Err(Usage(why).into());
            }
            column.skip(samples);
        }
        let skipped_s = samples as f64 / column.rate_hz;
        let Some(temperature) = temperature.filter(|temperature| temperature.name != column.name) else {
            return Ok(Settled { skipped_s, ..Settled::default() });
        };
        let rates = match column.points(file) {
            // so many are lost that the record cannot be written out; nothing was asked that needs it
            Err(_) if self.order.is_none() => return Ok(Settled { skipped_s, ..Settled::default() }),
            rates => rates?,
        };
        let mut temps = temperature.points(file)?;
        temps.iter_mut().for_each(|temp| *temp *= temperature.scale);
        // what was skipped of a gap is not in the column
        let temps = &temps[temps.len().saturating_sub(rates.len())..];
        let Some(order) = self.order else {
            return Ok(Settled { follows: follows(&rates, temps, column.scale), skipped_s, ..Settled::default() });
        };
        let mut detrended = allan::detrend(&rates, temps, order).map_err(|why| anyhow!(why)).with_context(|| {
            format!("--detrend: {}, columns {} and {}", file.display(), column.name, temperature.name)
        })?;
        column.series = Series::Numbers(std::mem::take(&mut detrended.residual));
        column.gaps.clear();
        detrended.coefficients.iter_mut().for_each(|coefficient| *coefficient *= column.scale);
        Ok(Settled { detrended: Some(detrended), follows: None, skipped_s })
    }
}

fn follows(rates: &[f64], temps: &[f64], scale: f64) -> Option<AllanWarning> {
    let Follows { explained, slope_per_c, span_c } = allan::follows_temperature(rates, temps)?;
    Some(AllanWarning::FollowsTemperature { explained, slope: slope_per_c * scale, span_c })
}

/// The deviations of what is left, as those of the noise.
pub fn widened(mut analysis: Analysis, detrended: Option<&Detrended>, confidence: f64) -> Analysis {
    if let Some(detrended) = detrended {
        analysis.points.iter_mut().for_each(|point| *point = detrended.widened(point, confidence));
    }
    analysis
}

/// What the temperature does to a model: it is warned of, or K is widened.
pub fn heed(fit: &mut Fit, detrended: Option<&Detrended>, follows: Option<AllanWarning>) {
    if let Some(detrended) = detrended {
        fit.k = detrended.widened_walk(&fit.k);
    }
    if let Some(follows) = follows {
        fit.warnings.insert(0, follows);
    }
}

/// A warning, with the options that help.
pub fn text(warning: &AllanWarning) -> String {
    let help = match warning {
        AllanWarning::FollowsTemperature { .. } => " (--detrend temp, --skip 45m)",
        _ => "",
    };
    format!("{}: {warning}{help}", warning.code())
}

/// What was done, a line each.
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
    /// Unit of the rate per °C, °C², °C³, about `mean_c`.
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
