//! A chamber that is controlled by two shell commands of the user.

use super::{Chamber, SafeEnd, shell};
use crate::error::{Cause, UserError};
use crate::{DeviceError, Result, Stop};
use std::fmt;
use std::ops::RangeInclusive;
use std::thread;
use std::time::{Duration, Instant};

/// The commands that set and read a chamber, and the time for which a failed command is repeated.
#[derive(Clone, Debug, PartialEq)]
pub struct ChamberCommands {
    set: String,
    read: String,
    retry: Duration,
}

const PLACEHOLDER: &str = "{temp_c}";
/// Plausible readings of a chamber, °C. A reading outside of this range is an error.
const SENSIBLE_C: RangeInclusive<f64> = -273.0..=1000.0;
/// First wait before a retry. The wait doubles each time, up to [`LONGEST_WAIT`], or [`LONGEST_ENDING_WAIT`] in
/// [`Chamber::end`].
const FIRST_WAIT: Duration = Duration::from_millis(100);
const LONGEST_WAIT: Duration = Duration::from_secs(5);
const LONGEST_ENDING_WAIT: Duration = Duration::from_secs(1);
/// Longest sleep between two checks for a stop.
const SLICE: Duration = Duration::from_millis(50);

impl ChamberCommands {
    /// A chamber that two commands control. `set` contains `{temp_c}` in place of the temperature. `read` prints the
    /// air temperature, °C. [`Chamber::set`] and [`Chamber::read_c`] repeat a command that fails for the time `retry`.
    ///
    /// # Errors
    /// Returns an error if a command is empty, or if `set` does not contain `{temp_c}`.
    pub fn new(set: &str, read: &str, retry: Duration) -> Result<Self, String> {
        if !set.contains(PLACEHOLDER) {
            return Err(format!("`{set}` has no {PLACEHOLDER}; write it where the temperature goes"));
        }
        if read.trim().is_empty() {
            return Err("the command that reads the temperature is empty".to_owned());
        }
        Ok(Self { set: set.to_owned(), read: read.to_owned(), retry })
    }

    /// The command that sets a temperature, with one decimal, and never an exponent or a negative zero.
    fn set_to(&self, temp_c: f64) -> String {
        let tenths = (temp_c * 10.0).round() / 10.0 + 0.0;
        self.set.replace(PLACEHOLDER, &format!("{tenths:.1}"))
    }
}

struct Limits {
    command: Duration,
    /// Time limit of a command after a stop, and the least time of an attempt to set the safe temperature.
    grace: Duration,
    /// Time within which attempts to set the safe temperature begin.
    ending: Duration,
}

const LIMITS: Limits =
    Limits { command: Duration::from_secs(10), grace: Duration::from_secs(1), ending: Duration::from_secs(10) };

pub(super) struct CommandedChamber {
    commands: ChamberCommands,
    limits: Limits,
    /// The stop of the user, and the stop of this chamber alone ([`Chamber::halt`]). Either one ends every wait,
    /// except in [`Chamber::end`].
    stops: [Stop; 2],
    /// True if a set command was run. The chamber may have followed the command even if the command failed.
    is_touched: bool,
    air_c: Option<f64>,
}

fn failure(command: &str, why: impl fmt::Display) -> String {
    format!("`{command}`: {why}")
}

impl CommandedChamber {
    pub fn new(commands: &ChamberCommands, stop: &Stop) -> Self {
        let stops = [stop.clone(), Stop::default()];
        Self { commands: commands.clone(), limits: LIMITS, stops, is_touched: false, air_c: None }
    }

    fn run(&self, command: &str) -> Result<String, String> {
        let Self { stops, limits, .. } = self;
        let (latest, mut stopped) = (Instant::now() + limits.command, None);
        let until = || match stops.iter().any(Stop::asked) {
            true => latest.min(*stopped.get_or_insert_with(Instant::now) + limits.grace),
            false => latest,
        };
        shell::first_line(command, until).map_err(|error| failure(command, error))
    }

    fn set_once(&mut self, temp_c: f64) -> Result<(), String> {
        self.is_touched = true;
        self.run(&self.commands.set_to(temp_c)).map(drop)
    }

    fn read_once(&mut self) -> Result<f64, String> {
        let command = &self.commands.read;
        let line = self.run(command)?;
        let number = line.parse().ok().filter(|temp_c| SENSIBLE_C.contains(temp_c));
        let air_c = number.ok_or_else(|| {
            failure(command, format_args!("its first line is {line:?}, and not a number in °C alone"))
        })?;
        self.air_c = Some(air_c);
        Ok(air_c)
    }

    fn retry<T>(&mut self, what: impl Fn(&mut Self) -> Result<T, String>) -> Result<T> {
        let (until, mut wait) = (Instant::now() + self.commands.retry, FIRST_WAIT);
        loop {
            self.heed()?;
            let done = what(self);
            self.heed()?;
            match done {
                Ok(done) => return Ok(done),
                Err(why) if Instant::now() + wait > until => return Err(self.lost(&why)),
                Err(_) => self.pause(wait)?,
            }
            wait = (wait * 2).min(LONGEST_WAIT);
        }
    }

    fn lost(&self, why: &str) -> DeviceError {
        let retry_s = self.commands.retry.as_secs();
        UserError::new(Cause::Gone, format!("the chamber failed, and again for {retry_s} s: {why}")).into()
    }

    /// Returns an error if a stop was requested.
    fn heed(&self) -> Result<()> {
        if self.stops.iter().any(Stop::asked) {
            return Err(UserError::new(Cause::Stopped, "stopped while the chamber was waited for").into());
        }
        Ok(())
    }

    fn pause(&self, wait: Duration) -> Result<()> {
        let until = Instant::now() + wait;
        loop {
            self.heed()?;
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(());
            }
            thread::sleep(left.min(SLICE));
        }
    }
}

impl Chamber for CommandedChamber {
    fn start(&mut self) -> Result<()> {
        let read = self.read_once();
        self.heed()?;
        read.map(drop).map_err(|why| {
            let words = format!("the chamber cannot be read: {why}; try the command by itself");
            UserError::new(Cause::Silent, words).into()
        })
    }

    fn set(&mut self, temp_c: f64) -> Result<()> {
        self.retry(|chamber| chamber.set_once(temp_c))
    }

    fn read_c(&mut self) -> Result<Option<f64>> {
        self.retry(Self::read_once).map(Some)
    }

    fn halt(&self) -> Stop {
        self.stops[1].clone()
    }

    fn end(&mut self, safe_c: f64) -> Option<SafeEnd> {
        if !self.is_touched {
            return None;
        }
        let (command, air_c) = (self.commands.set_to(safe_c), self.air_c);
        let (until, mut wait) = (Instant::now() + self.limits.ending, FIRST_WAIT);
        loop {
            // the last attempt also gets the time `grace`
            let latest = until.max(Instant::now() + self.limits.grace);
            let failed = shell::first_line(&command, || latest).err().map(|error| failure(&command, error));
            if failed.is_none() || Instant::now() + wait >= until {
                return Some(SafeEnd { failed, air_c });
            }
            thread::sleep(wait);
            wait = (wait * 2).min(LONGEST_ENDING_WAIT);
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;

    const MOST: Duration = Duration::from_secs(60);
    const SHORT: Limits = Limits {
        command: Duration::from_millis(50),
        grace: Duration::from_millis(50),
        ending: Duration::from_millis(200),
    };

    fn chamber(set: &str, read: &str, retry: Duration) -> CommandedChamber {
        CommandedChamber::new(&ChamberCommands::new(set, read, retry).expect("commands"), &Stop::default())
    }

    fn words(error: DeviceError) -> (Cause, String) {
        (error.cause(), format!("{:#}", anyhow::Error::from(error)))
    }

    #[test]
    fn commands_that_cannot_work_are_refused() {
        let refused = |set, read| ChamberCommands::new(set, read, MOST).expect_err("it cannot work");
        assert!(refused("set.sh", "read.sh").contains("`set.sh` has no {temp_c}"));
        assert!(refused("set.sh {temp_c}", " ").contains("reads the temperature is empty"));
    }

    #[test]
    fn a_temperature_is_a_plain_number_with_one_decimal() {
        let commands = ChamberCommands::new("a {temp_c} ${B} {temp_c}", "read", MOST).expect("commands");
        for (temp_c, shown) in [(85.0, "85.0"), (-40.06, "-40.1"), (-0.04, "0.0"), (250.0, "250.0")] {
            assert_eq!(commands.set_to(temp_c), format!("a {shown} ${{B}} {shown}"));
        }
    }

    #[test]
    fn only_a_bare_number_is_a_temperature() {
        for printed in ["23.4 C", "", "nan", "inf", "1e9", "23,4", "set: 23.4"] {
            let mut chamber = chamber("true {temp_c}", &format!("echo '{printed}'"), Duration::ZERO);
            let (_, why) = words(chamber.start().expect_err("no number"));
            assert!(why.contains(&format!("its first line is {printed:?}, and not a number")), "{why}");
            assert!(chamber.read_c().is_err());
        }
    }

    #[test]
    fn a_command_that_hangs_is_killed_and_counts_as_failed() {
        let mut chamber = chamber("sleep 600 # {temp_c}", "sleep 600", Duration::ZERO);
        chamber.limits = SHORT;
        assert!(words(chamber.read_c().expect_err("it hangs")).1.contains("it did not end within"));
        assert!(words(chamber.set(60.0).expect_err("it hangs")).1.contains("and was killed"));
        assert!(chamber.end(25.0).and_then(|end| end.failed).is_some_and(|why| why.contains("it did not end")));
    }

    /// The stop is requested while a command hangs, or while a failed command waits for its next try.
    #[test]
    fn a_stop_ends_every_wait_but_the_last_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("set_c");
        for read in ["sleep 600", "false"] {
            let mut chamber = chamber(&format!("echo {{temp_c}} > '{}'", file.display()), read, MOST);
            chamber.limits.grace = SHORT.grace;
            chamber.set(60.0).expect("it is set");
            let (halt, began) = (chamber.halt(), Instant::now());
            let asking = thread::spawn(move || {
                thread::sleep(Duration::from_millis(300));
                halt.ask();
            });
            assert_eq!(words(chamber.read_c().expect_err("it is stopped")).0, Cause::Stopped, "{read}");
            asking.join().expect("no panic");
            assert!(began.elapsed() < LIMITS.command, "{:?}", began.elapsed());
            assert_eq!(chamber.end(25.0), Some(SafeEnd { failed: None, air_c: None }));
            assert_eq!(fs::read_to_string(&file).expect("a file"), "25.0\n");
        }
    }
}
