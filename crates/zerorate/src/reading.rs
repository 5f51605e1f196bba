//! What the core takes of a part: one reading of one axis.

/// One reading of one axis, in codes as the part gave them. `From<&Sample>` of the driver's samples comes with the
/// feature `adis16130`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// When, in ns of a clock that runs evenly; its zero does not matter.
    pub t_ns: u64,
    /// Running number of the edge of data ready that announced it; it may wrap. Where a part has none: of the reading.
    pub seq: u32,
    /// Code of the rate less the zero code ([`Scale`](crate::Scale)).
    pub rate: i32,
    /// Code of the temperature less the zero code, if it was read.
    pub temp: Option<i32>,
    /// The part itself, or a code at the end of the scale, says that the rate is beyond the range.
    pub out_of_range: bool,
    /// Readings lost since the one before.
    pub lost: u32,
}

#[cfg(feature = "adis16130")]
impl From<&adis16130::Sample> for Reading {
    /// On the 24-bit scale (F-43). Out of range by the status (OVR, F-35), which tells with CLAMP = 0 as well, or by a
    /// code at the end of the scale.
    #[inline]
    fn from(sample: &adis16130::Sample) -> Self {
        let from_zero = |code24: u32| code24 as i32 - adis16130::ZERO_CODE as i32;
        Self {
            t_ns: sample.t_ns,
            seq: sample.seq,
            rate: from_zero(sample.rate.code24()),
            temp: sample.temp.map(|temp| from_zero(temp.code24())),
            out_of_range: sample.rate.is_at_rail() || sample.status.is_some_and(|status| status.out_of_range()),
            lost: sample.lost,
        }
    }
}
