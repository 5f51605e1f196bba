//! The names of options in messages, which each front end sets.

use std::fmt;
use zerorate_allan::SettingName;

/// An option of [`ColumnOptions`](super::ColumnOptions) or of a front end. Each front end has its own name for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields of `ColumnOptions`, and of `ImuOptions` and `Choice`")]
pub enum Setting {
    Column,
    Topic,
    TimeColumn,
    TimeUnit,
    Rate,
    Unit,
    Scale,
    Decimal,
    Raw,
    MaxBad,
    Gyro,
    Accel,
    GyroUnit,
    AccelUnit,
    GyroRange,
    AccelRange,
    Part,
    ForceUnit,
    Combine,
    Horizon,
    AsFitted,
    Format,
    Skip,
    Until,
    Detrend,
    TempColumn,
    Where,
    Increments,
    NoIncrements,
}

impl Setting {
    /// The name of the option without a front end, such as the field `time_column` of
    /// [`ColumnOptions`](super::ColumnOptions).
    #[must_use]
    pub const fn name(self) -> SettingName {
        SettingName::text(self.word())
    }

    /// The word from which front ends make the name of the option: `time_column`.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Column => "column",
            Self::Topic => "topic",
            Self::TimeColumn => "time_column",
            Self::TimeUnit => "time_unit",
            Self::Rate => "rate",
            Self::Unit => "unit",
            Self::Scale => "scale",
            Self::Decimal => "decimal",
            Self::Raw => "raw",
            Self::MaxBad => "max_bad",
            Self::Gyro => "gyro",
            Self::Accel => "accel",
            Self::GyroUnit => "gyro_unit",
            Self::AccelUnit => "accel_unit",
            Self::GyroRange => "gyro_range",
            Self::AccelRange => "accel_range",
            Self::Part => "part",
            Self::ForceUnit => "force_unit",
            Self::Combine => "combine",
            Self::Horizon => "horizon",
            Self::AsFitted => "as_fitted",
            Self::Format => "format",
            Self::Skip => "skip",
            Self::Until => "until",
            Self::Detrend => "detrend",
            Self::TempColumn => "temp_column",
            Self::Where => "where",
            Self::Increments => "increments",
            Self::NoIncrements => "no increments",
        }
    }
}

/// The names of the options in a front end.
#[derive(Clone, Copy)]
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

impl fmt::Debug for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Names({}, …)", self.of(Setting::Column))
    }
}
