//! The averaging times at which a deviation is computed.

use super::Stat;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use core::str::FromStr;

/// A set of averaging times. All but [`Taus::List`] end at or below the longest that the statistic allows.
#[derive(Clone, Debug, PartialEq)]
pub enum Taus {
    /// 1, 2, 4, 8 … samples.
    Octave,
    /// 1, 2, 3, then 4, 5, 6, 7, 8, 10, 12, 14, 16, 20 … samples: four per octave, for a plot. A length and its double
    /// read mostly the same data from memory, so these lengths cost less than as many others.
    Fine,
    /// 1, 2, 4, 10, 20, 40, 100 … samples.
    Decade,
    /// This many lengths, evenly spaced in logarithm from one sample to the longest. Lengths that round to the same
    /// number of samples count once, so there may be fewer.
    Log(u32),
    /// 1, 2, 3 … samples.
    All,
    /// A list of times, s, each rounded to whole samples. A repeated length is computed once, and the repetition is
    /// reported as [`Reason::SameLength`](crate::Reason::SameLength).
    List(Vec<f64>),
}

impl FromStr for Taus {
    type Err = TausError;

    /// Parses `octave`, `fine`, `decade`, `log:100`, `all`, or seconds with commas: `0.1,1,10`.
    fn from_str(text: &str) -> Result<Self, TausError> {
        let lower = text.trim().to_ascii_lowercase();
        match (lower.as_str(), lower.strip_prefix("log:")) {
            ("octave", _) => Ok(Self::Octave),
            ("fine", _) => Ok(Self::Fine),
            ("decade", _) => Ok(Self::Decade),
            ("all", _) => Ok(Self::All),
            (_, Some(count)) => match count.trim().parse() {
                Ok(count) if count > 0 => Ok(Self::Log(count)),
                _ => Err(TausError::Count(count.to_string())),
            },
            (list, None) => list.split(',').map(seconds).collect::<Result<_, _>>().map(Self::List),
        }
    }
}

fn seconds(text: &str) -> Result<f64, TausError> {
    match text.trim().parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err(TausError::Time(text.trim().to_string())),
    }
}

/// The part of a text that [`Taus::from_str`] does not accept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TausError {
    /// The part is neither a name, such as `octave`, nor a time above 0 s.
    Time(String),
    /// The part after `log:` is not a positive whole number.
    Count(String),
}

impl fmt::Display for TausError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Time(text) => write!(f, "{text:?} is not an averaging time")?,
            Self::Count(text) => write!(f, "{text:?} is not a number of averaging times")?,
        }
        f.write_str(
            "; give octave, fine, decade, all, log:N with N from 1, or seconds above 0 separated by commas \
             (0.1,1,10)",
        )
    }
}

impl core::error::Error for TausError {}

/// Longest averaging length, in samples, of `stat` in a record of `phase_points` points (one more than rate samples);
/// 0 if the record is too short.
///
/// For N points, the longest is (N − 1)/2 for ADEV and OADEV, (N − 1)/3 for HDEV and OHDEV, and N/3 for MDEV and TDEV.
/// For TOTDEV it is (N − 1)/2, because reflection adds no information beyond half of the record.
#[must_use]
pub fn longest(stat: Stat, phase_points: u64) -> u64 {
    stat.row().kernel.longest(phase_points)
}

impl Taus {
    /// Lengths in samples from 1 to `longest`, ascending, each once. Empty for a list: [`nearest`] converts its times.
    pub(crate) fn lengths(&self, longest: u64) -> Vec<u64> {
        let up_to = |m: &u64| *m <= longest;
        match self {
            Self::Octave => core::iter::successors(Some(1u64), |m| m.checked_mul(2)).take_while(up_to).collect(),
            Self::Fine => {
                let octaves = (0..u64::BITS - 2).flat_map(|k| (4..8).map(move |quarter| quarter << k));
                (1..4).chain(octaves).take_while(up_to).collect()
            }
            Self::Decade => core::iter::successors(Some(1u64), |ten| ten.checked_mul(10))
                .take_while(up_to)
                .flat_map(|ten| [1, 2, 4].into_iter().filter_map(move |digit| ten.checked_mul(digit)))
                .filter(up_to)
                .collect(),
            Self::Log(count) if u64::from(*count) < longest => spaced(*count, longest),
            Self::Log(_) | Self::All => (1..=longest).collect(),
            Self::List(_) => Vec::new(),
        }
    }
}

fn spaced(count: u32, longest: u64) -> Vec<u64> {
    let step = libm::log(longest as f64) / f64::from(count.max(2) - 1);
    let mut lengths: Vec<u64> =
        (0..count).map(|i| (libm::round(libm::exp(f64::from(i) * step)) as u64).clamp(1, longest)).collect();
    lengths.dedup();
    lengths
}

/// Number of samples in `tau_s`, rounded. 0 for less than half a sample, a negative value or NaN.
pub(crate) fn nearest(tau_s: f64, rate_hz: f64) -> u64 {
    libm::round(tau_s * rate_hz) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_lists_are_parsed() {
        assert_eq!("octave".parse(), Ok(Taus::Octave));
        assert_eq!("fine".parse(), Ok(Taus::Fine));
        assert_eq!(" Decade".parse(), Ok(Taus::Decade));
        assert_eq!("ALL".parse(), Ok(Taus::All));
        assert_eq!("log:100".parse(), Ok(Taus::Log(100)));
        assert_eq!("0.1, 1,1e1".parse(), Ok(Taus::List(alloc::vec![0.1, 1.0, 10.0])));
    }

    #[test]
    fn errors_say_what_is_accepted() {
        for (text, part) in
            [("octaves", "octaves"), ("1,,2", ""), ("1,-2", "-2"), ("nan", "nan"), ("inf", "inf"), ("", "")]
        {
            assert_eq!(text.parse::<Taus>(), Err(TausError::Time(part.to_string())), "{text}");
        }
        for (text, part) in [("log:0", "0"), ("log:", ""), ("log:1.5", "1.5"), ("log:-3", "-3")] {
            assert_eq!(text.parse::<Taus>(), Err(TausError::Count(part.to_string())), "{text}");
        }
        let said = "fast".parse::<Taus>().unwrap_err().to_string();
        assert!(said.contains("\"fast\"") && said.contains("octave, fine, decade, all, log:N"), "{said}");
    }

    #[test]
    fn lengths_end_at_the_longest() {
        assert_eq!(Taus::Octave.lengths(9), [1, 2, 4, 8]);
        assert_eq!(Taus::Fine.lengths(29), [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28]);
        assert_eq!(Taus::Decade.lengths(45), [1, 2, 4, 10, 20, 40]);
        assert_eq!(Taus::All.lengths(4), [1, 2, 3, 4]);
        assert_eq!(Taus::Log(4).lengths(1000), [1, 10, 100, 1000]);
        assert_eq!(Taus::Log(1).lengths(1000), [1]);
        assert_eq!(Taus::Log(u32::MAX).lengths(3), [1, 2, 3]);
        assert_eq!(Taus::Log(9).lengths(10), [1, 2, 3, 4, 6, 7, 10]);
        for taus in [Taus::Octave, Taus::Fine, Taus::Decade, Taus::All, Taus::Log(10)] {
            assert_eq!(taus.lengths(0), []);
        }
        assert_eq!(Taus::Octave.lengths(u64::MAX).len(), 64);
        assert_eq!(Taus::Fine.lengths(u64::MAX).last(), Some(&(7 << 61)));
        assert_eq!(Taus::Decade.lengths(u64::MAX).last(), Some(&10_000_000_000_000_000_000));
    }

    #[test]
    fn times_round_to_whole_samples() {
        assert_eq!(nearest(0.0349, 100.0), 3);
        assert_eq!(nearest(0.004, 100.0), 0);
        assert_eq!(nearest(f64::NAN, 100.0), 0);
        assert_eq!(nearest(-1.0, 100.0), 0);
    }
}
