//! Calibration files of schema 2 and higher: several axes of any part.

use zerorate::calibration::{Calibration, FileError, FileWarning, NoiseRecord, Origin};
use zerorate::{Outcome, Part, Warning};

const PART: &str = r#"
    schema = 1
    name = "ADIS16405"
    axis = [{ name = "x" }, { name = "y" },
            { name = "z", rate = { lsb_per_dps = 40, zero_code = 0, width_bits = 14 } }]
    rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16, range_dps = 300 }
    temperature = { lsb_per_c = 7.14, zero_code = 0, zero_c = 25, width_bits = 12, noise_c = 0.14 }
    [noise]
    white_dps_per_rt_hz = 0.05
    flicker_floor_dps = { value = 0.007, source = "data sheet" }
    rate_random_walk_dps_per_rt_s = 3e-4
"#;

fn outcome_of(pbc_dps: f64, own: Warning) -> Outcome {
    let mut outcome = crate::outcome::outcome();
    outcome.correction.pbc_dps = pbc_dps;
    outcome.warnings = vec![Warning::EarthIncluded, own];
    outcome
}

fn measured() -> Calibration {
    let outcomes = [
        outcome_of(-0.253_712_345_678_901_2, Warning::Restless),
        outcome_of(0.7, Warning::CurvatureUnknown),
        outcome_of(0.1, Warning::RestUnjudged),
    ];
    let origin = Origin { serial: Some("SN \"17\"".into()), device: "replay:imu.csv".into(), ..Origin::default() };
    Calibration::new(&Part::parse(PART).unwrap(), &outcomes, origin)
}

#[test]
fn three_axes_come_back_bit_for_bit() {
    let calibration = measured();
    let text = calibration.to_toml();
    let (read, warnings) = Calibration::parse(&text).unwrap();
    assert_eq!(read, calibration, "{text}");
    assert_eq!((read.id(), read.schema()), (calibration.id(), 2));
    assert!(warnings.is_empty());
    let z = read.axis("z").unwrap();
    assert_eq!((z.rate.unwrap().codes(), z.correction.pbc_dps), ((-8192, 8191), 0.1));
    assert_eq!(read.temp.unwrap().value(714), 125.0);
    assert_eq!(read.validity.unwrap().margin_c, 10.0 * 0.14);
}

#[test]
fn a_warning_of_all_axes_stands_once() {
    let calibration = measured();
    // the text is without the name of a setting, which differs between front ends
    let warning = "earth-included: Earth rotation (up to 0.00418 °/s) is part of PBC; give its component";
    assert_eq!(calibration.warnings, [warning]);
    let own = calibration.axes.iter().map(|axis| axis.warnings.as_slice());
    let expected = [Warning::Restless, Warning::CurvatureUnknown, Warning::RestUnjudged]
        .map(|one| [format!("{}: {one}", one.code())]);
    assert!(own.eq(expected.iter().map(|one| &one[..])));
}

#[test]
fn noise_says_where_it_comes_from() {
    let NoiseRecord { white_source, flicker_source, rate_random_walk_source, .. } =
        measured().axes[1].noise.clone().unwrap();
    assert_eq!(
        [white_source, flicker_source, rate_random_walk_source],
        ["measured", "typical (data sheet)", "typical"]
    );
    let unknown = PART.split("[noise]").next().unwrap();
    let outcomes = [(); 3].map(|()| outcome_of(0.1, Warning::Restless));
    let calibration = Calibration::new(&Part::parse(unknown).unwrap(), &outcomes, Origin::default());
    assert_eq!(calibration.axes[0].noise.as_ref().unwrap().flicker_source, "unknown");
}

const BY_HAND: &str = r#"schema = 2
part = "ADIS16405"
[temperature]
lsb_per_c = 7.14
zero_code = 0
zero_c = 25
width_bits = 12
[[axis]]
name = "x"
correction = { pbc_dps = -0.25, btc_dps_per_c = -0.04, t3_c = 31.5 }
[[axis]]
name = "y"
[axis.rate]
lsb_per_dps = 20
zero_code = 0
width_bits = 16
[axis.correction]
pbc_dps = 0.75
btc_dps_per_c = 0.02
t3_c = 31.25
[validity]
temp_min_c = 25
temp_max_c = 33
"#;

const VALIDITY: &str = "[validity]\ntemp_min_c = 25\ntemp_max_c = 33";

#[test]
fn a_file_written_by_hand_may_lack_scales() {
    let (calibration, warnings) = Calibration::parse(BY_HAND).unwrap();
    assert_eq!(warnings, [FileWarning::NoChecksum]);
    assert_eq!((calibration.axes[0].rate, calibration.axes[1].rate.unwrap().lsb_per_unit), (None, 20.0));
    assert_eq!(calibration.validity.unwrap().margin_c, 0.5);
    let (again, _) = Calibration::parse(&calibration.to_toml()).unwrap();
    assert_eq!(again, calibration);
    let mut corrector = calibration.corrector("ADIS16405", ["x", "y"]).unwrap();
    corrector.read(Some(33.5));
    assert_eq!(corrector.correct(1, Some(1.0)), Some(1.0 + 0.75 + 2.25 * 0.02));
    assert!(!corrector.is_extrapolated() && corrector.correct(2, Some(1.0)).is_none());
}

/// Each row replaces a text in the file, and has the line, the axis and the text of the error.
#[test]
fn every_mistake_is_named_with_its_line_and_axis() {
    for (from, to, line, axis, said) in [
        ("schema = 2", "schema = 5", 1, None, "newer"),
        ("t3_c = 31.25", "t3_c = 31.25\nbtc3_dps_per_c3 = 1", 21, Some("y"), "btc3_dps_per_c3 belongs to schema 3"),
        ("schema = 2", "schema = 1", 8, Some("x"), "axis belongs to schema 2"),
        ("\"ADIS16405\"", "\"a b\"", 2, None, "up to 40 letters"),
        ("width_bits = 12", "width_bits = 40", 3, None, "width_bits is 40"),
        ("lsb_per_c = 7.14", "lsb_per_c = 0", 3, None, "not a scale"),
        ("lsb_per_c = 7.14", "lsb_per_k = 7.14", 4, None, "lsb_per_k"),
        ("pbc_dps = -0.25", "pbc_dps = nan", 10, Some("x"), "pbc_dps must be a number within ±100000 °/s"),
        ("pbc_dps = -0.25", "pbc_dsp = -0.25", 10, Some("x"), "pbc_dsp"),
        ("pbc_dps = -0.25, ", "", 10, Some("x"), "missing field `pbc_dps`"),
        ("name = \"x\"", "name = \"y\"", 12, Some("y"), "is the name of another axis"),
        ("name = \"y\"", "name = \"\\u0007\"", 12, Some("\u{7}"), "up to 40 letters"),
        ("name = \"y\"", "name = 5", 12, Some("2"), "invalid type"),
        ("name = \"y\"", "serial = 5", 12, Some("2"), "serial"),
        ("lsb_per_dps = 20", "lsb_per_dps = -20", 13, Some("y"), "not a scale"),
        ("width_bits = 16", "width_bits = 0", 13, Some("y"), "width_bits is 0"),
        // the range of the scale: 65 535 codes of 1/20 °/s are 3276.75 °/s
        ("pbc_dps = 0.75", "pbc_dps = 3277", 18, Some("y"), "pbc_dps must be a number within ±3277 °/s"),
        ("btc_dps_per_c = 0.02", "btc_dps_per_c = -inf", 19, Some("y"), "btc_dps_per_c must be a number"),
        // the scale reaches 25 + 2047/7.14 = 312 °C, so the general limit of 200 °C holds
        ("t3_c = 31.25", "t3_c = 200.5", 20, Some("y"), "t3_c must be a temperature within -100 … 200 °C"),
        ("t3_c = 31.25", "t3_c = 31.25\nt3_c = 3", 21, None, "duplicate key"),
        ("temp_min_c = 25", "temp_min_c = 34", 22, None, "must not lie above"),
        ("temp_min_c = 25", "temp_min_c = -1e300", 22, None, "temp_min_c must be a temperature"),
        ("temp_min_c = 25", "margin_c = -1\ntemp_min_c = 25", 22, None, "margin_c must be"),
        (VALIDITY, "[run]", 21, None, "missing field"),
        (VALIDITY, "[correction]\npbc_dps = 0\nbtc_dps_per_c = 0\nt3_c = 25", 21, None, "belongs into an [[axis]]"),
    ] {
        let text = BY_HAND.replace(from, to);
        assert_ne!(text, BY_HAND, "{from}");
        let error = Calibration::parse(&text).expect_err(to);
        let (at, of) = match &error {
            FileError::Syntax { line, axis, .. } | FileError::Value { line, axis, .. } => (*line, axis.as_deref()),
            FileError::Newer { line, .. } => (*line, None),
            other => panic!("{other:?}"),
        };
        assert_eq!((at, of), (line, axis), "{to}: {error}");
        assert!(error.to_string().contains(said), "{to}: {error}");
        if let Some(axis) = of.filter(|axis| *axis != "\u{7}") {
            assert!(error.to_string().starts_with(&format!("line {line}, axis {axis}: ")), "{error}");
        }
        assert!(!error.to_string().contains(|c: char| c.is_control() && c != '\n'), "{error:?}");
    }
}

#[test]
fn one_axis_at_least_and_eight_at_most() {
    let axis = "[[axis]]\nname = \"NAME\"\ncorrection = { pbc_dps = 0, btc_dps_per_c = 0, t3_c = 25 }\n";
    let with = |count: usize| {
        let axes = (0..count).map(|k| axis.replace("NAME", &format!("a{k}")));
        Calibration::parse(&axes.fold("schema = 2\npart = \"P\"\n".to_owned(), |text, axis| text + &axis))
    };
    assert!(with(0).unwrap_err().to_string().contains("there is no [[axis]]"));
    assert_eq!(with(8).unwrap().0.axes.len(), 8);
    assert!(with(9).unwrap_err().to_string().contains("axis stands 9 times; give 1 to 8"));
    let none = Calibration::parse("schema = 2\npart = \"P\"\naxis = []\n").unwrap_err().to_string();
    assert!(none.contains("axis stands 0 times"), "{none}");
}

/// Schema 1 cannot express another part, scale, margin or name of the axis, nor warnings of the axis alone.
#[test]
fn schema_1_is_written_only_for_a_line_of_a_standard_adis16130() {
    let one = |change: fn(&mut Calibration)| {
        let outcomes = [outcome_of(0.1, Warning::Restless)];
        let mut calibration = Calibration::new(&Part::ADIS16130, &outcomes, Origin::default());
        change(&mut calibration);
        let (read, _) = Calibration::parse(&calibration.to_toml()).unwrap();
        assert_eq!(read, calibration);
        read.schema()
    };
    assert_eq!(one(|_| ()), 1);
    assert_eq!(one(|it| it.axes[0].name = "z".into()), 2);
    assert_eq!(one(|it| it.axes[0].rate.as_mut().unwrap().lsb_per_unit = 91.75), 2);
    assert_eq!(one(|it| it.axes[0].warnings.push("own".into())), 2);
    assert_eq!(one(|it| it.part = "ADIS16136".into()), 2);
    assert_eq!(one(|it| it.temp = None), 2);
    assert_eq!(one(|it| it.axes[0].correction.btc2_dps_per_c2 = 1e-4), 3);
    assert_eq!(one(|it| (it.temp, it.axes[0].correction.btc3_dps_per_c3) = (None, 1e-6)), 3);
    assert_eq!(one(|it| it.validity.as_mut().unwrap().margin_c = 0.25), 2);
}

#[test]
fn the_id_follows_names_and_numbers_of_every_axis() {
    let id = |from: &str, to: &str| Calibration::parse(&BY_HAND.replace(from, to)).unwrap().0.id();
    let ids =
        [id("", ""), id("31.25", "31.5"), id("\"y\"", "\"z\""), id("ADIS16405", "ADIS16400"), id("-0.25", "-0.5")];
    assert!((1..ids.len()).all(|k| !ids[..k].contains(&ids[k]) && ids[k].len() == 12), "{ids:?}");
}

/// A log may hold axes in another order, or fewer. Another part, or an axis that was not calibrated, is an error.
#[test]
fn axes_are_found_by_name() {
    let (calibration, _) = Calibration::parse(BY_HAND).unwrap();
    let mut corrector = calibration.corrector("ADIS16405", ["y"]).unwrap();
    corrector.read(Some(31.25));
    assert_eq!((corrector.axes(), corrector.correct(0, Some(0.0))), (1, Some(0.75)));
    let said = |part, axis| calibration.corrector(part, [axis]).unwrap_err().to_string();
    assert!(said("ADIS16130", "x").contains("the calibration is of part ADIS16405 (axes x, y), not of ADIS16130"));
    assert!(said("ADIS16405", "z").contains("no axis \"z\": it is of x, y"), "{}", said("ADIS16405", "z"));
}
