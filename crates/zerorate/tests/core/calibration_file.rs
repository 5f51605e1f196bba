//! The calibration file: a written calibration reads back the same, and a changed file is refused.

use crate::outcome::outcome;
use crate::track::world::Random;
use zerorate::calibration::{CalibratedAxis, Calibration, FileError, Notes, Origin};
use zerorate::track::TrackerConfig;
use zerorate::{Axis, Correction, Part};

fn origin() -> Origin {
    Origin {
        serial: Some("SN \"17\"".into()),
        created: Some("2026-11-21T10:00:00Z".into()),
        software: "zerorate 0.1.0".into(),
        device: "twin:seed=7".into(),
        config: "24 bit".into(),
        capture_sha256: "ab".repeat(32),
        notes: Notes::default(),
    }
}

fn measured() -> Calibration {
    Calibration::new(&Part::ADIS16130, &[outcome()], origin())
}

fn error(text: &str) -> FileError {
    Calibration::parse(text).expect_err("must be refused")
}

#[test]
fn a_calibration_comes_back_bit_for_bit() {
    let calibration = measured();
    let text = calibration.to_toml();
    let (read, warnings) = Calibration::parse(&text).unwrap();
    assert!(text.contains("schema = 1\n") && !text.contains("axis") && !text.contains("margin_c"), "{text}");
    assert_eq!(read, calibration);
    assert_eq!(read.id(), calibration.id());
    assert!(warnings.is_empty());
}

#[test]
fn line_ends_and_blank_lines_do_not_matter() {
    let text = measured().to_toml();
    assert!(Calibration::parse(&text.replace('\n', "\r\n")).unwrap().1.is_empty());
    assert!(Calibration::parse(&text.replace('\n', "\n\n")).unwrap().1.is_empty());
}

#[test]
fn every_changed_digit_is_found_and_its_line_named() {
    let text = measured().to_toml();
    let lines: Vec<&str> = text.lines().collect();
    for (index, line) in lines.iter().enumerate().filter(|(_, line)| line.contains(" = ")) {
        let Some(at) = line.rfind(|c: char| c.is_ascii_digit()) else { continue };
        let digit = if line.as_bytes()[at] == b'7' { "6" } else { "7" };
        let mut edited: Vec<String> = lines.iter().map(ToString::to_string).collect();
        edited[index].replace_range(at..=at, digit);
        match error(&edited.join("\n")) {
            FileError::Edited { line } if line == index + 1 => {}
            // a changed check of a line is reported as an edit of the line that it protects
            FileError::Edited { .. } if line.starts_with("line_checks") => {}
            FileError::Newer { line, .. } if line == index + 1 => {}
            other => panic!("line {}: {line}: {other:?}", index + 1),
        }
    }
}

#[test]
fn every_truncation_is_found() {
    let text = measured().to_toml();
    let protected = text.find("line_checks").unwrap();
    for length in protected..text.trim_end().len() {
        match error(&text[..length]) {
            FileError::Truncated { .. } | FileError::Edited { .. } | FileError::Syntax { .. } => {}
            other => panic!("cut at {length}: {other:?}"),
        }
    }
    let whole_lines = text.lines().count() - 5;
    let cut: Vec<&str> = text.lines().take(whole_lines).collect();
    assert!(matches!(error(&cut.join("\n")), FileError::Truncated { .. }));
}

#[test]
fn one_check_line_alone_is_not_enough() {
    let text = measured().to_toml();
    let without: Vec<&str> = text.lines().filter(|line| !line.starts_with("checksum")).collect();
    assert!(matches!(error(&without.join("\n")), FileError::Edited { .. }));
}

const BY_HAND: &str = "schema = 1
part = \"ADIS16130\"
[correction]
pbc_dps = -0.25
btc_dps_per_c = -0.04
t3_c = 31.5
";

/// The terms of a curve need schema 3. Without them the file has schema 1. Each term changes the id.
#[test]
fn a_curve_is_schema_3() {
    let terms = "btc2_dps_per_c2 = 0.0005\nbtc3_dps_per_c3 = -1e-6\n";
    let by_hand = BY_HAND.replace("schema = 1", "schema = 3") + terms;
    let (curved, _) = Calibration::parse(&by_hand).unwrap();
    let line = Correction::line(-0.25, -0.04, 31.5);
    let curve = Correction { btc2_dps_per_c2: 0.0005, btc3_dps_per_c3: -1e-6, ..line };
    assert_eq!((curved.axes[0].correction, curved.schema(), curved.is_plain()), (curve, 3, true));
    let text = curved.to_toml();
    assert!(text.contains("\nschema = 3\n") && text.contains("\n[correction]\n"), "{text}");
    assert_eq!(Calibration::parse(&text).unwrap(), (curved.clone(), Vec::new()));
    let (straight, _) = Calibration::parse(&by_hand.replace("0.0005", "0").replace("-1e-6", "0")).unwrap();
    assert_eq!(straight, Calibration::parse(BY_HAND).unwrap().0);
    assert_eq!(straight.schema(), 1);
    assert!(!straight.to_toml().contains("btc2"));
    let id = |from: &str, to: &str| Calibration::parse(&by_hand.replace(from, to)).unwrap().0.id();
    let ids = [straight.id(), id("", ""), id("0.0005", "0.0006"), id("-1e-6", "-2e-6")];
    assert!((1..ids.len()).all(|k| !ids[..k].contains(&ids[k])), "{ids:?}");
    for (from, to, line, said) in [
        ("schema = 3", "schema = 1", 7, "btc2_dps_per_c2 belongs to schema 3"),
        ("schema = 3", "schema = 2", 1, "there is no [[axis]]"),
        ("0.0005", "11", 7, "btc2_dps_per_c2 must be a number within ±10 °/s/°C²"),
        ("-1e-6", "nan", 8, "btc3_dps_per_c3 must be a number within ±10 °/s/°C³"),
    ] {
        let error = error(&by_hand.replace(from, to)).to_string();
        assert!(error.starts_with(&format!("line {line}: ")) && error.contains(said), "{error}");
    }
}

/// Replaces lines of a measured file, one at a time, by a line with an impossible value. Some values are whole
/// numbers, which are read like decimal numbers.
#[test]
fn an_impossible_value_is_refused_with_its_line() {
    let unmarked = |line: &&str| !line.starts_with("checksum") && !line.starts_with("line_checks");
    let text: Vec<String> = measured().to_toml().lines().filter(unmarked).map(str::to_owned).collect();
    assert!(Calibration::parse(&text.join("\n")).is_ok());
    for wrong in [
        "u_pbc_dps = -1",
        "u_pbc_dps = -0.5",
        "u_t2_c = -1",
        "coverage = 1",
        "coverage_factor = 0",
        "coverage_factor = -2.0",
        "cov_pbc_btc_dps2_per_c = 1",
        "cov_pbc_t3_dps_c = -0.1",
        "drift_dps = -0.003",            // u(PBC) is 0.0026 °/s
        "u_curvature_dps_per_c = 0.005", // u(BTC) is 0.0048 °/s/°C
        "t1_c = 1000",
        "white_dps_per_rt_hz = -1",
        "flicker_cutoff_hz = -1e-4",
        "duration_s = -3171",
        "duration_s = nan",
        "rate_hz = -100",
        "settle_s = -1.0",
        "max_lost = 2",
        "created = \"2026-13-01T10:00:00Z\"",
        "created = \"yesterday\"",
    ] {
        let key = wrong.split(' ').next().unwrap();
        let at = text.iter().position(|line| line.split(' ').next() == Some(key)).expect(key);
        let mut edited = text.clone();
        edited[at] = wrong.to_owned();
        let said = error(&edited.join("\n")).to_string();
        // the error names the first of the lines from which the covariance is made
        let is_named = said.starts_with(&format!("line {}", at + 1)) || key == "cov_pbc_t3_dps_c";
        assert!(is_named && said.contains(key.split("_t3_").next().unwrap()), "{wrong}: {said}");
    }
}

#[test]
fn mistakes_are_named_with_their_line() {
    let with = |from: &str, to: &str| error(&BY_HAND.replace(from, to));
    assert!(matches!(with("schema = 1", "schema = 5"), FileError::Newer { line: 1, schema: 5 }));
    assert!(matches!(with("ADIS16130", "ADIS16136"), FileError::Value { line: 2, name: "part", .. }));
    assert!(matches!(with("-0.25", "nan"), FileError::Value { line: 4, name: "pbc_dps", .. }));
    assert!(matches!(with("-0.04", "40"), FileError::Value { line: 5, name: "btc_dps_per_c", .. }));
    assert!(matches!(with("31.5", "300"), FileError::Value { line: 6, name: "t3_c", .. }));
    assert!(matches!(with("t3_c", "t3_k"), FileError::Syntax { line: 6, .. }));
    assert!(matches!(with("-0.04", "-0.04.1"), FileError::Syntax { line: 5, .. }));
    let missing = with("t3_c = 31.5", "");
    assert!(missing.to_string().contains("t3_c"), "{missing}");
}

/// Computes u² by hand, with the numbers of `measured` at 2 °C above T3: 0.0026² + 4 · 0.0048² + 2 · 2 · 1e-8.
#[test]
fn the_uncertainty_of_a_correction_is_propagated() {
    let calibration = measured();
    let expected = (6.76e-6 + 9.216e-5 + 4e-8_f64).sqrt();
    let axis = calibration.axes[0].clone();
    let found = axis.u_correction_dps(axis.correction.t3_c + 2.0).unwrap();
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    assert_eq!(CalibratedAxis { uncertainty: None, ..axis }.u_correction_dps(25.0), None);
}

/// Simulates many measurements of a bias that is a line over temperature. Mean rate, T3 and BTC have random errors.
/// The errors of BTC and of the mean rate are correlated.
#[test]
fn the_uncertainty_of_a_correction_is_the_scatter_of_many_measurements() {
    const DRAWS: u32 = 40_000;
    let (bias_dps, btc, t3_c) = (0.3, -0.04, 33.0);
    let (u_rate, u_t3, u_btc, shared): (f64, f64, f64, f64) = (0.0026, 0.05, 0.0008, 0.6);
    let mut calibration = measured().axes.remove(0);
    let u = calibration.uncertainty.as_mut().unwrap();
    u.u_pbc_dps = (u_rate * u_rate + btc * btc * u_t3 * u_t3).sqrt();
    (u.u_btc_dps_per_c, u.u_t3_c) = (u_btc, u_t3);
    (u.cov_pbc_btc_dps2_per_c, u.cov_pbc_t3_dps_c) = (-shared * u_rate * u_btc, -btc * u_t3 * u_t3);
    let stated_cov_pbc_t3 = u.cov_pbc_t3_dps_c;
    calibration.correction.t3_c = t3_c;

    let mut random = Random::new(1);
    let (mut squares, mut product) = ([0.0; 3], 0.0);
    let temps_c = [t3_c - 6.0, t3_c, t3_c + 4.0];
    for _ in 0..DRAWS {
        let (rate, t3, own) = (random.normal(), random.normal(), random.normal());
        let found = Correction::line(
            -(bias_dps + u_rate * rate),
            btc + u_btc * (shared * rate + (1.0 - shared * shared).sqrt() * own),
            t3_c + u_t3 * t3,
        );
        let bias_at = |temp_c: f64| bias_dps - btc * (temp_c - t3_c);
        for (square, temp_c) in squares.iter_mut().zip(temps_c) {
            *square += found.apply(bias_at(temp_c), temp_c).powi(2);
        }
        product += (found.pbc_dps + bias_at(found.t3_c)) * (found.t3_c - t3_c);
    }
    for (square, temp_c) in squares.into_iter().zip(temps_c) {
        let seen = (square / f64::from(DRAWS)).sqrt();
        let stated = calibration.u_correction_dps(temp_c).unwrap();
        assert!((stated / seen - 1.0).abs() < 0.015, "at {temp_c} °C: {stated} where {seen} is seen");
    }
    let seen = product / f64::from(DRAWS);
    assert!((stated_cov_pbc_t3 / seen - 1.0).abs() < 0.05, "{stated_cov_pbc_t3} where {seen} is seen");
}

#[test]
fn a_tracker_begins_with_the_uncertainty_of_the_curve() {
    let text = "schema = 3\npart = \"ADIS16130\"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n\
        [curve]\ncoverage = 0.95\ncoverage_factor = 1.96\norder = 1\norder_weights = [0.0, 1.0, 0.0, 0.0]\n\
        covariance = [[4e-6, 1e-7, 0.0, 0.0], [1e-7, 9e-6, 0.0, 0.0], [0.0, 0.0, 1e-8, 0.0], [0.0, 0.0, 0.0, 0.0]]\n\
        lag_s = 0.0\nplay_c = 0.0\nsteps = []\n";
    let (calibration, _) = Calibration::parse(text).unwrap();
    let config = TrackerConfig::of_calibration(&calibration.axes[0], &Axis::ADIS16130).unwrap();
    assert!((config.prior.u_pbc_dps - 0.002).abs() < 1e-12 && (config.prior.u_btc_dps_per_c - 0.003).abs() < 1e-12);
    assert_eq!(config.prior.cov_pbc_btc_dps2_per_c, 1e-7);
    assert!((config.prior.u_curvature_dps_per_c2 - 1e-4).abs() < 1e-15);
    assert!((calibration.axes[0].u_correction_dps(32.5).unwrap() - (13.21e-6_f64).sqrt()).abs() < 1e-9);
    let sources = |models_dps: f64, sway_dps: f64, probability: f64| {
        format!(
            "steps = []\n[curve.sources]\nu_models_pbc_dps = {models_dps}\nu_models_btc_dps_per_c = 0.0\n\
             u_sway_pbc_dps = {sway_dps}\nu_sway_btc_dps_per_c = 0.0\nsway_probability = {probability}\n"
        )
    };
    let (stated, _) = Calibration::parse(&text.replace("steps = []", &sources(0.0012, 0.0016, 0.02))).unwrap();
    assert!(stated.axes[0].budget().iter().any(|part| (part.u - 0.0016).abs() < 1e-12 && part.of == "PBC"));
    for (from, to, key) in [
        ("1e-7", "7e-6", "covariance"),                                // more than √(4e-6 · 9e-6)
        ("[1e-7, 9e-6", "[2e-7, 9e-6", "covariance"),                  // not symmetric
        ("0.0, 0.0, 1e-8, 0.0", "0.0, 0.0, 1e-8, 1e-9", "covariance"), // of a term without a variance
        ("schema = 3", "schema = 1", "schema 3"),
        ("4e-6", "-4e-6", "covariance"),
        ("lag_s = 0.0", "lag_s = -1", "lag_s"),
        ("play_c = 0.0", "play_c = -1", "play_c"),
        ("steps = []", "steps = [[-5, 0.1]]", "steps"),
        ("coverage_factor = 1.96", "coverage_factor = 0", "coverage_factor"),
        ("coverage_factor = 1.96", "coverage_factor = -1.96", "above 0"),
        ("steps = []", &sources(0.0012, 0.0017, 0.02), "u_models_pbc_dps"), // √(0.0012² + 0.0017²) > 0.0020
        ("steps = []", &sources(0.001, -0.001, 0.02), "u_sway_pbc_dps"),
        ("steps = []", &sources(0.001, 0.001, 2.0), "sway_probability"),
    ] {
        let said = Calibration::parse(&text.replace(from, to)).unwrap_err().to_string();
        assert!(said.contains(key), "{to}: {said}");
    }
}

/// Operator and host need schema 4, and do not change the id.
#[test]
fn notes_make_a_file_schema_4() {
    let notes = Notes { operator: Some("Ada".into()), host: Some("pi4".into()), ..Notes::default() };
    let noted = Calibration { notes, ..measured() };
    let text = noted.to_toml();
    assert!(
        text.contains("schema = 4") && text.contains("operator = \"Ada\"") && text.contains("host = \"pi4\""),
        "{text}"
    );
    assert_eq!(Calibration::parse(&text).unwrap().0, noted);
    assert_eq!(noted.id(), measured().id());
    let early = text.lines().filter(|line| !line.starts_with("checksum") && !line.starts_with("line_checks"));
    let early = early.collect::<Vec<_>>().join("\n").replace("schema = 4", "schema = 1");
    let error = Calibration::parse(&early).unwrap_err().to_string();
    assert!(error.contains("belongs to schema 4"), "{error}");
}
