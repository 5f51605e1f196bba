//! Devices that a browser can read: the twin, a recording that was dropped on the page, and a bridge whose bytes the
//! page transfers. None of them blocks or has a clock.

mod bridge;
mod replay;
mod twin;

pub use bridge::Bridge;
pub use replay::Replay;
pub use twin::TwinSource;

use crate::session::{About, NoticeText};
use adis16130::{Config, MCLK_HZ, SamplerConfig};
use adis16130_twin::Truth;
use zerorate::Axis;
use zerorate_record::{CaptureInfo, Converter, Row};

/// The result of asking a source for a reading.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// A reading.
    Row(Row),
    /// No reading yet.
    Waiting,
    /// The end of a recording.
    Ended,
}

/// A device that is being read.
pub trait Source {
    /// The facts about the device that are known now. [`Source::opened`] tells when there are more.
    fn about(&self) -> About;

    /// True if the device was opened since the last call, so that more facts are known.
    fn opened(&mut self) -> bool {
        false
    }

    /// Returns the next reading, if there is one.
    ///
    /// # Errors
    /// Returns an error that states why the device cannot be read any longer, and what to do.
    fn next(&mut self) -> Result<Next, String>;

    /// The true values of the twin at this time; empty if the device is not a twin.
    fn truths(&self) -> Vec<Truth> {
        Vec::new()
    }

    /// Returns the messages since the last call.
    fn notes(&mut self) -> Vec<NoticeText> {
        Vec::new()
    }

    /// Passes on bytes that the serial port received. `now_ms` is the time of the page's clock, ms.
    fn received(&mut self, bytes: &[u8], now_ms: f64) {
        let _ = (bytes, now_ms);
    }

    /// Takes the bytes to write to the serial port.
    fn to_send(&mut self) -> Vec<u8> {
        Vec::new()
    }

    /// Reports that the serial port was disconnected.
    fn unplugged(&mut self, why: &str) {
        let _ = why;
    }
}

/// The facts about an ADIS16130 that is read through the driver, without registers and checks.
fn about_part(name: &str, config: &Config, is_simulated: bool, has_roa_capacitor: bool) -> About {
    let converter = Converter {
        width: config.width(),
        rate_conversion: config.rate_conversion().bits(),
        temp_conversion: config.temp_conversion().bits(),
    };
    let sampling = SamplerConfig::new();
    let info = CaptureInfo {
        device: name.to_owned(),
        every_temp: sampling.every_temp,
        divider: sampling.divider,
        divided: sampling.divided,
        software: zerorate::SOFTWARE.to_owned(),
        bandwidth_hz: has_roa_capacitor.then_some(Axis::ADIS16130_ROA_10NF_HZ),
        ..CaptureInfo::adis16130(converter)
    };
    let (rate, temp) = config.conversion_cycles();
    About {
        name: name.to_owned(),
        part: info.part(),
        simulated: is_simulated,
        // the nominal conversion rate, F-31
        nominal_hz: Some(f64::from(MCLK_HZ) / f64::from(rate + temp)),
        registers: Vec::new(),
        checks: Vec::new(),
        info,
    }
}
