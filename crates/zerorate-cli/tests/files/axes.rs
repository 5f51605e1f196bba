//! Calibration, correction and export for another gyroscope, an ADIS16405 with three axes, by its part file alone.

use super::allan::{reference_data, unpacked};
use super::{Bench, SMALLEST};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::fs::File;
use std::path::Path;
use zerorate::{Calibration, Part};
use zerorate_record::{CaptureInfo, CaptureWriter, Format, Layout, Row};

/// The part file. Its scales come from the data sheet. Its noise is about as large as the real log's in the last test.
const PART: &str = r#"
schema = 1
name = "ADIS16405"
axis = [{ name = "x" }, { name = "y" }, { name = "z" }]
[rate]
lsb_per_dps = 20
zero_code = 0
width_bits = 16
range_dps = 300
bandwidth_hz = 330
[temperature]
lsb_per_c = 7.14
zero_code = 0
zero_c = 25
width_bits = 12
noise_c = 0.1
[noise]
white_dps_per_rt_hz = { value = 0.05, source = "data sheet" }
flicker_floor_dps = 0.007
rate_random_walk_dps_per_rt_s = 1e-5
[bias]
initial_dps = { value = 0, u = 3 }
tempco_dps_per_c = { value = 0, u = 0.05 }
curvature_dps_per_c2 = { value = 0, u = 0.0005 }
hysteresis_dps = 0.002
"#;

/// Bias at 25 °C, °/s, and its coefficient, °/s/°C, of each axis.
const BIAS: [(f64, f64); 3] = [(0.8, 0.04), (-1.2, -0.02), (0.3, 0.1)];
const RATE_HZ: f64 = 100.0;
/// The hour of AN-1042, shortened to 150 s.
const PLAN: &str = "--average 10s --warmup 40s --settle 30s --offset 60s";
const ROWS: u32 = 15_200;

/// A standard normal number: the sum of 12 uniform numbers, minus 6.
fn normal(random: &mut Xoshiro256PlusPlus) -> f64 {
    (0..12).map(|_| (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64).sum::<f64>() - 6.0
}

/// Records a part at rest that warms by 8 °C.
fn record(path: &Path) {
    let layout = Layout::of_part(&Part::parse(PART).unwrap()).unwrap();
    let info = CaptureInfo { serial: Some("IMU-7".into()), ..CaptureInfo::new(layout) };
    let out = Box::new(File::create(path).unwrap());
    let mut writer = CaptureWriter::create(path, out, Format::Arrows, &info).unwrap();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    for k in 0..ROWS {
        let t_s = f64::from(k) / RATE_HZ;
        let warmed_c = 8.0 * (1.0 - (-t_s / 25.0).exp());
        let rates = [0, 1, 2].map(|axis| {
            let (bias_dps, per_c) = BIAS[axis];
            // 0.05 °/s/√Hz up to 50 Hz, half the sample rate
            let noise_dps = 0.05 * 50_f64.sqrt() * normal(&mut random);
            ((bias_dps + per_c * warmed_c + noise_dps) * 20.0).round() as i64
        });
        let temp = ((warmed_c + 0.1 * normal(&mut random)) * 7.14).round() as i64;
        let row = Row::new(u64::from(k) * 10_000_000, k, &rates).unwrap().with_temp_code(Some(temp));
        writer.push(&row).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn another_part_is_calibrated_corrected_and_exported() {
    let bench = Bench::new();
    bench.write("part.toml", PART);
    record(&bench.path("imu.arrows"));
    let said = bench.zerorate(&format!("calibrate --device replay:imu.arrows --part part.toml {PLAN} -o unit.toml"));
    assert!(said.stdout.contains("axis y\n  PBC") && said.code == Some(0), "{said:?}");
    let text = bench.text("unit.toml");
    let (unit, warnings) = Calibration::parse(&text).unwrap();
    assert!(warnings.is_empty());
    assert_eq!((unit.part.as_str(), unit.serial.as_deref(), unit.axes.len()), ("ADIS16405", Some("IMU-7"), 3));
    for (axis, (bias_dps, per_c)) in unit.axes.iter().zip(BIAS) {
        let (found, u) = (axis.correction, axis.uncertainty.unwrap());
        let pbc = (found.pbc_dps + bias_dps + per_c * (found.t3_c - 25.0)) / u.u_pbc_dps;
        let btc = (found.btc_dps_per_c + per_c) / u.u_btc_dps_per_c;
        assert!(pbc.abs() < 4.0 && btc.abs() < 4.0, "axis {}: {pbc} u, {btc} u", axis.name);
        assert!(u.u_pbc_dps < 0.02 && u.u_btc_dps_per_c < 0.01, "{u:?}");
        assert_eq!(axis.noise.as_ref().unwrap().rate_random_walk_source, "typical");
    }
    // a recalibration from the recording gives the same file
    bench.zerorate(&format!("recalibrate imu.arrows --part part.toml {PLAN} -o again.toml")).ok();
    assert_eq!(bench.text("again.toml"), text);
    let json = bench.zerorate(&format!("recalibrate imu.arrows --part part.toml {PLAN} --json")).ended_with(0).json();
    assert_eq!(json["axes"][2]["pbc_dps"], unit.axes[2].correction.pbc_dps);

    bench.zerorate("correct imu.arrows --cal unit.toml -o corrected.csv").ok();
    let corrected = bench.text("corrected.csv");
    let mut rows = corrected.lines().filter(|line| !line.starts_with('#'));
    let columns: Vec<&str> = rows.next().unwrap().split(',').collect();
    let last: Vec<Vec<&str>> = rows.map(|row| row.split(',').collect()).skip(ROWS as usize - 6_000).collect();
    for axis in ["x", "y", "z"] {
        let column = columns.iter().position(|name| *name == format!("{axis}_corrected_dps")).unwrap();
        let sum: f64 = last.iter().map(|row| row[column].parse::<f64>().unwrap()).sum();
        assert!((sum / 6_000.0).abs() < 0.02, "{axis}: {}", sum / 6_000.0);
    }
    let stream = "stream --device replay:imu.arrows --part part.toml --cal unit.toml --rate 1";
    assert!(bench.zerorate(stream).ok().starts_with("t_s,x_dps,y_dps,z_dps,temp_c,"));
    let header = bench.zerorate("export unit.toml --format c").ok();
    assert!(header.contains("int32_t zerorate_z_correct_code(int32_t rate_code, int32_t temp_code)"), "{header}");
    bench.zerorate("report unit.toml -o unit.html").ok();
}

#[test]
fn the_wrong_part_is_named() {
    let bench = Bench::new();
    bench.write("part.toml", PART.replace("ADIS16405", "ADIS16400"));
    bench.write("broken.toml", PART.replace("lsb_per_c = 7.14", "lsb_per_c = 0"));
    record(&bench.path("imu.arrows"));
    bench
        .zerorate("recalibrate imu.arrows --part part.toml")
        .fails(2, &["ADIS16405 with the axes x, y, z", "ADIS16400"]);
    bench.zerorate("recalibrate imu.arrows --part broken.toml").fails(2, &["broken.toml", "lsb_per_c is 0"]);
    bench.zerorate("recalibrate imu.arrows --part none.toml").fails(2, &["none.toml"]);
    bench
        .zerorate("calibrate --device twin:seed=1 --part part.toml")
        .fails(2, &["describes an ADIS16400", "is an ADIS16130"]);
    // a calibration of another part is refused even with --force
    bench.write("unit.toml", super::calibration(-0.25, -0.04, 31.5));
    bench
        .zerorate("correct imu.arrows --cal unit.toml --force -o corrected.csv")
        .fails(1, &["of part ADIS16130 (axes rate), not of ADIS16405"]);
    assert!(!bench.path("corrected.csv").exists());
}

/// The log of a real part at rest, with a simulated temperature. The rate of the z axis has a step, so the calibration
/// is refused. With a larger `--max-u-btc`, the bias of each axis agrees with the mean over step 8.
#[test]
fn a_real_log_goes_all_the_way() {
    let Some(folder) = reference_data() else { return };
    let bench = Bench::new();
    bench.write("part.toml", PART);
    let axes = ["x", "y", "z"].map(|axis| {
        let bytes = unpacked(&folder.join(format!("adis16405/adis16405_imu1_gyro_{axis}.i16le.xz")));
        bytes.as_chunks().0.iter().take(320_000).map(|code| i16::from_le_bytes(*code)).collect::<Vec<i16>>()
    });
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut log = "t_s,x,y,z,temp\n".to_owned();
    for row in 0..axes[0].len() {
        let t_s = row as f64 / RATE_HZ;
        let warmed_c = 8.0 * (1.0 - (-t_s / 400.0).exp()) + 0.1 * normal(&mut random);
        let [x, y, z] = axes.each_ref().map(|codes| codes[row]);
        log += &format!("{t_s:.2},{x},{y},{z},{}\n", (warmed_c * 7.14).round());
    }
    bench.write("log.csv", log);
    bench
        .zerorate("calibrate --device replay:log.csv --part part.toml -o unit.toml")
        .fails(3, &["axis z: the rate stepped"]);
    bench.zerorate(&format!("capture --device replay:log.csv --part part.toml --duration 2h -o imu.{SMALLEST}")).ok();
    bench
        .zerorate(&format!("calibrate --device replay:imu.{SMALLEST} --part part.toml --max-u-btc 0.05 -o unit.toml"))
        .ok();
    bench.zerorate(&format!("correct imu.{SMALLEST} --part part.toml --cal unit.toml -o corrected.arrows")).ok();
    bench.zerorate("export unit.toml --format rust").ok();
    let unit = Calibration::parse(&bench.text("unit.toml")).unwrap().0;
    for (axis, codes) in unit.axes.iter().zip(&axes) {
        let end: f64 = codes[302_100..317_000].iter().map(|code| f64::from(*code)).sum::<f64>() / 14_900.0 / 20.0;
        let off_dps = axis.correction.pbc_dps + end;
        assert!(off_dps.abs() < 0.002, "axis {}: {off_dps} °/s off the mean of step 8", axis.name);
    }
}
