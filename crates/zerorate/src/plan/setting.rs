//! The settings of a measurement, and texts that name them as each front end does.

use core::fmt;
use zerorate_allan::SettingName;

/// Makes [`Setting`] from a row for each: its variant, its word, and its field.
macro_rules! settings {
    ($($setting:ident $word:literal $field:literal),* $(,)?) => {
        /// A setting of a measurement, for which each front end has its own name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        #[expect(missing_docs, reason = "the fields of `Plan`; which device is read, and how")]
        pub enum Setting { $($setting),* }

        impl Setting {
            /// The word from which front ends make its name: `max_u_btc`.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$setting => $word),* }
            }

            /// Its name as a field of [`Plan`](crate::Plan) or of the reader of the sensor: `max_u_btc_dps_per_c`.
            #[must_use]
            pub const fn name(self) -> SettingName {
                SettingName::text(match self { $(Self::$setting => $field),* })
            }
        }
    };
}

settings! {
    Average "average" "average_s",
    WarmUp "warmup" "warmup_s",
    Settle "settle" "settle_s",
    Offset "offset" "offset_s",
    FinalTemperature "final_temp" "final_temp_s",
    MaxLost "max_lost" "max_lost",
    MaxUBtc "max_u_btc" "max_u_btc_dps_per_c",
    Earth "earth_dps" "earth_dps",
    AssumeLinear "assume_linear" "assume_linear",
    Target "target_dph" "target_dps",
    EveryTemp "every_temp" "every_temp",
    Divider "divider" "divider",
    Edge "edge" "rdy_edge",
    Device "device" "device",
    SelfTest "self_test" "self_test",
}

/// The names that a front end uses for the settings.
pub type SettingNames = fn(Setting) -> SettingName;

/// A text that names settings. Each front end has its own names for them.
pub trait Wording {
    /// Writes the text with these names for settings.
    ///
    /// # Errors
    /// Passes on the errors of the writer.
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
