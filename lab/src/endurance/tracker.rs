//! Runs the bias tracker for as many hours of the sensor's time as the server ran, but as fast as possible.

use super::gauge::Gauge;
use crate::venv::done;
use anyhow::{Context, Result, ensure};
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Least duration in the sensor's time, h. A shorter run would end before its memory is measured several times.
const LEAST_HOURS: f64 = 0.5;
const STEP: Duration = Duration::from_millis(50);
const RATE_HZ: f64 = 1.0;
const HOUR_S: f64 = 3600.0;

pub fn run(program: &Path, device: &str, hours: f64) -> Result<()> {
    let hours = hours.max(LEAST_HOURS);
    let folder = tempfile::tempdir()?;
    let (unit, rows) = (folder.path().join("unit.toml"), folder.path().join("rows.csv"));
    let mut calibrate = Command::new(program);
    calibrate.args(["calibrate", "--device", device, "-o"]).arg(&unit);
    done(calibrate.stdout(Stdio::null()).stderr(Stdio::null()))?;
    let mut stream = Command::new(program);
    stream.args(["stream", "--device", device, "--track", "--rate", &RATE_HZ.to_string(), "--cal"]).arg(&unit);
    stream.args(["--duration", &(hours * HOUR_S).to_string()]).stdout(File::create(&rows)?).stderr(Stdio::null());
    let (mut child, mut gauge) = (stream.spawn()?, Gauge::default());
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        // a process that has just ended has no memory to measure
        let _ = gauge.read(child.id());
        sleep(STEP);
    };
    ensure!(status.success(), "the tracker ended with {status}");
    let count = in_order(&fs::read_to_string(&rows)?)?;
    let expected = hours * HOUR_S * RATE_HZ;
    ensure!((count as f64 - expected).abs() <= 1.0, "{count} rows in place of {expected}");
    println!("tracker       {hours:.2} h of the sensor, {count} rows in order; {}", gauge.memory());
    gauge.check(0.0)
}

fn in_order(text: &str) -> Result<usize> {
    let times = text.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    let times = times.map(|line| line.split(',').next().unwrap_or_default().parse::<f64>().context("a time"));
    let times = times.collect::<Result<Vec<_>>>()?;
    ensure!(times.is_sorted_by(|earlier, later| earlier < later), "the times of the rows do not rise");
    Ok(times.len())
}
