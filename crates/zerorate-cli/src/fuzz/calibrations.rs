//! Damaged calibrations, and the reports made of them.

use super::edited;
use zerorate::Calibration;

/// A measured calibration of one axis, without the check lines, which would reject every edit.
const CALIBRATION: &str = include_str!("../../tests/golden/hour-3.toml");

/// The calibration with the fields that a simulated part lacks.
fn calibration() -> String {
    let fields = "created = \"2026-01-02T03:04:05Z\"\nsupply_note = \"linear\"\nwarnings = [\"one\", \"two\"]\n";
    let (before, after) = CALIBRATION.split_once("created = \"SIMULATED\"\n").expect("a simulated calibration");
    [before, fields, after].concat()
}

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
fn calibrations() {
    let text = calibration();
    let (measured, _) = Calibration::parse(&text).expect("a calibration");
    let (axes, _) = Calibration::parse(AXES).expect("a calibration");
    let curves = AXES.replace("schema = 2", "schema = 3").replace("t3_c = 3 }", "t3_c = 3, btc2_dps_per_c2 = 4e-4 }");
    Calibration::parse(&curves).expect("a calibration");
    let seeds = [&text, &measured.to_toml(), AXES, &axes.to_toml(), &curves].map(|text| text.as_bytes().to_vec());
    edited(1500, &seeds, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let Ok((calibration, _)) = Calibration::parse(text) else { return };
        assert!(calibration.axes.iter().all(|axis| axis.correction.apply(0.0, 25.0).is_finite()));
        let (again, _) = Calibration::parse(&calibration.to_toml()).expect("what is written can be read");
        assert_eq!(again, calibration);
        zerorate_view::report::calibration_page(&[(calibration, "edited".to_owned())], None).expect("a page");
    });
}
