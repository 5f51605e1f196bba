//! A Debian 12 with the base packages only and without Rust, like the system of a new user.

use super::Folder;
use crate::tools::{Tool, available, is_root};
use crate::venv::done;
use anyhow::{Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const TOOLS: [Tool; 1] = [Tool { program: "mmdebstrap", package: "mmdebstrap" }];
/// A package that is installed beside the base packages, because the package of `zerorate` depends on it.
pub const BARE: &str = "adduser";

pub struct Root(PathBuf);

impl Root {
    /// A fresh bare Debian with these packages, separated by commas. The first call keeps it as an archive. If this
    /// process is not root, or mmdebstrap is missing, prints that and returns `None`.
    pub fn with(folder: &Folder, packages: &str) -> Result<Option<Self>> {
        if !is_root() {
            eprintln!("SKIPPED: a bare Debian to try things in: this needs root");
            return Ok(None);
        }
        if !available(&TOOLS, "a bare Debian to try things in")? {
            return Ok(None);
        }
        let archive = folder.work.join(format!("bookworm-{packages}.tar"));
        if !archive.exists() {
            let part = archive.with_extension("part.tar");
            let mut make = Command::new("mmdebstrap");
            make.args(["--quiet", "--variant=minbase", &format!("--include={packages}"), "bookworm"]);
            done(make.arg(&part))?;
            fs::rename(part, &archive)?;
        }
        let root = folder.empty("root")?;
        done(Command::new("tar").arg("--extract").arg("--file").arg(archive).arg("--directory").arg(&root))?;
        Ok(Some(Self(root)))
    }

    /// The path on this machine of a path inside the bare Debian.
    pub fn path(&self, path: impl AsRef<Path>) -> PathBuf {
        self.0.join(path)
    }

    pub fn copy(&self, from: &Path, to: &str) -> Result<()> {
        fs::create_dir_all(self.path(to).parent().unwrap_or(&self.0))?;
        fs::copy(from, self.path(to))?;
        Ok(())
    }

    /// A command that runs in `folder` of the bare Debian, in its own process namespace and without network.
    pub fn command_in(&self, folder: &str, program: &str) -> Command {
        let mut command = Command::new("unshare");
        command.args(["--mount", "--pid", "--net", "--fork", "--kill-child"]);
        command.arg(format!("--mount-proc={}", self.path("proc").display()));
        command.arg("chroot").arg(&self.0).args(["/usr/bin/env", "--chdir", folder, program]);
        command.env_clear().env("PATH", "/usr/sbin:/usr/bin:/sbin:/bin").env("LC_ALL", "C.UTF-8");
        command
    }

    pub fn script(&self, script: &str) -> Result<()> {
        let status = self.command_in("/", "/bin/sh").args(["-euc", script]).status()?;
        ensure!(status.success(), "in a bare Debian, `{script}` ended with {status}");
        Ok(())
    }
}
