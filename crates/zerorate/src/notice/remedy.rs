//! Remedies: what to do about a warning or a refusal. Each front end adds its own names of the settings.

use crate::plan::{Setting, SettingNames};
use core::fmt;

/// A remedy: one thing that the user can do.
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
    /// The number of the remedy in the C interface. It never changes.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The setting that the remedy changes, if it changes one.
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

    /// The text of the remedy, without the name of its setting.
    const fn text(self) -> &'static str {
        match self {
            Self::GiveEarth => "give its component",
            Self::AssumeLinear => "if linear, state it",
            Self::SettleLonger => "settle longer",
            Self::ShieldFromDraughts => "shield the part from draughts",
            Self::LinearSupply => "use a linear supply",
            Self::CheckNothingMoved => "check that nothing moved",
            Self::CheckNothingMovedSlowly => "check that nothing moved slowly",
            Self::Chamber => "measure in a chamber",
            Self::WarmMoreSlowly => "warm and settle more slowly",
            Self::FixToStillPlatform => "fix it to a still base",
            Self::CheckOverWiderRange => "check it over a wider range",
            Self::RecordAndRecompute => "calibrate from a recording",
            Self::LongerOffset => "average the offset longer",
            Self::SmallerDivider => "use a smaller divider",
            Self::LargerDivider => "use a larger divider",
            Self::SlowerClock => "lower the SPI clock",
            Self::ShorterCable => "shorten or shield the cable",
            Self::OtherRate => "change the rate",
            Self::KeepStill => "keep the platform still",
            Self::RemoveVibration => "remove the vibration",
            Self::StartCold => "start with a part that was off for an hour",
            Self::LongerWarmUp => "wait longer",
            Self::AcceptMoreUBtc => "accept more",
            Self::ReadTemperatureLess => "read the temperature less often",
            Self::ReadTemperatureMore => "read the temperature more often",
            Self::AllowMoreLoss => "allow more",
            Self::CheckSupplyAndWiring => "check supply and wiring",
            Self::CheckDataReady => "check the data-ready wire, its level and pull-up",
            Self::ResetAndCheck => "reset the part, check its data wire and supply",
            Self::LongerAverage => "average longer",
            Self::CompletePart => "complete the part's file",
            Self::WiderSpan => "calibrate over a wider span",
            Self::FasterClock => "raise the SPI clock",
            Self::HeatAndCool => "heat and cool the part",
            Self::GiveUpTarget => "relax the target",
            Self::OtherEdge => "use the other edge",
        }
    }
}

/// Writes remedies as the end of a sentence, each with the name of its setting in brackets. An empty name is left out.
pub(crate) fn write_remedies(remedies: &[Remedy], f: &mut fmt::Formatter<'_>, names: SettingNames) -> fmt::Result {
    for (index, remedy) in remedies.iter().enumerate() {
        let before = match index {
            0 => "; ",
            _ if index + 1 == remedies.len() => ", or ",
            _ => ", ",
        };
        write!(f, "{before}{}", remedy.text())?;
        if let Some(name) = remedy.setting().map(names).filter(|name| !name.word.is_empty()) {
            write!(f, " ({name})")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remedy_names_the_setting_that_it_changes() {
        use Setting::{AssumeLinear, Average, Divider, Earth, Edge, EveryTemp, MaxLost, MaxUBtc};
        for (remedy, setting) in [
            (Remedy::GiveEarth, Earth),
            (Remedy::AssumeLinear, AssumeLinear),
            (Remedy::SettleLonger, Setting::Settle),
            (Remedy::LongerOffset, Setting::Offset),
            (Remedy::SmallerDivider, Divider),
            (Remedy::LargerDivider, Divider),
            (Remedy::OtherRate, Divider),
            (Remedy::LongerWarmUp, Setting::WarmUp),
            (Remedy::AcceptMoreUBtc, MaxUBtc),
            (Remedy::ReadTemperatureLess, EveryTemp),
            (Remedy::ReadTemperatureMore, EveryTemp),
            (Remedy::AllowMoreLoss, MaxLost),
            (Remedy::GiveUpTarget, Setting::Target),
            (Remedy::LongerAverage, Average),
            (Remedy::OtherEdge, Edge),
        ] {
            assert_eq!(remedy.setting(), Some(setting), "{remedy:?}");
        }
        assert_eq!(Remedy::KeepStill.setting(), None);
    }
}
