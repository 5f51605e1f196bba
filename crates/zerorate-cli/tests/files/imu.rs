//! `zerorate imu`: all axes of a log at once, and a file for each filter.

use super::{Bench, number_of, white};
use serde_json::Value;

const RATE_HZ: f64 = 100.0;
/// Standard deviation of a sample of each axis: °/s, then m/s².
const SIGMAS: [f64; 6] = [0.10, 0.12, 0.08, 0.020, 0.025, 0.030];
const HEAD: &str = "t_s,gyro_x_dps,gyro_y_dps,gyro_z_dps,ax [m/s^2],ay [m/s^2],az [m/s^2],mag_x,temp_c";

/// A log of white noise. The last accelerometer axis also measures gravity.
fn log() -> String {
    let mut text = format!("{HEAD}\n");
    for (row, noise) in white(6 * 20_000, 1.0, 7).as_chunks::<6>().0.iter().enumerate() {
        let axes = [0, 1, 2, 3, 4, 5].map(|axis| SIGMAS[axis] * noise[axis]);
        let [x, y, z, ax, ay, az] = axes.map(|value| format!("{value:.6}"));
        let az = az.parse::<f64>().unwrap() + 9.81;
        text += &format!("{:.2},{x},{y},{z},{ax},{ay},{az:.6},{},25.{}\n", row as f64 / RATE_HZ, row % 7, row % 5);
    }
    text
}

/// The log with changed cells. `change` gets the number of each line, 0 for the header, and its cells.
fn log_with(change: impl Fn(usize, &mut [String])) -> String {
    let changed = |(row, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        change(row, &mut cells);
        cells.join(",") + "\n"
    };
    log().lines().enumerate().map(changed).collect()
}

pub fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("imu.csv", log());
    bench
}

/// The command without options, since the header names the time column.
const LINE: &str = "imu imu.csv";

/// N of the axis at `index`, in rad/√s or m/s/√s.
fn n(index: usize) -> f64 {
    let n = SIGMAS[index] / RATE_HZ.sqrt();
    if index < 3 { n.to_radians() } else { n }
}

#[test]
fn every_filter_gets_its_file() {
    let bench = bench();
    for (format, reader) in [
        ("kalibr", "Kalibr"),
        ("openvins", "OpenVINS"),
        ("vins", "VINS"),
        ("orbslam3", "ORB-SLAM3"),
        ("kf-gins", "KF-GINS"),
        ("ros", "ROS"),
    ] {
        let line = format!("{LINE} --combine mean --inflate 10 --format {format} -o {format}.yaml");
        bench.zerorate(&line).ended_with(0).saying(&[&format!("wrote {format}.yaml for {reader}")]);
        assert!(bench.text(&format!("{format}.yaml")).contains("by 10, for"), "{format}");
    }
}

#[test]
fn the_contract_of_json() {
    let report = bench().zerorate(&format!("{LINE} --json")).ended_with(0).json();
    let axes = report["axes"].as_array().unwrap();
    let names: Vec<_> = axes.iter().map(|axis| axis["name"].as_str().unwrap()).collect();
    assert_eq!(names, HEAD.split(',').skip(1).take(6).collect::<Vec<_>>());
    assert_eq!((report["rate_hz"].as_f64(), report["samples"].as_u64()), (Some(RATE_HZ), Some(20_000)));
    for (axis, kind, unit) in [(&axes[0], "gyroscope", "°/s"), (&axes[5], "accelerometer", "m/s²")] {
        assert_eq!((axis["kind"].as_str(), axis["unit"].as_str()), (Some(kind), Some(unit)));
        let k = &axis["fit"]["k"];
        assert!(k["value"].is_number() && k["hi"].is_number() && k["identified"].is_boolean(), "{k}");
    }
}

#[test]
fn columns_that_are_not_axes_are_left_out_and_named() {
    let bench = bench();
    let text = bench.zerorate(LINE).saying(&["not read as an axis of an IMU: mag_x\n"]).ok();
    assert!(["°/√h", "m/s/√h", "µg"].iter().all(|unit| text.contains(unit)), "{text}");
    bench.write("none.csv", "t_s,height,weight\n0,1,2\n1,2,3\n");
    bench.zerorate("imu none.csv").ended_with(2).saying(&["it has: height, weight"]);
}

/// Gyroscope N is 0.60, 0.72 and 0.48 °/√h. The one-sided accelerometer noise density is 0.29, 0.36 and 0.43 mg/√Hz.
#[test]
fn axes_are_compared_with_a_data_sheet() {
    let bench = bench();
    bench.write(
        "sheet.toml",
        "schema = 1\nname = \"X\"\nsource = \"none\"\n[gyroscope]\nangle_random_walk = { typical = 0.60, unit = \
         \"deg/rt(hr)\" }\n[accelerometer]\nnoise_density = { maximum = 0.4, unit = \"mg/√Hz\", source = \"p. 3\" }\n",
    );
    let run = bench.zerorate(&format!("{LINE} --datasheet sheet.toml --report imu.html")).ok();
    let rows: Vec<&str> = run.lines().filter(|line| line.contains("typical") || line.contains("at most")).collect();
    let ends = ["within", "worse, 1.20 times", "better, 0.80 times", "within", "within", "worse, 1.09 times"];
    assert_eq!(rows.len(), ends.len(), "{run}");
    for (row, end) in rows.iter().zip(ends) {
        assert!(row.trim_end().ends_with(end), "{end}: {row}");
    }
    let json = bench.zerorate(&format!("{LINE} --datasheet sheet.toml --json")).json();
    assert_eq!(
        (json["data_sheet"]["name"].as_str(), json["data_sheet"]["source"].as_str()),
        (Some("X"), Some("none"))
    );
    let line = &json["axes"][5]["data_sheet"][0];
    assert_eq!(
        (line["limit"].as_str(), line["source"].as_str(), line["verdict"].as_str()),
        (Some("maximum"), Some("p. 3"), Some("worse"))
    );
    assert!((line["measured"].as_f64().unwrap() / (2f64.sqrt() * n(5) / 9.806_65e-3) - 1.0).abs() < 0.02, "{line}");
    let whole = "adis16405";
    let run = bench.zerorate(&format!("{LINE} --datasheet {whole}")).ok();
    assert!(run.contains("Beside the data sheet of ADIS16405") && run.contains("typical 0.05 °/s/√Hz"), "{run}");
}

/// 30 °/s on one axis of the gyroscope for 6 s is reported as motion, and not only as bit errors.
#[test]
fn a_slow_turn_is_motion() {
    let bench = Bench::new();
    let turned = log_with(|row, cells| {
        if (4000..4600).contains(&row) {
            cells[1] = (cells[1].parse::<f64>().unwrap() + 30.0).to_string();
        }
    });
    bench.write("imu.csv", turned);
    let said = bench.zerorate(LINE).ended_with(0).stderr;
    assert!(
        said.contains("motion: the sensor moves from 30 s to 50 s; the longest rest: --skip 51 --until"),
        "{said}"
    );
    assert!(said.contains("so none was replaced; motion, or bit errors?"), "{said}");
    let of_motion = |line: &str| {
        let report = bench.zerorate(&format!("{line} --json")).json();
        let warnings = report["warnings"].as_array().unwrap().iter().filter_map(Value::as_str);
        warnings.filter(|one| one.starts_with("motion: the sensor moves from 30 s to 50 s; ")).count()
    };
    for line in [LINE, "allan imu.csv --fit --column 1", "allan imu.csv --fit --column 1,2"] {
        assert_eq!(of_motion(line), 1, "{line}");
    }
}

/// Each kind of finding on several axes is one line, the most serious first. `--json` has all of them.
#[test]
fn findings_are_a_line_for_each_kind() {
    let bench = Bench::new();
    let knocked = log_with(|row, cells| {
        if row == 5000 {
            (cells[4], cells[5]) = ("3.5".to_owned(), "-4.5".to_owned());
        }
    });
    bench.write("imu.csv", knocked);
    let run = bench.zerorate(&format!("{LINE} -o imu.yaml")).ended_with(0);
    let lines: Vec<&str> = run.stderr.lines().collect();
    assert!(lines[0].starts_with("warning: motion: axes glitch together at 50.0 s"), "{lines:?}");
    assert!(
        lines[1].starts_with("warning: glitches: ") && lines[1].ends_with("replaced by straight lines (+ 2 more)"),
        "{lines:?}"
    );
    let most = "warning: ".len() + 100;
    assert!(lines[..lines.len() - 1].iter().all(|line| line.chars().count() <= most), "{lines:?}");
    let codes: Vec<&str> = lines.iter().filter_map(|line| line.strip_prefix("warning: ")?.split(':').next()).collect();
    let unique: std::collections::BTreeSet<&str> = codes.iter().copied().collect();
    assert_eq!(codes.len(), unique.len(), "{codes:?}");
    assert!(codes.contains(&"not-identified") && lines.len() < 8, "{lines:?}");
    assert_eq!(
        lines[lines.len() - 1],
        "wrote imu.yaml for Kalibr (imu.yaml): of the axes of a kind the worst was taken (--combine worst)"
    );
    assert!(run.stdout.contains("\n  gyro_x_dps  ") && run.stdout.contains("B, µg"), "{}", run.stdout);
    let report = bench.zerorate(&format!("{LINE} --json")).ended_with(0).json();
    assert_eq!(report["motion"][0]["kind"], "knock", "{}", report["motion"]);
    for axis in [3, 4] {
        let warnings = report["axes"][axis]["warnings"].as_array().unwrap();
        assert!(warnings.iter().any(|warning| warning.as_str().unwrap().starts_with("glitches: 1 glitch (")));
    }
}

/// A log of several IMUs is answered with a table to choose from. No text names an option that `imu` lacks.
#[test]
fn several_imus_are_a_table() {
    let bench = Bench::new();
    bench.write("px4.ulg", include_bytes!("../../../zerorate-logs/fixtures/imu.ulg"));
    bench.zerorate("imu px4.ulg --topic /imu").fails(2, &["choose one with --topic:\n  topic ", "sensor_gyro#1"]);
    bench.zerorate("allan px4.ulg --topic /imu --column all").fails(2, &["choose one with --topic:"]);
    for (name, content, said) in [
        ("words.csv", &b"a,b\nc,d\n"[..], "is it a log?"),
        ("codes.bin", &[0x9f, 0x01, 0xfe, 0x82, 0xff, 0x03], "raw numbers need their type (--raw)"),
    ] {
        bench.write(name, content);
        let run = bench.zerorate(&format!("imu {name} -o x.yaml"));
        assert!(run.code != Some(0) && run.stderr.contains(said), "{name}: {run:?}");
    }
    assert!(!bench.path("x.yaml").exists());
    bench.write("imu.csv", log());
    let report = bench.zerorate("imu imu.csv --column gyro_x_dps,5 --json").ended_with(0).json();
    assert_eq!((&report["topic"], &report["motion"]), (&Value::Null, &serde_json::json!([])));
    let names = report["axes"].as_array().unwrap().iter().map(|axis| axis["name"].as_str().unwrap());
    assert_eq!(names.collect::<Vec<_>>(), ["gyro_x_dps", "ay [m/s^2]"]);
}

/// One gyroscope axis has an echo, which no model fits, but the other axis is fine. A file is written only with
/// `--accept-rejected`, and states the rejection.
#[test]
fn a_rejected_axis_writes_a_file_only_when_forced() {
    let bench = Bench::new();
    let rows: Vec<Vec<f64>> =
        log().lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let row = |i: usize| format!("{},{},{}\n", rows[i][0], rows[i][1], rows[i][2] + 0.9 * rows[i - 40][2]);
    let echo: String = (40..rows.len()).map(row).collect();
    bench.write("imu.csv", format!("t_s,gyro_x_dps,gyro_y_dps\n{echo}"));
    let run = bench.zerorate(&format!("{LINE} -o imu.yaml --force")).ended_with(3);
    let said = "refused: imu.csv: gyro_y_dps: the noise model is off by ";
    assert!(run.stderr.contains(said) && !bench.path("imu.yaml").exists(), "{}", run.stderr);
    assert!(run.stderr.starts_with("warning: model-rejected: ") && run.stdout.contains("NOT A RESULT"), "{run:?}");
    assert!(run.stdout.contains("gyro_y_dps  –"), "{}", run.stdout);
    let run = bench.zerorate(&format!("{LINE} -o imu.yaml --accept-rejected --report imu.html")).ended_with(0);
    run.saying(&["written all the same (--accept-rejected)"]);
    let page = bench.text("imu.html");
    for said in ["rejected: off by ", "%: rejected</td>", "</td><td>–</td></tr>"] {
        assert!(page.contains(said), "{said}");
    }
    let yaml = bench.text("imu.yaml");
    assert!(yaml.contains("# NOT A RESULT: gyro_y_dps: the noise model is off by "), "{yaml}");
}

/// Ctrl-C while a log is piped in without end: the exit code tells of a signal, and no file is left.
#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_behind() {
    use crate::harness::{Run, start};
    use std::io::Write;
    use std::os::unix::process::CommandExt;
    use std::process::{Command, Stdio};
    let bench = Bench::new();
    let mut command = bench.command("imu - -o imu.yaml");
    // a terminal sends Ctrl-C to all processes of a group
    let mut child = start(command.process_group(0).stdin(Stdio::piped()));
    let mut pipe = child.stdin.take().unwrap();
    // the log does not fit into a pipe, so the program must be reading when all of it is written
    pipe.write_all(log().as_bytes()).unwrap();
    let sent = Command::new("sh").args(["-c", &format!("kill -INT -{}", child.id())]).status().unwrap();
    assert!(sent.success());
    let run = Run::ended(child);
    drop(pipe);
    assert_eq!((run.code, run.stdout.as_str()), (Some(130), ""), "{}", run.stderr);
    assert!(bench.names().is_empty(), "{:?}", bench.names());
}

/// Each message about a mistake in the log or in the options names its remedy.
#[test]
fn each_mistake_is_named_with_its_remedy() {
    let bench = bench();
    let plain = log().replace("t_s,gyro_x_dps,gyro_y_dps,gyro_z_dps", "time,gx,gy,gz");
    bench.write("plain.csv", plain.replace(" [m/s^2]", ""));
    bench.write("unnamed.csv", "a,b\n1,2\n2,3\n3,4\n");
    bench.write("unlike.csv", "t_s,c1,c2\n0,1,2\n1,2,3\n2,3,4\n");
    bench.write("binary.toml", b"\xff\xfe");
    for (line, said) in [
        (
            "imu plain.csv",
            "give --rate in Hz, or --time-column time with --time-unit s if it is the time, as it rises",
        ),
        (
            "imu plain.csv",
            "rises evenly (100.000 Hz). Also: columns gx, gy, gz (gyroscope) state no unit; give --gyro-unit",
        ),
        ("imu plain.csv", "; columns ax, ay, az (accelerometer) state no unit; give --accel-unit m/s²|g|mg|ug"),
        ("imu unnamed.csv", "give --rate in Hz, or --time-column if a column holds the time. Also: it has no column"),
        ("imu plain.csv --rate 100", "columns gx, gy, gz (gyroscope) state no unit; give --gyro-unit"),
        ("imu plain.csv --rate 100", "; columns ax, ay, az (accelerometer) state no unit; give --accel-unit"),
        ("imu imu.csv --datasheet binary.toml", "binary.toml: not the file of a data sheet: it is not text"),
        ("imu imu.csv -o x.yaml --format kalbr", "tip: a similar value exists: 'kalibr'"),
        ("imu imu.csv --gyro 4", "is in m/s², which is not a unit of gyroscopes"),
        ("imu imu.csv --gyro 1 --column 2", "cannot be used with"),
        ("imu imu.csv --horizon 20 --as-fitted", "cannot be used with"),
        ("imu imu.csv --format openvins", "--output <FILE>"),
        ("imu imu.csv --inflate 10", "--output <FILE>"),
        ("imu unlike.csv", "Say which are axes with --gyro and --accel"),
    ] {
        bench.zerorate(line).fails(2, &[said]);
    }
    bench
        .zerorate("imu imu.csv -o none/imu.yaml")
        .fails(1, &["cannot write none/imu.yaml: the folder none does not exist; make it"]);
    // the table is printed, since only the file depends on the horizon
    let said = "error: imu.csv: the horizon is longer than half of the record: give at most";
    bench.zerorate("imu imu.csv -o x.yaml --horizon 101").ended_with(2).saying(&[said]);
    assert!(!bench.path("x.yaml").exists());
    bench.zerorate("imu imu.csv -o -").fails(2, &["give the file a name"]);
    assert!(!bench.path("-").exists());
    let said = "warning: kind-absent: --column names no accelerometer";
    bench.zerorate("imu imu.csv --column 1,2,3 --format VINS -o v.yaml").ended_with(0).saying(&[said]);
    let several = log().replacen("t_s,gyro_x_dps,gyro_y_dps,gyro_z_dps,ax [m/s^2]", "t_s,a_dps,b_dps,c_dps,d_dps", 1);
    bench.write("several.csv", several);
    bench
        .zerorate("imu several.csv")
        .fails(2, &["columns of several sensors; choose the axes of one with --gyro:\n  a_dps\n"]);
}

/// Noise of 0.05 °/s with a correlation time of 1 s is added to white noise. The text, and the table and the plot of
/// the page, have the term.
#[test]
fn a_gauss_markov_term_is_shown() {
    let bench = Bench::new();
    let (mut text, mut memory) = ("t_s,gyro_x_dps,gyro_y_dps\n".to_owned(), 0.0);
    for row in log().lines().skip(1) {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let phi = (-1.0 / RATE_HZ).exp();
        memory = phi * memory + (1.0 - phi * phi).sqrt() * 0.05 / SIGMAS[1] * cells[2];
        text += &format!("{},{:.6},{}\n", cells[0], cells[1] + memory, cells[3]);
    }
    bench.write("imu.csv", text);
    let table = bench.zerorate(&format!("{LINE} --report imu.html")).ok();
    assert!(table.contains("Gauss–Markov σ ") && table.contains(" °/h, T "), "{table}");
    let page = bench.text("imu.html");
    for said in [
        "<th>Gauss–Markov σ</th>",
        "<th>its correlation time</th><td>s</td><td>",
        "GM: Gauss–Markov σ and time",
        "\nGM 1",
    ] {
        assert!(page.contains(said), "{said}");
    }
}

#[test]
fn a_gyroscope_alone_leaves_the_rest_open() {
    let bench = Bench::new();
    let three: String =
        log().lines().map(|line| line.split(',').take(3).collect::<Vec<_>>().join(",") + "\n").collect();
    bench.write("imu.csv", three);
    bench.zerorate(&format!("{LINE} -o imu.yaml")).ok();
    let yaml = bench.text("imu.yaml");
    assert!(yaml.contains("# accelerometer_noise_density:   # m/s²/√Hz: no such axes were read"), "{yaml}");
}

/// The page has curves, spectra and records of both kinds, with a legend, and stays small with six axes.
#[test]
fn the_page_shows_record_spectrum_and_curves() {
    let bench = Bench::new();
    // a spectral line of 0.05 °/s rms at 12.5 Hz on the z axis
    let disturbed = log_with(|row, cells| {
        if let Ok(rate_dps) = cells[3].parse::<f64>() {
            let sine = 0.05 * 2f64.sqrt() * (std::f64::consts::PI / 4.0 * row as f64).sin();
            cells[3] = format!("{:.6}", rate_dps + sine);
        }
    });
    bench.write("imu.csv", disturbed);
    bench.zerorate(&format!("{LINE} --report imu.html")).ok();
    let page = bench.text("imu.html");
    assert_eq!(page.matches("<svg").count(), 6);
    for said in [
        "velocity random walk",
        "angle random walk",
        "Coefficients by axis",
        "Lines in the spectrum",
        " Hz</th><td>°/s rms</td><td>–</td><td>–</td><td>0.0",
        "12.5 Hz, 0.0",
        "B at 0.664 B",
        "density, °/s/√Hz",
        "density, m/s²/√Hz",
        "deviation from the mean, m/s²",
        "time, s",
    ] {
        assert!(page.contains(said), "{said}");
    }
    assert!(!page.contains("AN-1042") && page.len() < 600_000, "{}", page.len());
    let line = "allan imu.csv --time-column t_s --column gyro_x_dps,gyro_y_dps --report two.html";
    bench.zerorate(line).ok();
    let page = bench.text("two.html");
    assert_eq!((page.matches("<svg").count(), page.contains("Gyroscope: spectrum")), (3, true));
}

#[test]
fn allan_takes_several_columns() {
    let bench = bench();
    let line = "allan imu.csv --time-column t_s";
    let all = bench.zerorate(&format!("{line} --column all --json")).ended_with(0).json();
    let names: Vec<&str> = all["axes"].as_array().unwrap().iter().map(|axis| axis["name"].as_str().unwrap()).collect();
    let columns: Vec<&str> = HEAD.split(',').skip(1).collect();
    assert_eq!(names, columns);
    let two = "--column gyro_z_dps,gyro_x_dps";
    let axes = bench.zerorate(&format!("{line} {two} --json")).ended_with(0).json();
    let one = bench.zerorate(&format!("{line} --column gyro_z_dps --json")).ended_with(0).json();
    assert_eq!((&axes["axes"][0]["points"], &axes["axes"][0]["name"]), (&one["points"], &"gyro_z_dps".into()));
    let csv = bench.zerorate(&format!("{line} {two} --csv")).ok();
    assert!(csv.starts_with("file,column,tau_s,m,dev_dps,") && csv.contains("imu.csv,gyro_x_dps,"), "{csv}");
    let mixed = bench.zerorate(&format!("{line} --column gyro_x_dps,3,4 --plot x.svg"));
    mixed.fails(2, &["different quantities"]);
    let log = log().replace("gyro_x_dps,gyro_y_dps", "gx,gy");
    bench.write("unnamed.csv", log);
    let said = bench.zerorate("allan unnamed.csv --column gx,gy,gyro_z_dps").ended_with(0).stderr;
    assert!(said.contains("the unit of column gx is not stated") && said.contains(" (+ 1 more)\n"), "{said}");
    let said = bench.zerorate("allan unnamed.csv --column gx,gyro_z_dps").ended_with(0).stderr;
    assert!(said.contains("the unit of column gx is not stated") && !said.contains(" more)"), "{said}");
}

#[test]
fn each_series_and_each_part_of_a_log_is_a_result_of_its_own() {
    let bench = Bench::new();
    let noise = white(6 * 3000, 1.0, 9);
    let mut text = "t_s,sensor,gyro_x_dps,gyro_y_dps,gyro_z_dps\n".to_owned();
    for (row, noise) in noise.as_chunks::<6>().0.iter().enumerate() {
        for sensor in [0, 1] {
            let [x, y, z] = [0, 1, 2].map(|axis| noise[3 * sensor + axis] * [0.1, 0.5][sensor]);
            text += &format!("{:.2},{},{x:.5},{y:.5},{z:.5}\n", row as f64 / RATE_HZ, ["left", "right"][sensor]);
        }
    }
    bench.write("two.csv", text);
    let line = "--where sensor=left --where sensor=right --until 20s";
    bench
        .zerorate(&format!("imu two.csv {line} -o imu.yaml --plot imu.svg"))
        .ended_with(0)
        .saying(&["imu-right.yaml"]);
    let density = |name: &str| number_of(&bench.text(name), "gyroscope_noise_density");
    let ratio = density("imu-right.yaml") / density("imu-left.yaml");
    assert!((ratio / 5.0 - 1.0).abs() < 0.2, "{ratio}");
    assert!(bench.path("imu-left.svg").exists() && bench.path("imu-right.svg").exists());
    let text = bench.zerorate(&format!("allan two.csv --column gyro_x_dps {line}")).ok();
    assert!(text.contains("two.csv sensor=right, column gyro_x_dps: 2000 samples"), "{text}");
    bench.zerorate(&format!("imu two.csv {line} --json")).ended_with(2).saying(&["takes one --where"]);
}
