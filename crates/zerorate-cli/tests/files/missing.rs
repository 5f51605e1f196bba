//! What is not built in: one sentence says which feature and which command add it, and no file is left behind.

use super::{Bench, calibration};

/// The end of the sentence.
const COMMAND: &str = "`cargo install --path crates/zerorate-cli --features full` adds it\n";

#[track_caller]
fn says(bench: &Bench, line: &str, what: &str, feature: &str) {
    let said = bench.zerorate(line).fails(2);
    let sentence = format!("this program was built without {what} (feature `{feature}`): {COMMAND}");
    let last = said.lines().last().map(|last| format!("{last}\n")).unwrap_or_default();
    assert!(last.starts_with("error: ") && last.ends_with(&sentence), "{said}");
}

/// Reads a file in each way that a log or a capture is read.
#[track_caller]
fn reading_says(content: &[u8], what: &str, feature: &str) {
    let bench = Bench::new();
    bench.write("log", content);
    says(&bench, "allan log --rate 10", what, feature);
    says(&bench, "imu log", what, feature);
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn hdf5() {
    reading_says(include_bytes!("../../../zerorate-logs/fixtures/imu.h5"), "HDF5", "hdf5");
}

#[cfg(not(feature = "matlab"))]
#[test]
fn matlab() {
    reading_says(include_bytes!("../../../zerorate-logs/fixtures/imu.mat"), "the reader of MATLAB files", "matlab");
}

#[cfg(not(feature = "npz"))]
#[test]
fn npz() {
    reading_says(include_bytes!("../../../zerorate-logs/fixtures/imu.npz"), "the reader of .npz archives", "npz");
}

#[cfg(not(feature = "packed"))]
#[test]
fn packed() {
    reading_says(include_bytes!("../../../zerorate-logs/fixtures/checked/log.csv.gz"), "gzip", "packed");
}

#[cfg(not(feature = "ros"))]
#[test]
fn ros() {
    reading_says(include_bytes!("../../../zerorate-logs/fixtures/imu_none.bag"), "the reader of ROS 1 bags", "ros");
}

#[cfg(not(feature = "mcap"))]
#[test]
fn mcap() {
    reading_says(include_bytes!("../../../zerorate-logs/fixtures/imu_zstd.mcap"), "MCAP", "mcap");
    recording_says("mcap", "MCAP");
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet() {
    let content = include_bytes!("../../../zerorate-logs/fixtures/checked/none.parquet");
    reading_says(content, "Parquet", "parquet");
    recording_says("parquet", "Parquet");
    let bench = Bench::new();
    bench.write("log.parquet", content);
    says(&bench, "recalibrate log.parquet", "Parquet", "parquet");
    says(&bench, "capture --device replay:log.parquet -o out.csv", "Parquet", "parquet");
}

/// Before a sample is taken.
#[cfg(not(all(feature = "mcap", feature = "parquet")))]
#[track_caller]
fn recording_says(form: &str, what: &str) {
    let bench = Bench::new();
    for line in ["capture -o out", "calibrate --log out", "chamber f57 --device twin: --log out"] {
        says(&bench, &format!("{line}.{form}"), what, form);
        let left: Vec<_> = std::fs::read_dir(bench.dir.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
        assert!(left.is_empty(), "{line}: {left:?}");
    }
}

#[cfg(not(feature = "png"))]
#[test]
fn png() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 31.5));
    bench.write("log.csv", "gz\n1\n2\n1\n3\n2\n1\n2\n3\n");
    for line in ["report unit.toml -o out.png", "allan log.csv --rate 10 --unit dps --plot out.png"] {
        says(&bench, line, "PNG", "png");
        assert!(!bench.path("out.png").exists());
    }
}

#[cfg(not(feature = "serve"))]
#[test]
fn the_page() {
    let bench = Bench::new();
    for line in ["serve", "serve --listen 127.0.0.1:0 --device twin:seed=7 -o log.arrows"] {
        says(&bench, line, "`zerorate serve`", "serve");
    }
    let help = bench.zerorate("serve --help").ok();
    assert!(help.contains("built without"), "{help}");
}
