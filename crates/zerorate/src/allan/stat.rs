use core::fmt;
use core::str::FromStr;

/// What is computed. Every one of them is a root of a mean of squared differences of adjacent averages over τ.
///
/// x is the running sum of the rate in steps of one sample (for a gyroscope: the angle), m the samples in each average, N the
/// points of x, one more than samples of the rate. d₂ = x\[i+2m\] − 2x\[i+m\] + x\[i\] and d₃ = x\[i+3m\] − 3x\[i+2m\] + 3x\[i+m\] − x\[i\].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stat {
    /// Allan deviation, every m-th i: σ² = ⟨d₂²⟩ / 2m² (NIST SP 1065 equation 10).
    Adev,
    /// Overlapping Allan deviation, every i: σ² = ⟨d₂²⟩ / 2m² (NIST SP 1065 equation 11).
    Oadev,
    /// Modified Allan deviation: σ² = ⟨(sum of m adjacent d₂)²⟩ / 2m⁴ (NIST SP 1065 equation 14).
    Mdev,
    /// Time deviation τ / √3 times the modified Allan deviation, in units of the input times s (NIST SP 1065 equation 15).
    Tdev,
    /// Hadamard deviation, every m-th i: σ² = ⟨d₃²⟩ / 6m² (NIST SP 1065 equation 17).
    Hdev,
    /// Overlapping Hadamard deviation, every i: σ² = ⟨d₃²⟩ / 6m² (NIST SP 1065 equation 18).
    Ohdev,
    /// Total deviation: as the overlapping Allan deviation, with x continued by reflection through both of its ends, and i such
    /// that the point in the middle, i+m, is every one but the first and the last (NIST SP 1065 equation 25).
    Totdev,
}

impl Stat {
    /// All of them.
    pub const ALL: [Self; 7] = [Self::Adev, Self::Oadev, Self::Mdev, Self::Tdev, Self::Hdev, Self::Ohdev, Self::Totdev];

    /// Its name in lower case: `oadev`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Adev => "adev",
            Self::Oadev => "oadev",
            Self::Mdev => "mdev",
            Self::Tdev => "tdev",
            Self::Hdev => "hdev",
            Self::Ohdev => "ohdev",
            Self::Totdev => "totdev",
        }
    }
}

impl fmt::Display for Stat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Stat {
    type Err = UnknownStat;

    fn from_str(name: &str) -> Result<Self, UnknownStat> {
        Self::ALL.into_iter().find(|stat| stat.name().eq_ignore_ascii_case(name)).ok_or(UnknownStat)
    }
}

/// A name that no [`Stat`] has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownStat;

impl fmt::Display for UnknownStat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("not a statistic; there are")?;
        Stat::ALL.iter().try_for_each(|stat| write!(f, " {stat}"))
    }
}

impl core::error::Error for UnknownStat {}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn names_read_back() {
        for stat in Stat::ALL {
            assert_eq!(stat.to_string().to_uppercase().parse(), Ok(stat));
        }
        let error = "theo1".parse::<Stat>().unwrap_err();
        assert_eq!(error.to_string(), "not a statistic; there are adev oadev mdev tdev hdev ohdev totdev");
    }
}
