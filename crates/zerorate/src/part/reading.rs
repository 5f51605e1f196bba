//! The input of this crate: a reading of one axis, or of all axes of a part at one time.

use super::MAX_AXES;

/// One reading of one axis, in codes as the part gave them. `From<&Sample>` of the driver's samples comes with the
/// feature `adis16130`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Time, ns, of a clock that runs evenly from any zero.
    pub t_ns: u64,
    /// Running number of the edge of data ready that announced the reading, which may wrap. For a part without data
    /// ready it is the number of the reading.
    pub seq: u32,
    /// Code of the rate less the zero code ([`Scale`](crate::Scale)).
    pub rate: i32,
    /// Code of the temperature less the zero code, if it was read.
    pub temp: Option<i32>,
    /// Whether the rate is beyond the range, by the status of the part or by a code at the end of the scale.
    pub out_of_range: bool,
    /// Number of readings that were lost between the previous reading and this one.
    pub lost: u32,
}

/// One reading of all axes of a part at one time. Rates and temperature are codes less their zero codes.
///
/// A fixed array has room for [`MAX_AXES`] rates, so a scan needs no heap.
///
/// ```
/// use zerorate::Scan;
/// let scan = Scan::new(1_000, 7, &[12, -5, 0]).expect("three axes").with_temp(Some(93)).with_out_of_range(1);
/// let y = scan.reading(1).expect("the second axis");
/// assert_eq!((y.t_ns, y.rate, y.temp, y.out_of_range), (1_000, -5, Some(93), true));
/// assert!(scan.reading(3).is_none() && Scan::new(0, 0, &[0; 9]).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scan {
    /// Time, as in [`Reading`].
    pub t_ns: u64,
    /// Running number, as in [`Reading`].
    pub seq: u32,
    /// Number of scans that were lost between the previous scan and this one.
    pub lost: u32,
    /// Code of the shared temperature less the zero code, if it was read.
    pub temp: Option<i32>,
    rates: [i32; MAX_AXES],
    axes: u8,
    /// A bit for each axis: whether the rate is out of range.
    out_of_range: u8,
}

/// Asserts that `Scan::out_of_range` has a bit for each axis.
const _: () = assert!(MAX_AXES <= u8::BITS as usize);

impl Scan {
    /// Makes a scan from the code of each axis less its zero code, without a temperature, with none lost and none out
    /// of range. `None` for more than [`MAX_AXES`] codes.
    #[must_use]
    #[inline]
    pub fn new(t_ns: u64, seq: u32, rates: &[i32]) -> Option<Self> {
        let mut all = [0; MAX_AXES];
        all.get_mut(..rates.len())?.copy_from_slice(rates);
        Some(Self { t_ns, seq, lost: 0, temp: None, rates: all, axes: rates.len() as u8, out_of_range: 0 })
    }

    /// Sets the code of the temperature less its zero code. `None` means that it was not read.
    #[must_use]
    #[inline]
    pub fn with_temp(self, temp: Option<i32>) -> Self {
        Self { temp, ..self }
    }

    /// Sets the number of scans that were lost before this one.
    #[must_use]
    #[inline]
    pub fn with_lost(self, lost: u32) -> Self {
        Self { lost, ..self }
    }

    /// Marks this axis as out of range, as in [`Reading`].
    #[must_use]
    #[inline]
    pub fn with_out_of_range(self, axis: usize) -> Self {
        let bit = if axis < MAX_AXES { 1 << axis } else { 0 };
        Self { out_of_range: self.out_of_range | bit, ..self }
    }

    /// The code of each axis less its zero code.
    #[must_use]
    #[inline]
    pub fn rates(&self) -> &[i32] {
        &self.rates[..usize::from(self.axes).min(MAX_AXES)]
    }

    /// Returns the reading of one axis. `None` if the scan does not have this axis.
    #[must_use]
    #[inline]
    pub fn reading(&self, axis: usize) -> Option<Reading> {
        let &Self { t_ns, seq, lost, temp, out_of_range, .. } = self;
        let &rate = self.rates().get(axis)?;
        Some(Reading { t_ns, seq, rate, temp, out_of_range: out_of_range >> axis & 1 == 1, lost })
    }
}

impl From<&Reading> for Scan {
    /// Makes the scan of a part with one axis.
    #[inline]
    fn from(reading: &Reading) -> Self {
        let &Reading { t_ns, seq, rate, temp, out_of_range, lost } = reading;
        let mut rates = [0; MAX_AXES];
        rates[0] = rate;
        Self { t_ns, seq, lost, temp, rates, axes: 1, out_of_range: u8::from(out_of_range) }
    }
}

#[cfg(feature = "adis16130")]
impl From<&adis16130::Sample> for Reading {
    /// Converts to the 24-bit scale (F-43). The reading is out of range by the status (OVR, F-35), which works with
    /// CLAMP = 0 as well, or by a code at the end of the scale.
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
