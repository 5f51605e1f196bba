//! Logs of ArduPilot and PX4 with the same readings of three axes and the temperature give the same calibration.

use super::Bench;
use super::tempcal::{Reading, ulog};
use std::fmt::Write;
use zerorate::{Calibration, Correction};

const PART: &str = r#"schema = 1
name = "ICM-42688-P"
axis = [{ name = "x" }, { name = "y" }, { name = "z" }]
[rate]
lsb_per_dps = 1000
zero_code = 0
width_bits = 24
[temperature]
lsb_per_c = 132.48
zero_code = 0
zero_c = 25
width_bits = 16
"#;
/// The steps of AN-1042, shortened from 53 minutes to 130 s.
const PLAN: &str = "--average 10s --warmup 40s --settle 30s --offset 40s";
const ROWS: u32 = 6_600;
const RATE_HZ: f64 = 50.0;
/// Bias at 25 °C, °/s, and its coefficient, °/s/°C, of each axis.
const BIAS: [(f64, f64); 3] = [(0.8, 0.04), (-1.2, -0.02), (0.3, 0.1)];

/// Rows of time (s), rates (°/s) and temperature (°C): an exponential warm-up by 8 °C with pseudo-random noise.
fn rows() -> impl Iterator<Item = (f64, [f64; 3], f64)> {
    (0..ROWS).map(|k| {
        let t_s = f64::from(k) / RATE_HZ;
        let warmed_c = 8.0 * (1.0 - (-t_s / 25.0).exp());
        let noise = |n: u32| f64::from((k * 4 + n).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 23) - 1.0;
        let rates = [0, 1, 2].map(|n| {
            let (bias_dps, per_c) = BIAS[n as usize];
            bias_dps + per_c * warmed_c + 0.03 * noise(n)
        });
        (t_s, rates, 25.0 + warmed_c + 0.02 * noise(3))
    })
}

/// The part file, with the names of the log's columns.
fn part(axes: [&str; 3], temp: &str) -> String {
    let part = ["x", "y", "z"].into_iter().zip(axes).fold(PART.to_owned(), |part, (name, column)| {
        part.replace(&format!("name = \"{name}\""), &format!("name = \"{name}\", column = \"{column}\""))
    });
    part.replace("zero_c = 25", &format!("zero_c = 25\ncolumn = \"{temp}\""))
}

/// A log as `mavlogdump.py --format csv --types IMU` writes it for one IMU.
fn of_ardupilot() -> String {
    let mut log = "timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz\n".to_owned();
    for (t_s, rates, temp_c) in rows() {
        let [x, y, z] = rates.map(f64::to_radians);
        let us = (t_s * 1e6) as u64 + 5_000_000;
        let stamp = 1.7e9 + t_s;
        writeln!(log, "{stamp:.2},{us},0,{x:.9},{y:.9},{z:.9},0.1,0.2,-9.8,0,0,{temp_c:.6},1,1,50,50").unwrap();
    }
    log
}

/// A ULog with one gyroscope topic.
fn of_px4() -> Vec<u8> {
    let reading = |(at_s, rates, temp_c)| Reading { at_s, temp_c, rates, accelerations: [0.0; 3] };
    ulog(&[("sensor_gyro", 0)], rows().map(reading))
}

fn corrections(bench: &Bench, log: &str, part: &str) -> Vec<Correction> {
    bench.write("part.toml", part);
    let line = format!("calibrate --device replay:{log} --part part.toml {PLAN} --force -o unit.toml");
    bench.zerorate(&line).ok();
    let text = bench.text("unit.toml");
    Calibration::parse(&text).unwrap().0.axes.iter().map(|axis| axis.correction).collect()
}

/// The rates are in rad/s: the part file states it for the columns of ArduPilot, and PX4 defines it for its fields.
/// The PX4 log is read with and without column names in the part file.
#[test]
fn every_form_gives_the_same_calibration() {
    let bench = Bench::new();
    bench.write("ardupilot.csv", of_ardupilot());
    bench.write("px4.ulg", of_px4());
    let ardupilot = part(["GyrX [rad/s]", "GyrY [rad/s]", "GyrZ [rad/s]"], "T [°C]");
    let wanted = corrections(&bench, "ardupilot.csv", &ardupilot);
    for (axis, (bias, per_c)) in wanted.iter().zip(BIAS) {
        let off = axis.pbc_dps + bias + per_c * (axis.t3_c - 25.0);
        assert!(off.abs() < 0.02 && (axis.btc_dps_per_c + per_c).abs() < 0.003, "{axis:?}: {off}");
    }
    let px4 = part(["sensor_gyro.x", "sensor_gyro.y", "sensor_gyro.z"], "sensor_gyro.temperature");
    for part in [PART, &px4] {
        let found = corrections(&bench, "px4.ulg", part);
        assert_eq!(found.len(), 3);
        for (found, wanted) in found.iter().zip(&wanted) {
            let off =
                [found.pbc_dps - wanted.pbc_dps, found.btc_dps_per_c - wanted.btc_dps_per_c, found.t3_c - wanted.t3_c];
            assert!(off.iter().all(|off| off.abs() < 2e-5), "{part}: {found:?} {wanted:?}");
        }
    }
}

/// The unit must be one of angular rate. A ROS bag has no temperature.
#[test]
fn facts_that_a_log_lacks_are_asked_for() {
    let bench = Bench::new();
    bench.write("ardupilot.csv", of_ardupilot());
    let fixtures = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../zerorate-logs/fixtures");
    bench.write("imu.bag", std::fs::read(fixtures.join("imu_none.bag")).unwrap());
    let asks = |log: &str, part: String, said: &str| {
        bench.write("part.toml", part);
        bench.zerorate(&format!("calibrate --device replay:{log} --part part.toml {PLAN}")).fails(2, &[said]);
    };
    let of_another_kind = part(["AccX [m/s²]", "GyrY [rad/s]", "GyrZ [rad/s]"], "T [°C]");
    asks("ardupilot.csv", of_another_kind, "the axis of a gyroscope");
    #[cfg(feature = "ros")]
    asks("imu.bag", PART.to_owned(), "a message of sensor_msgs/Imu holds no temperature");
}

/// Without `-o`, the result of a real part is saved under its own name, with a message. `--no-save` saves no
/// calibration.
#[test]
fn a_finished_hour_is_kept() {
    let bench = Bench::new();
    bench.write("px4.ulg", of_px4());
    bench.write("part.toml", PART);
    let line = format!("calibrate --device replay:px4.ulg --part part.toml {PLAN}");
    let calibrations =
        || bench.names().into_iter().filter(|name| name.starts_with("calibration-")).collect::<Vec<_>>();
    let run = bench.zerorate(&format!("{line} --no-save")).ended_with(0);
    assert!(run.stderr.starts_with("the result will only be printed"), "{}", run.stderr);
    assert!(run.stdout.contains("Nothing was saved") && calibrations().is_empty(), "{}", run.stdout);
    let run = bench.zerorate(&line).ended_with(0);
    let [name] = &calibrations()[..] else { panic!("{:?}", calibrations()) };
    assert!(run.stderr.starts_with("the result will be saved as calibration-<id>.toml"), "{}", run.stderr);
    assert!(run.stdout.contains(&format!("Written to {name}")), "{}", run.stdout);
    let text = bench.text(name);
    let (calibration, _) = Calibration::parse(&text).unwrap();
    assert_eq!(*name, format!("calibration-{}.toml", calibration.id()));
    // another file has the name, so that file stays and the result is saved beside it
    bench.write(name, "another");
    bench.zerorate(&line).ended_with(2).saying(&["exists", "the calibration is not lost"]);
    assert_eq!(bench.text(name), "another");
    assert_eq!(calibrations().len(), 2);
}
