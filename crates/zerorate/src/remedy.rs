//! What to do about a warning or a refusal: a value, which each front end puts into its own words.

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
    /// Its name as a field of [`Plan`](crate::Plan), or of what reads the part.
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

/// What a front end calls a setting.
pub type Names = fn(Setting) -> &'static str;

/// Something to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[repr(u8)]
#[expect(missing_docs, reason = "its text says it")]
pub enum Remedy {
    GiveEarth = 1,
    AssumeLinear,
    SettleLonger,
    ShieldFromDraughts,
    LinearSupply,
    CheckNothingMoved,
    CheckNothingMovedSlowly,
    Chamber,
    WarmMoreSlowly,
    FixToStillPlatform,
    CheckOverWiderRange,
    RecordAndRecompute,
    LongerOffset,
    SmallerDivider,
    LargerDivider,
    SlowerClock,
    ShorterCable,
    OtherRate,
    KeepStill,
    RemoveVibration,
    StartCold,
    LongerWarmUp,
    AcceptMoreUBtc,
    ReadTemperatureLess,
    ReadTemperatureMore,
    AllowMoreLoss,
    CheckSupplyAndWiring,
    CheckDataReady,
    ResetAndCheck,
    LongerAverage,
    CompletePart,
    WiderSpan,
    FasterClock,
    HeatAndCool,
    GiveUpTarget,
    OtherEdge,
}

impl Remedy {
    /// A number that stays, for C.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The setting that it is about, if it is about one.
    #[must_use]
    pub const fn setting(self) -> Option<Setting> {
        Some(match self {
            Self::GiveEarth => Setting::Earth,
            Self::AssumeLinear => Setting::AssumeLinear,
            Self::SettleLonger => Setting::Settle,
            Self::LongerOffset => Setting::Offset,
            Self::SmallerDivider | Self::LargerDivider | Self::OtherRate => Setting::Divider,
            Self::LongerWarmUp => Setting::WarmUp,
            Self::AcceptMoreUBtc => Setting::MaxUBtc,
            Self::ReadTemperatureLess | Self::ReadTemperatureMore => Setting::EveryTemp,
            Self::AllowMoreLoss => Setting::MaxLost,
            Self::GiveUpTarget => Setting::Target,
            Self::LongerAverage => Setting::Average,
            Self::OtherEdge => Setting::Edge,
            _ => return None,
        })
    }

    /// What to do, before the name of its setting.
    const fn text(self) -> &'static str {
        match self {
            Self::GiveEarth => "give its component on the axis",
            Self::AssumeLinear => "if this unit is known to be linear, say so",
            Self::SettleLonger => "settle longer",
            Self::ShieldFromDraughts => "shield the part from draughts",
            Self::LinearSupply => "use a linear supply",
            Self::CheckNothingMoved => "check that nothing moved",
            Self::CheckNothingMovedSlowly => "check that nothing moved slowly",
            Self::Chamber => "measure at several temperatures in a chamber (F-54)",
            Self::WarmMoreSlowly => "warm and settle longer and more slowly",
            Self::FixToStillPlatform => "fix the part to a still platform",
            Self::CheckOverWiderRange => "check it over a wider range before you rely on it elsewhere than at T3",
            Self::RecordAndRecompute => "record the samples and compute the calibration from them",
            Self::LongerOffset => "average the offset longer",
            Self::SmallerDivider => "use a smaller divider",
            Self::LargerDivider => "use a larger divider",
            Self::SlowerClock => "lower the SPI clock",
            Self::ShorterCable => "shorten or shield the cable",
            Self::OtherRate => "read at another rate",
            Self::KeepStill => "keep the platform still",
            Self::RemoveVibration => "remove the vibration",
            Self::StartCold => "start with a part that was off for an hour",
            Self::LongerWarmUp => "wait longer",
            Self::AcceptMoreUBtc => "accept more",
            Self::ReadTemperatureLess => "read the temperature less often",
            Self::ReadTemperatureMore => "read the temperature more often",
            Self::AllowMoreLoss => "allow more",
            Self::CheckSupplyAndWiring => "check supply and wiring",
            Self::CheckDataReady => {
                "check the data-ready wire, its level and its pull-up, and only then what else the host does"
            }
            Self::ResetAndCheck => "reset the part, and check its data wire and its supply",
            Self::LongerAverage => "average longer",
            Self::CompletePart => "complete the file of the part",
            Self::WiderSpan => "calibrate over a wider span",
            Self::FasterClock => "raise the SPI clock",
            Self::HeatAndCool => "heat and cool the part, by hand or in a chamber",
            Self::GiveUpTarget => "ask for what the part can give",
            Self::OtherEdge => "listen to the other edge of data ready",
        }
    }
}

/// Something whose text names settings.
pub trait Say {
    /// Says it, with these names for settings.
    ///
    /// # Errors
    /// The writer's.
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result;

    /// The same, to be displayed.
    fn with(&self, names: Names) -> Said<'_, Self>
    where
        Self: Sized,
    {
        Said { what: self, names }
    }
}

/// Something and the names of its settings.
#[derive(Clone, Copy, Debug)]
pub struct Said<'a, T> {
    what: &'a T,
    names: Names,
}

impl<T: Say> fmt::Display for Said<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.what.say(f, self.names)
    }
}

/// Says remedies one after the other, each with the name of its setting in brackets.
pub(crate) fn say_all(remedies: &[Remedy], f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
    for remedy in remedies {
        write!(f, "; {}", remedy.text())?;
        if let Some(setting) = remedy.setting() {
            write!(f, " ({})", names(setting))?;
        }
    }
    Ok(())
}
