//! Debian's stock kernel. The kernel package is only unpacked, not installed.

use crate::app::emptied;
use crate::tools::is_root;
use crate::venv::{done, printed};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The meta package of the kernel. 6.12 is the first version with drivers for the emulated USB adapter, and Debian 12
/// provides it.
const META: &str = "linux-image-6.12-amd64";

pub struct Kernel {
    tree: PathBuf,
    pub release: String,
}

impl Kernel {
    /// Fetches and unpacks the kernel below `folder`, unless its current version is there already.
    pub fn fetch(folder: &Path) -> Result<Self> {
        let package = package()?;
        let tree = folder.join(&package);
        if !tree.join("complete").exists() {
            unpack(&package, folder, &tree)?;
        }
        let modules = tree.join("lib/modules");
        let release = fs::read_dir(&modules)?.next().context("no modules in the kernel package")??;
        let release = release.file_name().to_string_lossy().into_owned();
        if !modules.join(&release).join("modules.dep").exists() {
            done(Command::new("depmod").arg("-b").arg(&tree).arg(&release))?;
        }
        Ok(Self { tree, release })
    }

    pub fn image(&self) -> PathBuf {
        self.tree.join("boot").join(format!("vmlinuz-{}", self.release))
    }

    /// The files of `modules` and of all modules that they need, in loading order.
    pub fn module_files(&self, modules: &[&str]) -> Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        for module in modules {
            let tree = fs::canonicalize(&self.tree)?;
            let mut modprobe = Command::new("modprobe");
            modprobe.arg("-d").arg(tree).args(["-S", &self.release, "--show-depends", module]);
            for line in printed(&mut modprobe)?.lines() {
                let file = line.strip_prefix("insmod ").map(|file| PathBuf::from(file.trim()));
                files.extend(file.filter(|file| !files.contains(file)));
            }
        }
        Ok(files)
    }
}

fn package() -> Result<String> {
    if known().is_none() && is_root() {
        done(Command::new("apt-get").args(["update", "-qq"]))?;
    }
    known().with_context(|| format!("apt knows no {META}: sudo apt-get update"))
}

fn known() -> Option<String> {
    let output = Command::new("apt-cache").args(["depends", META]).stderr(Stdio::null()).output().ok()?;
    let depends = String::from_utf8(output.stdout).ok()?;
    depends.lines().find_map(|line| Some(line.trim().strip_prefix("Depends: ")?.to_owned()))
}

fn unpack(package: &str, folder: &Path, tree: &Path) -> Result<()> {
    let download = emptied(folder.join("download"))?;
    eprintln!("fetching {package}");
    done(Command::new("apt-get").args(["download", "-qq", package]).current_dir(&download))?;
    let file = fs::read_dir(&download)?.next().context("apt-get download left no file")??;
    done(Command::new("dpkg-deb").arg("-x").arg(file.path()).arg(tree))?;
    ensure!(tree.join("boot").is_dir(), "{package} holds no kernel");
    fs::remove_dir_all(&download)?;
    Ok(fs::write(tree.join("complete"), "")?)
}
