//! Power failures. After a power failure, the disk contains what was synced before. A file system in an image file
//! simulates this, because the image lacks everything that the kernel has not written yet.

use super::bench::{Bench, Folder, SHORT, random};
use super::process::repaired;
use super::{Class, Verdict};
use crate::killed::Killed;
use crate::tools::is_root;
use crate::venv::done;
use anyhow::Result;
use rand::RngExt;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::Duration;

pub const CLASSES: &[Class] = &[
    Class::new("power cut after calibrate", "right after exit 0: calibration and log are there, whole", 1, after),
    Class::new("power cut after capture csv", "right after exit 0", 1, after),
    Class::new("power cut after capture parquet", "right after exit 0", 1, after),
    Class::new("power cut after export h", "right after exit 0", 1, after),
    Class::new("power cut in capture", "at a random moment of a recording: the file is a prefix", 1, within),
];

const NO_IMAGES: &str = "needs root and loop devices";
/// Size of the image: enough for the log of a short calibration, which has 30 MB.
const IMAGE_BYTES: u64 = 96 << 20;

/// A file system in an image file, mounted.
struct Disk {
    folder: Folder,
    mounted: PathBuf,
}

impl Disk {
    /// Makes and mounts a new disk; `None` if this machine cannot mount images.
    fn new(name: &str) -> Result<Option<Self>> {
        if !is_root() {
            return Ok(None);
        }
        let folder = Folder::new(name)?;
        let image = folder.path().join("disk.img");
        File::create(&image)?.set_len(IMAGE_BYTES)?;
        done(Command::new("mkfs.ext4").args(["-q", "-F"]).arg(&image))?;
        Self::mount(folder, &image)
    }

    fn mount(folder: Folder, image: &Path) -> Result<Option<Self>> {
        let mounted = folder.path().join("disk");
        fs::create_dir_all(&mounted)?;
        let mount = Command::new("mount").args(["-o", "loop"]).arg(image).arg(&mounted).stderr(Stdio::null()).status();
        Ok(mount.is_ok_and(|status| status.success()).then_some(Self { folder, mounted }))
    }

    fn file(&self, name: &str) -> String {
        self.mounted.join(name).display().to_string()
    }

    /// A copy of the disk with the content that a power failure would leave now.
    fn after_a_power_cut(&self, name: &str) -> Result<Option<Self>> {
        let folder = Folder::new(&format!("{name}-cut"))?;
        let image = folder.path().join("disk.img");
        fs::copy(self.folder.path().join("disk.img"), &image)?;
        Self::mount(folder, &image)
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        // unmount lazily, since a killed process may not have ended yet
        let _ = Command::new("umount").arg("-l").arg(&self.mounted).status();
    }
}

/// A new disk; `None` if images cannot be mounted here. Only the first call tries that.
fn disk(name: &str) -> Result<Option<Disk>> {
    static POSSIBLE: OnceLock<bool> = OnceLock::new();
    let is_possible = *POSSIBLE.get_or_init(|| Disk::new("try").is_ok_and(|disk| disk.is_some()));
    if is_possible { Disk::new(name) } else { Ok(None) }
}

fn after(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let (name, device) = (format!("{}-{seed}", class.replace(' ', "-")), format!("twin:seed={seed}"));
    let Some(disk) = disk(&name)? else { return Ok(Verdict::Skipped(NO_IMAGES)) };
    let form = class.rsplit(' ').next().unwrap_or(class);
    let result = disk.file(&format!("result.{}", if form == "calibrate" { "toml" } else { form }));
    let (log, unit) = (disk.file("log.arrows"), bench.file("unit.toml"));
    let args = match form {
        "calibrate" => [&["calibrate", "--device", &device, "-o", &result, "--log", &log], &SHORT[..]].concat(),
        "h" => vec!["export", &unit, "--format", "c", "-o", &result],
        _ => vec!["capture", "--device", &device, "--samples", "9000", "-o", &result],
    };
    bench.must(&args)?;
    let Some(found) = disk.after_a_power_cut(&name)? else {
        return Ok(Verdict::Silent("the file system cannot be mounted any more".to_owned()));
    };
    let name = Path::new(&result).file_name().unwrap_or_default();
    let [before, after] = [fs::read(&result)?, fs::read(found.mounted.join(name)).unwrap_or_default()];
    let mut lost = before != after;
    if form == "calibrate" {
        lost |= fs::read(&log)? != fs::read(found.mounted.join("log.arrows")).unwrap_or_default();
    }
    Ok(if lost {
        Verdict::Silent(format!("{} bytes of {} are left", after.len(), before.len()))
    } else {
        Verdict::Right
    })
}

fn within(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let (name, device) = (format!("within-{seed}"), format!("twin:seed={seed}"));
    let Some(disk) = disk(&name)? else { return Ok(Verdict::Skipped(NO_IMAGES)) };
    let args = ["capture", "--device", &device, "--duration", "10m", "-o", &disk.file("log.arrows")];
    let child = Killed(bench.command(&args).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?);
    sleep(Duration::from_millis(random(class, seed).random_range(0..1_500)));
    // or the copy would have some blocks from before a write, and some from after it
    drop(child);
    let Some(found) = disk.after_a_power_cut(&name)? else {
        return Ok(Verdict::Silent("the file system cannot be mounted any more".to_owned()));
    };
    let log = found.file("log.arrows");
    if fs::metadata(&log).map_or(0, |about| about.len()) == 0 {
        return Ok(Verdict::Right);
    }
    repaired(bench, &found.folder, &log, &device)
}
