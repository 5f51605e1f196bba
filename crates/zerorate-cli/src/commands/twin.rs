//! `zerorate twin`: the keys of the simulated part, and the part as hardware that other software sees.

use crate::interrupt;
use crate::output::print;
use adis16130_twin::{KEYS, Key, Spec};
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// List the keys of the simulated sensor, or plug it into a virtual machine
///
/// Every command that reads a sensor takes the twin as `--device twin:KEY=VALUE,…`. Without options this command lists
/// the keys.
///
/// With --usb the twin becomes hardware, on wall time, behind an emulated USB adapter for SPI and GPIO (Intel LJCA,
/// 8086:0b63). QEMU plugs it into a guest, where the kernel's own drivers bind it: usb-ljca, spi-ljca and gpio-ljca of
/// Linux 6.12. RDY is line 3 of the adapter's GPIO chip. Ctrl-C unplugs the twin. docs/formats/ljca.md has the
/// messages and the options of QEMU.
#[derive(Args, Debug)]
pub struct TwinArgs {
    /// The unit, as in --device twin:KEY=VALUE,… .
    #[arg(value_name = "KEY=VALUE,…", requires = "usb")]
    keys: Option<Spec>,

    /// Plug the twin in at this unix socket, on which QEMU listens (-chardev socket,…,server=on).
    #[arg(long, value_name = "SOCKET")]
    usb: Option<PathBuf>,

    /// Master clock of the converter, Hz. It may be slower than the key mclk_hz allows, so that a slow host can
    /// follow. Temperatures and noise follow the wall clock.
    #[arg(long, value_name = "HZ", requires = "usb")]
    #[arg(value_parser = clap::value_parser!(u32).range(1_000..=10_000_000))]
    mclk_hz: Option<u32>,

    /// Convert from the start, as after F-30: for drivers that write no register, such as the driver of Linux.
    #[arg(long, requires = "usb")]
    initialised: bool,

    /// Log every SPI frame to this file: t_ns,mosi,miso,lost_rate,edges as CSV.
    #[arg(long, value_name = "FILE", requires = "usb")]
    wire: Option<PathBuf>,

    /// Overwrite an existing --wire file.
    #[arg(long, requires = "wire")]
    force: bool,

    /// At the end, print what the twin saw and its true values as one JSON object.
    #[arg(long, requires = "usb")]
    json: bool,
}

pub fn run(args: &TwinArgs) -> Result<()> {
    let Some(socket) = &args.usb else {
        return print(&(keys_help() + "\n"));
    };
    interrupt::listen();
    let mut spec = args.keys.clone().unwrap_or_else(|| Spec::from_seed(1));
    if let Some(mclk_hz) = args.mclk_hz {
        spec.mclk_hz = mclk_hz.into();
    }
    hardware::run(args, socket, spec)
}

#[cfg(not(unix))]
mod hardware {
    use super::*;

    pub fn run(_: &TwinArgs, _: &std::path::Path, _: Spec) -> Result<()> {
        Err(crate::exit::Usage("--usb needs unix sockets, which this system does not have".to_owned()).into())
    }
}

#[cfg(unix)]
mod hardware {
    use super::*;
    use crate::output::{Outputs, print_json, say};
    use crate::twin_usb::{self, Final, Served, Setup};
    use adis16130_twin::ChannelLosses;
    use serde::Serialize;
    use std::path::Path;

    /// What the part saw, and its true values.
    #[derive(Serialize)]
    struct Summary {
        seed: u64,
        mclk_hz: f64,
        duration_s: f64,
        #[serde(flatten)]
        seen: Served,
        lost_rate: Losses,
        lost_temp: Losses,
        truth: TruthReport,
    }

    /// Readings that were lost unread (F-33).
    #[derive(Serialize)]
    struct Losses {
        overwritten: u64,
        dropped: u64,
    }

    impl From<ChannelLosses> for Losses {
        fn from(losses: ChannelLosses) -> Self {
            Self { overwritten: losses.overwritten, dropped: losses.lost_new }
        }
    }

    /// The terms of the slow bias at the end. A perfect measurement finds PBC = −bias and BTC = −slope (F-50).
    #[derive(Serialize)]
    struct TruthReport {
        sensor_c: f64,
        pbc_dps: f64,
        btc_dps_per_c: f64,
        curvature_dps_per_c2: f64,
    }

    pub fn run(args: &TwinArgs, socket: &Path, spec: Spec) -> Result<()> {
        let (seed, mclk_hz) = (spec.seed, spec.mclk_hz);
        let mut outputs = Outputs::new(args.force).printing();
        let wire = args.wire.as_deref().map(|path| outputs.recording(path)).transpose()?;
        let setup = Setup { spec, initialised: args.initialised, wire };
        let Final { seen, lost, truth } = twin_usb::serve(socket, setup)?;
        let summary = Summary {
            seed,
            mclk_hz,
            duration_s: truth.t_ns as f64 * 1e-9,
            seen,
            lost_rate: lost.rate.into(),
            lost_temp: lost.temp.into(),
            truth: TruthReport {
                sensor_c: truth.sensor_c,
                pbc_dps: truth.pbc_dps(truth.sensor_c),
                btc_dps_per_c: truth.btc_dps_per_c(truth.sensor_c),
                curvature_dps_per_c2: (1.0 + truth.sensitivity_error) * truth.curvature_dps_per_c2,
            },
        };
        if args.json {
            return print_json(&summary);
        }
        let Served { spi_frames, rate_reads, temp_reads, edges, edges_reported } = seen;
        say(format_args!(
            "unplugged after {:.1} s: {spi_frames} SPI frames, {rate_reads} rates and {temp_reads} temperatures read, \
             {edges_reported} of {edges} edges of RDY reported",
            summary.duration_s
        ));
        Ok(())
    }
}

/// The table of the keys, from the table of the twin.
pub fn keys_help() -> String {
    let keys: Vec<String> = KEYS.iter().map(entry).collect();
    format!(
        "Keys of --device twin:KEY=VALUE,KEY=VALUE,… (drawn: by the seed, so every seed is another unit)\n\n{}\n\n\
         For example: zerorate calibrate --device twin:seed=7,bias_dps=0.8\n\
         axes=3 makes a part with the axes x, y and z. Each has its own bias and noise.\n\
         All axes share one clock and one temperature.",
        keys.join("\n")
    )
}

fn entry(key: &Key) -> String {
    let Key { name, default, help, .. } = key;
    format!("  {name:<17} {help}\n  {:<17} {} [default: {default}]", "", key.allowed())
}
