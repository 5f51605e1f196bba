//! The numbers of the remedies for a refusal, which `zerorate_procedure_remedy` returns.

use zerorate::Remedy;

/// Set `earth_dps` to the component of the Earth's rotation on the axis.
pub const ZERORATE_REMEDY_GIVE_EARTH: u8 = 1;
/// Set `assume_linear`, if this unit is known to be linear.
pub const ZERORATE_REMEDY_ASSUME_LINEAR: u8 = 2;
/// Settle longer (`settle_s`).
pub const ZERORATE_REMEDY_SETTLE_LONGER: u8 = 3;
/// Shield the part from draughts.
pub const ZERORATE_REMEDY_SHIELD_FROM_DRAUGHTS: u8 = 4;
/// Use a linear supply.
pub const ZERORATE_REMEDY_LINEAR_SUPPLY: u8 = 5;
/// Check that nothing moved.
pub const ZERORATE_REMEDY_CHECK_NOTHING_MOVED: u8 = 6;
/// Check that nothing moved slowly.
pub const ZERORATE_REMEDY_CHECK_NOTHING_MOVED_SLOWLY: u8 = 7;
/// Measure at several temperatures in a chamber (F-54).
pub const ZERORATE_REMEDY_CHAMBER: u8 = 8;
/// Warm the part more slowly, and let it settle longer.
pub const ZERORATE_REMEDY_WARM_MORE_SLOWLY: u8 = 9;
/// Fix the part to a still platform.
pub const ZERORATE_REMEDY_FIX_TO_STILL_PLATFORM: u8 = 10;
/// Check the calibration over a wider range of temperatures before you rely on it elsewhere than at T3.
pub const ZERORATE_REMEDY_CHECK_OVER_WIDER_RANGE: u8 = 11;
/// Record the samples and compute the calibration from them.
pub const ZERORATE_REMEDY_RECORD_AND_RECOMPUTE: u8 = 12;
/// Average the rate of step 8 longer (`offset_s`).
pub const ZERORATE_REMEDY_LONGER_OFFSET: u8 = 13;
/// Use a smaller divider of the edges of RDY.
pub const ZERORATE_REMEDY_SMALLER_DIVIDER: u8 = 14;
/// Use a larger divider of the edges of RDY.
pub const ZERORATE_REMEDY_LARGER_DIVIDER: u8 = 15;
/// Lower the SPI clock.
pub const ZERORATE_REMEDY_SLOWER_CLOCK: u8 = 16;
/// Shorten or shield the cable.
pub const ZERORATE_REMEDY_SHORTER_CABLE: u8 = 17;
/// Read at another rate, for example with another divider.
pub const ZERORATE_REMEDY_OTHER_RATE: u8 = 18;
/// Keep the platform still.
pub const ZERORATE_REMEDY_KEEP_STILL: u8 = 19;
/// Remove the vibration.
pub const ZERORATE_REMEDY_REMOVE_VIBRATION: u8 = 20;
/// Start with a part that was off for an hour.
pub const ZERORATE_REMEDY_START_COLD: u8 = 21;
/// Warm up longer (`warmup_s`).
pub const ZERORATE_REMEDY_LONGER_WARM_UP: u8 = 22;
/// Accept a larger uncertainty of BTC (`max_u_btc_dps_per_c`).
pub const ZERORATE_REMEDY_ACCEPT_MORE_U_BTC: u8 = 23;
/// Read the temperature less often.
pub const ZERORATE_REMEDY_READ_TEMPERATURE_LESS: u8 = 24;
/// Read the temperature more often.
pub const ZERORATE_REMEDY_READ_TEMPERATURE_MORE: u8 = 25;
/// Allow a larger share of lost samples (`max_lost`).
pub const ZERORATE_REMEDY_ALLOW_MORE_LOSS: u8 = 26;
/// Check supply and wiring.
pub const ZERORATE_REMEDY_CHECK_SUPPLY_AND_WIRING: u8 = 27;
/// Check the data-ready wire, its level and its pull-up. If they are right, check what else the host does.
pub const ZERORATE_REMEDY_CHECK_DATA_READY: u8 = 28;
/// Reset the part, and check its data wire and its supply.
pub const ZERORATE_REMEDY_RESET_AND_CHECK: u8 = 29;
/// Average longer in steps 4 and 6 (`average_s`).
pub const ZERORATE_REMEDY_LONGER_AVERAGE: u8 = 30;
/// Add the missing typical values to the part's file.
pub const ZERORATE_REMEDY_COMPLETE_PART: u8 = 31;
/// Calibrate over a wider span of temperatures.
pub const ZERORATE_REMEDY_WIDER_SPAN: u8 = 32;
/// Raise the SPI clock.
pub const ZERORATE_REMEDY_FASTER_CLOCK: u8 = 33;
/// Use the other edge of data ready (`rdy_rises`).
pub const ZERORATE_REMEDY_OTHER_EDGE: u8 = 36;

const _: () = {
    assert!(ZERORATE_REMEDY_GIVE_EARTH == Remedy::GiveEarth.code());
    assert!(ZERORATE_REMEDY_ASSUME_LINEAR == Remedy::AssumeLinear.code());
    assert!(ZERORATE_REMEDY_SETTLE_LONGER == Remedy::SettleLonger.code());
    assert!(ZERORATE_REMEDY_SHIELD_FROM_DRAUGHTS == Remedy::ShieldFromDraughts.code());
    assert!(ZERORATE_REMEDY_LINEAR_SUPPLY == Remedy::LinearSupply.code());
    assert!(ZERORATE_REMEDY_CHECK_NOTHING_MOVED == Remedy::CheckNothingMoved.code());
    assert!(ZERORATE_REMEDY_CHECK_NOTHING_MOVED_SLOWLY == Remedy::CheckNothingMovedSlowly.code());
    assert!(ZERORATE_REMEDY_CHAMBER == Remedy::Chamber.code());
    assert!(ZERORATE_REMEDY_WARM_MORE_SLOWLY == Remedy::WarmMoreSlowly.code());
    assert!(ZERORATE_REMEDY_FIX_TO_STILL_PLATFORM == Remedy::FixToStillPlatform.code());
    assert!(ZERORATE_REMEDY_CHECK_OVER_WIDER_RANGE == Remedy::CheckOverWiderRange.code());
    assert!(ZERORATE_REMEDY_RECORD_AND_RECOMPUTE == Remedy::RecordAndRecompute.code());
    assert!(ZERORATE_REMEDY_LONGER_OFFSET == Remedy::LongerOffset.code());
    assert!(ZERORATE_REMEDY_SMALLER_DIVIDER == Remedy::SmallerDivider.code());
    assert!(ZERORATE_REMEDY_LARGER_DIVIDER == Remedy::LargerDivider.code());
    assert!(ZERORATE_REMEDY_SLOWER_CLOCK == Remedy::SlowerClock.code());
    assert!(ZERORATE_REMEDY_SHORTER_CABLE == Remedy::ShorterCable.code());
    assert!(ZERORATE_REMEDY_OTHER_RATE == Remedy::OtherRate.code());
    assert!(ZERORATE_REMEDY_KEEP_STILL == Remedy::KeepStill.code());
    assert!(ZERORATE_REMEDY_REMOVE_VIBRATION == Remedy::RemoveVibration.code());
    assert!(ZERORATE_REMEDY_START_COLD == Remedy::StartCold.code());
    assert!(ZERORATE_REMEDY_LONGER_WARM_UP == Remedy::LongerWarmUp.code());
    assert!(ZERORATE_REMEDY_ACCEPT_MORE_U_BTC == Remedy::AcceptMoreUBtc.code());
    assert!(ZERORATE_REMEDY_READ_TEMPERATURE_LESS == Remedy::ReadTemperatureLess.code());
    assert!(ZERORATE_REMEDY_READ_TEMPERATURE_MORE == Remedy::ReadTemperatureMore.code());
    assert!(ZERORATE_REMEDY_ALLOW_MORE_LOSS == Remedy::AllowMoreLoss.code());
    assert!(ZERORATE_REMEDY_CHECK_SUPPLY_AND_WIRING == Remedy::CheckSupplyAndWiring.code());
    assert!(ZERORATE_REMEDY_CHECK_DATA_READY == Remedy::CheckDataReady.code());
    assert!(ZERORATE_REMEDY_RESET_AND_CHECK == Remedy::ResetAndCheck.code());
    assert!(ZERORATE_REMEDY_LONGER_AVERAGE == Remedy::LongerAverage.code());
    assert!(ZERORATE_REMEDY_COMPLETE_PART == Remedy::CompletePart.code());
    assert!(ZERORATE_REMEDY_WIDER_SPAN == Remedy::WiderSpan.code());
    assert!(ZERORATE_REMEDY_FASTER_CLOCK == Remedy::FasterClock.code());
    assert!(ZERORATE_REMEDY_OTHER_EDGE == Remedy::OtherEdge.code());
};
