//! The settings of a measurement, and texts that name them as each front end does.

use core::fmt;

/// A setting of a measurement, for which each front end has its own name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields of `Plan`; which device is read, how often, and whether it is tested")]
pub enum Setting {
    Average,
    WarmUp,
    Settle,
    Offset,
    FinalTemperature,
    MaxLost,
    MaxUBtc,
    Earth,
    AssumeLinear,
    Target,
    EveryTemp,
    Divider,
    Edge,
    Device,
    SelfTest,
}

impl Setting {
    /// Name of the setting as a field of [`Plan`](crate::Plan) or of the reader of the part.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Average => "average_s",
            Self::WarmUp => "warmup_s",
            Self::Settle => "settle_s",
            Self::Offset => "offset_s",
            Self::FinalTemperature => "final_temp_s",
            Self::MaxLost => "max_lost",
            Self::MaxUBtc => "max_u_btc_dps_per_c",
            Self::Earth => "earth_dps",
            Self::AssumeLinear => "assume_linear",
            Self::Target => "target_dps",
            Self::EveryTemp => "every_temp",
            Self::Divider => "divider",
            Self::Edge => "rdy_edge",
            Self::Device => "device",
            Self::SelfTest => "self_test",
        }
    }
}

/// The names that a front end uses for the settings.
pub type SettingNames = fn(Setting) -> &'static str;

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
