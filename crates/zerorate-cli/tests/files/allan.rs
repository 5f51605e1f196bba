//! Allan deviations of logs, compared with published figures and with each other.

use super::{Bench, SMALLEST, capture, skip};
use lzma_rust2::XzReader;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// The averaging factor m and the deviation of each point in the JSON.
fn points(json: &str) -> Vec<(u64, f64)> {
    let json: serde_json::Value = serde_json::from_str(json).unwrap();
    let points = json["points"].as_array().unwrap();
    points.iter().map(|point| (point["m"].as_u64().unwrap(), point["dev"].as_f64().unwrap())).collect()
}

/// The R package avar publishes a real record and its overlapping Allan variance at 18 averaging times.
#[test]
fn the_published_allan_variance_of_a_real_gyroscope_is_found() {
    let Some(folder) = reference_data().map(|data| data.join("adis16405")) else {
        return;
    };
    let bench = Bench::new();
    bench.write("gyro_z.i16", unpacked(&folder.join("adis16405_imu1_gyro_z.i16le.xz")));
    let json = bench.zerorate("allan gyro_z.i16 --raw i16 --rate 100 --scale 0.05 --json").ok();
    let found = points(&json);
    let published = fs::read_to_string(folder.join("published_gyro_z.csv")).unwrap();
    let rows: Vec<Vec<f64>> =
        published.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 18);
    for row in rows {
        let (tau_s, variance) = (row[0], row[1]);
        let m = (tau_s * 100.0).round() as u64;
        let (_, dev) = found.iter().find(|(found, _)| *found == m).unwrap();
        assert!((dev * dev / variance - 1.0).abs() < 1e-5, "{tau_s} s: {} instead of {variance}", dev * dev);
    }
}

/// The folder with recordings that are not in this repository. Without it, prints that the test is skipped.
pub fn reference_data() -> Option<PathBuf> {
    let beside_project = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("ZERORATE_REFERENCE_DATA").map_or_else(beside_project, PathBuf::from);
    if !folder.join("adis16405").is_dir() {
        skip(&format!("no reference recordings in {} (set ZERORATE_REFERENCE_DATA)", folder.display()));
        return None;
    }
    Some(folder)
}

/// The content of a compressed recording in the folder of [`reference_data`].
pub fn unpacked(path: &Path) -> Vec<u8> {
    let mut content = Vec::new();
    XzReader::new(File::open(path).unwrap(), true).read_to_end(&mut content).unwrap();
    content
}

/// A capture states its rate and its scale. The corrected capture has the same noise.
#[test]
fn a_capture_needs_no_options() {
    let bench = Bench::new();
    let rows =
        |i: u64| format!("{},{i},{},8,8400000,0\n", 1_000 + i * 10_000_000, 8_388_608 + (i * i * 7919) % 10_007);
    bench.write("rest.csv", capture("A1", &(0..300).map(rows).collect::<String>()));
    let raw = points(&bench.zerorate("allan rest.csv --json").ok());
    bench.write("unit.toml", super::calibration(-0.25, 0.0, 30.0));
    bench.zerorate(&format!("correct rest.csv --cal unit.toml -o corrected.{SMALLEST}")).ok();
    let corrected = points(&bench.zerorate(&format!("allan corrected.{SMALLEST} --json")).ok());
    let same = |((_, a), (_, b)): (&(u64, f64), &(u64, f64))| (a / b - 1.0).abs() < 1e-9;
    assert!(corrected.iter().zip(&raw).all(same));
    let table = bench.zerorate("allan rest.csv").ok();
    let header: Vec<&str> = table.lines().next().unwrap().split_whitespace().collect();
    assert_eq!(header, ["tau_s", "m", "dev_dps", "lo_dps", "hi_dps", "dev_deg_per_h", "edf", "n", "noise"]);
    assert_eq!(table.lines().count(), 1 + raw.len());
}

#[test]
fn gaps_are_not_closed_up_silently() {
    let bench = Bench::new();
    // the 7 samples lost before the first row are not a gap, because the record had not begun
    let rows = "0,1,8388608,8,8400000,7\n10000000,2,8388610,8,,0\n40000000,5,8388609,8,,2\n50000000,6,8388611,8,,0\n";
    bench.write("gap.csv", capture("A1", rows));
    let said = "warning: gaps: gap.csv: 2 samples are missing among 4; averages that lack";
    bench.zerorate("allan gap.csv --json").ended_with(0).saying(&[said]);
    let run = bench.zerorate("allan gap.csv --ignore-gaps --json").ended_with(0);
    let run = run.saying(&["2 samples are missing among 4; the gaps are closed up"]);
    assert_eq!(run.json()["rate_hz"], 100.0);
}

#[test]
fn errors_name_the_line_and_the_remedy() {
    let bench = Bench::new();
    bench.write("log.csv", "t,x\n0,1\n1,2\n2,abc\n");
    bench.write("one.csv", "1\n");
    bench.write("empty.csv", "");
    bench.write("short.csv", "t,x\n0,1\n1\n");
    let cases = [
        ("short.csv --column x --max-bad 0.5", 2, "give --rate in Hz"),
        ("log.csv --column x --rate 100", 1, "log.csv, line 4, column x: `abc` is not a number"),
        ("log.csv --rate 100", 2, "choose with --column one of: 0 `t`, 1 `x`"),
        ("log.csv", 2, "choose with --column one of: 0 `t`, 1 `x`. Also give --rate in Hz, or --time-column"),
        ("one.csv --rate 100", 1, "1 samples are too few"),
        ("empty.csv --rate 100", 1, "empty.csv cannot be read as a log: it is empty"),
        ("short.csv --rate 100 --column x", 1, "line 3, column x: the line ends"),
        (". --rate 100", 1, "directory"),
        ("absent.csv --rate 100", 1, "absent.csv"),
        ("one.csv --rate 0", 2, "above zero"),
        ("one.csv --rate 100 --stat theo1", 2, "there are adev oadev"),
        ("one.csv --rate 100 --taus some", 2, "octave"),
    ];
    for (line, code, reason) in cases {
        bench.zerorate(&format!("allan {line}")).fails(code, &[reason]);
    }
}
