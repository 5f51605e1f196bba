//! The last line that the program prints, however it ends: how the chamber was left, or what the user must set.

use crate::exit_message;
use crate::output::say;
use crate::wording::coded;
use zerorate_host::SafeEnd;
use zerorate_jobs::JobWarning;
use zerorate_jobs::chamber::{AirListener, AirState};

/// Updates the exit message when the state of the chamber changes.
pub struct ExitMessage;

impl AirListener for ExitMessage {
    fn set_pending(&self, air: &AirState) {
        exit_message::set_pending(match air.by_hand {
            true => by_hand(air),
            false => warning(format!(
                "the program ended before the chamber was sent to {:.1} °C{}: switch it off by hand",
                air.safe_c,
                last_set(air)
            )),
        });
    }

    fn leaving(&self, air: &AirState) {
        say(format_args!("sending the chamber to {:.1} °C; Ctrl-C again ends at once", air.safe_c));
    }

    fn settle(&self, air: Option<(&AirState, Option<&SafeEnd>)>) {
        exit_message::settle(air.map(|(air, end)| end.map_or_else(|| by_hand(air), |end| ended(air, end))));
    }
}

impl Drop for ExitMessage {
    /// Prints the message after a panic, since nothing else prints it then.
    fn drop(&mut self) {
        if std::thread::panicking() {
            exit_message::say_after(|| ());
        }
    }
}

fn by_hand(air: &AirState) -> String {
    format!("set the chamber to {:.1} °C, or switch it off", air.safe_c)
}

fn last_set(air: &AirState) -> String {
    air.set_c.map_or(String::new(), |set_c| format!("; it was last set to {set_c:.1} °C"))
}

fn ended(state: &AirState, SafeEnd { failed, air_c }: &SafeEnd) -> String {
    let safe_c = state.safe_c;
    let air = air_c.map_or(String::new(), |air_c| format!("; its air was at {air_c:.1} °C"));
    match failed {
        None => format!("the chamber was left at {safe_c:.1} °C{air}"),
        Some(why) => warning(format!(
            "the chamber could not be sent to {safe_c:.1} °C and nobody knows what it does{}: switch it off by hand \
             ({why}){air}",
            last_set(state)
        )),
    }
}

fn warning(how: String) -> String {
    format!("warning: {}", coded(JobWarning::ChamberLeft(how)))
}
