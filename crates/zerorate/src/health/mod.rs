//! The health of a sensor: which readings are valid, whether they still change, whether the sensor is at rest,
//! whether samples are lost, and where a resonance appears among the samples.

pub(crate) mod block_means;
mod checkup;
mod freeze;
mod judge;
pub mod plausible;
pub mod resonance;
pub mod stationarity;
mod tally;

pub use checkup::Checkup;
pub use freeze::Frozen;
pub use judge::{FaultCounts, Flags, Health, Judged};
pub use tally::Tally;
