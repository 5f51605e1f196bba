//! Counts of conversions and losses per channel, and the last reads by the host.

/// Samples that the host never saw, per channel, since the twin was made.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct LostUnread {
    /// Losses of the rate channel.
    pub rate: ChannelLosses,
    /// Losses of the temperature channel.
    pub temp: ChannelLosses,
}

/// Samples of one channel that the host never saw.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelLosses {
    /// Number of samples that were overwritten before they were read (F-33).
    pub overwritten: u64,
    /// Number of new samples that were dropped because the register was being read during the update (F-33).
    pub lost_new: u64,
}

/// The last readings of the data registers. A field is `None` until the host reads its register.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct LastRead {
    /// The last reading of RATEDATA.
    pub rate: Option<Reading>,
    /// The last reading of TEMPDATA.
    pub temp: Option<Reading>,
}

/// A read of a data register, as the part sent it, before a fault of the wires changed it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Reading {
    /// The content of the register in 24 bits.
    pub code: u32,
    /// The last conversion that was stored in the register. `None` if there was none since the reset. With
    /// [`Fault::Frozen`](crate::Fault::Frozen) the code is older than this conversion.
    pub conversion: Option<Conversion>,
    /// Whether the input was out of range, so that the code has wrapped or saturated (F-35).
    pub out_of_range: bool,
}

/// A conversion of one channel.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Conversion {
    /// Number of the conversion among all conversions of the channel since the twin was made, from 1 on. A conversion
    /// whose result the register did not store counts as well.
    pub number: u64,
    /// Simulated time of the end of the conversion, in ns from the start.
    pub t_ns: u64,
}

/// The counts and the last reading of a channel, which outlast a reset.
#[derive(Copy, Clone, Default)]
pub(crate) struct Tally {
    pub(crate) conversions: u64,
    pub(crate) losses: ChannelLosses,
    pub(crate) last_read: Option<Reading>,
}
