//! Options for records in which the temperature changed.

use crate::column::flag;
use crate::exit::Usage;
use clap::Args;
use zerorate_allan::MOST_ORDER;
use zerorate_imu::Detrending;
use zerorate_logs::Names;

/// Options for a sensor that was warming.
#[derive(Args, Clone, Debug)]
pub struct TemperatureArgs {
    /// Remove a polynomial over temperature first, by least squares: of order 1, or up to 3 as in temp:2. Noise that
    /// it may have removed widens the intervals of long averages and of K.
    #[arg(long, value_name = "temp[:ORDER]", value_parser = order, help_heading = "Temperature")]
    detrend: Option<usize>,

    /// The column with the temperature [default: temp_code of a capture, else temp, temp_c or temperature].
    #[arg(long, value_name = "NAME", help_heading = "Temperature")]
    pub temp_column: Option<String>,
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
    pub fn detrending(&self) -> Detrending {
        Detrending { order: self.detrend, names: Names(flag) }
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
