//! Proposes settings with which the host loses fewer samples.

use adis16130::Config;
use zerorate::{Setting, SettingNames};

/// SPI reads per sample: status, rate and temperature.
const READS: f64 = 3.0;
/// Temperature readings per second that resolve 0.02 °C at 1 °C/s (F-55).
const TEMPS_HZ: f64 = 100.0;
/// The largest share of the time that reading may take. The rest is reserve for catching up after a delay.
const BUSY: f64 = 0.8;
/// Share of lost samples up to which no other settings are proposed.
const BEARABLE: f64 = 0.001;

/// Proposes settings that lose fewer samples: reading the temperature less often (F-55), or else a divider (F-56).
/// `None` if hardly any samples are lost, or if no divider suffices. `taken` is the share of samples that were read,
/// `read_s` the duration of one SPI read, and `mclk_hz` the clock of the part. The text uses `names` for the settings.
pub fn proposal(taken: f64, read_s: f64, mclk_hz: u32, names: SettingNames) -> Option<String> {
    if taken >= 1.0 - BEARABLE {
        return None;
    }
    let (rate_cycles, temp_cycles) = Config::new().conversion_cycles();
    let pair_s = f64::from(rate_cycles + temp_cycles) / f64::from(mclk_hz);
    let every = (1.0 / (pair_s * TEMPS_HZ)).round().max(1.0);
    if every > 1.0 && (READS - 1.0 + 1.0 / every) * read_s <= BUSY * pair_s {
        return Some(format!("{} {every} (F-55)", names(Setting::EveryTemp)));
    }
    // if both channels are read at every N-th edge, N + 1 conversions pass from one reading to the next
    let conversions = (READS * read_s / (BUSY * pair_s / 2.0)).ceil();
    let divider = (conversions - 1.0).max(2.0);
    let rate_hz = 2.0 / (pair_s * (divider + 1.0));
    let name = names(Setting::Divider);
    (divider <= f64::from(u16::MAX)).then(|| format!("{name} {divider} (F-56): {rate_hz:.0} samples a second"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130::MCLK_HZ;

    /// A pair of conversions, of rate and temperature, takes 175.7 µs at 6 MHz (F-31).
    #[test]
    fn a_slow_host_reads_temperature_less_often_and_only_then_the_rate() {
        let cases = [
            (1.0, 500e-6, None),
            (0.9, 60e-6, Some("every_temp 57 (F-55)")),
            (0.5, 80e-6, Some("divider 3 (F-56): 2846 samples a second")),
            (0.1, 450e-6, Some("divider 19 (F-56): 569 samples a second")),
            (0.5, 1.0, Some("divider 42694 (F-56): 0 samples a second")),
            (0.5, 2.0, None),
        ];
        for (taken, read_s, expected) in cases {
            assert_eq!(proposal(taken, read_s, MCLK_HZ, Setting::name).as_deref(), expected, "{taken}, {read_s}");
        }
    }
}
