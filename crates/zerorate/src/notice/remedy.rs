//! Remedies: what to do about a warning or a refusal. Each front end adds its own names of the settings.

use crate::plan::{Setting, SettingNames};
use core::fmt;

/// Makes [`Remedy`] from a row for each remedy: its number, its variant, its text without the name of its setting and,
/// if it changes a setting, that setting.
macro_rules! remedies {
    (@setting) => { None };
    (@setting $setting:ident) => { Some(Setting::$setting) };
    ($($code:literal $remedy:ident $text:literal $($setting:ident)?;)*) => {
        /// A remedy: one thing that the user can do.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        #[repr(u8)]
        #[expect(missing_docs, reason = "its text says it")]
        pub enum Remedy { $($remedy = $code),* }

        impl Remedy {
            /// The setting that the remedy changes, if it changes one.
            #[must_use]
            pub const fn setting(self) -> Option<Setting> {
                match self { $(Self::$remedy => remedies!(@setting $($setting)?)),* }
            }

            const fn text(self) -> &'static str {
                match self { $(Self::$remedy => $text),* }
            }
        }
    };
}

remedies! {
    1 GiveEarth "give its component" Earth;
    2 AssumeLinear "if linear, state it" AssumeLinear;
    3 SettleLonger "settle longer" Settle;
    4 ShieldFromDraughts "shield the part from draughts";
    5 LinearSupply "use a linear supply";
    6 CheckNothingMoved "check that nothing moved";
    7 CheckNothingMovedSlowly "check that nothing moved slowly";
    8 Chamber "measure in a chamber";
    9 WarmMoreSlowly "warm and settle more slowly";
    10 FixToStillPlatform "fix it to a still base";
    11 CheckOverWiderRange "check it over a wider range";
    12 RecordAndRecompute "calibrate from a recording";
    13 LongerOffset "average the offset longer" Offset;
    14 SmallerDivider "use a smaller divider" Divider;
    15 LargerDivider "use a larger divider" Divider;
    16 SlowerClock "lower the SPI clock";
    17 ShorterCable "shorten or shield the cable";
    18 OtherRate "change the rate" Divider;
    19 KeepStill "keep the platform still";
    20 RemoveVibration "remove the vibration";
    21 StartCold "start with a part that was off for an hour";
    22 LongerWarmUp "wait longer" WarmUp;
    23 AcceptMoreUBtc "accept more" MaxUBtc;
    24 ReadTemperatureLess "read the temperature less often" EveryTemp;
    25 ReadTemperatureMore "read the temperature more often" EveryTemp;
    26 AllowMoreLoss "allow more" MaxLost;
    27 CheckSupplyAndWiring "check supply and wiring";
    28 CheckDataReady "check the data-ready wire, its level and pull-up";
    29 ResetAndCheck "reset the part, check its data wire and supply";
    30 LongerAverage "average longer" Average;
    31 CompletePart "complete the part's file";
    32 WiderSpan "calibrate over a wider span";
    33 FasterClock "raise the SPI clock";
    34 HeatAndCool "heat and cool the part";
    35 GiveUpTarget "relax the target" Target;
    36 OtherEdge "use the other edge" Edge;
}

impl Remedy {
    /// The number of the remedy in the C interface. It never changes.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
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
