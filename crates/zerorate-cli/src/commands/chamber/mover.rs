//! What moves the air, and what becomes of it: however a measurement ends, the chamber is sent where it may stay, and
//! the user reads what it was left at.

use crate::output::say;
use crate::{interrupt, last_word};
use anyhow::Result;
use zerorate_host::{Apart, Chamber, ChamberSpec, Left};

/// The code of the warning about a chamber that may go on heating or cooling.
const CODE: &str = "chamber-left";

/// What moves the air.
pub enum By {
    /// A recording has decided that already.
    Nobody,
    /// Somebody at the knobs, who is told each step.
    Hand,
    /// A chamber.
    Chamber(Box<dyn Chamber>),
}

/// What moves the air, until it is left. It is left at the latest when it is dropped.
pub struct Mover {
    pub by: By,
    /// What a real chamber is called.
    name: Option<String>,
    safe_c: f64,
    told_c: Option<f64>,
    is_left: bool,
}

impl Mover {
    /// Nothing is told or started by this.
    pub fn new(spec: Option<&ChamberSpec>, is_simulated: bool, safe_c: f64) -> Result<Self> {
        let by = match spec.map(|spec| spec.chamber(interrupt::stop())) {
            None => By::Nobody,
            Some(None) => By::Hand,
            // nobody waits for a chamber while a part is read; a simulated part waits anyway
            Some(Some(chamber)) if is_simulated => By::Chamber(chamber),
            Some(Some(chamber)) => By::Chamber(Box::new(Apart::new(chamber)?)),
        };
        let name = spec.filter(|spec| matches!(spec, ChamberSpec::Lines(_))).map(ToString::to_string);
        Ok(Self { by, name, safe_c, told_c: None, is_left: false })
    }

    /// Sets it going.
    pub fn start(&mut self) -> Result<()> {
        self.owe();
        match &mut self.by {
            By::Chamber(chamber) => Ok(chamber.start()?),
            By::Nobody | By::Hand => Ok(()),
        }
    }

    /// The set point that it was told last, °C.
    pub fn told_c(&self) -> Option<f64> {
        self.told_c
    }

    /// Sends a chamber's air to a temperature, °C.
    pub fn set(&mut self, temp_c: f64) -> Result<()> {
        let By::Chamber(chamber) = &mut self.by else { return Ok(()) };
        chamber.set(temp_c)?;
        self.told_c = Some(temp_c);
        self.owe();
        Ok(())
    }

    /// What is said if the program ends before the chamber is left.
    fn owe(&self) {
        match (&self.by, &self.name) {
            (By::Hand, _) => last_word::owe(self.by_hand()),
            (_, Some(name)) => last_word::owe(format!(
                "warning: {CODE}: the program ended before {name} was sent to {:.1} °C{}: switch it off by hand",
                self.safe_c,
                self.told()
            )),
            _ => {}
        }
    }

    /// Sends it where it may stay, once, and settles what is said last.
    pub fn leave(&mut self) {
        if std::mem::replace(&mut self.is_left, true) {
            return;
        }
        let by_hand = self.by_hand();
        let word = match &mut self.by {
            By::Nobody => None,
            By::Hand => Some(by_hand),
            By::Chamber(chamber) => {
                if interrupt::asked() && self.name.is_some() {
                    say(format_args!("sending the chamber to {:.1} °C; Ctrl-C again ends at once", self.safe_c));
                }
                let left = chamber.end(self.safe_c);
                left.map(|left| self.word(&left))
            }
        };
        last_word::settle(word);
    }

    fn by_hand(&self) -> String {
        format!("set the chamber to {:.1} °C, or switch it off", self.safe_c)
    }

    fn told(&self) -> String {
        self.told_c.map_or(String::new(), |told_c| format!("; it was last told {told_c:.1} °C"))
    }

    /// What a chamber was left at.
    fn word(&self, left: &Left) -> String {
        let Left { set_c, is_stopped, air_c, why } = left;
        let (safe_c, name) = (self.safe_c, self.name.as_deref().unwrap_or("the chamber"));
        let air = air_c.map_or(String::new(), |air_c| format!("; its air is at {air_c:.1} °C"));
        let why = why.as_ref().map_or(String::new(), |why| format!(" ({why})"));
        match (left.holds(safe_c), is_stopped) {
            (true, true) => format!("{name} was left at {safe_c:.1} °C and stopped{air}"),
            (true, false) => format!("{name} was left at {safe_c:.1} °C{why}{air}"),
            (false, true) => format!("{name} was stopped, but did not take {safe_c:.1} °C{why}{air}"),
            (false, false) => {
                let does = match set_c {
                    Some(set_c) => format!("and holds {set_c:.1} °C"),
                    None => format!("and nobody knows what it does{}", self.told()),
                };
                format!(
                    "warning: {CODE}: the chamber could not be sent to {safe_c:.1} °C {does}: switch it off by \
                     hand{why}{air}"
                )
            }
        }
    }
}

impl Drop for Mover {
    fn drop(&mut self) {
        self.leave();
        // nobody else will say it
        if std::thread::panicking() {
            last_word::say_after(|| ());
        }
    }
}
