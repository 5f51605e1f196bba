//! The settings of a part's configuration that a host can choose, in their form on the wire.

use crate::codes::Width;
use crate::config::{Config, RdyEdge};
use crate::frame::Framing;
use crate::registers::ConversionTime;
use serde::{Deserialize, Serialize};

/// The settings of a [`Config`] that a host can choose. The others have their values of F-30.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    /// Whether CS rises between all bytes (F-22).
    pub cs_per_byte: bool,
    /// Whether the data registers are 16 bits wide.
    pub bits16: bool,
    /// Value of RATECONV: conversion time of the rate (F-31).
    pub rate_conversion: u8,
    /// Value of TEMPCONV: conversion time of the temperature (F-31).
    pub temp_conversion: u8,
    /// Whether the rising edge of RDY announces new data (F-32).
    pub rdy_rises: bool,
}

impl From<&Config> for Settings {
    fn from(config: &Config) -> Self {
        Self {
            cs_per_byte: matches!(config.framing(), Framing::PerByte),
            bits16: matches!(config.width(), Width::Bits16),
            rate_conversion: config.rate_conversion().bits(),
            temp_conversion: config.temp_conversion().bits(),
            rdy_rises: matches!(config.rdy_edge(), RdyEdge::Rising),
        }
    }
}

impl From<Settings> for Config {
    fn from(settings: Settings) -> Self {
        Self::new()
            .with_framing(if settings.cs_per_byte { Framing::PerByte } else { Framing::Command })
            .with_width(if settings.bits16 { Width::Bits16 } else { Width::Bits24 })
            .with_rate_conversion(ConversionTime::new(settings.rate_conversion))
            .with_temp_conversion(ConversionTime::new(settings.temp_conversion))
            .with_rdy_edge(if settings.rdy_rises { RdyEdge::Rising } else { RdyEdge::Falling })
    }
}
