//! A row of a capture: the readings of all axes of a part at one time, in raw codes.

use super::succession::Mark;
use adis16130::Sample;
use zerorate::MAX_AXES;

/// A row of raw codes. The [`Layout`](super::Layout) of the capture gives their meaning. The codes are stored in an
/// array of [`MAX_AXES`] elements, so that a row needs no allocation.
///
/// ```
/// use zerorate_record::Row;
/// let row = Row::new(1_000, 7, &[12, -5, 0]).expect("three axes").with_temp_code(Some(93)).with_lost(2);
/// assert_eq!((row.codes(), row.temp_code, row.lost), (&[12, -5, 0][..], Some(93), 2));
/// assert!(Row::new(0, 0, &[0; 9]).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Time of the reading, ns, on a monotonic clock with an arbitrary zero.
    pub t_ns: u64,
    /// Running number of the reading's data-ready edge, or of the reading if there is no such signal. It wraps around.
    pub edge_seq: u32,
    /// Number of readings lost since the previous row, the same for all axes; `u32::MAX` means that many or more.
    pub lost: u32,
    /// The status register, if it was read.
    pub status: Option<u32>,
    /// The temperature code, if it was read.
    pub temp_code: Option<i64>,
    pub(super) codes: [i64; MAX_AXES],
    pub(super) axes: u8,
}

impl Row {
    /// A row with the code of each axis, without status, temperature or losses. `None` if there are more than
    /// [`MAX_AXES`] axes.
    #[must_use]
    #[inline]
    pub fn new(t_ns: u64, edge_seq: u32, codes: &[i64]) -> Option<Self> {
        let mut all = [0; MAX_AXES];
        all.get_mut(..codes.len())?.copy_from_slice(codes);
        Some(Self::with_codes(t_ns, edge_seq, all, codes.len()))
    }

    /// A row of `axes` axes. Their codes are the first ones in `codes`.
    #[inline]
    pub(super) fn with_codes(t_ns: u64, edge_seq: u32, codes: [i64; MAX_AXES], axes: usize) -> Self {
        Self { t_ns, edge_seq, lost: 0, status: None, temp_code: None, codes, axes: axes.min(MAX_AXES) as u8 }
    }

    /// Sets the status register; `None` if it was not read.
    #[must_use]
    #[inline]
    pub fn with_status(self, status: Option<u32>) -> Self {
        Self { status, ..self }
    }

    /// Sets the temperature code; `None` if it was not read.
    #[must_use]
    #[inline]
    pub fn with_temp_code(self, temp_code: Option<i64>) -> Self {
        Self { temp_code, ..self }
    }

    /// Sets the number of readings lost before the row.
    #[must_use]
    #[inline]
    pub fn with_lost(self, lost: u32) -> Self {
        Self { lost, ..self }
    }

    /// The code of each axis, in the order of the layout.
    #[must_use]
    #[inline]
    pub fn codes(&self) -> &[i64] {
        &self.codes[..usize::from(self.axes).min(MAX_AXES)]
    }

    /// The time, edge number and losses of the row.
    #[must_use]
    #[inline]
    pub fn mark(&self) -> Mark {
        Mark { t_ns: self.t_ns, edge_seq: self.edge_seq, lost: self.lost }
    }
}

impl From<&Sample> for Row {
    /// A row of an ADIS16130. The layout states the width of its codes.
    #[inline]
    fn from(sample: &Sample) -> Self {
        let mut codes = [0; MAX_AXES];
        codes[0] = sample.rate.code().into();
        Self::with_codes(sample.t_ns, sample.seq, codes, 1)
            .with_lost(sample.lost)
            .with_status(sample.status.map(|status| status.bits().into()))
            .with_temp_code(sample.temp.map(|temp| temp.code().into()))
    }
}
