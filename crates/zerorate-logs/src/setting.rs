//! The names of options in messages, which each front end sets.

use zerorate_allan::SettingName;

/// Makes [`Setting`] from a row for each: its variant and its word.
macro_rules! settings {
    ($($setting:ident $word:literal;)*) => {
        /// An option of [`ColumnOptions`](super::ColumnOptions) or of a front end. Each front end has its own name for
        /// it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        #[expect(missing_docs, reason = "the fields of `ColumnOptions`, and of `ImuOptions` and `Choice`")]
        pub enum Setting { $($setting),* }

        impl Setting {
            /// The word from which front ends make the name of the option: `time_column`.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$setting => $word),* }
            }
        }
    };
}

settings! {
    Column "column";
    Topic "topic";
    TimeColumn "time_column";
    TimeUnit "time_unit";
    Rate "rate";
    Unit "unit";
    Scale "scale";
    Decimal "decimal";
    Raw "raw";
    MaxBad "max_bad";
    Gyro "gyro";
    Accel "accel";
    GyroUnit "gyro_unit";
    AccelUnit "accel_unit";
    GyroRange "gyro_range";
    AccelRange "accel_range";
    Part "part";
    ForceUnit "force_unit";
    Combine "combine";
    Horizon "horizon";
    AsFitted "as_fitted";
    Format "format";
    Skip "skip";
    Until "until";
    Detrend "detrend";
    TempColumn "temp_column";
    Where "where";
    Increments "increments";
    NoIncrements "no increments";
}

impl Setting {
    /// The name of the option without a front end, such as the field `time_column` of
    /// [`ColumnOptions`](super::ColumnOptions).
    #[must_use]
    pub const fn name(self) -> SettingName {
        SettingName::text(self.word())
    }
}

/// The names of the options in a front end.
#[derive(Clone, Copy, Debug)]
pub struct Names(pub fn(Setting) -> SettingName);

impl Names {
    /// The name of an option in this front end.
    #[must_use]
    pub fn of(self, setting: Setting) -> SettingName {
        (self.0)(setting)
    }
}

impl Default for Names {
    fn default() -> Self {
        Self(Setting::name)
    }
}

/// Quotes a name for a shell, if it needs quotes.
pub fn quoted(name: &str) -> String {
    let is_plain = name.chars().all(|c| c.is_alphanumeric() || "_-./:#,=".contains(c));
    if is_plain { name.to_owned() } else { format!("'{}'", name.replace('\'', "'\\''")) }
}
