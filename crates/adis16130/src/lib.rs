#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "async")]
pub mod asynch;
pub mod blocking;
#[cfg(feature = "bridge")]
pub mod bridge;
mod channel;
mod checksum;
mod codes;
mod config;
mod diagnosis;
mod error;
pub mod frame;
mod quotient;
mod readback;
pub mod registers;
mod sample;
mod sampler;
mod self_test;
mod timeline;
mod wait;

pub use checksum::WriteCheck;
pub use codes::{RateCode, TempCode, Width, round_to_16_bits};
pub use config::{Channels, Config, RdyEdge, Write};
pub use diagnosis::{Fault, Mismatch};
pub use error::{
    BusError, Error, InitError, NoReading, OutOfRange, ReadError, SampleError, SelfTestError, VerifyError, WaitError,
};
pub use frame::Framing;
pub use readback::Differences;
pub use registers::{ChannelStatus, ConversionTime};
pub use sample::{Edge, Sample};
pub use sampler::{Due, Sampler, SamplerConfig};
pub use self_test::{SelfTest, SelfTestPlan};
pub use wait::{PollInterval, WaitBound};

/// Codes per °/s on the 24-bit scale (F-40).
pub const RATE_LSB_PER_DPS: u32 = 23_488;

/// Codes per °C on the 24-bit scale (F-41).
pub const TEMP_LSB_PER_C: u32 = 14_093;

/// The 24-bit code of 0 °/s and of 25 °C (F-40, F-41).
pub const ZERO_CODE: u32 = 1 << 23;

/// The temperature at [`ZERO_CODE`], in °C (F-41).
pub const TEMP_AT_ZERO_CODE_C: i32 = 25;

/// Nominal master clock in Hz (F-31). The clock of a part may be 2 % off, so measure the rate.
pub const MCLK_HZ: u32 = 6_000_000;

/// MCLK cycles for which RDY is high before it falls on an update (F-32).
pub const SCALING_CYCLES: u32 = 163;

/// The SPI mode of the part: clock idle high, sampled on the second edge (F-20).
pub const SPI_MODE: embedded_hal::spi::Mode = embedded_hal::spi::MODE_3;

/// The fastest SPI clock in Hz (F-21).
pub const MAX_SCLK_HZ: u32 = 10_000_000;

/// The slowest SPI clock, Hz, at which both channels can be read at the full rate if the software takes no time
/// (F-33).
pub const MIN_SCLK_HZ: u32 = 1_100_000;
