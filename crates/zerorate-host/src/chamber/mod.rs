//! Temperature chambers: what `--chamber` names, and the [`Chamber`] behind it.

mod air;
mod apart;
mod lines;
mod simulated;

pub(crate) use air::Follower;
pub use air::{Air, Lead};
pub use apart::Apart;
pub use lines::{DIALECTS, Dialect};
pub use simulated::SimulatedChamber;

use crate::Result;
use crate::options::{number, split};
use lines::{LineAddress, Lines};
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// A temperature chamber.
pub trait Chamber: Send {
    /// Sends its air to a temperature, °C.
    ///
    /// # Errors
    /// It cannot be told, nor told again within the patience that it was opened with.
    fn set(&mut self, temp_c: f64) -> Result<()>;

    /// The temperature of its air, °C; none where it does not tell.
    ///
    /// # Errors
    /// As [`Chamber::set`].
    fn read_c(&mut self) -> Result<Option<f64>>;

    /// Simulated time goes on.
    fn pass(&mut self, _seconds: f64) {}

    /// Sends its air to a temperature where it may stay, °C, and stops what was started. To be tried once, however the
    /// measurement ended.
    ///
    /// # Errors
    /// It cannot be told.
    fn end(&mut self, safe_c: f64) -> Result<()>;
}

/// What `--chamber` names.
#[derive(Clone, Debug, PartialEq)]
pub enum ChamberSpec {
    /// Somebody turns its knobs.
    Hand,
    /// A simulated one, on simulated time.
    Simulated(SimulatedChamber),
    /// One that takes lines of text.
    Lines(LineAddress),
}

/// What there is.
const FORMS: &str = "hand, sim:KEY=VALUE,…, tcp:HOST:PORT?set=COMMANDS, serial:/dev/ttyUSB0?set=COMMANDS";

impl FromStr for ChamberSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "hand" => Ok(Self::Hand),
            Some(("sim", keys)) => SimulatedChamber::parse(keys).map(Self::Simulated),
            Some(("tcp", rest)) => LineAddress::parse(rest, false).map(Self::Lines),
            Some(("serial", rest)) => LineAddress::parse(rest, true).map(Self::Lines),
            _ => Err(format!("no such kind of chamber; there are {FORMS}")),
        }
    }
}

impl fmt::Display for ChamberSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hand => f.write_str("a chamber that is set by hand"),
            Self::Simulated(_) => f.write_str("a simulated chamber"),
            Self::Lines(address) => address.fmt(f),
        }
    }
}

impl ChamberSpec {
    /// Opens it; none where it is set by hand.
    ///
    /// # Errors
    /// It does not answer.
    pub fn open(&self) -> Result<Option<Box<dyn Chamber>>> {
        Ok(match self {
            Self::Hand => None,
            Self::Simulated(chamber) => Some(Box::new(chamber.clone())),
            Self::Lines(address) => Some(Box::new(Lines::open(address)?)),
        })
    }
}

/// An option of an address: a whole number of seconds.
fn patience(text: &str) -> Result<Duration, String> {
    number("patience_s", text, 0..=3600).map(|s| Duration::from_secs(s.into()))
}

/// Name and options of an address.
fn name_and_options(text: &str) -> (&str, Vec<(&str, &str)>) {
    let (name, options) = split(text);
    (name, options.map(|option| option.split_once('=').unwrap_or((option, ""))).collect())
}
