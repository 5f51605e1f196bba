//! Damaged calibrations, and the reports made of them.

use super::edited;
use zerorate::Calibration;

/// A calibration of one axis with most of the fields that a file may have.
const CALIBRATION: &str = r#"schema = 1
part = "ADIS16130"
serial = "A17"
created = "2026-01-02T03:04:05Z"
method = "an1042"
supply_note = "linear"
warnings = ["one", "two"]

[correction]
pbc_dps = -0.25
btc_dps_per_c = -0.04
t3_c = 31.5

[measured]
b1_dps = 0.5
t1_c = 25.0
b2_dps = 0.8
t2_c = 32.5

[uncertainty]
coverage = 0.95
coverage_factor = 1.96
u_pbc_dps = 0.004
u_btc_dps_per_c = 0.001
u_t3_c = 0.01
cov_pbc_btc_dps2_per_c = 0.0
cov_pbc_t3_dps_c = 0.0
cov_btc_t3_dps = 0.0
u_curvature_dps_per_c = 0.0005
u_b1_dps = 0.004
u_t1_c = 0.01
u_b2_dps = 0.004
u_t2_c = 0.01

[noise]
white_dps_per_rt_hz = 0.008
white_source = "measured"
flicker_floor_dps = 0.002
flicker_cutoff_hz = 0.0001
flicker_source = "measured"
rate_random_walk_dps_per_rt_s = 0.00001
rate_random_walk_source = "typical (M-04)"

[validity]
temp_min_c = 25.0
temp_max_c = 32.5

[run]
duration_s = 3183.5
rate_hz = 5703.0
rdy_hz = 5703.0
samples = 18000000
lost_samples = 7
average_s = 10.0
warmup_s = 600.0
settle_s = 2400.0
offset_s = 150.0
max_lost = 0.001
max_u_btc_dps_per_c = 0.01
earth_dps = 0.003
assume_linear = false
"#;

/// A calibration of two axes. The first has only the required fields.
const AXES: &str = r#"schema = 2
part = "ADIS16405"
axis = [{ name = "x", correction = { pbc_dps = 1, btc_dps_per_c = 0, t3_c = 3 } }, { name = "y", warnings = ["one"],
    rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16, signed = true },
    correction = { pbc_dps = -0.25, btc_dps_per_c = -0.04, t3_c = 31.5 } }]
[temperature]
lsb_per_c = 7.14
zero_code = 0
zero_c = 25
width_bits = 12
[validity]
temp_min_c = 25.0
temp_max_c = 32.5
margin_c = 1.4
"#;

/// A calibration that is accepted gives finite rates, reads back as written, and makes a report.
#[test]
fn calibration() {
    let (measured, _) = Calibration::parse(CALIBRATION).expect("a calibration");
    let (axes, _) = Calibration::parse(AXES).expect("a calibration");
    let curves = AXES.replace("schema = 2", "schema = 3").replace("t3_c = 3 }", "t3_c = 3, btc2_dps_per_c2 = 4e-4 }");
    Calibration::parse(&curves).expect("a calibration");
    let seeds =
        [CALIBRATION, &measured.to_toml(), AXES, &axes.to_toml(), &curves].map(|text| text.as_bytes().to_vec());
    edited(1500, &seeds, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let Ok((calibration, _)) = Calibration::parse(text) else { return };
        assert!(calibration.axes.iter().all(|axis| axis.correction.apply(0.0, 25.0).is_finite()));
        let (again, _) = Calibration::parse(&calibration.to_toml()).expect("what is written can be read");
        assert_eq!(again, calibration);
        zerorate_view::report::calibration_page(&[(calibration, "edited".to_owned())], None).expect("a page");
    });
}
