//! Fills the disk of a recording and frees it again. The server must report the full disk, continue, keep what was
//! recorded, and record again after the device is opened anew (docs/serve.md).

use crate::bench_serve::page;
use crate::bench_serve::samples::CaptureSummary;
use crate::server::Server;
use crate::tools::is_root;
use crate::venv::done;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicU64;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Size of the disk: room for the samples of half a minute.
const SIZE: &str = "size=4m";
const FILL: &str = r#"{"id":1,"do":"speed","factor":20}"#;
const AGAIN: &str = r#"{"id":2,"do":"reopen"}"#;
/// Longest wait for the disk to fill, and for the second recording. Each takes seconds, but longer on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// How long a page checks that the sensor continues while the disk is full.
const LOOK: Duration = Duration::from_secs(2);

struct Disk {
    folder: tempfile::TempDir,
}

impl Disk {
    /// A mounted disk; `None` if this machine cannot mount one.
    fn new() -> Result<Option<Self>> {
        let folder = tempfile::tempdir()?;
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", SIZE, "tmpfs"]).arg(folder.path()).stderr(Stdio::null());
        let is_mounted = is_root() && mount.status().is_ok_and(|status| status.success());
        Ok(is_mounted.then_some(Self { folder }))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        // unmounted lazily, since the server may still be shutting down
        let _ = Command::new("umount").arg("-l").arg(self.folder.path()).status();
    }
}

pub fn run(program: &Path, device: &str) -> Result<()> {
    let Some(disk) = Disk::new()? else {
        println!("SKIPPED: a disk that fills: needs root and tmpfs");
        return Ok(());
    };
    let [first, second] = ["served.arrows", "served-2.arrows"].map(|name| disk.file(name));
    let server = Server::start(program, &["--device", device, "-o", &first.display().to_string()])?;
    page::ask(&server.page, FILL)?;
    wait_until(|| page::notice(&server.page, "not-recorded"))?;
    let seen = Instant::now();
    page::watch(&server.page, &|| seen.elapsed() >= LOOK, &AtomicU64::new(0)).context("behind a full disk")?;
    // the complete batches of the first file must equal the twin's samples
    let kept = tempfile::tempdir()?;
    let (torn, repaired) = (kept.path().join("torn.arrows"), kept.path().join("repaired.arrows"));
    fs::copy(&first, &torn)?;
    fs::remove_file(&first)?;
    done(Command::new(program).arg("repair").arg(&torn).arg("-o").arg(&repaired).stdout(Stdio::null()))?;
    let before = CaptureSummary::of(program, &repaired)?;
    before.check(program, device, kept.path())?;
    page::ask(&server.page, AGAIN)?;
    wait_until(|| Ok(fs::metadata(&second).is_ok_and(|about| about.len() > 1 << 18)))?;
    let failed = server.end().is_err();
    ensure!(failed, "the exit code does not tell that a recording failed");
    let after = CaptureSummary::of(program, &second)?;
    ensure!(after.lost == 0, "{} samples were lost in the second recording", after.lost);
    println!("disk          {} samples until it was full, {} once it was freed: each whole", before.rows, after.rows);
    Ok(())
}

fn wait_until(is: impl Fn() -> Result<bool>) -> Result<()> {
    let begun = Instant::now();
    while !is()? {
        ensure!(begun.elapsed() < PATIENCE, "it did not happen within {PATIENCE:?}");
        sleep(Duration::from_millis(200));
    }
    Ok(())
}
