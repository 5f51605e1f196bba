//! Temperature chambers: set by hand, simulated, or controlled by two shell commands of the user.

mod ambient;
mod commands;
mod shell;
mod simulated;
mod thread;

pub(crate) use ambient::ProfileFollower;
pub use ambient::{AmbientProfile, ProfileWriter};
pub use commands::ChamberCommands;
pub use simulated::SimulatedChamber;
pub use thread::ChamberThread;

use crate::{Result, Stop};
use commands::CommandedChamber;
use std::str::FromStr;

/// A temperature chamber. Call `start` once before `set`, `read_c` and `pass`, and `end` once after them.
pub trait Chamber: Send {
    /// Checks that the chamber responds, without changing its temperature.
    fn start(&mut self) -> Result<()> {
        Ok(())
    }

    /// Sets the temperature, °C. Afterwards [`Chamber::end`] must be called, even after an error, because the
    /// chamber may have followed a command that failed.
    ///
    /// # Errors
    /// Returns an error if the temperature cannot be set within the time for retries, or after a stop.
    fn set(&mut self, temp_c: f64) -> Result<()>;

    /// Reads the air temperature, °C; `None` if there is no new reading.
    ///
    /// # Errors
    /// Returns an error if the temperature cannot be read within the time for retries, or after a stop.
    fn read_c(&mut self) -> Result<Option<f64>>;

    /// Lets this many seconds of simulated time pass. Does nothing in a real chamber.
    fn pass(&mut self, _seconds: f64) {}

    /// A stop of this chamber alone. Once requested, it ends every wait except in [`Chamber::end`].
    fn halt(&self) -> Stop {
        Stop::default()
    }

    /// Sets the safe temperature, °C, whether or not the measurement succeeded. `None` for a simulated chamber, or if
    /// no temperature was set before: then a chamber with commands is left as it is. Takes about ten seconds at most.
    fn end(&mut self, safe_c: f64) -> Option<SafeEnd>;
}

/// The outcome of setting the safe temperature.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SafeEnd {
    /// The reason why the safe temperature could not be set; `None` if it was set.
    pub failed: Option<String>,
    /// The last reading of the air temperature, °C; `None` if there is none.
    pub air_c: Option<f64>,
}

/// A chamber, as the user specifies it.
#[derive(Clone, Debug, PartialEq)]
pub enum ChamberSpec {
    /// A person sets the chamber by hand.
    Hand,
    /// A simulated chamber, on simulated time.
    Simulated(SimulatedChamber),
    /// A chamber that the user's commands set and read.
    Commands(ChamberCommands),
}

impl FromStr for ChamberSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "hand" => Ok(Self::Hand),
            Some(("sim", keys)) => SimulatedChamber::parse(keys).map(Self::Simulated),
            _ => Err("no such kind of chamber; there are hand and sim:KEY=VALUE,…".to_owned()),
        }
    }
}

impl ChamberSpec {
    /// Makes the chamber without running a command. `None` if a person sets the chamber. Once `stop` is requested,
    /// only [`Chamber::end`] still waits.
    #[must_use]
    pub fn chamber(&self, stop: &Stop) -> Option<Box<dyn Chamber>> {
        match self {
            Self::Hand => None,
            Self::Simulated(chamber) => Some(Box::new(chamber.clone())),
            Self::Commands(commands) => Some(Box::new(CommandedChamber::new(commands, stop))),
        }
    }
}
