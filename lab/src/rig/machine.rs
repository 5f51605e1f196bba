//! The virtual machine: QEMU with a USB redirection socket, and its console.

use super::kernel::Kernel;
use super::preferred;
use crate::killed::Killed;
use crate::venv::done;
use anyhow::{Context, Result, bail};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

const SSDT: &str = include_str!("part.dsl");
/// The mark at the start of the script's lines on the console.
const MARK: &str = "RIG ";

pub struct Machine {
    qemu: Killed,
    console: Receiver<String>,
    seen: Vec<String>,
    started: Instant,
    /// The file that receives the guest's files.
    archive: PathBuf,
}

impl Machine {
    /// Boots `kernel` with the file system `initramfs`. Parts are plugged in through `socket`.
    pub fn boot(folder: &Path, kernel: &Kernel, initramfs: &Path, socket: &Path) -> Result<Self> {
        let archive = folder.join("out.tar");
        let ssdt = folder.join("part");
        fs::write(ssdt.with_extension("dsl"), SSDT)?;
        let dsl = ssdt.with_extension("dsl");
        done(Command::new("iasl").arg("-p").arg(&ssdt).arg(dsl).stdout(Stdio::null()))?;
        let mut qemu = preferred(Path::new("qemu-system-x86_64"))
            .args("-accel tcg -m 512 -machine q35 -nodefaults -nographic -no-reboot -serial stdio".split(' '))
            .arg("-serial")
            .arg(format!("file:{}", archive.display()))
            .arg("-kernel")
            .arg(kernel.image())
            .arg("-initrd")
            .arg(initramfs)
            .args(["-append", "console=ttyS0 quiet panic=-1"])
            .arg("-acpitable")
            .arg(format!("file={}", ssdt.with_extension("aml").display()))
            .args(["-device", "qemu-xhci,id=xhci,addr=04.0,p2=2,p3=1"])
            .arg("-chardev")
            .arg(format!("socket,id=part,path={},server=on,wait=off", socket.display()))
            .args(["-device", "usb-redir,chardev=part,bus=xhci.0,port=1"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .context("starting qemu-system-x86_64")?;
        let output = qemu.stdout.take().context("no console")?;
        let (lines, console) = channel();
        thread::spawn(move || {
            let read = BufReader::new(output).split(b'\n').map_while(Result::ok);
            for line in read.map(|line| String::from_utf8_lossy(&line).trim().to_owned()) {
                if lines.send(line).is_err() {
                    break;
                }
            }
        });
        Ok(Self { qemu: Killed(qemu), console, seen: Vec::new(), started: Instant::now(), archive })
    }

    /// Waits until the script prints `text`, for `limit` at most.
    pub fn until(&mut self, text: &str, limit: Duration) -> Result<()> {
        let deadline = Instant::now() + limit;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.console.recv_timeout(left) {
                Ok(line) => {
                    let said = line.strip_prefix(MARK).map(str::to_owned);
                    self.seen.push(line);
                    let Some(said) = said else { continue };
                    eprintln!("{:6.1} s  {said}", self.started.elapsed().as_secs_f64());
                    if said == text {
                        return Ok(());
                    }
                    if said.starts_with("failed") {
                        bail!("the guest {said}\n{}", self.last_lines());
                    }
                }
                Err(RecvTimeoutError::Timeout) => {
                    bail!("the guest did not say \"{text}\" within {} s\n{}", limit.as_secs(), self.last_lines());
                }
                Err(RecvTimeoutError::Disconnected) => {
                    bail!("the machine ended before it said \"{text}\"\n{}", self.last_lines());
                }
            }
        }
    }

    /// Waits for the machine to end, and unpacks the guest's files to `folder`.
    pub fn files(mut self, folder: &Path) -> Result<()> {
        self.qemu.0.wait()?;
        fs::create_dir_all(folder)?;
        done(Command::new("tar").arg("-xf").arg(&self.archive).arg("-C").arg(folder))
    }

    fn last_lines(&self) -> String {
        let from = self.seen.len().saturating_sub(30);
        self.seen[from..].join("\n")
    }
}
