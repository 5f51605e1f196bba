//! Logs that look like rates of one sensor but are not: the result is correct, or the message states the cause.

use super::{Bench, number_of, white};
use serde_json::Value;

const RATE_HZ: f64 = 100.0;
/// Standard deviation of a sample, °/s, and the corresponding N, °/√s.
const SIGMA: f64 = 0.05;
const N: f64 = 0.005;

/// Samples of two sensors. The second one has three times the noise.
fn two(rows: usize) -> (Vec<f64>, Vec<f64>) {
    (white(rows, SIGMA, 7), white(rows, 3.0 * SIGMA, 11))
}

/// The fitted N of the first axis, °/√s.
fn n(json: &Value) -> f64 {
    let fit = if json["axes"].is_array() { &json["axes"][0]["fit"] } else { &json["fit"] };
    fit["n"]["value"].as_f64().unwrap()
}

fn is_near(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 0.05
}

/// Rows of several sensors, with timestamps that are equal, or later by half a period or by 1.3 ms. The message names
/// the column that distinguishes the sensors, and `--where` selects one.
#[test]
fn rows_of_several_sensors_are_refused_and_read_one_by_one() {
    let bench = Bench::new();
    let (one, other) = two(4000);
    let ids = [("SensorId", "1", "2"), ("I", "0", "1"), ("sensor", "gyro_a", "gyro_b"), ("addr", "0x68", "0x69")];
    for (column, first, second) in ids {
        for offset_s in [0.0, 0.005, 0.0013] {
            let rows = one.iter().zip(&other).zip(0..).map(|((x, y), row)| {
                let (at, then) = (f64::from(row) / RATE_HZ, f64::from(row) / RATE_HZ + offset_s);
                format!("{at:.4},{first},{x:.6}\n{then:.4},{second},{y:.6}\n")
            });
            bench.write("two.csv", format!("t_s,{column},gz_dps\n{}", rows.collect::<String>()));
            let shared =
                if offset_s == 0.0 { ", and 4000 of 8000 rows repeat the stamp" } else { ": rows of 2 sensors" };
            let remedy = format!("give --where {column}={first}");
            for line in ["imu two.csv", "allan two.csv --column gz_dps --fit"] {
                let seen = format!("column `{column}` is {first} (100 Hz), {second} (100 Hz) in turn{shared}");
                bench.zerorate(line).fails(2, &[&seen, &remedy]);
            }
            for (value, expected) in [(first, N), (second, 3.0 * N)] {
                let json =
                    bench.zerorate(&format!("imu two.csv --where {column}={value} --json")).ended_with(0).json();
                assert!(is_near(n(&json), expected), "{column}={value}: {}", n(&json));
                assert!(is_near(json["rate_hz"].as_f64().unwrap(), RATE_HZ));
            }
        }
    }
    bench.zerorate("imu two.csv --where addr=0x70").fails(2, &["`addr` is `0x70` in no row"]);
    bench.zerorate("imu two.csv --where add=0x68").fails(2, &["did you mean `addr`?"]);
}

/// The rows of several sensors come in blocks, as from packets.
#[test]
fn sensors_in_packets_are_told_apart() {
    let bench = Bench::new();
    let (one, other) = two(4000);
    let block = |values: &[f64], id: u32, start: usize| -> String {
        let rows = values.iter().zip(start..);
        rows.map(|(value, row)| format!("{:.2},{id},{value:.6}\n", row as f64 / RATE_HZ)).collect()
    };
    let blocks = one.chunks(10).zip(other.chunks(10)).enumerate();
    let blocks = blocks.map(|(at, (x, y))| block(x, 3, 10 * at) + &block(y, 4, 10 * at));
    bench.write("two.csv", format!("t_s,k,gz_dps\n{}", blocks.collect::<String>()));
    bench.zerorate("allan two.csv --column gz_dps").fails(2, &["column `k` is 3 (100 Hz), 4 (100 Hz) in turn"]);
    let json = bench.zerorate("allan two.csv --column gz_dps --where k=4 --fit --json").ended_with(0).json();
    assert!(is_near(n(&json), 3.0 * N));
}

/// A counter, a flag, a coarse clock and a temperature in codes do not look like several sensors.
#[test]
fn flags_counters_and_coarse_readings_are_one_sensor() {
    let bench = Bench::new();
    let values = white(4000, SIGMA, 7);
    let chance = white(4000, 1.0, 3);
    let log = |time: &dyn Fn(usize) -> f64, names: &str, beside: &dyn Fn(usize) -> String| {
        let row = |(row, value): (usize, &f64)| format!("{:.3},{value:.6},{}\n", time(row), beside(row));
        format!("t_s,gz_dps,{names}\n{}", values.iter().enumerate().map(row).collect::<String>())
    };
    let even = |row: usize| row as f64 / RATE_HZ;
    let coarse = |row: usize| (row / 4) as f64 * 0.04;
    for time in [&even as &dyn Fn(usize) -> f64, &coarse] {
        let text = log(time, "seq,toggle,fifo_index,valid,new_mag,heater,state,temp_code", &|row| {
            let (valid, temp) = (u8::from(chance[row] > 0.1), 25 + i32::from(chance[row] > 0.8));
            let (mag, heater) = (u8::from(row % 20 == 0), u8::from(row / 50 % 2 == 1));
            let state = if chance[row] > 1.0 { "busy" } else { "ok" };
            format!("{},{},{},{valid},{mag},{heater},{state},{temp}", row % 16, row % 2, row % 4)
        });
        bench.write("one.csv", text);
        let json = bench.zerorate("imu one.csv --json").ended_with(0).json();
        assert!(is_near(n(&json), N) && is_near(json["rate_hz"].as_f64().unwrap(), RATE_HZ), "{}", n(&json));
    }
}

/// A further column before the rate does not change the other warnings about the log.
#[test]
fn warnings_about_a_log_come_beside_any_column() {
    let bench = Bench::new();
    let values = white(3000, SIGMA, 7);
    let log = |names: &str, cell: &str| {
        let row = |(row, value): (usize, &f64)| match row {
            400 => format!("4.00,{cell}#ERR\n"),
            _ => format!("{:.2},{cell}{value:.6}\n", row as f64 / RATE_HZ),
        };
        let mut rows: Vec<String> = values.iter().enumerate().map(row).collect();
        rows.swap(100, 101);
        format!("boot ok\nt_s,{names}gx_dps\n{}", rows.concat())
    };
    let said = |log: String| {
        bench.write("log.csv", log);
        let run = bench.zerorate("imu log.csv --json").ended_with(0);
        let warnings = run.json()["warnings"].as_array().unwrap().clone();
        let codes = warnings.iter().map(|line| line.as_str().unwrap().split(": ").next().unwrap().to_owned());
        codes.filter(|code| code != "columns-left-out").collect::<Vec<_>>()
    };
    let alone = said(log("", ""));
    assert_eq!(alone[..3], ["lines-skipped", "lines-broken", "times-mended"]);
    assert_eq!(said(log("temp_c,", "25.0,")), alone);
}

/// Codes of an ICM sensor: signed, unsigned by mistake, or without a scale.
#[test]
fn codes_without_sign_or_scale_are_noticed() {
    let bench = Bench::new();
    let axes: Vec<Vec<f64>> = (1..=6).map(|seed| white(3000, 6.0, seed)).collect();
    let log = |bits: u32, point: &str| {
        let cell = |axis: usize, row: usize| {
            let level = if axis == 5 { 16_384.0 } else { 2.0 };
            let code = (axes[axis][row] + level).round() as i64;
            format!(",{}{point}", if bits == 0 { code } else { code.rem_euclid(1 << bits) })
        };
        let row = |row: usize| format!("{row}0{}\n", (0..6).map(|axis| cell(axis, row)).collect::<String>());
        format!("t_ms,gx,gy,gz,ax,ay,az\n{}", (0..3000).map(row).collect::<String>())
    };
    let scaled = "--gyro-unit dps --gyro-scale 0.00875 --accel-unit g --accel-scale 6.1035e-5";
    for (bits, point) in [(0, ""), (16, ""), (24, ""), (32, ""), (16, ".0")] {
        bench.write("codes.csv", log(bits, point));
        let json = bench.zerorate(&format!("imu codes.csv {scaled} --json")).ended_with(0).json();
        assert!(is_near(n(&json), 6.0 * 0.00875 / 10.0), "{bits}: {}", n(&json));
        let warnings = json["warnings"].to_string();
        assert_eq!(warnings.contains("codes-unsigned: codes.csv, gx: codes of "), bits > 0, "{warnings}");
        assert!(!warnings.contains("implausible"), "{warnings}");
    }
    for point in ["", ".0"] {
        bench.write("codes.csv", log(0, point));
        let said = bench.zerorate("imu codes.csv --gyro-unit dps --accel-unit g").ended_with(0).stderr;
        assert!(said.contains("implausible: codes.csv: gravity is 160"), "{said}");
    }
    let said = bench.zerorate("imu codes.csv --gyro gx,gy,gz --gyro-unit dps").ended_with(0).stderr;
    assert!(said.contains("implausible: codes.csv: the noise of all gyroscopes is above 0.8"), "{said}");
    bench.write("codes.csv", log(0, ""));
    let said = bench.zerorate("imu codes.csv --gyro gx,gy,gz --gyro-unit dps").ended_with(0).stderr;
    assert!(said.contains("implausible: codes.csv: gx has steps of 1.000 °/s"), "{said}");
}

/// The scale comes from a part, from a full scale with 16 bits, or from a fraction such as 1/131.
#[test]
fn codes_get_the_scale_of_their_part() {
    let bench = Bench::new();
    let axes: Vec<Vec<f64>> = (1..=6).map(|seed| white(3000, 6.0, seed)).collect();
    let row = |row: usize| {
        let code = |axis: usize| (axes[axis][row] + if axis == 5 { 8192.0 } else { 0.0 }).round() as i16;
        (0..6).map(code).collect::<Vec<i16>>()
    };
    let line = |at: usize| format!("{at}0,{}\n", row(at).iter().map(i16::to_string).collect::<Vec<_>>().join(","));
    bench.write("codes.csv", format!("t_ms,gx,gy,gz,ax,ay,az\n{}", (0..3000).map(line).collect::<String>()));
    let records: Vec<u8> = (0..3000).flat_map(row).flat_map(i16::to_be_bytes).collect();
    bench.write("codes.bin", &records);
    let n_dps = (6.0f64 * 6.0 + 1.0 / 12.0).sqrt() / 10.0;
    let raw = "imu codes.bin --raw 6xi16be --gyro 0,1,2 --accel 3,4,5 --rate 100";
    for (command, codes_per_dps, said) in [
        ("imu codes.csv --part mpu6050:500 --accel-range 4", 65.5, ""),
        ("imu codes.csv --part MPU-6050 --gyro-range 500 --accel-range 4", 65.5, ""),
        ("imu codes.csv --part mpu6050 --accel-range 4", 131.0, "scale-assumed: MPU-6050: ±250 °/s"),
        ("imu codes.csv --part mpu6050 --gyro-range 500", 65.5, "accel"),
        ("imu codes.csv --gyro-range 500 --accel-range 4", 65.536, "scale-assumed: --gyro-range 500: 65.5 codes"),
        (&format!("{raw} --part mpu6050:500 --accel-range 4"), 65.5, ""),
        ("imu codes.csv --gyro-unit dps --gyro-scale 1/131 --accel-range 4", 131.0, ""),
    ] {
        let json = bench.zerorate(&format!("{command} --json")).ended_with(0).json();
        assert!(is_near(n(&json), n_dps / codes_per_dps), "{command}: {}", n(&json));
        let warnings = json["warnings"].to_string();
        match said {
            "accel" => assert!(warnings.contains("implausible") && warnings.contains("--accel-range 4")),
            "" => assert!(!warnings.contains("implausible") && !warnings.contains("scale-assumed"), "{warnings}"),
            said => assert!(warnings.contains(said), "{warnings}"),
        }
    }
    for (command, said) in [
        ("imu codes.csv", "8192 per g): --accel-range 4"),
        ("imu codes.csv", "--gyro-range with the full scale in °/s, or --part with"),
        ("imu codes.csv --part mpu6050:500 --gyro-range 500", "it states the full scale, and so does --gyro-range"),
        ("imu codes.csv --part 6050", "did you mean mpu6050?"),
        ("imu codes.csv --gyro-range 250 --gyro-unit dps", "cannot be used with"),
    ] {
        bench.zerorate(command).ended_with(2).saying(&[said]);
    }
}

/// Gyroflow states its scales in lines above the header. Scales that the program does not know are reported.
#[test]
fn scales_above_a_header_are_used_or_named() {
    let bench = Bench::new();
    let axes: Vec<Vec<f64>> = (1..=6).map(|seed| white(3000, 4.0, seed)).collect();
    let rows: String = (0..3000)
        .map(|row| {
            let cell = |axis: usize| (axes[axis][row] + if axis == 5 { 2048.0 } else { 0.0 }).round();
            format!("{},{}\n", 2 * row, (0..6).map(|axis| cell(axis).to_string()).collect::<Vec<_>>().join(","))
        })
        .collect();
    let head = "GYROFLOW IMU LOG\nversion,1.3\nid,custom\ntscale,0.001\ngscale,0.00122173\nascale,0.00048828125\n";
    bench.write("log.gcsv", format!("{head}t,gx,gy,gz,ax,ay,az\n{rows}"));
    let n_dps = (4.0f64 * 4.0 + 1.0 / 12.0).sqrt() * 0.07 / 500f64.sqrt();
    let units = "--gyro-unit rad/s --accel-unit g";
    let scales = "--gyro-scale 0.00122173 --accel-scale 0.00048828125";
    let time = "--time-column t --time-unit ms";
    for options in ["--max-bad 0", units, &format!("{time} {units}"), &format!("{time} {units} {scales}")] {
        let json = bench.zerorate(&format!("imu log.gcsv --json {options}")).ended_with(0).json();
        assert!(is_near(n(&json), n_dps) && is_near(json["rate_hz"].as_f64().unwrap(), 500.0), "{options}");
        assert!(!json["warnings"].to_string().contains("implausible"), "{}", json["warnings"]);
    }
    let json = bench.zerorate("allan log.gcsv --column gx --fit --json").ended_with(0).json();
    assert!(is_near(n(&json), n_dps));
    bench.write("log.csv", format!("# gyro scale: 0.07 dps per LSB\nt_ms,gx,gy,gz,ax,ay,az\n{rows}"));
    let said = bench.zerorate("allan log.csv --column gx --unit dps").ended_with(0).stderr;
    assert!(said.contains("scale-unused: log.csv: `gyro scale: 0.07 dps per LSB`"), "{said}");
    let said = bench.zerorate("allan log.csv --column gx --unit dps --scale 0.07").ended_with(0).stderr;
    assert!(!said.contains("scale-unused"), "{said}");
}

#[test]
fn the_scale_of_a_capture_is_not_lost_to_a_unit_or_a_name() {
    let bench = Bench::new();
    bench.zerorate("capture --device twin:seed=3 --duration 20s -o rest.arrows").ok();
    bench
        .zerorate("allan rest.arrows --unit dps")
        .fails(2, &["states the scale of the codes in `rate_code`", "leave --unit out, or give --scale as well"]);
    for line in ["imu rest.arrows --gyro-unit rad/s", "tempcal rest.arrows --gyro rate_code --gyro-unit dps"] {
        bench.zerorate(line).fails(2, &["states the scale of the codes in `rate_code`", "leave --gyro-unit out"]);
    }
    let of = |line: &str| n(&bench.zerorate(line).ended_with(0).json());
    let own = of("imu rest.arrows --json");
    assert_eq!(of("imu rest.arrows --gyro rate_code --json"), own);
    assert!((of("imu rest.arrows --gyro-unit dps --gyro-scale 1/23488 --json") / own - 1.0).abs() < 1e-9);
}

/// A wrong unit of time gives an absurd rate or year, and the message proposes the right unit. A given rate may
/// contradict the timestamps.
#[test]
fn a_wrong_unit_of_time_or_rate_is_noticed() {
    let bench = Bench::new();
    let values = white(3000, SIGMA, 7);
    let log = |time: &str, at: &dyn Fn(usize) -> String| {
        let rows = values.iter().enumerate().map(|(row, value)| format!("{},{value:.6}\n", at(row)));
        bench.write("log.csv", format!("{time},gz_dps\n{}", rows.collect::<String>()));
    };
    log("t", &|row| (10_000_000 * row).to_string());
    bench
        .zerorate("imu log.csv --time-column t --time-unit s")
        .fails(2, &["in ns the rows come at 100.000 Hz", "--time-unit ns"]);
    log("t", &|row| (10 * row).to_string());
    bench.zerorate("imu log.csv --time-column t --time-unit us").fails(2, &["--time-unit ms"]);
    log("t_ns", &|row| format!("{:.3}", row as f64 / 40.0));
    bench.zerorate("allan log.csv --column gz_dps").fails(2, &["with --time-unit s"]);
    bench.zerorate("allan log.csv --column gz_dps --time-column t_ns --time-unit s").ok();
    log("t_s", &|row| (1_700_000_000_000 + 10 * row as u64).to_string());
    bench.zerorate("imu log.csv").fails(2, &["with --time-unit ms"]);

    let said = |line: &str| bench.zerorate(line).ended_with(0).stderr;
    log("t_ms", &|row| (if row == 3 { 0 } else { 10 * row }).to_string());
    assert!(said("imu log.csv --rate 200").contains("rate-contradicts"), "one wrong stamp among the right ones");
    let expected = "rate-contradicts: log.csv: 200.000000 Hz was given, and the stamps tell 100.000000 Hz";
    for step in [1, 4] {
        log("t_ms", &|row| (10 * (row / step * step)).to_string());
        for line in ["imu log.csv", "allan log.csv --column gz_dps"] {
            assert!(!said(&format!("{line} --rate 101")).contains("rate-contradicts"));
            let warned = said(&format!("{line} --rate 200"));
            assert!(step > 1 && warned.contains("rate-contradicts") || warned.contains(expected), "{warned}");
        }
    }
}

/// For pure white noise, K in the noise file is the upper limit of the fit or covers the noise, and never near zero.
#[test]
fn k_is_never_next_to_zero_where_n_covers_the_curve() {
    let bench = Bench::new();
    for seed in 1..=12 {
        let rows = white(6000, SIGMA, seed).into_iter().enumerate();
        let rows: String = rows.map(|(row, value)| format!("{:.2},{value:.6}\n", row as f64 / RATE_HZ)).collect();
        bench.write("log.csv", format!("t_s,gx_dps\n{rows}"));
        bench.zerorate("imu log.csv -o imu.yaml --force").ended_with(0);
        let yaml = bench.text("imu.yaml");
        let [n, k] = ["gyroscope_noise_density", "gyroscope_random_walk"].map(|key| number_of(&yaml, key));
        let horizon_s: f64 = 20.0;
        assert!(k * k * horizon_s / 3.0 > 0.09 * n * n / horizon_s, "{seed}: {yaml}");
    }
}

/// The noise file repeats warnings about its numbers, since a reader of the file does not see the program's output.
#[test]
fn warnings_that_matter_stand_in_the_file() {
    let bench = Bench::new();
    let values = white(3000, SIGMA, 7);
    let rows = values.iter().enumerate().filter(|(row, _)| row % 500 != 7);
    let rows: String = rows.map(|(row, value)| format!("{:.2},25,{value:.6}\n", row as f64 / RATE_HZ)).collect();
    bench.write("log.csv", format!("t_s,temp_c,gx_dps\n{rows}"));
    bench.zerorate("imu log.csv -o imu.yaml").ended_with(0);
    bench.zerorate("allan log.csv --column gx_dps --imu-yaml allan.yaml").ended_with(0);
    for name in ["imu.yaml", "allan.yaml"] {
        let yaml = bench.text(name);
        assert!(yaml.contains("\n# warning: gaps: log.csv: 6 samples are missing"), "{yaml}");
        assert!(!yaml.contains("columns-left-out"), "{yaml}");
    }
}

/// Increments of angle and velocity in place of rates, as in data for KF-GINS and of ADIS sensors.
#[test]
fn increments_are_asked_about_and_read() {
    let bench = Bench::new();
    let axes: Vec<Vec<f64>> = (1..=6).map(|seed| white(3000, SIGMA, seed)).collect();
    let log = |names: &str| {
        let row = |row: usize| {
            let cell = |axis: usize| match axis {
                0..3 => axes[axis][row].to_radians() / RATE_HZ,
                _ => (axes[axis][row] + if axis == 5 { 9.81 } else { 0.0 }) / RATE_HZ,
            };
            let cells: Vec<String> = (0..6).map(|axis| format!("{:.9e}", cell(axis))).collect();
            format!("{:.2},{}\n", row as f64 / RATE_HZ, cells.join(","))
        };
        bench.write("log.csv", format!("{names}\n{}", (0..3000).map(row).collect::<String>()));
    };
    log("t_s,dtheta_x,dtheta_y,dtheta_z,dvel_x,dvel_y,dvel_z");
    let units = "--gyro-unit rad/s --accel-unit m/s²";
    bench.zerorate(&format!("imu log.csv {units}")).fails(2, &["dtheta_x", "give --increments, or --increments=no"]);
    bench.zerorate("allan log.csv --column dtheta_x --unit rad/s").fails(2, &["--increments"]);
    let json = bench.zerorate(&format!("imu log.csv {units} --increments --json")).ended_with(0).json();
    assert!(is_near(n(&json), N) && !json["warnings"].to_string().contains("implausible"), "{}", n(&json));
    let json = bench.zerorate("allan log.csv --column dtheta_x --unit rad/s --increments --fit --json").json();
    assert!(is_near(n(&json), N));
    log("t_s,gx,gy,gz,ax,ay,az");
    bench.zerorate(&format!("imu log.csv {units}")).fails(2, &["0.0981 m/s², times 100 Hz, are gravity: 9.81 m/s²"]);
    bench.zerorate(&format!("imu log.csv {units} --increments=no")).ended_with(0);
}
