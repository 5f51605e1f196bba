//! Tests the text form of a specification.

use adis16130_twin::{Fault, KEYS, Motion, Profile, RdyOutput, Roa, Spec, SpecError};

#[test]
fn every_key_reaches_its_field() {
    let text = "bias_dps=0.8,tempco_dps_per_c=-0.04,curvature=1e-3,hysteresis=0,lag_s=30,ambient_c=-10,profile=oven,\
         warmup_c=0,warmup_s=300,mclk_hz=6144000,rdy=pulse,roa=10nf,supply_step_mv=-20,noise=0,flicker_hz=0.01,\
         rotation_dps=5,motion=sway,sway_dps=2,sway_hz=1,bit_error_rate=1e-5,fault=rdy_stutter,fault_at_s=12.5,seed=9";
    let missing = KEYS.iter().find(|key| !text.contains(&format!("{}=", key.name)));
    assert_eq!(missing.map(|key| key.name), None);
    let expected = Spec {
        bias_dps: 0.8,
        tempco_dps_per_c: -0.04,
        curvature_dps_per_c2: 1e-3,
        hysteresis_dps: 0.0,
        lag_s: 30.0,
        ambient_c: -10.0,
        profile: Profile::Oven,
        warmup_c: 0.0,
        warmup_s: 300.0,
        mclk_hz: 6.144e6,
        rdy: RdyOutput::Pulse,
        roa: Roa::TenNanofarad,
        supply_step_mv: -20.0,
        noise: false,
        flicker_hz: 0.01,
        rotation_dps: 5.0,
        motion: Motion::Sway,
        sway_dps: 2.0,
        sway_hz: 1.0,
        bit_error_rate: 1e-5,
        fault: Fault::RdyStutter,
        fault_at_s: Some(12.5),
        ..Spec::from_seed(9)
    };
    assert_eq!(Spec::parse_keys(text).unwrap(), expected);
    assert_eq!(text.parse::<Spec>().unwrap(), expected);
}

#[test]
fn defaults_are_seed_1() {
    assert_eq!(Spec::parse_keys(""), Ok(Spec::from_seed(1)));
    assert_eq!(Spec::parse_keys("noise=1, motion = none"), Ok(Spec::default()));
}

#[test]
fn an_override_changes_nothing_else() {
    let drawn = Spec::from_seed(5);
    let set = Spec::parse_keys("seed=5,bias_dps=0").unwrap();
    assert_eq!(Spec { bias_dps: drawn.bias_dps, ..set }, drawn);
}

#[test]
fn bad_items_are_named() {
    let message = |text: &str| Spec::parse_keys(text).unwrap_err().to_string();
    assert_eq!(message("sede=7"), "unknown key `sede`; did you mean `seed`?");
    assert_eq!(message("bias=0.4"), "unknown key `bias`; did you mean `bias_dps`?");
    assert!(message("tempco=0.04").contains("`tempco_dps_per_c`?"));
    assert!(message("zzzzzz=1").starts_with("unknown key `zzzzzz`; known keys: seed bias_dps"));
    assert_eq!(message("seed"), "`seed` is not key=value");
    assert_eq!(message("seed=1,"), "`` is not key=value");
    assert_eq!(message("seed=1,seed=2"), "seed is given twice");
    assert_eq!(message("seed=-1"), "seed=-1: seed takes a whole number from 0 to 2^64 - 1");
    assert_eq!(message("profile=cold"), "profile=cold: profile takes constant|ramp|oven");
    for mclk in ["NaN", "-6e6", "0", "999", "10000001", "inf", "six", ""] {
        let text = format!("mclk_hz={mclk}");
        assert_eq!(message(&text), format!("{text}: mclk_hz takes a number from 1000 to 10000000"));
    }
    assert!(matches!(Spec::parse_keys("noise=2"), Err(SpecError::BadValue { key: "noise", .. })));
}
