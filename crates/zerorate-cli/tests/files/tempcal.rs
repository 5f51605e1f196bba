//! `zerorate tempcal` on logs whose bias is known: the curves, and the parameters of flight controllers, evaluated by
//! the formulas of their firmware.

use super::autopilot::{of_ardupilot, of_px4};
use super::{Bench, white};
use serde_json::Value;
use std::fmt::Write;

const RATE_HZ: f64 = 20.0;
const ROWS: usize = 24_000;
/// Standard deviation of a sample of each axis, °/s or m/s².
const SIGMA: f64 = 0.01;
/// Acceleration of the sensor at rest: gravity along z, m/s².
const GRAVITY: [f64; 3] = [0.0, 0.0, 9.806_65];

/// Coefficients of the bias in powers of (T − 25 °C)/20 °C, °/s and m/s².
const GYRO: [[f64; 4]; 3] = [[0.5, 0.4, -0.08, 0.03], [-0.2, -0.3, 0.06, 0.02], [0.1, 0.05, 0.04, -0.03]];
const ACCEL: [[f64; 4]; 3] = [[0.0, 0.05, 0.01, 0.004], [0.0, -0.03, 0.01, 0.0], [0.0, 0.02, -0.01, 0.003]];

fn bias(terms: &[f64; 4], temp_c: f64) -> f64 {
    let d = (temp_c - 25.0) / 20.0;
    terms.iter().rev().fold(0.0, |sum, term| sum * d + term)
}

/// A reading: time (s), temperature (°C), rates (°/s) and accelerations (m/s²).
pub struct Reading {
    pub at_s: f64,
    pub temp_c: f64,
    pub rates: [f64; 3],
    pub accelerations: [f64; 3],
}

/// Readings of a sensor that warms from 8 °C for twenty minutes.
fn readings() -> Vec<Reading> {
    let noise = white(6 * ROWS, 1.0, 5);
    let reading = |(row, noise): (usize, &[f64; 6])| {
        let at_s = row as f64 / RATE_HZ;
        let temp_c = 8.0 + 35.0 * (1.0 - (-at_s / 400.0).exp()) + 0.3 * (at_s / 100.0).sin();
        let of = |terms: &[[f64; 4]; 3], sigma: f64, first: usize| {
            [0, 1, 2].map(|axis| bias(&terms[axis], temp_c) + sigma * noise[first + axis])
        };
        let accelerations = of(&ACCEL, SIGMA, 3);
        let accelerations = [0, 1, 2].map(|axis| accelerations[axis] + GRAVITY[axis]);
        Reading { at_s, temp_c, rates: of(&GYRO, SIGMA, 0), accelerations }
    };
    noise.as_chunks::<6>().0.iter().enumerate().map(reading).collect()
}

fn csv(temp_name: &str, temp: impl Fn(f64) -> f64) -> String {
    let mut text = format!("t_s,gx_dps,gy_dps,gz_dps,ax [m/s^2],ay [m/s^2],az [m/s^2],{temp_name}\n");
    for Reading { at_s, temp_c, rates: [gx, gy, gz], accelerations: [ax, ay, az] } in readings() {
        let temp = temp(temp_c);
        let _ = writeln!(text, "{at_s:.3},{gx:.6},{gy:.6},{gz:.6},{ax:.6},{ay:.6},{az:.6},{temp:.3}");
    }
    text
}

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("log.csv", csv("temp_c", |temp_c| temp_c));
    bench
}

#[test]
fn the_curves_of_a_table_are_the_true_ones() {
    let bench = bench();
    let found = bench.zerorate("tempcal log.csv --json").json();
    let axes = found["axes"].as_array().unwrap();
    assert_eq!(axes.len(), 6);
    for (axis, terms) in axes.iter().zip(GYRO.iter().chain(&ACCEL)) {
        let is_gyro = axis["kind"] == "gyroscope";
        let (bias_key, u_key) = if is_gyro { ("bias_dps", "u_dps") } else { ("bias_mps2", "u_mps2") };
        let points = axis["curve"].as_array().unwrap();
        assert!(points.len() >= 9);
        for point in points {
            let number = |key: &str| point[key].as_f64().unwrap();
            // the bias of an accelerometer is stated relative to its bias at the reference temperature, 25 °C
            let truth = bias(terms, number("temp_c")) - if is_gyro { 0.0 } else { bias(terms, 25.0) };
            let off = (number(bias_key) - truth).abs();
            assert!(off < 4.0 * number(u_key) + 1e-5 && off < 0.005, "{}: {point} {truth}", axis["name"]);
        }
        let number = |key: &str| axis[key].as_f64().unwrap();
        assert!(number("after") < 0.2 * number("before") && number("lag_s") < 2.0, "{axis}");
        assert_eq!((number("reference_c"), &axis["hysteresis"]), (25.0, &Value::Null));
        assert!(
            axis["warnings"].as_array().unwrap().iter().any(|line| line.as_str().unwrap().starts_with("one-branch"))
        );
    }
    bench.zerorate("tempcal log.csv").ended_with(0).saying(&["warning: one-branch: all axes"]);
}

#[test]
fn every_file_is_written_and_the_calibration_is_exported() {
    let bench = bench();
    let line = "tempcal log.csv --serial SN7 -o unit.toml --plot curve.svg --report page.html";
    bench.zerorate(line).ended_with(0).saying(&["wrote unit.toml"]);
    assert!(bench.text("curve.svg").contains("Bias over temperature"));
    let page = bench.text("page.html");
    for said in
        ["gx_dps", "(one-branch): all axes: the logs only warm", "<th>X2, °/s/°C²</th>", "<th>slope, °/s/°C</th>"]
    {
        assert!(page.contains(said), "{said} in {page}");
    }
    assert!(!page.contains("<th>hysteresis"), "no axis has one: {page}");
    assert!(bench.text("unit.toml").contains("serial = \"SN7\""));
    let exported = bench.zerorate("export unit.toml --format json").json();
    for (axis, terms) in exported["axes"].as_array().unwrap().iter().zip(&GYRO) {
        assert!((axis["pbc_dps"].as_f64().unwrap() + terms[0]).abs() < 0.002, "{axis}");
        assert!((axis["btc_dps_per_c"].as_f64().unwrap() + terms[1] / 20.0).abs() < 0.0003, "{axis}");
    }
    bench.zerorate("tempcal log.csv --format csv -o curve.csv").ended_with(0);
    assert!(bench.text("curve.csv").starts_with("axis,unit,temp_c,bias,u\ngx_dps,°/s,8."));
    bench.zerorate(line).fails(2, &["exists"]);
}

#[test]
fn a_log_without_a_curve_is_refused_or_asked_about() {
    let bench = Bench::new();
    bench.write("still.csv", csv("temp_c", |temp_c| 25.0 + (temp_c - 25.0) / 20.0));
    bench.zerorate("tempcal still.csv -o unit.toml").fails(3, &["code: small-span"]);
    assert!(!bench.path("unit.toml").exists());
    bench.write("log.csv", csv("temp_c", |temp_c| temp_c));
    bench.zerorate("tempcal log.csv --max-u 0.01").ended_with(0);
    bench.zerorate("tempcal log.csv --max-u 1e-5").fails(3, &["code: uncertain", "the bias of g"]);
    bench.write("kelvin.csv", csv("temperature", |temp_c| temp_c + 273.15));
    bench.zerorate("tempcal kelvin.csv").fails(2, &["looks like kelvins"]);
    bench.write("none.csv", csv("pressure_pa", |temp_c| temp_c));
    bench.zerorate("tempcal log.csv --format px4").fails(2, &["--output <FILE>"]);
    bench.zerorate("tempcal none.csv").fails(2, &["has no temperature", "--temp-column"]);
    bench
        .zerorate("tempcal none.csv --temp-column pressure_pa")
        .ended_with(0)
        .saying(&["units-taken: none.csv: pressure_pa states no unit, and is taken in °C ("]);
    bench.zerorate("tempcal none.csv --temp-column pressure_pa --format px4 -o p").fails(2, &["device_id"]);
}

#[test]
fn logs_of_one_unit_are_fitted_together() {
    let bench = bench();
    bench.zerorate("tempcal log.csv log.csv").fails(2, &["was given before"]);
    bench.write("again.csv", csv("temp_c", |temp_c| temp_c + 0.01));
    let found = bench.zerorate("tempcal log.csv again.csv --json").json();
    assert!(found["axes"][0]["spread_of_starts"].as_f64().unwrap() < 0.01, "{}", found["axes"][0]["spread_of_starts"]);
    bench.write("other.csv", csv("temp_c", |temp_c| temp_c).replace("g", "w"));
    bench.zerorate("tempcal log.csv other.csv").fails(2, &["give logs of the same unit"]);
}

/// Writes a log whose bias follows the temperature `temp_at`, a function of time in s, with a lag of 60 s.
fn write_lagging(bench: &Bench, name: &str, temp_at: &dyn Fn(f64) -> f64) {
    let (mut text, mut late_c) = ("t_s,gx [rad/s],temp_c,note\n".to_owned(), temp_at(0.0));
    for (row, noise) in white(ROWS, SIGMA, 11).into_iter().enumerate() {
        let at_s = row as f64 / RATE_HZ;
        late_c += (temp_at(at_s) - late_c) / (60.0 * RATE_HZ);
        let rate = (bias(&GYRO[0], late_c) + noise).to_radians();
        let _ = writeln!(text, "{at_s:.3},{rate:.9},{:.3},7", temp_at(at_s));
    }
    bench.write(name, text);
}

/// Calibrates a lagging sensor from a log in which it warms and a log in which it cools.
fn calibrated_lagging() -> Bench {
    let bench = Bench::new();
    write_lagging(&bench, "warm.csv", &|at_s| 8.0 + 35.0 * (1.0 - (-at_s / 300.0).exp()));
    write_lagging(&bench, "cool.csv", &|at_s| 12.0 + 30.0 * (-at_s / 200.0).exp());
    bench.zerorate("tempcal warm.csv cool.csv --serial B7 -o unit.toml").ended_with(0);
    bench
}

#[test]
fn a_calibration_of_logs_corrects_another_log_with_its_lag() {
    let bench = calibrated_lagging();
    write_lagging(&bench, "swing.csv", &|at_s| 25.0 + 10.0 * (at_s / 150.0).sin());
    let line = "correct swing.csv --cal unit.toml";
    bench.zerorate(&format!("{line} -o out.csv")).ended_with(0).saying(&["out.csv: 24000 samples"]);
    let out = bench.text("out.csv");
    let (head, text) = out.split_once('\n').unwrap();
    assert_eq!(head, "t_s,temp_c,gx_dps,gx_corrected_dps");
    let numbers = |row: &str| row.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = text.lines().map(numbers).collect();
    let mean = |rows: &[Vec<f64>], column: usize| rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64;
    let worst = |column: usize| rows.chunks(600).map(|rows| mean(rows, column).abs()).fold(0.0, f64::max);
    assert!(worst(2) > 0.5 && worst(3) < 0.01, "{} before, {} after", worst(2), worst(3));

    let again = "correct out.csv --cal unit.toml -o again.csv --gyro gx_corrected_dps";
    bench.zerorate(again).fails(2, &["gx_corrected_dps is corrected already"]);
    bench.zerorate(&format!("{line} -o out.arrows")).fails(2, &["ends in .csv"]);
    bench.zerorate(&format!("{line} --serial 7 -o x.csv")).fails(1, &["--force corrects nevertheless"]);
    bench.write("renamed.csv", bench.text("swing.csv").replace("gx [rad/s]", "wx [rad/s]"));
    let renamed = "correct renamed.csv --cal unit.toml -o renamed-out.csv";
    bench.zerorate(renamed).fails(2, &["lacks axes of the calibration", "with --gyro, in the same order"]);
    bench.zerorate(&format!("{renamed} --gyro 1")).ended_with(0);
    assert_eq!(bench.text("renamed-out.csv").split_once('\n').unwrap().1, text);
}

#[test]
fn a_correction_of_a_log_warns_where_it_may_be_off() {
    let bench = calibrated_lagging();
    write_lagging(&bench, "hot.csv", &|_| 60.0);
    let said = bench.zerorate("correct hot.csv --cal unit.toml -o hot-out.csv").ended_with(0).stderr;
    assert!(said.contains("warning: extrapolated: "), "{said}");
    write_lagging(&bench, "cold.csv", &|at_s| 10.0 + 0.1 * at_s.min(300.0));
    let silent = bench.text("cold.csv").replace(",40.000,", ",,");
    bench.write("silent.csv", silent);
    let said = bench.zerorate("correct silent.csv --cal unit.toml -o out.csv").ended_with(0).stderr;
    assert!(said.contains("lag-at-start: up to 0.1") && said.contains("temperature-missing: 168"), "{said}");
    let out = bench.text("out.csv");
    assert!(out.lines().last().unwrap().ends_with(','), "no correction without a temperature");
    write_lagging(&bench, "warming.csv", &|at_s| 10.0 + 0.02 * at_s);
    let hold = |(row, text): (usize, &str)| {
        let cells: Vec<&str> = text.split(',').collect();
        if (1_000..5_000).contains(&row) { format!("{},{},30.000,7", cells[0], cells[1]) } else { text.to_owned() }
    };
    let held: Vec<String> = bench.text("warming.csv").lines().enumerate().map(hold).collect();
    bench.write("held.csv", held.join("\n"));
    let said = bench.zerorate("correct held.csv --cal unit.toml -o held-out.csv").ended_with(0).stderr;
    assert!(said.contains("temperature-held: the thermometer stood still for 200 s"), "{said}");
}

/// A DataFlash log with the messages FMT, PARM and IMU of two sensors. ArduPilot corrected the first sensor from the
/// beginning. If `enabled_after` is given, the parameters say that it corrects the second sensor from that time (s).
fn dataflash(enabled_after: Option<f64>) -> Vec<u8> {
    let mut log = Vec::new();
    let form = |log: &mut Vec<u8>, id: u8, length: usize, name: &str, letters: &str, labels: &str| {
        log.extend([0xA3, 0x95, 0x80, id, length as u8]);
        for (text, size) in [(name, 4), (letters, 16), (labels, 64)] {
            log.extend(text.bytes().chain(std::iter::repeat(0)).take(size));
        }
    };
    form(&mut log, 64, 3 + 8 + 16 + 4, "PARM", "QNf", "TimeUS,Name,Value");
    form(&mut log, 65, 3 + 8 + 1 + 28, "IMU", "QBfffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T");
    let parameter = |log: &mut Vec<u8>, at_s: f64, name: &str, value: f32| {
        log.extend([0xA3, 0x95, 64]);
        log.extend(((at_s * 1e6) as u64).to_le_bytes());
        log.extend(name.bytes().chain(std::iter::repeat(0)).take(16));
        log.extend(value.to_le_bytes());
    };
    PARAMETERS.iter().for_each(|(name, value)| parameter(&mut log, 0.0, name, *value));
    if let Some(at_s) = enabled_after {
        parameter(&mut log, at_s, "INS_TCAL2_ENABLE", 2.0);
        parameter(&mut log, at_s, "INS_TCAL2_ENABLE", 1.0);
    }
    for Reading { at_s, temp_c, rates, accelerations } in readings() {
        for imu in 0..2_u8 {
            let mut rates = rates.map(f64::to_radians);
            if imu == 0 {
                rates[0] -= corrected_before(temp_c);
            }
            // rotated by 180° about x, as AHRS_ORIENTATION 8 says
            let turned = |[x, y, z]: [f64; 3]| [x, -y, -z];
            log.extend([0xA3, 0x95, 65]);
            log.extend(((at_s * 1e6) as u64).to_le_bytes());
            log.push(imu);
            let values = turned(rates).into_iter().chain(turned(accelerations)).chain([temp_c]);
            values.for_each(|value| log.extend((value as f32).to_le_bytes()));
        }
    }
    log
}

const PARAMETERS: [(&str, f32); 6] = [
    ("AHRS_ORIENTATION", 8.0),
    ("INS_TCAL1_ENABLE", 1.0),
    ("INS_TCAL1_TMIN", 10.0),
    ("INS_TCAL1_TMAX", 40.0),
    ("INS_TCAL1_GYR1_X", 300.0),
    ("INS_GYR1_CALTEMP", 20.0),
];

/// The rate about x that ArduPilot subtracts with [`PARAMETERS`], rad/s.
fn corrected_before(temp_c: f64) -> f64 {
    300e-6 * (temp_c.clamp(10.0, 40.0) - 20.0)
}

#[test]
fn the_parameters_of_ardupilot_remove_the_bias_of_all_sensors() {
    let bench = Bench::new();
    bench.write("log.bin", dataflash(None));
    bench.zerorate("tempcal log.bin --format ardupilot -o tcal.parm").ended_with(0).saying(&["wrote tcal.parm"]);
    let of = of_ardupilot(&bench.text("tcal.parm"));
    for (imu, (kind, truth)) in (1..3).flat_map(|imu| [("GYR", &GYRO), ("ACC", &ACCEL)].map(|of| (imu, of))) {
        let tcal = |name: &str| of[&format!("INS_TCAL{imu}_{name}")];
        let per_unit = if kind == "GYR" { 1_f64.to_radians() } else { 1.0 };
        for (axis, terms) in ["X", "Y", "Z"].iter().zip(truth) {
            // polynomial_eval of AP_InertialSensor_tempcal.cpp: no constant term, coefficients in millionths
            let poly = |temp_c: f64| {
                let d = temp_c as f32 - 35.0;
                let of = |order: u32| tcal(&format!("{kind}{order}_{axis}"));
                f64::from((of(1) + (of(2) + of(3) * d) * d) * d * 1.0e-6)
            };
            for temp_c in [10.0, 20.0, 30.0, 40.0] {
                let change = (bias(terms, temp_c) - bias(terms, 35.0)) * per_unit;
                let off = (poly(temp_c) - change).abs() / per_unit;
                assert!(off < 0.004, "IMU {imu} {kind} {axis} at {temp_c}: {off}");
            }
        }
        assert!((8.0..8.5).contains(&tcal("TMIN")) && (40.0..43.0).contains(&tcal("TMAX")), "{of:?}");
    }
}

#[test]
fn a_log_in_which_ardupilot_begins_to_correct_asks_where_to_end() {
    let bench = Bench::new();
    bench.write("log.bin", dataflash(Some(900.0)));
    bench.zerorate("tempcal log.bin").fails(2, &["INS_TCAL2_ENABLE changes after 900 s", "--until 900"]);
    bench.zerorate("tempcal log.bin --until 900").ended_with(0);
}

/// A log of PX4 of these sensors: the topic and the instance of each.
pub fn ulog(sensors: &[(&str, u8)], readings: impl IntoIterator<Item = Reading>) -> Vec<u8> {
    let mut log = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    let mut message = |kind: u8, body: &[u8]| {
        log.extend((body.len() as u16).to_le_bytes());
        log.push(kind);
        log.extend(body);
    };
    message(b'B', &[0; 40]);
    let fields = "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;\
                  float temperature;uint32_t error_count;uint8_t[3] clip_counter;uint8_t samples;";
    for name in ["sensor_gyro", "sensor_accel"] {
        message(b'F', format!("{name}:{fields}").as_bytes());
    }
    for (id, (name, instance)) in (0_u16..).zip(sensors) {
        message(b'A', &[&[*instance][..], &id.to_le_bytes(), name.as_bytes()].concat());
    }
    for Reading { at_s, temp_c, rates, accelerations } in readings {
        let us = (at_s * 1e6) as u64 + 5_000_000;
        for (id, (name, _)) in (0_u16..).zip(sensors) {
            let mut body = [&id.to_le_bytes()[..], &(us + 120).to_le_bytes(), &us.to_le_bytes()].concat();
            body.extend((1_310_988 + u32::from(id)).to_le_bytes());
            let values = if *name == "sensor_gyro" { rates.map(f64::to_radians) } else { accelerations };
            values.into_iter().chain([temp_c]).for_each(|value| body.extend((value as f32).to_le_bytes()));
            message(b'D', &[&body[..], &[0; 8]].concat());
        }
    }
    log
}

#[test]
fn the_parameters_of_px4_remove_the_bias_of_all_sensors() {
    let bench = Bench::new();
    let sensors = [("sensor_gyro", 0), ("sensor_gyro", 1), ("sensor_accel", 0)];
    bench.write("log.ulg", ulog(&sensors, readings()));
    bench.zerorate("tempcal log.ulg --format px4 -o tc.params").ended_with(0);
    let of = of_px4(&bench.text("tc.params"));
    assert_eq!((of["TC_G_ENABLE"], of["TC_A_ENABLE"], of["TC_G1_ID"]), (1.0, 1.0, 1_310_989.0));
    for (sensor, truth) in [("G0", &GYRO), ("G1", &GYRO), ("A0", &ACCEL)] {
        let tc = |name: &str| of[&format!("TC_{sensor}_{name}")];
        let is_gyro = sensor.starts_with('G');
        let per_unit = if is_gyro { 1_f64.to_radians() } else { 1.0 };
        for (axis, terms) in truth.iter().enumerate() {
            // the polynomial of PX4's TemperatureCompensation.cpp, calc_thermal_offsets_3D
            let offset = |temp_c: f64| {
                let d = temp_c as f32 - tc("TREF");
                let x = |order: u32| tc(&format!("X{order}_{axis}"));
                f64::from(x(0) + x(1) * d + x(2) * d * d + x(3) * d * d * d)
            };
            let level = if is_gyro { 0.0 } else { offset(25.0) - bias(terms, 25.0) };
            for temp_c in [10.0, 20.0, 30.0, 40.0] {
                let off = (offset(temp_c) - level - bias(terms, temp_c) * per_unit).abs() / per_unit;
                assert!(off < 0.004, "{sensor} {axis} at {temp_c}: {off}");
            }
        }
    }
}

/// The calibrated gyroscope is on the second topic.
#[test]
fn a_correction_reads_every_topic_that_is_given() {
    let bench = Bench::new();
    let sensors = [("sensor_accel", 0), ("sensor_gyro", 0), ("sensor_gyro", 1)];
    bench.write("log.ulg", ulog(&sensors, readings().into_iter().take(600)));
    let of_logs = super::AXES.replace("[temperature]", "method = \"tempcal\"\n[temperature]");
    bench.write("unit.toml", of_logs.replace("name = \"", "name = \"sensor_gyro_1."));
    let line = "correct log.ulg --topic sensor_accel --topic sensor_gyro#1 --cal unit.toml -o out.csv";
    bench.zerorate(line).ended_with(0).saying(&["out.csv: 600 samples"]);
}
