//! Temperature chambers: what `--chamber` names, and the [`Chamber`] behind it.

mod air;
mod apart;
mod left;
mod lines;
mod simulated;

pub(crate) use air::Follower;
pub use air::{Air, Lead};
pub use apart::Apart;
pub use left::Left;
pub use lines::{DIALECTS, Dialect, ENDING_S};
pub use simulated::SimulatedChamber;

use crate::options::{number, split};
use crate::{Result, Stop};
use lines::{LineAddress, Lines};
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// A temperature chamber. It is started once and ended once.
pub trait Chamber: Send {
    /// Sets it going. From here on [`Chamber::end`] is due, even after an error: a command may be obeyed and its
    /// answer get lost.
    ///
    /// # Errors
    /// It does not answer.
    fn start(&mut self) -> Result<()> {
        Ok(())
    }

    /// Sends its air to a temperature, °C.
    ///
    /// # Errors
    /// It cannot be told, nor told again within the patience that it was opened with.
    fn set(&mut self, temp_c: f64) -> Result<()>;

    /// The temperature of its air, °C; none where it does not tell.
    ///
    /// # Errors
    /// Reads the temperature of the air, °C. Errors as for [`Chamber::set`].
    fn read_c(&mut self) -> Result<Option<f64>>;

    /// Simulated time goes on.
    fn pass(&mut self, _seconds: f64) {}

    /// A stop that, once it is asked, cuts short every wait of this chamber except [`Chamber::end`].
    fn halt(&self) -> Stop {
        Stop::default()
    }

    /// Sends its air to a temperature where it may stay, °C, and stops what was started, however the measurement
    /// ended. None where nothing was set going. Takes some [`ENDING_S`] seconds at most.
    fn end(&mut self, safe_c: f64) -> Option<Left>;
}

/// The chamber that `--chamber` names.
#[derive(Clone, Debug, PartialEq)]
pub enum ChamberSpec {
    /// Somebody turns its knobs.
    Hand,
    /// A simulated one, on simulated time.
    Simulated(SimulatedChamber),
    /// One that takes lines of text.
    Lines(LineAddress),
}

/// All forms of a chamber's name.
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
    /// The chamber, which nothing was said to so far; none where it is set by hand. Once `stop` is asked, it waits for
    /// nothing any more but in [`Chamber::end`].
    #[must_use]
    pub fn chamber(&self, stop: &Stop) -> Option<Box<dyn Chamber>> {
        match self {
            Self::Hand => None,
            Self::Simulated(chamber) => Some(Box::new(chamber.clone())),
            Self::Lines(address) => Some(Box::new(Lines::new(address, stop))),
        }
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
