//! Invalid logs, whose message names the file and the place and says what to do, and logs in folders or from stdin.

use super::{Bench, imu};
use crate::harness::Run;
use std::fs::{self, File};
use std::path::Path;

const FILES: [(&str, &[u8]); 9] = [
    ("inf.csv", b"x\n1.5\n-inf\n"),
    ("short.csv", b"t,x\n0,1\n1\n2,3\n"),
    ("back.csv", b"t_s,x\n0,1\n1,2\n0.5,3\n"),
    ("untimed.csv", b"t_s,x\n0,1\n,2\n2,3\n"),
    ("twice.csv", b"x,x\n0,1\n1,2\n"),
    ("ros1.bag", b"#ROSBAG V1.2\n"),
    ("log.npz", b"PK\x03\x04rest"),
    ("log.parquet", b"PAR1 and no more"),
    ("log.gz", b"\x1F\x8B\x08\x00\x00\x00\x00\x00\x02\x03\x33"),
];

/// The arguments of `allan`, the exit code, and the expected message.
const CASES: [(&str, i32, &str); 12] = [
    ("inf.csv --rate 9", 1, "inf.csv, line 3, column x: it is infinite"),
    (
        "back.csv --column x --time-column t_s",
        3,
        "back.csv, column t_s: the time goes back by 0.5, at row 2 from 1 to 0.5",
    ),
    ("untimed.csv --column x --time-column t_s", 1, "untimed.csv, line 3, column t_s: no time"),
    ("short.csv --column x --time-column when", 2, "no column `when`; choose with --time-column one of: 0 `t`, 1 `x`"),
    ("twice.csv --column x --rate 9", 2, "several columns `x`, so it takes their number"),
    ("inf.csv --rate 9 --unit knots", 2, "`knots` is not a unit of angular rate or acceleration; choose dps"),
    ("inf.csv --time-column 0 --rate 9", 2, "--rate"),
    ("inf.csv --time-unit s", 2, "--time-column"),
    ("ros1.bag --rate 9", 1, "ros1.bag cannot be read as a log: it is a bag of ROS 1 in its old version 1; convert"),
    ("log.npz --rate 9", 1, "log.npz, as an archive"),
    ("log.parquet --rate 9", 1, "log.parquet, as a Parquet file"),
    ("log.gz --rate 9", 1, "log.gz, as Gzip: it cannot be unpacked"),
];

#[test]
fn errors_of_a_log_name_the_cause() {
    let bench = Bench::new();
    for (name, content) in FILES {
        bench.write(name, content);
    }
    for (line, code, reason) in CASES {
        bench.zerorate(&format!("allan {line}")).fails(code, &[reason]);
    }
}

/// The files of a ROS 2 bag are read in the order in which its metadata.yaml lists them.
#[test]
fn a_bag_in_a_folder_is_read() {
    let bench = Bench::new();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../zerorate-logs/fixtures/bag_of_two");
    let folder = bench.path("bag");
    fs::create_dir(&folder).unwrap();
    for (from, to) in [("bag_of_two_0.mcap", "a_1.mcap"), ("bag_of_two_1.mcap", "a_0.mcap")] {
        fs::copy(fixtures.join(from), folder.join(to)).unwrap();
    }
    bench.zerorate("allan bag --column z").fails(1, &["several bags and without a metadata.yaml"]);
    let files = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - a_1.mcap\n    \
                 - \"a_0.mcap\"\n  duration:\n";
    fs::write(folder.join("metadata.yaml"), files).unwrap();
    let run = bench.zerorate("allan bag --column z --json").ended_with(0);
    assert_eq!(run.saying(&["bag: 1 samples are missing among 20"]).json()["rate_hz"], 200.0);
    // rosbag2 writes the count of a topic after its name, the package rosbags before it
    let counted = |count: u32, is_first: bool| {
        let topic = |name: &str, count: u32| match is_first {
            false => format!(
                "    - topic_metadata:\n        name: {name}\n        type: any\n      message_count: {count}\n"
            ),
            true => format!("  - message_count: {count}\n    topic_metadata:\n      name: {name}\n      type: any\n"),
        };
        let topics = topic("/chat", 600) + &topic("/imu", count) + &topic("/imu/raw", 700);
        let text = format!("{files}  message_count: 1319\n  topics_with_message_count:\n{topics}  files:\n");
        fs::write(folder.join("metadata.yaml"), text).unwrap();
        bench.zerorate("allan bag --column z --json").ended_with(0).stderr
    };
    for is_first in [false, true] {
        let said = counted(38, is_first);
        let expected = "messages-miscounted: bag states 38 messages of /imu and holds 19";
        assert!(said.contains(expected), "{said}");
        assert!(!counted(19, is_first).contains("messages-miscounted"));
    }
    fs::remove_file(folder.join("a_0.mcap")).unwrap();
    bench.zerorate("allan bag --column z").fails(1, &["a_0.mcap"]);
    fs::create_dir(bench.path("none")).unwrap();
    bench.zerorate("allan none --rate 1").fails(1, &["neither a metadata.yaml nor a bag"]);
}

#[test]
fn a_log_is_read_from_standard_input() {
    let bench = Bench::new();
    bench.write("log.csv", "t_ms,gz_dps\n0,0.5\n10,1.5\n20,0.25\n30,2.5\n");
    let said = |log: &Path, options: &str| {
        let piped = File::open(log).unwrap();
        let run = Run::of(bench.command(&format!("allan - {options} --json")).stdin(piped));
        serde_json::from_str::<serde_json::Value>(&run.ok()).unwrap()
    };
    assert_eq!(said(&bench.path("log.csv"), "--column 1 --time-column 0")["rate_hz"], 100.0);
    let bag = Path::new(env!("CARGO_MANIFEST_DIR")).join("../zerorate-logs/fixtures/imu_lz4.bag");
    assert_eq!(said(&bag, "--column z")["rate_hz"], 200.0);
}

/// A wrong unit shows in the measured gravity, a mixed-up column in a gyroscope's mean of hundreds of °/s, and a
/// marker such as −999 in the number of equal least values.
#[test]
fn a_wrong_unit_mixed_columns_and_a_limit_are_warned_of() {
    let bench = imu::bench();
    let said = |name: &str, change: &dyn Fn(String) -> String| {
        bench.write(name, change(bench.text("imu.csv")));
        bench.zerorate(&format!("imu {name}")).ended_with(0).stderr
    };
    assert!(!said("as-it-is.csv", &|log| log).contains("implausible"));
    let in_g = said("in-g.csv", &|log| log.replace("m/s^2", "g"));
    assert!(in_g.contains("warning: implausible: in-g.csv: gravity is 96.2"), "{in_g}");
    let mixed = bench.text("imu.csv");
    bench.write("mixed.csv", mixed.replacen("gyro_z_dps", "x", 1).replacen("az [m/s^2]", "gyro_z [rad/s]", 1));
    bench.zerorate("imu mixed.csv").fails(2, &["ax [m/s^2],ay [m/s^2] are two axes of the accelerometer"]);
    let mixed = bench.zerorate("imu mixed.csv --column 1,2,4,5,6").ended_with(0).stderr;
    assert!(mixed.contains("implausible: mixed.csv: gyro_z [rad/s] is 562 °/s in the mean"), "{mixed}");
    let marked = said("marked.csv", &|log| {
        let lines = log.lines().enumerate().map(|(i, line)| match line.split_once(',') {
            Some((t, _)) if i % 100 == 99 => format!("{t},-999,-999,-999,0,0,9.81,0,25\n"),
            _ => format!("{line}\n"),
        });
        lines.collect()
    });
    assert!(marked.contains("clipped: marked.csv, gyro_x_dps: 1.00 % of the samples are -999, the least"), "{marked}");
}
