//! A sample rate that a file states beside its columns, as a single number or an attribute such as `Fs`.

#[derive(Clone, Debug, PartialEq)]
pub struct StatedRate {
    pub name: String,
    pub rate_hz: f64,
}

/// Words for a sample rate, in lower case and with letters only.
const WORDS: &str =
    "fs samplerate samplingrate samplefreq samplingfreq samplefrequency samplingfrequency updaterate odr";

/// True if a name is that of a sample rate, with or without `hz` at its end. The name of a structure or group in front
/// does not count.
pub fn is_rate(name: &str) -> bool {
    let own = name.rsplit(['.', '/', '@']).next().unwrap_or_default().to_lowercase();
    let word: String = own.chars().filter(|c| c.is_alphanumeric()).collect();
    let bare = word.strip_suffix("hz").unwrap_or(&word);
    WORDS.split(' ').any(|known| known == bare)
}

impl StatedRate {
    /// The rate among single numbers and their names. `None` if they state no rate, or different rates.
    pub fn among(numbers: impl IntoIterator<Item = (String, f64)>) -> Option<Self> {
        let is_stated = |(name, rate_hz): &(String, f64)| is_rate(name) && *rate_hz > 0.0 && rate_hz.is_finite();
        let mut stated = numbers.into_iter().filter(is_stated);
        let (name, rate_hz) = stated.next()?;
        stated.all(|(_, other)| other == rate_hz).then_some(Self { name, rate_hz })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_state_a_sample_rate() {
        for name in ["Fs", "fs", "imu.Fs", "imu/SampleRate", "sampling_rate", "sample_rate_hz", "odr_hz"] {
            assert!(is_rate(name), "{name}");
        }
        for name in ["gyro_rate", "Fsr", "fs.x", "frate", "khz", "baud_rate", "hz", "rate", ""] {
            assert!(!is_rate(name), "{name}");
        }
    }

    #[test]
    fn two_rates_state_none() {
        let of = |numbers: &[(&str, f64)]| {
            StatedRate::among(numbers.iter().map(|(name, value)| ((*name).to_owned(), *value))).map(|of| of.rate_hz)
        };
        assert_eq!(of(&[("n", 3.0), ("Fs", 100.0), ("imu.Fs", 100.0)]), Some(100.0));
        assert_eq!(of(&[("Fs", 100.0), ("gps.Fs", 5.0)]), None);
        assert_eq!(of(&[("Fs", 0.0), ("fs", f64::NAN)]), None);
    }
}
