//! Sets the wall clock by an hour, forward and back, while the server records. libfaketime does that for one process,
//! whose monotonic clock it does not change.

use crate::bench_serve::page;
use crate::bench_serve::samples::CaptureSummary;
use crate::server::Server;
use crate::tools::{self, Tool};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

const TOOL: Tool = Tool { program: "faketime", package: "faketime" };
/// The offsets of the clock, in the notation of libfaketime.
const STEPS: [&str; 3] = ["+3600", "-3600", "+0"];
const LASTS: Duration = Duration::from_secs(4);
/// Largest time by which the sensor may be ahead of the wall clock, s. On a busy machine the sensor may lag by more.
const AHEAD_S: f64 = 1.0;

pub fn run(program: &Path, device: &str) -> Result<()> {
    let library = tools::available(&[TOOL], "a clock that is set by an hour")?.then(library).flatten();
    let Some(library) = library else {
        println!("SKIPPED: a clock that is set by an hour: libfaketime is not there");
        return Ok(());
    };
    let folder = tempfile::tempdir()?;
    let (capture, offset) = (folder.path().join("served.arrows"), folder.path().join("offset"));
    fs::write(&offset, "+0\n")?;
    let mut command = Command::new(program);
    command.env("LD_PRELOAD", library).env("FAKETIME_TIMESTAMP_FILE", &offset);
    command.env("FAKETIME_DONT_FAKE_MONOTONIC", "1").env("FAKETIME_CACHE_DURATION", "1");
    let output = capture.display().to_string();
    let server = Server::start_with(&mut command, "127.0.0.1:0", &["--device", device, "-o", &output])?;
    let (shown_ms, begun) = (AtomicU64::new(0), Instant::now());
    for step in STEPS {
        fs::write(&offset, format!("{step}\n"))?;
        let since = Instant::now();
        // a page must get all frames, although the clock is set while it is open
        page::watch(&server.page, &|| since.elapsed() >= LASTS, &shown_ms).with_context(|| format!("at {step} s"))?;
    }
    let wall_s = begun.elapsed().as_secs_f64();
    server.end()?;
    let recorded = CaptureSummary::of(program, &capture)?;
    let shown_s = shown_ms.load(Ordering::Relaxed) as f64 * 1e-3;
    ensure!(recorded.span_s <= wall_s + AHEAD_S && shown_s > 0.0, "{} s of the sensor in {wall_s} s", recorded.span_s);
    recorded.check(program, device, folder.path())?;
    let CaptureSummary { rows, lost, span_s, .. } = recorded;
    println!(
        "clock         set by {STEPS:?} s: {rows} samples over {span_s:.1} s in {wall_s:.1} s, {lost} lost, the twin's"
    );
    Ok(())
}

/// The path of libfaketime in Debian's package; `None` if the package is not installed.
fn library() -> Option<PathBuf> {
    let listed = Command::new("dpkg").args(["-L", "libfaketime"]).output().ok()?;
    let text = String::from_utf8(listed.stdout).ok()?;
    let mut lines = text.lines().filter(|line| line.ends_with("/libfaketimeMT.so.1"));
    lines.next().map(PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If libfaketime did not change a program's clock, the task would test nothing with it.
    #[test]
    fn the_library_sets_the_clock_of_a_program() {
        let Some(library) = library() else { return };
        let folder = tempfile::tempdir().unwrap();
        let offset = folder.path().join("offset");
        fs::write(&offset, "+3600\n").unwrap();
        let now = |command: &mut Command| {
            let output = command.arg("+%s").output().unwrap().stdout;
            String::from_utf8(output).unwrap().trim().parse::<i64>().unwrap()
        };
        let mut set = Command::new("date");
        set.env("LD_PRELOAD", library).env("FAKETIME_TIMESTAMP_FILE", &offset);
        let ahead_s = now(&mut set) - now(&mut Command::new("date"));
        assert!((3500..3700).contains(&ahead_s), "{ahead_s}");
    }
}
