//! Features that are not built in: a message names the feature and the command that adds it, and no file is left. The
//! tests of `zerorate-logs` cover the formats that are only read.

use super::{Bench, calibration};

/// The end of each message.
const COMMAND: &str = "`cargo install --path crates/zerorate-cli --features full` adds it\n";

#[track_caller]
fn says(bench: &Bench, line: &str, what: &str, feature: &str) {
    let said = bench.zerorate(line).fails(2, &[]);
    let sentence = format!("this program was built without {what} (feature `{feature}`): {COMMAND}");
    let last = said.lines().last().map(|last| format!("{last}\n")).unwrap_or_default();
    assert!(last.starts_with("error: ") && last.ends_with(&sentence), "{said}");
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_names_its_feature() {
    let bench = Bench::new();
    for line in
        ["capture -o out.parquet", "calibrate --log out.parquet", "chamber f57 --device twin: --log out.parquet"]
    {
        says(&bench, line, "Parquet", "parquet");
        assert!(bench.names().is_empty(), "before a sample is taken: {line}: {:?}", bench.names());
    }
    bench.write("log", include_bytes!("../../../zerorate-logs/fixtures/checked/none.parquet"));
    for line in ["allan log --rate 10", "imu log", "recalibrate log", "capture --device replay:log -o out.csv"] {
        says(&bench, line, "Parquet", "parquet");
    }
}

#[cfg(not(feature = "png"))]
#[test]
fn png_names_its_feature() {
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
fn the_page_names_its_feature() {
    let bench = Bench::new();
    for line in ["serve", "serve --listen 127.0.0.1:0 --device twin:seed=7 -o log.arrows"] {
        says(&bench, line, "`zerorate serve`", "serve");
    }
    let help = bench.zerorate("serve --help").ok();
    assert!(help.contains("built without"), "{help}");
}
