//! The state in which a chamber is left: the last line that the user reads, however the program ends.

use crate::last_word;
use crate::output::say;
use crate::wording::coded;
use zerorate_host::Left;
use zerorate_jobs::JobWarning;
use zerorate_jobs::chamber::{AirListener, AirState};

/// Keeps the last word.
pub struct LastWord;

impl AirListener for LastWord {
    fn owe(&self, air: &AirState) {
        last_word::owe(match &air.name {
            None => by_hand(air),
            Some(name) => warning(format!(
                "the program ended before {name} was sent to {:.1} °C{}: switch it off by hand",
                air.safe_c,
                told(air)
            )),
        });
    }

    fn leaving(&self, air: &AirState) {
        say(format_args!("sending the chamber to {:.1} °C; Ctrl-C again ends at once", air.safe_c));
    }

    fn settle(&self, air: Option<(&AirState, Option<&Left>)>) {
        last_word::settle(air.map(|(air, left)| left.map_or_else(|| by_hand(air), |left| word(air, left))));
    }
}

impl Drop for LastWord {
    /// Says the word after a panic, since nothing else will.
    fn drop(&mut self) {
        if std::thread::panicking() {
            last_word::say_after(|| ());
        }
    }
}

fn by_hand(air: &AirState) -> String {
    format!("set the chamber to {:.1} °C, or switch it off", air.safe_c)
}

fn told(air: &AirState) -> String {
    air.told_c.map_or(String::new(), |told_c| format!("; it was last told {told_c:.1} °C"))
}

/// Says in which state a chamber was left.
fn word(state: &AirState, left: &Left) -> String {
    let Left { set_c, is_stopped, air_c, why } = left;
    let (safe_c, name) = (state.safe_c, state.name.as_deref().unwrap_or("the chamber"));
    let air = air_c.map_or(String::new(), |air_c| format!("; its air is at {air_c:.1} °C"));
    let why = why.as_ref().map_or(String::new(), |why| format!(" ({why})"));
    match (left.holds(safe_c), is_stopped) {
        (true, true) => format!("{name} was left at {safe_c:.1} °C and stopped{air}"),
        (true, false) => format!("{name} was left at {safe_c:.1} °C{why}{air}"),
        (false, true) => format!("{name} was stopped, but did not take {safe_c:.1} °C{why}{air}"),
        (false, false) => {
            let does = match set_c {
                Some(set_c) => format!("and holds {set_c:.1} °C"),
                None => format!("and nobody knows what it does{}", told(state)),
            };
            warning(format!("the chamber could not be sent to {safe_c:.1} °C {does}: switch it off by hand{why}{air}"))
        }
    }
}

fn warning(how: String) -> String {
    format!("warning: {}", coded(JobWarning::ChamberLeft(how)))
}
