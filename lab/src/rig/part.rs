//! The twin as USB hardware, and its record of the bus.

use super::preferred;
use crate::killed::Killed;
use crate::twin_usb::Summary;
use anyhow::{Context, Result, ensure};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A plugged-in part: a running `cargo xtask twin-usb`.
pub struct UsbTwin {
    process: Killed,
    summary: PathBuf,
    wire: PathBuf,
}

/// A read of a data register, as recorded on the wire.
#[derive(Clone, Copy, Debug)]
pub struct RegisterReading {
    pub code: u32,
    /// Number of rate readings that were lost from power-on to this read.
    pub lost_rate: u64,
    /// Number of falling edges of RDY from power-on to this read.
    pub edges: u32,
}

/// The part's record of all transfers on the bus.
pub struct Record {
    pub summary: Summary,
    pub rates: Vec<RegisterReading>,
    pub temps: Vec<RegisterReading>,
}

impl UsbTwin {
    /// Switches a part on and plugs it in. The names of its files in `folder` begin with `name`.
    pub fn plug(folder: &Path, name: &str, socket: &Path, arguments: &[&str]) -> Result<Self> {
        let summary = folder.join(format!("{name}.part.json"));
        let wire = folder.join(format!("{name}.wire.csv"));
        let mut command = preferred(&std::env::current_exe()?);
        command.arg("twin-usb").arg(socket).arg("--wire").arg(&wire).args(arguments);
        command.stdout(File::create(&summary)?).stderr(Stdio::null());
        let process = Killed(command.spawn().context("starting the part")?);
        Ok(Self { process, summary, wire })
    }

    pub fn unplug(mut self) -> Result<Record> {
        let _ = Command::new("sh").arg("-c").arg(format!("kill -TERM {}", self.process.0.id())).status();
        let status = self.process.0.wait()?;
        ensure!(status.success(), "the part ended with {status}");
        let summary = serde_json::from_str(&fs::read_to_string(&self.summary)?)?;
        let wire = fs::read_to_string(&self.wire)?;
        Ok(Record { summary, rates: reads(&wire, "48"), temps: reads(&wire, "4a") })
    }
}

/// The 24-bit reads with this COM byte (F-24) in a log of the wire, whose columns are t_ns,mosi,miso,lost_rate,edges.
fn reads(wire: &str, com: &str) -> Vec<RegisterReading> {
    let frame = |line: &str| {
        let mut fields = line.split(',').skip(1);
        let (mosi, miso, lost, edges) = (fields.next()?, fields.next()?, fields.next()?, fields.next()?);
        let is_read = mosi.len() == 8 && mosi.starts_with(com);
        let code = u32::from_str_radix(miso.get(2..8)?, 16).ok().filter(|_| is_read)?;
        Some(RegisterReading { code, lost_rate: lost.parse().ok()?, edges: edges.parse().ok()? })
    };
    wire.lines().filter_map(frame).collect()
}
