//! Logs as the page reads them: questions, results, and files.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::fmt::Write;
use zerorate_imu::Kind;
use zerorate_input::Input;
use zerorate_web::log::LogReader;
use zerorate_web::log::message::{LogBias, LogInspection, LogSetting, LogSettings, NoiseFileCommand};

/// Normal numbers with variance 1, almost: each is the sum of twelve uniform ones.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    move || (0..12).map(|_| random.next_u64() as f64 / 2f64.powi(64)).sum::<f64>() - 6.0
}

/// A log with the header `head`: white noise of six axes at 100 Hz, with standard deviation 0.1.
fn table(head: &str, rows: usize) -> String {
    let mut noise = noise(7);
    let mut text = format!("{head}\n");
    for row in 0..rows {
        let _ = write!(text, "{}", row as f64 / 100.0);
        for _ in 0..6 {
            let _ = write!(text, ",{:.6}", 0.1 * noise());
        }
        text.push('\n');
    }
    text
}

/// A log of half an hour at 10 Hz. The temperature rises by `span_c`, and the bias by 0.002 °/s/°C.
fn warming(span_c: f64) -> String {
    let mut noise = noise(9);
    let mut text = "t_s,gx_dps,gy_dps,gz_dps,temp_c\n".to_owned();
    for row in 0..18_000 {
        let temp_c = 20.0 + span_c * f64::from(row) / 18_000.0;
        let _ = write!(text, "{}", f64::from(row) / 10.0);
        for _ in 0..3 {
            let _ = write!(text, ",{:.6}", 0.002 * temp_c + 0.02 * noise());
        }
        let _ = writeln!(text, ",{temp_c:.4}");
    }
    text
}

/// A PX4 log of a gyroscope: half an hour at 10 Hz, during which the gyroscope warms by 30 °C.
fn of_px4() -> Vec<u8> {
    let mut noise = noise(9);
    let mut bytes = b"ULog\x01\x12\x35\x01".to_vec();
    bytes.extend(0u64.to_le_bytes());
    let mut message = |kind: u8, body: &[u8]| {
        bytes.extend((body.len() as u16).to_le_bytes());
        bytes.push(kind);
        bytes.extend(body);
    };
    let fields = "uint64_t timestamp;uint32_t device_id;float x;float y;float z;float temperature;";
    message(b'F', format!("sensor_gyro:{fields}").as_bytes());
    message(b'A', b"\0\0\0sensor_gyro");
    for row in 0..18_000u16 {
        let temp_c = 20.0 + f32::from(row) / 600.0;
        let mut body = vec![0, 0];
        body.extend((u64::from(row) * 100_000).to_le_bytes());
        body.extend(3_670_026u32.to_le_bytes());
        for _ in 0..3 {
            body.extend((3.5e-5 * temp_c + 3.5e-4 * noise() as f32).to_le_bytes());
        }
        body.extend(temp_c.to_le_bytes());
        message(b'D', &body);
    }
    bytes
}

/// The bias over temperature that the page shows, after the analysis.
fn bias(text: &str, settings: &LogSettings) -> Option<LogBias> {
    let (LogInspection::Log(_), Some(mut reader)) = look(text, settings) else { panic!("a log") };
    while reader.analyse().expect("an axis").is_some() {}
    reader.bias()
}

const HEAD: &str = "t_s,gx_dps,gy_dps,gz_dps,ax_mps2,ay_mps2,az_mps2";

fn look(text: &str, settings: &LogSettings) -> (LogInspection, Option<LogReader>) {
    LogReader::look("imu.csv", || Input::from(text.as_bytes().to_vec()), settings)
}

fn command(format: &str) -> NoiseFileCommand {
    NoiseFileCommand { format: format.to_owned(), combine: "worst".to_owned(), inflate: 1.0, accept_rejected: false }
}

#[test]
fn six_axes_become_coefficients_pictures_and_a_file() {
    let (looked, reader) = look(&table(HEAD, 20_000), &LogSettings::default());
    let (LogInspection::Log(about), Some(mut reader)) = (looked, reader) else { panic!("a log") };
    assert_eq!((about.form.as_str(), about.samples, about.columns.len()), ("text", 20_000, 6));
    assert!((about.rate_hz - 100.0).abs() < 1e-6 && about.columns[5].kind == Some(Kind::Accelerometer));
    let mut axes = Vec::new();
    while let Some(axis) = reader.analyse().expect("an axis") {
        axes.push(axis);
    }
    // white noise of 0.1 °/s at 100 Hz has N = 0.01 °/√s = 0.6 °/√h
    let report = &axes[0].axis.report;
    let n = &report.fit.as_ref().expect("a model").n;
    let in_use = n.in_unit(0).expect("a value").value;
    assert_eq!((n.units[0].unit.as_str(), n.identified), ("°/√h", true));
    assert!((in_use / 0.6 - 1.0).abs() < 0.05, "{in_use}");
    assert!((report.points[0].dev / 0.1 - 1.0).abs() < 0.05 && report.points[0].model.is_some());
    let words = &axes[0].terms[0];
    assert_eq!((words.name.as_str(), words.values.len(), words.identified), ("N  angle random walk", 3, true));
    let summary = reader.summary();
    assert_eq!(summary.pictures.len(), 6);
    assert!(summary.pictures.iter().all(|picture| picture.svg.starts_with("<svg")));
    assert_eq!(summary.no_noise_file, None);
    let file = reader.noise_file(&command("kalibr")).expect("a file");
    assert!(file.text.contains("gyroscope_noise_density: 1.7") && file.text.contains("imu.csv"), "{}", file.text);
    assert!(reader.noise_file(&command("caliber")).is_err_and(|why| why.contains("kalibr")));
}

#[test]
fn a_changing_temperature_becomes_a_curve_and_files() {
    let found = bias(&warming(30.0), &LogSettings::default()).expect("a curve");
    assert_eq!((found.why_not, found.pictures.len()), (None, 1));
    assert!(found.text.contains("gx_dps") && found.text.contains("20.0 to 50.0 °C"), "{}", found.text);
    assert!(found.warnings.iter().any(|text| text.contains(": all axes: ")), "{:?}", found.warnings);
    let names: Vec<&str> = found.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["bias-report.html", "bias-curve.csv", "calibration.toml", "ardupilot.param"]);
    assert!(found.no_files.iter().all(|why| why.starts_with("px4.params: ") && why.contains("device_id")));
    let toml = &found.files[2].text;
    assert!(zerorate::Calibration::parse(toml).is_ok_and(|(known, _)| known.axes.len() == 3), "{toml}");
}

#[test]
fn a_log_of_px4_becomes_its_parameters() {
    let bytes = of_px4();
    let said = LogSettings { topic: Some("sensor_gyro".to_owned()), ..LogSettings::default() };
    let (looked, reader) = LogReader::look("flight.ulg", || Input::from(bytes.clone()), &said);
    let mut reader = reader.unwrap_or_else(|| panic!("{looked:?}"));
    let found = reader.bias().expect("a curve");
    let file = found.files.iter().find(|file| file.name == "px4.params").unwrap_or_else(|| panic!("{found:?}"));
    assert!(file.text.contains("TC_G0_ID\t3670026\t6"), "{}", file.text);
}

#[test]
fn a_small_span_of_temperatures_is_not_offered() {
    assert!(bias(&warming(4.0), &LogSettings::default()).is_none());
    assert!(bias(&table(HEAD, 2_000), &LogSettings::default()).is_none());
}

#[test]
fn a_temperature_of_any_name_gives_the_bias_once_it_is_named() {
    let text = warming(30.0).replacen("temp_c", "heat", 1);
    let named = |name: &str| LogSettings { temp_column: Some(name.to_owned()), ..LogSettings::default() };
    let why_not = |settings: &LogSettings| bias(&text, settings).map(|bias| bias.why_not);
    assert_eq!(why_not(&LogSettings::default()), None);
    assert_eq!(why_not(&named("heat")), Some(None));
    let still = why_not(&named("gx_dps")).flatten().expect("a rate is no temperature");
    assert!(still.contains("gx_dps is not a temperature"), "{still}");
    let LogInspection::Question { text, settings, .. } = look(&text, &named("cold")).0 else { panic!("a question") };
    assert!(settings == [LogSetting::TempColumn] && text.contains("no column \"cold\""), "{text}");
}

#[test]
fn facts_that_a_log_lacks_are_asked_for() {
    let text = table("row,gx,gy,gz,ax,ay,az", 2_000);
    let (looked, _) = look(&text, &LogSettings::default());
    let LogInspection::Question { text: question, settings, .. } = looked else { panic!("{looked:?}") };
    assert!(settings.contains(&LogSetting::RateHz) && question.contains("“sample rate”"), "{question}");
    // the page asks for the units in the same round
    assert!(settings.contains(&LogSetting::GyroUnit) && settings.contains(&LogSetting::AccelUnit), "{question}");
    let mut said = LogSettings { rate_hz: Some(100.0), ..LogSettings::default() };
    let (looked, _) = look(&text, &said);
    let LogInspection::Question { settings, .. } = looked else { panic!("{looked:?}") };
    assert_eq!(settings, [LogSetting::GyroUnit, LogSetting::AccelUnit]);
    (said.gyro_unit, said.accel_unit) = (Some("rad/s".to_owned()), Some("g".to_owned()));
    said.columns = Some(vec!["gz".to_owned()]);
    let (looked, _) = look(&text, &said);
    let LogInspection::Log(about) = looked else { panic!("{looked:?}") };
    assert_eq!((about.columns.len(), about.columns[0].name.as_str()), (1, "gz"));
    said.rate_hz = Some(-1.0);
    assert!(matches!(look(&text, &said).0, LogInspection::Question { .. } | LogInspection::Refused { .. }));
}

#[test]
fn a_scale_that_is_not_above_zero_is_asked_for() {
    let gyro = LogSettings { gyro_scale: Some(0.0), ..LogSettings::default() };
    let accel = LogSettings { accel_scale: Some(-1.0), ..LogSettings::default() };
    for (said, setting) in [(gyro, LogSetting::GyroScale), (accel, LogSetting::AccelScale)] {
        let LogInspection::Question { settings, .. } = look(&table(HEAD, 2_000), &said).0 else { panic!() };
        assert_eq!(settings, [setting]);
    }
}

#[test]
fn other_files_are_refused_with_a_reason() {
    for bytes in [&b"SQLite format 3\0............"[..], b"", b"PAR1 and then nothing", b"\x93NUMPY\x01\x00\xff\xff"] {
        let looked = LogReader::look("x", || Input::from(bytes.to_vec()), &LogSettings::default()).0;
        assert!(matches!(&looked, LogInspection::Refused { text } if text.contains('x')), "{looked:?}");
    }
}

/// The temperature rises by almost 6 °C. The rate x follows it by 0.05 °/s per °C; the rate y does not.
#[test]
fn a_rate_that_follows_its_temperature_is_reported() {
    let whole = table("t_s,x_dps,y_dps,z_dps,ax_mps2,ay_mps2,az_mps2", 20_000);
    let mut text = "t_s,gx_dps,gy_dps,temp_c\n".to_owned();
    for (row, line) in whole.lines().skip(1).enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let temp_c = 25.0 + 6.0 * (1.0 - (-(row as f64) / 6_000.0).exp());
        let _ = writeln!(text, "{},{:.6},{:.6},{temp_c:.4}", cells[0], cells[1] + 0.05 * temp_c, cells[2]);
    }
    for columns in [None, Some(vec!["gx_dps".to_owned(), "gy_dps".to_owned()])] {
        let (_, reader) = look(&text, &LogSettings { columns, ..LogSettings::default() });
        let mut reader = reader.expect("a log");
        let mut follows = || {
            let axis = reader.analyse().expect("a noise model").expect("an axis");
            axis.axis.report.warnings.iter().any(|warning| warning.starts_with("follows-temperature: "))
        };
        assert_eq!([follows(), follows()], [true, false]);
    }
}

#[test]
fn a_dead_axis_is_refused_as_frozen() {
    let text = format!("gx_dps\n{}", "0.5\n".repeat(500));
    let said = LogSettings { rate_hz: Some(100.0), ..LogSettings::default() };
    let (_, reader) = look(&text, &said);
    let refused = reader.expect("a log").analyse();
    assert!(refused.is_err_and(|why| why.contains("frozen")));
}
