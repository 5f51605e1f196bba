//! The input and output of the sampling loop.

use crate::codes::{RateCode, TempCode};
use crate::registers::ChannelStatus;

/// An edge of RDY as the host has seen it (F-32).
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Edge {
    /// The time of the edge, in ns of a clock that runs evenly. Its zero does not matter.
    pub t_ns: u64,
    /// Running number of the edge. It counts all edges, also those that the host had no time to handle, and may wrap.
    pub seq: u32,
}

/// A reading of the rate, and of the temperature if it was due.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Time of the edge that announced the sample, in ns.
    pub t_ns: u64,
    /// Running number of that edge ([`Edge::seq`]). Together with `t_ns` it gives the rate of the edges.
    pub seq: u32,
    /// The rate, as a code in the width of the data registers.
    pub rate: RateCode,
    /// The status of the rate channel, if it was read.
    pub status: Option<ChannelStatus>,
    /// The temperature, if it was read (F-55).
    pub temp: Option<TempCode>,
    /// Number of rate samples lost since the previous `Sample`: overwritten, dropped by a register that was being read
    /// (F-33), missed by the host, or lost in a failed read.
    pub lost: u32,
}
