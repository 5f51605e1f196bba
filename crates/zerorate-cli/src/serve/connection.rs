//! Checks of the connection that only the computer to which the part is connected can make.

use crate::wording::flag;
use zerorate::Tally;
use zerorate_host::{Bus, DeviceInfo};
use zerorate_jobs::proposal::proposal;
use zerorate_web::message::CheckResult;

/// Duration of the samples that are checked, as in `zerorate probe`, s.
const DURATION_S: f64 = 5.0;

fn check(what: &str, ok: bool, text: impl Into<String>) -> CheckResult {
    CheckResult { what: what.to_owned(), ok, text: text.into() }
}

/// The results of the checks that were made when the device was opened, in words.
pub fn connection_checks(revision: Option<u8>, bus: Option<Bus>) -> Vec<CheckResult> {
    let answers = revision.map(|revision| {
        check("part", true, format!("answers, revision {revision:02X}h; every register written reads back"))
    });
    let bus = bus.map(|bus| {
        let mhz = |hz: u32| f64::from(hz) * 1e-6;
        let (ok, fastest) = match bus.fastest_clean_hz {
            Some(hz) => (hz >= bus.sclk_hz, format!("up to {} MHz", mhz(hz))),
            None => (false, "at none of the clocks tried".to_owned()),
        };
        check("SPI", ok, format!("{} MHz; reads back {fastest}", mhz(bus.sclk_hz)))
    });
    answers.into_iter().chain(bus).collect()
}

/// Checks with the first seconds of samples whether this host reads all samples.
pub struct HostCheck {
    bus: Option<Bus>,
    mclk_hz: u32,
}

impl HostCheck {
    pub fn new(facts: &DeviceInfo, bus: Option<Bus>) -> Self {
        Self { bus, mclk_hz: facts.mclk_hz }
    }

    /// The result; `None` until the samples have the duration of the check. The inner value is `None` if hardly any
    /// samples are lost, or if no better settings are known.
    pub fn ended(&self, tally: &Tally) -> Option<Option<CheckResult>> {
        if tally.duration_s() < DURATION_S {
            return None;
        }
        let taken = tally.samples as f64 / (tally.samples + tally.lost) as f64;
        let options =
            self.bus.and_then(|bus| bus.read_s).and_then(|read_s| proposal(taken, read_s, self.mclk_hz, flag));
        Some(options.map(|options| check("host", false, format!("this host would lose fewer with {options}"))))
    }
}
