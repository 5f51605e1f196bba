//! The settings of a measurement, and texts that name them as each front end does.

use super::EARTH_DPS;
use core::fmt;
use zerorate_allan::SettingName;

/// The values that a setting of [`Plan`](crate::Plan) may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least value.
    pub least: f64,
    /// The largest value.
    pub most: f64,
    /// Unit of both values.
    pub unit: &'static str,
}

/// Makes [`Setting`] from a row for each setting: its variant, its word, its field and, if the plan bounds it, the
/// least and the largest value and their unit.
macro_rules! settings {
    ($($setting:ident $word:literal $field:literal $($least:expr, $most:expr, $unit:literal)?;)*) => {
        /// A setting of a measurement, for which each front end has its own name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        #[expect(missing_docs, reason = "the fields of `Plan`; which device is read, and how")]
        pub enum Setting { $($setting),* }

        impl Setting {
            /// The word from which front ends make the name of the setting, such as `max_u_btc`.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$setting => $word),* }
            }

            /// The name as a field of [`Plan`](crate::Plan) or of the sensor's reader, such as `max_u_btc_dps_per_c`.
            #[must_use]
            pub const fn name(self) -> SettingName {
                SettingName::text(match self { $(Self::$setting => $field),* })
            }

            /// The values that make sense for a measurement on Earth. `None` if the plan does not bound them.
            #[must_use]
            pub fn bounds(self) -> Option<Bounds> {
                match self {
                    $(Self::$setting => [$(Bounds { least: $least, most: $most, unit: $unit })?].first().copied()),*
                }
            }
        }
    };
}

/// Longest step of F-51, s: a day, one cycle of the ambient temperature.
const DAY_S: f64 = 86_400.0;
/// Smallest uncertainty of BTC that may be asked for, °/s/°C. No measurement of a day reaches it: the white noise of
/// an ADIS16130 alone (F-02) makes more than ten times as much.
const LEAST_U_BTC: f64 = 1e-8;
/// Largest uncertainty of BTC that may be asked for, °/s/°C. It restricts nothing: it is 25 times BTC itself (F-05).
const MOST_U_BTC: f64 = 1.0;
/// Smallest target, °/s: below a thousandth of the flicker floor (M-04), so no recording of an hour reaches it.
const LEAST_TARGET_DPS: f64 = 1e-6;
/// Largest target, °/s. It restricts nothing: a part without calibration reaches it (M-01).
const MOST_TARGET_DPS: f64 = 1.0;

settings! {
    Average "average" "average_s" 1.0, DAY_S, "s";
    WarmUp "warmup" "warmup_s" 0.0, DAY_S, "s";
    Settle "settle" "settle_s" 0.0, DAY_S, "s";
    Offset "offset" "offset_s" 1.0, DAY_S, "s";
    FinalTemperature "final_temp" "final_temp_s" 0.1, DAY_S, "s";
    MaxLost "max_lost" "max_lost" 0.0, 1.0, "of all samples";
    MaxUBtc "max_u_btc" "max_u_btc_dps_per_c" LEAST_U_BTC, MOST_U_BTC, "°/s/°C";
    Earth "earth_dps" "earth_dps" -EARTH_DPS, EARTH_DPS, "°/s (F-16)";
    AssumeLinear "assume_linear" "assume_linear";
    Target "target_dph" "target_dps" LEAST_TARGET_DPS, MOST_TARGET_DPS, "°/s";
    EveryTemp "every_temp" "every_temp";
    Divider "divider" "divider";
    Edge "edge" "rdy_edge";
    Device "device" "device";
    SelfTest "self_test" "self_test";
}

/// The names that a front end uses for the settings.
pub type SettingNames = fn(Setting) -> SettingName;

/// A text that names settings. Each front end has its own names for them.
pub trait Wording {
    /// Writes the text with these names for settings.
    ///
    /// # Errors
    /// Returns the errors of the writer.
    fn fmt_with(&self, f: &mut fmt::Formatter<'_>, names: SettingNames) -> fmt::Result;

    /// Returns the text with these names, to be displayed.
    fn with(&self, names: SettingNames) -> Worded<'_, Self>
    where
        Self: Sized,
    {
        Worded { text: self, names }
    }
}

/// A text with the setting names of a front end.
#[derive(Clone, Copy, Debug)]
pub struct Worded<'a, T> {
    text: &'a T,
    names: SettingNames,
}

impl<T: Wording> fmt::Display for Worded<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text.fmt_with(f, self.names)
    }
}
