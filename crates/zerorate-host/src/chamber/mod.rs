//! Temperature chambers: set by hand, simulated, or controlled by two commands of the user.

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

/// A temperature chamber. It is started once and ended once.
pub trait Chamber: Send {
    /// Checks that the chamber answers. It does not change the temperature.
    ///
    /// # Errors
    /// Returns an error if the chamber does not answer.
    fn start(&mut self) -> Result<()> {
        Ok(())
    }

    /// Sets the temperature, °C. From here on [`Chamber::end`] must be called, even after an error: the chamber may
    /// have obeyed a command that failed.
    ///
    /// # Errors
    /// Returns an error if the temperature cannot be set within the time for retries.
    fn set(&mut self, temp_c: f64) -> Result<()>;

    /// Reads the temperature of the air, °C; `None` if there is no new reading.
    ///
    /// # Errors
    /// Returns an error if the temperature cannot be read within the time for retries.
    fn read_c(&mut self) -> Result<Option<f64>>;

    /// Lets simulated time pass.
    fn pass(&mut self, _seconds: f64) {}

    /// A stop that, once it is asked, cuts short every wait of this chamber except [`Chamber::end`].
    fn halt(&self) -> Stop {
        Stop::default()
    }

    /// Sets the temperature at which the chamber may stay, °C, however the measurement ended. `None` if no temperature
    /// was ever set. Takes some ten seconds at most.
    fn end(&mut self, safe_c: f64) -> Option<SafeEnd>;
}

/// The result of the last set point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SafeEnd {
    /// The reason why the chamber did not confirm the set point; `None` if it did.
    pub failed: Option<String>,
    /// The last reading of the air, °C.
    pub air_c: Option<f64>,
}

/// The control of a chamber.
#[derive(Clone, Debug, PartialEq)]
pub enum ChamberSpec {
    /// Somebody sets the chamber by hand.
    Hand,
    /// A simulated chamber, on simulated time.
    Simulated(SimulatedChamber),
    /// A chamber that commands of the user set and read.
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
    /// The chamber, before its first command; `None` if it is set by hand. After `stop` only [`Chamber::end`] waits.
    #[must_use]
    pub fn chamber(&self, stop: &Stop) -> Option<Box<dyn Chamber>> {
        match self {
            Self::Hand => None,
            Self::Simulated(chamber) => Some(Box::new(chamber.clone())),
            Self::Commands(commands) => Some(Box::new(CommandedChamber::new(commands, stop))),
        }
    }
}
