//! Units of angular rate, acceleration, temperature and time, parsed from an option or from the name of a column.

use crate::factor::{joined_prefixes, states_codes, states_factor};
use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

/// A quantity that a column can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The rate of a gyroscope, with results in °/s.
    AngularRate,
    /// The acceleration of an accelerometer, with results in m/s².
    Acceleration,
    /// Temperature, with results in °C.
    Temperature,
}

impl Quantity {
    /// The unit of results of this quantity.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::AngularRate => "°/s",
            Self::Acceleration => "m/s²",
            Self::Temperature => "°C",
        }
    }

    /// The quantity that the name of a column states, and the size of the stated unit in the unit of results.
    pub fn of_column(name: &str) -> Option<(Self, f64)> {
        let unit = Unit::of_column(name).map(|unit| (unit.quantity(), unit.in_results()));
        unit.or_else(|| part_of_unit(name)).or_else(|| is_celsius(name).then_some((Self::Temperature, 1.0)))
    }
}

/// Standard gravity, m/s² (CGPM 1901).
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Makes [`Unit`] from a row for each unit: its variant, its symbol, its quantity, its size in °/s or m/s², all
/// accepted names in the spelling of [`plain`], and the endings without a slash by which a column name states it.
macro_rules! units {
    ($($(#[$doc:meta])* $unit:ident $symbol:literal $quantity:ident $size:expr, $names:expr, $endings:expr;)*) => {
        /// A unit of angular rate or of acceleration.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Unit { $($(#[$doc])* $unit),* }

        impl Unit {
            /// All units.
            pub const ALL: [Self; [$($symbol),*].len()] = [$(Self::$unit),*];

            /// The quantity that the unit measures: angular rate or acceleration.
            pub fn quantity(self) -> Quantity {
                match self { $(Self::$unit => Quantity::$quantity),* }
            }

            /// The symbol of the unit in options and results, such as `dps` or `m/s²`.
            pub fn name(self) -> &'static str {
                match self { $(Self::$unit => $symbol),* }
            }

            /// Size of the unit in °/s or m/s². 1 rad = 180°/π.
            pub fn in_results(self) -> f64 {
                match self { $(Self::$unit => $size),* }
            }

            fn names(self) -> &'static [&'static str] {
                match self { $(Self::$unit => &$names),* }
            }

            fn endings(self) -> &'static [&'static str] {
                match self { $(Self::$unit => &$endings),* }
            }
        }
    };
}

units! {
    /// °/s.
    Dps "dps" AngularRate 1.0,
        ["dps", "deg/s", "degs/s", "degs-1", "degps"], ["dps", "deg_s", "deg_per_s", "deg_per_sec", "degps"];
    /// 0.001 °/s.
    Mdps "mdps" AngularRate 1e-3, ["mdps", "mdeg/s"], ["mdps", "mdeg_s", "mdeg_per_s"];
    /// °/min.
    DegPerMin "deg/min" AngularRate 1.0 / 60.0, ["deg/min", "dpm"], ["dpm", "deg_min", "deg_per_min"];
    /// °/h.
    DegPerH "deg/h" AngularRate 1.0 / 3600.0,
        ["deg/h", "dph", "degph"], ["dph", "degph", "deg_h", "deg_hr", "deg_per_h", "deg_per_hr", "deg_per_hour"];
    /// rad/s.
    RadPerS "rad/s" AngularRate 180.0 / PI,
        ["rad/s", "rads/s", "rads-1", "radps"], ["rad_s", "rads", "radps", "rad_per_s", "rad_per_sec"];
    /// 0.001 rad/s.
    MradPerS "mrad/s" AngularRate 0.18 / PI, ["mrad/s", "mradps"], ["mrad_s", "mrads", "mradps", "mrad_per_s"];
    /// 0.000 001 rad/s.
    UradPerS "urad/s" AngularRate 0.000_18 / PI, ["urad/s", "uradps"], ["urad_s", "urads", "uradps", "urad_per_s"];
    /// Turns per minute.
    Rpm "rpm" AngularRate 6.0, ["rpm", "rev/min", "r/min"], ["rpm", "rev_min", "rev_per_min"];
    /// m/s².
    MPerS2 "m/s²" Acceleration 1.0,
        ["m/s2", "m/s/s", "ms-2", "mps2"], ["m_s2", "mps2", "m_per_s2", "ms2", "m_s_s"];
    /// Standard gravity, 9.806 65 m/s².
    G "g" Acceleration STANDARD_GRAVITY,
        ["g", "gn", "g0", "gee", "gees", "g-force", "gforce"], ["g", "gee", "gees"];
    /// 0.001 g.
    MilliG "mg" Acceleration STANDARD_GRAVITY * 1e-3, ["mg"], ["mg"];
    /// 0.000 001 g.
    MicroG "ug" Acceleration STANDARD_GRAVITY * 1e-6, ["ug"], ["ug"];
    /// cm/s², or Gal.
    CmPerS2 "cm/s²" Acceleration 1e-2, ["cm/s2", "cm/s/s", "cms-2", "gal"], ["cm_s2", "cm_per_s2", "cms2", "gal"];
    /// mm/s².
    MmPerS2 "mm/s²" Acceleration 1e-3, ["mm/s2", "mm/s/s", "mms-2"], ["mm_s2", "mm_per_s2", "mms2"];
}

impl Unit {
    /// The unit that the name of a column states: in brackets, at its end, or by the naming of ROS. REP-103 of ROS
    /// fixes the unit of an `angular_velocity` at rad/s, and of a `linear_acceleration` at m/s². `None` if the name
    /// states a factor or codes as well.
    pub fn of_column(name: &str) -> Option<Self> {
        if states_factor(name) || states_codes(name) || has_remark(name) {
            return None;
        }
        Self::stated(name).or_else(|| Self::of_ros(name).map(|(unit, _)| unit))
    }

    /// The unit of [`Self::of_column`] if the words alone tell it: `angular_velocity_x`. The name is not that of a
    /// field in a message of ROS, such as `angular_velocity.x`, so another unit is possible.
    pub fn taken_by_words(name: &str) -> Option<Self> {
        let (unit, is_field) = Self::of_ros(name)?;
        (!is_field && Self::of_column(name).is_some() && Self::stated(name).is_none()).then_some(unit)
    }

    /// The unit by the naming of ROS, and whether the name is a field of a message.
    fn of_ros(name: &str) -> Option<(Self, bool)> {
        let name = name.to_lowercase();
        let words = [("angular_velocity", Self::RadPerS), ("linear_acceleration", Self::MPerS2)];
        let mut found = words.into_iter().filter_map(|(word, unit)| Some((unit, name.split_once(word)?.1)));
        found.next().map(|(unit, rest)| (unit, rest.starts_with(['.', '/'])))
    }

    fn stated(name: &str) -> Option<Self> {
        if let Some(unit) = brackets(name).find_map(|inner| inner.parse().ok()) {
            return Some(unit);
        }
        // a factor, as in `gx (0.01 dps)`, makes another unit
        if bracketed(name).is_some_and(|inner| inner.starts_with(|c: char| c.is_ascii_digit())) {
            return None;
        }
        // a unit in camel case, as in `gyroXRadPerSec`
        let words = name.char_indices().filter(|(_, c)| c.is_uppercase()).map(|(at, _)| &name[at..]);
        let camel = words.filter_map(rate).next();
        let lower = joined_prefixes(name);
        let ending = |unit: &Self| {
            unit.endings().iter().filter(|ending| has_ending(&lower, ending)).map(|ending| ending.len()).max()
        };
        let at_its_end = Self::ALL.into_iter().filter_map(|unit| Some((ending(&unit)?, unit)));
        // a unit with a slash, as in `gx_rad/s` and `wx, rad/s`
        let at_end = || lower.match_indices(['_', ' ', ',', ':']).find_map(|(at, _)| rate(&lower[at + 1..]));
        let ended = at_its_end.max_by_key(|(length, _)| *length).map(|(_, unit)| unit);
        ended.or(camel).or_else(at_end)
    }
}

/// The quantity and the step size, in the unit of results, of a name such as `gx (0.01 dps)` or `gz [0.1°/s]`. Only
/// factors below 1 count, because the 250 in `gx (250 dps)` may be a range.
fn part_of_unit(name: &str) -> Option<(Quantity, f64)> {
    let inner = bracketed(name)?;
    let end = inner.find(|c: char| !c.is_ascii_digit() && c != '.')?;
    let (factor, unit) = (inner[..end].parse::<f64>().ok()?, inner[end..].parse::<Unit>().ok()?);
    (0.0 < factor && factor < 1.0).then(|| (unit.quantity(), factor * unit.in_results()))
}

/// Parses a unit that contains `/`, `per` or `ps`: `rad/s`, `RadPerSec`, `mps2`.
fn rate(text: &str) -> Option<Unit> {
    let lower = text.to_lowercase();
    let is_rate = ["/", "per", "ps"].iter().any(|part| lower.contains(part)) && !lower.contains(['_', ' ']);
    text.parse().ok().filter(|_| is_rate)
}

impl FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let plain = plain(text);
        Self::ALL.into_iter().find(|unit| unit.names().contains(&plain.as_str())).ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.into_iter().map(Self::name).collect();
            format!("`{text}` is not a unit of angular rate or acceleration; choose {}", names.join(", "))
        })
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Unifies the spelling of a unit: `(°/sec)` and `degrees per second` become `deg/s`, and `deg s⁻¹` becomes `degs-1`.
fn plain(unit: &str) -> String {
    let unit: String = unit.to_lowercase().chars().filter(|c| !c.is_whitespace() && !"()^*·".contains(*c)).collect();
    let parts = [
        ("-", "⁻"),
        ("1", "¹"),
        ("2", "²"),
        ("s", "seconds second sec"),
        ("min", "minute"),
        ("h", "hour hr"),
        ("/", "per"),
        // the degree sign: as GBK read as Latin-1, as UTF-8 read as Latin-1 (in lower case), as UTF-8, and as an
        // ordinal sign
        ("deg", "degrees degree ¡ã â° ° º"),
        ("rad", "radians radian"),
        ("m", "meters metres meter metre milli- milli"),
        ("u", "micro µ μ"),
    ];
    let spellings = parts.into_iter().flat_map(|(plain, all)| all.split(' ').map(move |one| (plain, one)));
    spellings.fold(unit, |unit, (plain, spelling)| unit.replace(spelling, plain))
}

/// A unit of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum TimeUnit {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
    /// Minutes.
    Min,
    /// Hours.
    H,
}

impl TimeUnit {
    /// All units.
    pub const ALL: [Self; 6] = [Self::S, Self::Ms, Self::Us, Self::Ns, Self::Min, Self::H];

    /// The symbol of the unit, such as `us`.
    pub fn name(self) -> &'static str {
        match self {
            Self::S => "s",
            Self::Ms => "ms",
            Self::Us => "us",
            Self::Ns => "ns",
            Self::Min => "min",
            Self::H => "h",
        }
    }

    /// Number of these units in a second.
    pub fn per_s(self) -> f64 {
        match self {
            Self::S => 1.0,
            Self::Ms => 1e3,
            Self::Us => 1e6,
            Self::Ns => 1e9,
            Self::Min => 1.0 / 60.0,
            Self::H => 1.0 / 3600.0,
        }
    }

    /// The unit that the name of a column states: in brackets, as its last word, or by the naming of ArduPilot, of
    /// phones and of Arduino sketches.
    pub fn of_column(name: &str) -> Option<Self> {
        let lower = joined_prefixes(name);
        match &*lower {
            "timeus" | "micros" | "us" | "usec" | "microseconds" | "microsecond" => return Some(Self::Us),
            "millis" | "ms" | "msec" | "milliseconds" | "millisecond" => return Some(Self::Ms),
            "sec" | "secs" | "second" | "seconds" | "seconds_elapsed" | "secondselapsed" => return Some(Self::S),
            "nanos" | "ns" | "nsec" | "nanoseconds" => return Some(Self::Ns),
            // in `gx_rad/s`, the `s` belongs to the unit of a rate
            _ if Unit::of_column(name).is_some() || states_factor(name) => return None,
            _ => {}
        }
        let named = |names: &[&str]| match bracketed(&lower) {
            Some(inner) => names.contains(&inner.trim()),
            None => names.iter().any(|ending| has_ending(&lower, ending)),
        };
        [
            (Self::S, &["s", "sec", "secs", "seconds"][..]),
            (Self::Ms, &["ms", "msec", "millis", "milliseconds", "mseconds"]),
            (Self::Us, &["us", "µs", "μs", "usec", "micros", "microseconds", "useconds"]),
            (Self::Ns, &["ns", "nsec", "nsecs", "nanos", "nanoseconds", "nanosec", "nseconds"]),
        ]
        .into_iter()
        .find(|(_, names)| named(names))
        .map(|(unit, _)| unit)
    }
}

/// True if the name of a column states °C: in brackets or as its last word.
pub fn is_celsius(name: &str) -> bool {
    let lower = name.to_lowercase();
    match bracketed(&lower) {
        _ if states_factor(name) => false,
        Some(inner) => ["c", "°c", "ºc", "℃", "degc", "deg c", "celsius"].contains(&inner.trim()),
        None => ["c", "degc", "deg_c", "celsius"].iter().any(|ending| has_ending(&lower, ending)),
    }
}

/// The text in the last pair of square brackets or, without such a pair, of round brackets.
fn bracketed(name: &str) -> Option<&str> {
    brackets(name).next()
}

/// The texts in all pairs of square brackets and then of round brackets, each from the last on.
fn brackets(name: &str) -> impl Iterator<Item = &str> {
    [('[', ']'), ('(', ')')].into_iter().flat_map(move |(open, close)| {
        name.rmatch_indices(open).filter_map(move |(at, _)| Some(name[at + 1..].split_once(close)?.0))
    })
}

/// True if a bracket beside the unit holds a number that is not an index, or says raw: `gx (dps) [131]`.
fn has_remark(name: &str) -> bool {
    let (units, rest): (Vec<&str>, Vec<&str>) = brackets(name).partition(|inner| inner.parse::<Unit>().is_ok());
    let is_remark = |inner: &&str| {
        let inner = inner.to_lowercase();
        inner.len() > 1 && !inner.contains(char::is_alphabetic) || ["raw", "int"].iter().any(|raw| inner.contains(raw))
    };
    !units.is_empty() && rest.iter().any(is_remark)
}

/// True if `name` ends with `ending` as a separate word.
fn has_ending(name: &str, ending: &str) -> bool {
    name.strip_suffix(ending).is_some_and(|rest| rest.ends_with(['_', '.', ' ', '-', '/']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_state_a_unit() {
        let cases = [
            ("gyro_z_dps", Some(Unit::Dps)),
            ("rate_corrected_dps", Some(Unit::Dps)),
            ("gz [rad/s]", Some(Unit::RadPerS)),
            ("GyroX (deg/s)", Some(Unit::Dps)),
            ("w_RS_S_x [rad s^-1]", Some(Unit::RadPerS)),
            ("/imu.angular_velocity.z", Some(Unit::RadPerS)),
            ("gyro_mrad_s", Some(Unit::MradPerS)),
            ("gyro_mdps", Some(Unit::Mdps)),
            ("drift (°/h)", Some(Unit::DegPerH)),
            ("gyro_rad_s", Some(Unit::RadPerS)),
            ("gz", None),
            ("holidays", None),
            ("adps", None),
            ("temp_c", None),
            ("gz [m/s^2]", Some(Unit::MPerS2)),
            ("a_RS_S_x [m s^-2]", Some(Unit::MPerS2)),
            ("/imu.linear_acceleration.x", Some(Unit::MPerS2)),
            ("AccX (g)", Some(Unit::G)),
            ("acc_x_mg", Some(Unit::MilliG)),
            ("ax_g", Some(Unit::G)),
            ("temp [K]", None),
            ("gx_rad/s", Some(Unit::RadPerS)),
            ("ax_m/s2", Some(Unit::MPerS2)),
            ("wx, rad/s", Some(Unit::RadPerS)),
            ("gyroXRadPerSec", Some(Unit::RadPerS)),
            ("accelXMps2", Some(Unit::MPerS2)),
            ("rate (°/sec)", Some(Unit::Dps)),
            ("rate [degrees per second]", Some(Unit::Dps)),
            ("rate [deg s⁻¹]", Some(Unit::Dps)),
            ("rate (rad s-1)", Some(Unit::RadPerS)),
            ("acc (meters/sec^2)", Some(Unit::MPerS2)),
            ("acc (milli-g)", Some(Unit::MilliG)),
            ("Accel_X m/(s^2)", Some(Unit::MPerS2)),
            ("Time (ms) 2", None),
            ("½ÇËÙ¶ÈX(¡ã/s)", Some(Unit::Dps)),
            ("angular_velocity_x_dps", Some(Unit::Dps)),
            ("Yaw (deg) S1", None),
            ("HeadingDegS1", None),
            ("latency_ms 2", None),
            ("imu_g0", None),
            ("mass:g", None),
            ("speed_m/s", None),
            ("heading_degs", None),
            ("flow_l/s", None),
            ("Msg", None),
        ];
        for (name, unit) in cases {
            assert_eq!(Unit::of_column(name), unit, "{name}");
        }
    }

    #[test]
    fn names_that_state_a_rarer_unit() {
        let cases = [
            ("ax (cm/s2)", Some(Unit::CmPerS2)),
            ("ax [cm/s²]", Some(Unit::CmPerS2)),
            ("acc_z_mm_s2", Some(Unit::MmPerS2)),
            ("ax (Gal)", Some(Unit::CmPerS2)),
            ("ax (gee)", Some(Unit::G)),
            ("ax_milli_g", Some(Unit::MilliG)),
            ("gyro_x_rpm", Some(Unit::Rpm)),
            ("gx (mrad/s)", Some(Unit::MradPerS)),
            ("gx [°/hr]", Some(Unit::DegPerH)),
            ("gx_degph", Some(Unit::DegPerH)),
            ("wx[rev/min]", Some(Unit::Rpm)),
            ("gyroUnfilt[0] (deg/s)", Some(Unit::Dps)),
            ("gx (deg/s) [131]", None),
            ("angular_velocity_x (deg/s) [raw]", None),
        ];
        for (name, unit) in cases {
            assert_eq!(Unit::of_column(name), unit, "{name}");
        }
    }

    #[test]
    fn words_alone_tell_a_unit_outside_of_messages() {
        for name in ["angular_velocity_x", "imu_linear_acceleration_z", "angular_velocity[0]"] {
            assert_eq!(Unit::taken_by_words(name), Unit::of_column(name), "{name}");
        }
        for name in ["/imu.angular_velocity.z", "field.angular_velocity.x", "angular_velocity_x_dps", "gx [rad/s]"] {
            assert_eq!(Unit::taken_by_words(name), None, "{name}");
        }
    }

    #[test]
    fn names_that_state_a_unit_of_time() {
        let cases = [
            ("t_ns", Some(TimeUnit::Ns)),
            ("time_us", Some(TimeUnit::Us)),
            ("TimeUS", Some(TimeUnit::Us)),
            ("timestamp [ms]", Some(TimeUnit::Ms)),
            ("#timestamp [ns]", Some(TimeUnit::Ns)),
            ("Time (s)", Some(TimeUnit::S)),
            ("time_s", Some(TimeUnit::S)),
            ("time", None),
            ("ticks", None),
            ("items", None),
            ("t [min]", None),
            ("millis", Some(TimeUnit::Ms)),
            ("seconds_elapsed", Some(TimeUnit::S)),
            ("gz_rad/s", None),
        ];
        for (name, unit) in cases {
            assert_eq!(TimeUnit::of_column(name), unit, "{name}");
        }
    }

    #[test]
    fn scales_to_the_units_of_results() {
        assert_eq!("mg".parse::<Unit>().unwrap().in_results(), 9.806_65e-3);
        assert_eq!("m/s^2".parse::<Unit>().unwrap().quantity(), Quantity::Acceleration);
        assert_eq!(Quantity::of_column("temp_c"), Some((Quantity::Temperature, 1.0)));
        assert_eq!(Quantity::of_column("gx (0.1°/s)"), Some((Quantity::AngularRate, 0.1)));
        assert_eq!(Quantity::of_column("gx [250 dps]"), None);
        assert_eq!("deg/h".parse::<Unit>().unwrap().in_results() * 3600.0, 1.0);
        assert_eq!(" Rad/s".parse::<Unit>().unwrap().in_results(), 1f64.to_degrees());
        assert!("furlong".parse::<Unit>().unwrap_err().contains("dps, mdps"));
    }
}
