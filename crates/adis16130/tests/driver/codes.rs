//! Tests the conversions of codes with the published vectors (F-40 … F-43).

use adis16130::{
    RATE_LSB_PER_DPS, RateCode, TEMP_AT_ZERO_CODE_C, TEMP_LSB_PER_C, TempCode, Width, ZERO_CODE, round_to_16_bits,
};

/// The nine rates of F-42: code, µ°/s rounded to nearest, °/s.
const RATES: [(u32, i32, f32); 9] = [
    (14_260_608, 250_000_000, 250.0),
    (8_623_488, 10_000_000, 10.0),
    (8_388_612, 170, 0.000_170_30),
    (8_388_609, 43, 0.000_042_575),
    (8_388_608, 0, 0.0),
    (8_388_607, -43, -0.000_042_575),
    (8_388_604, -170, -0.000_170_30),
    (8_153_728, -10_000_000, -10.0),
    (2_516_608, -250_000_000, -250.0),
];

/// The temperatures of F-42: code, m°C, °C.
const TEMPS: [(u32, i32, f32); 6] = [
    (9_516_048, 105_000, 105.0),
    (9_234_188, 85_000, 85.0),
    (8_402_701, 26_000, 26.0),
    (8_388_608, 25_000, 25.0),
    (8_036_283, 0, 0.0),
    (7_472_563, -40_000, -40.0),
];

#[test]
fn f40_f41_scale() {
    assert_eq!(RATE_LSB_PER_DPS, 23_488);
    assert_eq!(TEMP_LSB_PER_C, 14_093);
    assert_eq!(ZERO_CODE, 8_388_608);
    assert_eq!(TEMP_AT_ZERO_CODE_C, 25);
}

#[test]
fn f42_rates_are_exact() {
    for (code, udps, dps) in RATES {
        let rate = RateCode::new(code, Width::Bits24);
        assert_eq!(rate.to_udps(), udps, "{code}");
        // The small vectors are printed with five digits.
        let digits = if dps.fract() == 0.0 { 0.0 } else { 5e-9 };
        assert!((rate.to_dps() - dps).abs() <= digits, "{code}: {}", rate.to_dps());
    }
}

#[test]
fn f42_temperatures_are_exact() {
    for (code, millicelsius, celsius) in TEMPS {
        let temp = TempCode::new(code, Width::Bits24);
        assert_eq!(temp.to_millicelsius(), millicelsius, "{code}");
        assert_eq!(temp.to_celsius(), celsius, "{code}");
    }
}

#[test]
fn f43_rounds_ties_away_from_zero_rate() {
    let rates =
        [(14_260_608, 55_706), (8_623_488, 33_686), (8_388_608, 32_768), (8_153_728, 31_850), (2_516_608, 9_830)];
    let temps =
        [(9_516_048, 37_172), (9_234_188, 36_071), (8_402_701, 32_823), (8_036_283, 31_392), (7_472_563, 29_190)];
    for (code24, code16) in rates.into_iter().chain(temps) {
        assert_eq!(round_to_16_bits(code24), code16, "{code24}");
    }
    assert_eq!(round_to_16_bits(0), 0);
    assert_eq!(round_to_16_bits(0xFF_FFFF), 0xFFFF, "limited, not wrapped");
}

#[test]
fn sixteen_bits_are_the_24_bit_scale_divided_by_256() {
    let rate = RateCode::new(33_686, Width::Bits16);
    assert_eq!((rate.code(), rate.code24(), rate.width()), (33_686, 33_686 * 256, Width::Bits16));
    assert!((rate.to_dps() - 10.0).abs() < 0.006, "half a 16-bit code");
    assert_eq!(RateCode::new(32_768, Width::Bits16).to_udps(), 0);
    assert_eq!(TempCode::new(32_768, Width::Bits16).to_millicelsius(), 25_000);
}

#[test]
fn integers_round_to_nearest_over_the_whole_range() {
    for code in (0..=0xFF_FFFF_u32).step_by(9_973).chain([0, 0xFF_FFFF]) {
        let signed = f64::from(code) - 8_388_608.0;
        let rate = RateCode::new(code, Width::Bits24);
        assert_eq!(rate.to_dps(), (signed / 23_488.0) as f32, "{code}");
        let udps = rate.to_udps();
        assert!((f64::from(udps) - signed / 23_488.0 * 1e6).abs() <= 0.5 + 1e-6, "{code}");
        let temp = TempCode::new(code, Width::Bits24);
        assert!((f64::from(temp.to_millicelsius()) - (signed / 14_093.0 + 25.0) * 1e3).abs() <= 0.5 + 1e-6);
        assert!((f64::from(temp.to_celsius()) - (signed / 14_093.0 + 25.0)).abs() < 4e-5, "{code}");
    }
}

#[test]
fn rails_and_surplus_bits() {
    assert!(RateCode::new(0, Width::Bits24).is_at_rail());
    assert!(RateCode::new(0xFF_FFFF, Width::Bits24).is_at_rail());
    assert!(!RateCode::new(0xFFFF, Width::Bits24).is_at_rail());
    assert!(TempCode::new(0xFFFF, Width::Bits16).is_at_rail());
    assert_eq!(RateCode::new(0x1_8000, Width::Bits16).code(), 0x8000);
}
