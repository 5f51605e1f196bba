//! The options that specify the sensor and how it is read.

use crate::interrupt;
use crate::output::{Outputs, warn};
use crate::part::PartArgs;
use crate::wording::flag;
use anyhow::Result;
use clap::Args;
use std::ops::Deref;
use std::path::Path;
use zerorate_host::{DeviceSpec, Pace, Sampling, Setup};
use zerorate_jobs::{Acquisition, WarningSink};

/// The sensor to read.
#[derive(Args, Debug)]
pub struct SourceArgs {
    /// The sensor to read, such as twin:, replay:FILE or bridge:… (all: `zerorate help device`).
    #[arg(short, long, value_name = "DEV", default_value = "twin:", help_heading = "Sensor")]
    pub device: DeviceSpec,

    #[command(flatten)]
    pub part: PartArgs,
}

/// The sensor to read, and how fast simulated or recorded time goes.
#[derive(Args, Debug)]
pub struct DeviceArgs {
    #[command(flatten)]
    pub source: SourceArgs,

    /// Pace simulated or replayed time to the wall clock [default: as fast as possible].
    #[arg(long, help_heading = "Sensor")]
    pub realtime: bool,
}

impl SourceArgs {
    /// The settings for reading the device. Also registers a recording as an input of the run. Every command with
    /// `--device` calls this before it opens the device.
    pub fn setup(&self, sampling: SamplingArgs, outputs: &mut Outputs) -> Result<Setup> {
        self.file().map_or(Ok(()), |file| outputs.reads(file))?;
        let SamplingArgs { every_temp, divider } = sampling;
        let sampling = Sampling { every_temp, divider };
        Ok(Setup { sampling, part: self.part.named(outputs)?, ambient: None, names: flag })
    }

    pub fn file(&self) -> Option<&Path> {
        self.device.file()
    }
}

impl DeviceArgs {
    /// Opens the device. After this call, the first Ctrl-C only requests a clean end.
    pub fn open(&self, setup: Setup) -> Result<Acquisition> {
        self.open_at(setup, false)
    }

    /// Like [`Self::open`], but in real time if a person watches the samples.
    pub fn open_at(&self, setup: Setup, is_watched: bool) -> Result<Acquisition> {
        interrupt::listen();
        let pace = if self.realtime || is_watched { Pace::RealTime } else { Pace::Free };
        Acquisition::open(&self.device, setup, pace, interrupt::stop(), tell())
    }
}

pub fn tell() -> WarningSink {
    Box::new(|warning| warn(&[warning.coded()]))
}

impl Deref for DeviceArgs {
    type Target = SourceArgs;

    fn deref(&self) -> &SourceArgs {
        &self.source
    }
}

/// Options that select how often the sensor is read. A replayed capture keeps the settings of its recording.
#[derive(Args, Debug, Clone, Copy)]
pub struct SamplingArgs {
    /// Read the temperature with every N-th rate sample only, for a slow host [default: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = "Sensor")]
    pub every_temp: Option<u16>,

    /// Read on every N-th data-ready edge only; the resulting rate is measured and stated [default: 1]. Where a
    /// counter divides the line itself, put divided=N into the address. A divider then counts the edges behind it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = "Sensor")]
    pub divider: Option<u16>,
}
