//! A capture of a warming part: the warning of `allan`, and its option to remove the trend.

use super::Bench;

/// The twin is recorded for 40 minutes from power-on, while it warms.
#[test]
fn a_rate_that_follows_the_temperature_is_reported() {
    let bench = Bench::new();
    bench.zerorate("capture --device twin:seed=4 --duration 40m --divider 200 -o a.arrows").ended_with(0);
    let text = bench.zerorate("allan a.arrows --fit").ended_with(0).saying(&["--detrend temp", "--skip)"]);
    assert!(!text.stdout.contains("average for about"), "{}", text.stdout);
    let warned = bench.zerorate("allan a.arrows --fit --json").ended_with(0).json();
    assert_eq!(warned["advice"].as_array().map(Vec::len), Some(0), "{warned}");
}

#[test]
fn a_trend_that_cannot_be_removed_is_refused() {
    let bench = Bench::new();
    let rows: String = (0..2000).map(|i| format!("{},{}\n", (i * 7919 % 101) as f64 * 0.01, 20 + i / 500)).collect();
    bench.write("log.csv", format!("rate_dps,kelvin\n{rows}"));
    let refuse = |line: &str, why: &[&str]| drop(bench.zerorate(line).ended_with(2).saying(why));
    refuse("allan log.csv --rate 10 --column rate_dps --detrend temp", &["--temp-column", "temp_code"]);
    refuse("allan log.csv --rate 10 --column rate_dps --temp-column t", &["no column \"t\""]);
    refuse("allan log.csv --rate 10 --column rate_dps --skip 1h", &["--skip leaves nothing"]);
    refuse("allan log.csv --rate 10 --column rate_dps --pool --detrend temp --temp-column kelvin", &["--pool"]);
    let line = "allan log.csv --rate 10 --column rate_dps --detrend temp --temp-column kelvin --json";
    assert_eq!(bench.zerorate(line).ended_with(0).json()["detrend"]["order"], 1);
    let line = "allan log.csv --rate 10 --column rate_dps --detrend temp:2 --temp-column kelvin";
    bench.zerorate(line).ended_with(0).saying(&[
        "less a polynomial of order 2",
        "least squares over means of at most 128 parts",
        "°/s/°C²",
    ]);
    // imu refuses the log, since no noise model fits it
    let imu = "imu log.csv --rate 10 --column rate_dps --detrend temp --temp-column kelvin";
    bench.zerorate(imu).ended_with(3).saying(&["rate_dps"]);
}
