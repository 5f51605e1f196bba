use super::kernel::{Difference, Kernel, Order, Plain};
use core::fmt;
use core::str::FromStr;

/// The properties that tell one statistic from the others.
#[derive(Clone, Copy, Debug)]
pub(super) struct StatRow {
    /// The name that users write.
    pub name: &'static str,
    /// The name in words.
    pub title: &'static str,
    /// The differences that are squared: their order, their spacing, and the record length that one of them needs.
    pub kernel: Kernel,
    /// Divisor of the mean square of the differences of averages. With it, the deviation of white noise at m = 1,
    /// before a factor of τ/√3, is the standard deviation of the samples.
    pub divisor: f64,
    /// Whether the deviation is multiplied by τ/√3, which gives it the unit of the rate times s.
    pub is_times_s: bool,
    /// Whether frequency noise has the total deviation's own formula for the degrees of freedom. Otherwise, and for
    /// phase noise, they follow the formula for finite differences.
    pub has_total_edf: bool,
    /// Number of averages of τ below which the noise type is not identified.
    pub fewest_averages: u64,
    /// Cap on the noise exponent α that lengths with fewer averages inherit from the next shorter length.
    pub carried_alpha: i32,
    /// Whether the expected square is the Allan variance, so that a [`Fit`](super::Fit) models it.
    pub is_allan: bool,
}

macro_rules! statistics {
    ($($(#[$doc:meta])* $stat:ident { $($field:ident: $value:expr,)* })*) => {
        /// A statistic: the root of the mean square of differences of adjacent averages over τ.
        ///
        /// x is the running sum of the rate in steps of one sample (for a gyroscope: the angle), and m is the number
        /// of samples in each average. N is the number of points of x, one more than samples of the rate. The
        /// differences are d₂ = x\[i+2m\] − 2x\[i+m\] + x\[i\] and d₃ = x\[i+3m\] − 3x\[i+2m\] + 3x\[i+m\] − x\[i\].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
        pub enum Stat {$($(#[$doc])* $stat,)*}

        impl Stat {
            /// All statistics.
            pub const ALL: [Self; TABLE.len()] = [$(Self::$stat),*];
        }

        const TABLE: &[StatRow] = &[$(StatRow { $($field: $value),* }),*];
    };
}

// One row per statistic. A new kind of difference needs a new variant of `Kernel`; the compiler asks for the rest.
statistics! {
    /// Allan deviation, every m-th i: σ² = ⟨d₂²⟩ / 2m² (NIST SP 1065 equation 10).
    Adev {
        name: "adev", title: "Allan deviation",
        kernel: every_average(Order::Second), divisor: 2.0, is_times_s: false, has_total_edf: false,
        fewest_averages: 10, carried_alpha: 2, is_allan: true,
    }
    /// Overlapping Allan deviation, every i: σ² = ⟨d₂²⟩ / 2m² (NIST SP 1065 equation 11).
    Oadev {
        name: "oadev", title: "overlapping Allan deviation",
        kernel: every_sample(Order::Second), divisor: 2.0, is_times_s: false, has_total_edf: false,
        fewest_averages: 8, carried_alpha: 2, is_allan: true,
    }
    /// Modified Allan deviation: σ² = ⟨(sum of m adjacent d₂)²⟩ / 2m⁴ (NIST SP 1065 equation 14).
    Mdev {
        name: "mdev", title: "modified Allan deviation",
        kernel: Kernel::Modified, divisor: 2.0, is_times_s: false, has_total_edf: false,
        fewest_averages: 8, carried_alpha: 2, is_allan: false,
    }
    /// Time deviation: τ/√3 times the modified Allan deviation, in the input's unit times s (NIST SP 1065 equation
    /// 15).
    Tdev {
        name: "tdev", title: "time deviation",
        kernel: Kernel::Modified, divisor: 2.0, is_times_s: true, has_total_edf: false,
        fewest_averages: 8, carried_alpha: 2, is_allan: false,
    }
    /// Hadamard deviation, every m-th i: σ² = ⟨d₃²⟩ / 6m² (NIST SP 1065 equation 17).
    Hdev {
        name: "hdev", title: "Hadamard deviation",
        kernel: every_average(Order::Third), divisor: 6.0, is_times_s: false, has_total_edf: false,
        fewest_averages: 10, carried_alpha: 2, is_allan: false,
    }
    /// Overlapping Hadamard deviation, every i: σ² = ⟨d₃²⟩ / 6m² (NIST SP 1065 equation 18).
    Ohdev {
        name: "ohdev", title: "overlapping Hadamard deviation",
        kernel: every_sample(Order::Third), divisor: 6.0, is_times_s: false, has_total_edf: false,
        fewest_averages: 8, carried_alpha: 2, is_allan: false,
    }
    /// Total deviation: the overlapping Allan deviation with x continued by reflection through both of its ends. The
    /// middle point i+m is every point but the first and the last (NIST SP 1065 equation 25). In a record of length T
    /// its square is below the Allan variance by the share a·τ/T, with a = 0.481 for flicker noise of the rate and
    /// 0.75 for its random walk. Neither the deviation nor its limits are corrected for that.
    Totdev {
        name: "totdev", title: "total deviation",
        kernel: Kernel::Reflected, divisor: 2.0, is_times_s: false, has_total_edf: true,
        fewest_averages: 8, carried_alpha: 0, is_allan: true,
    }
}

const fn every_average(order: Order) -> Kernel {
    Kernel::Plain(Plain { order, overlapping: false })
}

const fn every_sample(order: Order) -> Kernel {
    Kernel::Plain(Plain { order, overlapping: true })
}

impl Stat {
    pub(super) const fn row(self) -> &'static StatRow {
        &TABLE[self as usize]
    }

    /// The name in lower case: `oadev`.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// The name in words: `overlapping Allan deviation`.
    pub const fn title(self) -> &'static str {
        self.row().title
    }

    /// Whether the unit of the statistic is the unit of the rate times s, as for an angle.
    pub const fn is_times_s(self) -> bool {
        self.row().is_times_s
    }

    /// Whether the expected square is the Allan variance, so that the curve is comparable with a [`Fit`](super::Fit).
    pub const fn is_allan(self) -> bool {
        self.row().is_allan
    }

    /// The differences that [`finite_difference_edf`](super::finite_difference_edf) needs for this statistic. `None`
    /// for the total deviation, which has its own formula.
    pub const fn difference(self) -> Option<Difference> {
        if self.row().has_total_edf { None } else { Some(self.row().kernel.difference()) }
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

/// The error for a name that no [`Stat`] has.
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

    /// The order d, whether S = m and whether F = 1 (NIST SP 1065 section 5.4.1), the unit and the expected value are
    /// typed again from the handbook.
    #[test]
    fn rows_are_those_of_the_handbook() {
        let of = |order, overlapped, modified| Some(Difference { order, overlapped, modified });
        let handbook = [
            (Stat::Adev, of(2, false, false), false, true),
            (Stat::Oadev, of(2, true, false), false, true),
            (Stat::Mdev, of(2, true, true), false, false),
            (Stat::Tdev, of(2, true, true), true, false),
            (Stat::Hdev, of(3, false, false), false, false),
            (Stat::Ohdev, of(3, true, false), false, false),
            (Stat::Totdev, None, false, true),
        ];
        for (stat, difference, is_times_s, is_allan) in handbook {
            assert_eq!(
                (stat.difference(), stat.is_times_s(), stat.is_allan()),
                (difference, is_times_s, is_allan),
                "{stat}"
            );
            assert!(stat.title().ends_with("deviation"));
        }
    }
}
