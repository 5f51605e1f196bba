#![doc = include_str!("../README.md")]
#![no_std]

extern crate alloc;

mod adc;
mod chip;
pub mod facts;
mod fault;
mod gyro;
mod keys;
mod means;
mod normal;
mod part;
mod pins;
mod registers;
mod spec;
mod spi;
mod tally;
mod truth;
mod twin;

pub use fault::{DEFAULT_BIT_ERROR_RATE, Fault};
pub use keys::{KEYS, Key, SpecError};
pub use means::{Mean, Means};
pub use pins::{RDY_WAIT_LIMIT_NS, RdyTimeout, SelfTestPin, SyncPin, TwinDelay, TwinRdy};
pub use spec::{Motion, Profile, RdyOutput, Roa, Spec};
pub use spi::TwinSpi;
pub use tally::{ChannelLosses, Conversion, LastRead, LostUnread, Reading};
pub use truth::Truth;
pub use twin::{Twin, TwinEdge};
