//! Parameters of flight controllers, read back and evaluated by the formulas of the firmware, which are typed again
//! from its source code.

use super::Bench;
use std::collections::BTreeMap;
use zerorate::{Calibration, Correction, Validity};

/// Three axes, in another order than a flight controller's. Two have curves, and one has a line.
const AXES: &str = r#"schema = 3
part = "ICM-42688-P"
serial = "IMU 7"
[[axis]]
name = "gyro_z"
correction = { pbc_dps = 0.31, btc_dps_per_c = -0.012, t3_c = 41.5, btc2_dps_per_c2 = 4e-4, btc3_dps_per_c3 = -6e-6 }
[[axis]]
name = "gyro_x"
correction = { pbc_dps = -0.75, btc_dps_per_c = 0.021, t3_c = 41.25, btc2_dps_per_c2 = -3e-4, btc3_dps_per_c3 = 2e-6 }
[[axis]]
name = "gyro_y"
correction = { pbc_dps = 1.125, btc_dps_per_c = 0.008, t3_c = 41.5 }
[validity]
temp_min_c = 12.5
temp_max_c = 47.75
"#;

/// Largest error from f32 arithmetic, °/h. f32 rounds a bias of 1 °/s by up to 2·10⁻⁴ °/h, and sums add to that.
const WORST_DPH: f64 = 0.002;

fn corrections() -> [Correction; 3] {
    let (calibration, _) = Calibration::parse(AXES).unwrap();
    ["gyro_x", "gyro_y", "gyro_z"].map(|name| calibration.axis(name).unwrap().correction)
}

/// Parses the parameters of a file by name. Lines that begin with # are comments.
fn parameters(text: &str, read: impl Fn(&str) -> (String, f32)) -> BTreeMap<String, f32> {
    text.lines().filter(|line| !line.starts_with('#')).map(read).collect()
}

/// Parses rows of QGroundControl: vehicle, component, name, value and type, separated by tabs.
pub fn of_px4(text: &str) -> BTreeMap<String, f32> {
    parameters(text, |line| match line.split('\t').collect::<Vec<_>>()[..] {
        ["1", "1", name, value, kind] => {
            let whole = name.ends_with("_ENABLE") || name.ends_with("_ID");
            assert_eq!(kind, if whole { "6" } else { "9" }, "MAV_PARAM_TYPE of {name}");
            (name.to_owned(), value.parse().unwrap())
        }
        _ => panic!("{line}"),
    })
}

/// Parses rows of Mission Planner and MAVProxy: name and value.
pub fn of_ardupilot(text: &str) -> BTreeMap<String, f32> {
    parameters(text, |line| {
        let (name, value) = line.split_once(',').unwrap();
        assert!(name.len() <= 16, "{name} is no name of MAVLink");
        (name.to_owned(), value.parse().unwrap())
    })
}

/// The corrected rate by PX4-Autopilot, src/modules/temperature_compensation/TemperatureCompensation.cpp
/// (calc_thermal_offsets_3D) and src/lib/sensor_calibration/Gyroscope.hpp (Correct). The temperature is limited, and
/// the offset is subtracted.
fn by_px4(of: &BTreeMap<String, f32>, sensor: u32, axis: usize, rate: f32, temp_c: f32) -> f32 {
    let get = |name: &str| of[&format!("TC_G{sensor}_{name}")];
    let held = temp_c.clamp(get("TMIN"), get("TMAX"));
    let delta = held - get("TREF");
    let x = |order: u32| get(&format!("X{order}_{axis}"));
    rate - (x(0) + x(1) * delta + x(2) * (delta * delta) + x(3) * (delta * delta * delta))
}

/// The corrected rate by ArduPilot, libraries/AP_InertialSensor/AP_InertialSensor_tempcal.cpp (polynomial_eval,
/// correct_sensor) and AP_InertialSensor_Backend.cpp (_rotate_and_correct_gyro). The polynomial in T − 35 °C has no
/// constant term, and its coefficients are in millionths.
fn by_ardupilot(of: &BTreeMap<String, f32>, imu: u32, axis: char, rate: f32, temp_c: f32) -> f32 {
    let tcal = |name: &str| of[&format!("INS_TCAL{imu}_{name}")];
    assert_eq!(tcal("ENABLE"), 1.0);
    let poly = |temp_c: f32| {
        let d = temp_c.clamp(tcal("TMIN"), tcal("TMAX")) - 35.0;
        let gyr = |order: u32| tcal(&format!("GYR{order}_{axis}"));
        (gyr(1) + (gyr(2) + gyr(3) * d) * d) * d * 1.0e-6
    };
    let offset = if imu == 1 { format!("INS_GYROFFS_{axis}") } else { format!("INS_GYR{imu}OFFS_{axis}") };
    rate - poly(temp_c) + poly(of[&format!("INS_GYR{imu}_CALTEMP")]) - of[&offset]
}

/// The largest difference between a firmware and the corrections, °/h, from 20 °C below the span to 20 °C above it.
/// Outside of the span, the firmware must hold the value of the correction at the end of the span.
fn worst_dph(span: Validity, firmware: impl Fn(usize, f32) -> f32) -> f64 {
    let mut worst = 0.0_f64;
    for tenth in ((span.temp_min_c - 20.0) * 10.0) as i32..=((span.temp_max_c + 20.0) * 10.0) as i32 {
        let temp_c = tenth as f32 / 10.0;
        for (axis, correction) in corrections().iter().enumerate() {
            let wanted = correction.at(f64::from(temp_c).clamp(span.temp_min_c, span.temp_max_c));
            let found = f64::from(firmware(axis, temp_c)).to_degrees();
            worst = worst.max((found - wanted).abs() * 3600.0);
        }
    }
    worst
}

fn span() -> Validity {
    Calibration::parse(AXES).unwrap().0.validity.unwrap()
}

#[test]
fn px4_computes_what_the_calibration_says() {
    let bench = Bench::new();
    bench.write("imu.toml", AXES);
    for (option, sensor) in [("", 0), (" --sensor 3", 3)] {
        let line = format!("export imu.toml --format px4 --device-id 2818058{option}");
        let text = bench.zerorate(&line).ok();
        let of = of_px4(&text);
        // 12 coefficients, three temperatures, the id of the device, and the switch TC_G_ENABLE
        assert_eq!((of.len(), of["TC_G_ENABLE"], of[&format!("TC_G{sensor}_ID")]), (17, 1.0, 2_818_058.0), "{text}");
        let worst = worst_dph(span(), |axis, temp_c| by_px4(&of, sensor, axis, 0.0, temp_c));
        assert!(worst < WORST_DPH, "{worst} °/h");
    }
}

/// The reference 35 °C of ArduPilot is inside the span, below it, or above it.
#[test]
fn ardupilot_computes_what_the_calibration_says() {
    let bench = Bench::new();
    for (low, high) in [(12.5, 47.75), (-10.0, 20.0), (40.0, 60.5)] {
        let text = AXES.replace("12.5", &format!("{low:?}")).replace("47.75", &format!("{high:?}"));
        bench.write("imu.toml", text);
        for (option, imu) in [("", 1), (" --sensor 2", 2), (" --sensor 3", 3)] {
            let of = of_ardupilot(&bench.zerorate(&format!("export imu.toml --format ardupilot{option}")).ok());
            assert_eq!(of.len(), 3 + 9 + 4, "{of:?}");
            let span = Validity { temp_min_c: low, temp_max_c: high, ..span() };
            let worst = worst_dph(span, |axis, temp_c| by_ardupilot(&of, imu, ['X', 'Y', 'Z'][axis], 0.0, temp_c));
            assert!(worst < WORST_DPH, "{low} … {high}: {worst} °/h");
        }
    }
}

/// At a start with INS_GYR_CAL = 1, ArduPilot measures a new offset and CALTEMP. The curve must not change.
#[test]
fn a_start_of_ardupilot_keeps_the_curve() {
    let bench = Bench::new();
    bench.write("imu.toml", AXES);
    let mut of = of_ardupilot(&bench.zerorate("export imu.toml --format ardupilot").ok());
    let start_c = 21.5;
    of.insert("INS_GYR1_CALTEMP".to_owned(), start_c as f32);
    for (axis, correction) in ['X', 'Y', 'Z'].into_iter().zip(corrections()) {
        of.insert(format!("INS_GYROFFS_{axis}"), -correction.at(start_c).to_radians() as f32);
    }
    let worst = worst_dph(span(), |axis, temp_c| by_ardupilot(&of, 1, ['X', 'Y', 'Z'][axis], 0.0, temp_c));
    assert!(worst < WORST_DPH, "{worst} °/h");
}

#[test]
fn values_that_a_flight_controller_lacks_are_refused() {
    let bench = Bench::new();
    bench.write("imu.toml", AXES);
    bench.write("one.toml", super::calibration(-0.25, -0.04, 31.5));
    bench.write("odd.toml", AXES.replace("gyro_z", "gyro_yaw"));
    for (line, code, said) in [
        ("imu.toml --format px4", 2, "give --device-id ID"),
        ("imu.toml --format px4 --device-id 0", 2, "which is never 0"),
        ("imu.toml --format px4 --device-id 5 --sensor 4", 2, "gyroscopes 0 to 3"),
        ("imu.toml --format ardupilot --sensor 0", 2, "IMUs 1 to 3"),
        ("imu.toml --format ardupilot --device-id 5", 2, "--device-id is for --format px4"),
        ("imu.toml --format json --sensor 1", 2, "--sensor is for"),
        ("imu.toml --format px4 --device-id 5 --span-c 4", 2, "are for tables"),
        ("imu.toml --format px4 --prefix a", 2, "--prefix is for names"),
        ("one.toml --format px4", 1, "the calibration is of rate alone"),
        ("one.toml --format ardupilot", 1, "the calibration is of rate alone"),
        ("odd.toml --format ardupilot", 1, "one name must end in z"),
        ("imu.toml --format kalibr", 2, "no place for a bias"),
        ("imu.toml --format ros", 2, "no place for a bias"),
    ] {
        bench.zerorate(&format!("export {line}")).fails(code, &[said]);
    }
    // without a stated span, the parameters hold within 9 °C of 41.5 °C, the T3 of two axes, and a warning says so
    bench.write("bare.toml", AXES.split("[validity]").next().unwrap());
    let text = bench.zerorate("export bare.toml --format ardupilot").saying(&["states no [validity]"]).ok();
    assert!(text.contains("INS_TCAL1_TMIN,32.5\nINS_TCAL1_TMAX,50.5\n"));
}
