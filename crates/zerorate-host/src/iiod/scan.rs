//! Converts rows of the hub to samples of a buffer: checked, corrected if possible, and with a count of losses.

use super::correcting::Correcting;
use super::table::{CORRECTED_RAD_PER_S, Quantity, Table};
use std::collections::VecDeque;
use std::ops::Range;
use zerorate::{Axis, Correction, Corrector, MAX_AXES};
use zerorate_record::{Layout, Row};

/// One sample of a buffer: the values of all channels at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scan {
    /// The row, with the last temperature that was read.
    pub row: Row,
    /// The corrected rate of each axis, °/s; `None` without a correction, a valid reading or a temperature.
    pub corrected_dps: [Option<f64>; MAX_AXES],
    /// Number of samples that were lost since this scanner was made. In a client's buffer, samples that the client
    /// missed count too.
    pub lost: u64,
}

/// Converts rows to scans, in order. Corrected scans come two rows later, because the checks need two more rows.
#[derive(Clone, Debug)]
pub struct Scanner {
    correcting: Option<Correcting>,
    waiting: VecDeque<(Row, u64)>,
    temp_code: Option<i64>,
    lost: u64,
}

impl Scanner {
    pub fn new(layout: &Layout, axes: &[Axis], corrector: Option<Corrector<Vec<Correction>>>) -> Self {
        let correcting = corrector.map(|corrector| Correcting::new(layout, axes, corrector));
        Self { correcting, waiting: VecDeque::new(), temp_code: None, lost: 0 }
    }

    /// Takes over the last temperature of another scanner.
    pub fn with_temp_of(mut self, other: &Self) -> Self {
        self.temp_code = other.temp_code;
        if let (Some(own), Some(others)) = (&mut self.correcting, &other.correcting) {
            own.corrector.read(others.corrector.temp_c());
        }
        self
    }

    /// The correction of an axis at the last temperature, °/s; `None` without a correction or a temperature.
    pub fn correction_dps(&self, axis: usize) -> Option<f64> {
        self.correcting.as_ref()?.corrector.correct(axis, Some(0.0))
    }

    /// Adds a row. `missed` samples before it count as lost, in addition to its own `lost`. Each corrected rate is
    /// shifted by its value in `trims_dps`, °/s. Returns the next scan, if one is complete.
    pub fn push(&mut self, row: &Row, missed: u64, trims_dps: &[f64; MAX_AXES]) -> Option<Scan> {
        self.lost = self.lost.saturating_add(missed).saturating_add(row.lost.into());
        self.waiting.push_back((*row, self.lost));
        let mut corrected_dps = match &mut self.correcting {
            Some(correcting) => correcting.push(row)?,
            None => [None; MAX_AXES],
        };
        for (dps, trim_dps) in corrected_dps.iter_mut().zip(trims_dps) {
            *dps = dps.map(|dps| dps + trim_dps);
        }
        let (row, lost) = self.waiting.pop_front()?;
        self.temp_code = row.temp_code.or(self.temp_code);
        Some(Scan { row: row.with_temp_code(self.temp_code), corrected_dps, lost })
    }
}

/// The layout of a sample in a buffer that has some of the channels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packing {
    /// Each quantity of a sample, and its place in bytes.
    places: Vec<(Quantity, Range<usize>)>,
    /// Size of a sample in bytes.
    pub size: usize,
}

impl Packing {
    /// The layout with the channels of `mask`. `None` if the mask is 0 or has a bit without a channel.
    pub fn new(table: &Table, mask: u32) -> Option<Self> {
        let channels = &table.channels;
        if mask == 0 || u64::from(mask) >> channels.len() != 0 {
            return None;
        }
        let mut packing = Self { places: Vec::new(), size: 0 };
        for (_, channel) in channels.iter().enumerate().filter(|(bit, _)| mask >> bit & 1 == 1) {
            // a channel is at a multiple of its own size, and no padding follows the last channel
            let at = packing.size.next_multiple_of(channel.bytes);
            packing.size = at + channel.bytes;
            packing.places.push((channel.quantity, at..packing.size));
        }
        Some(packing)
    }

    pub fn pack(&self, layout: &Layout, scan: &Scan, out: &mut Vec<u8>) {
        let start = out.len();
        out.resize(start + self.size, 0);
        for (quantity, place) in &self.places {
            let bytes = value(layout, scan, *quantity).to_le_bytes();
            out[start..][place.clone()].copy_from_slice(&bytes[..place.len()]);
        }
    }
}

/// The value of a channel. A sample has as many of its low bytes as the channel has.
fn value(layout: &Layout, scan: &Scan, quantity: Quantity) -> u64 {
    match quantity {
        Quantity::Rate(axis) => scan.row.codes().get(axis).copied().unwrap_or_default() as u64,
        Quantity::Temp => scan.row.temp_code.unwrap_or(layout.temp().codes().0) as u64,
        Quantity::Corrected(axis) => corrected(scan.corrected_dps[axis]) as u64,
        Quantity::Lost => scan.lost,
        Quantity::Time => scan.row.t_ns,
    }
}

/// The corrected rate in units of [`CORRECTED_RAD_PER_S`]; the smallest integer means that there is no rate.
pub fn corrected(rate_dps: Option<f64>) -> i64 {
    rate_dps.map_or(i64::MIN, |dps| (dps.to_radians() / CORRECTED_RAD_PER_S).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130::Width;

    fn layout() -> Layout {
        Layout::adis16130(Width::Bits24)
    }

    /// The layout follows the rule of libiio's `iio_device_get_sample_size_mask`.
    #[test]
    fn samples_are_aligned_as_the_library_expects() {
        let table = Table::new(&layout(), true);
        let ids: Vec<_> = table.channels.iter().map(|channel| channel.id.as_str()).collect();
        assert_eq!(ids, ["anglvel_z", "temp0", "anglvel_z_corrected", "count0", "timestamp"]);
        let size = |mask| Packing::new(&table, mask).map(|packing| packing.size);
        assert_eq!([0b1, 0b11, 0b10001, 0b10010, 0b11111, 0b01000].map(size), [4, 8, 16, 16, 32, 8].map(Some));
        assert_eq!([0, 0b10_0000, u32::MAX].map(size), [None; 3]);
    }

    #[test]
    fn a_sample_holds_the_codes_as_they_came() {
        let table = Table::new(&layout(), false);
        let row = Row::new(0x0102_0304_0506_0708, 3, &[0x80_0001]).expect("one axis").with_lost(2);
        let mut scanner = Scanner::new(&layout(), &[Axis::ADIS16130], None);
        let scan = scanner.push(&row, 5, &[0.0; MAX_AXES]).expect("nothing to wait for");
        let mut bytes = Vec::new();
        Packing::new(&table, 0b1111).expect("channels").pack(&layout(), &scan, &mut bytes);
        let expected = [[1, 0, 0x80, 0, 0, 0, 0, 0], [7, 0, 0, 0, 0, 0, 0, 0], [8, 7, 6, 5, 4, 3, 2, 1]];
        assert_eq!(bytes, expected.concat(), "rate, a temperature that was never read, lost, time");
        let warm = row.with_temp_code(Some(9)).with_lost(0);
        scanner.push(&warm, 0, &[0.0; MAX_AXES]);
        let later = scanner.push(&row.with_lost(1), 0, &[0.0; MAX_AXES]).expect("a sample");
        assert_eq!((later.row.temp_code, later.lost), (Some(9), 8), "the last that was read");
    }

    #[test]
    fn a_corrected_rate_belongs_to_its_sample_and_needs_a_valid_reading() {
        let corrector = Corrector::new(zerorate::CorrectorConfig {
            corrections: vec![Correction::line(-0.25, 0.0, 25.0)],
            validity: None,
        });
        let mut scanner = Scanner::new(&layout(), &[Axis::ADIS16130], Some(corrector));
        let mut trims_dps = [0.0; MAX_AXES];
        trims_dps[0] = 0.5;
        let mut scans = Vec::new();
        for k in 0..40u32 {
            // 1 °/s is 23488 codes (F-40); with 300 Hz bandwidth, a single reading 2^22 codes off cannot be real
            let code = if k == 20 { 8_388_608 + (1 << 22) } else { 8_388_608 + 23_488 + i64::from(k % 3) };
            let row = Row::new(u64::from(k) * 175_667, k, &[code]).expect("one axis").with_temp_code(Some(8_388_608));
            scans.extend(scanner.push(&row, 0, &trims_dps));
        }
        assert_eq!(scans.len(), 38, "two wait to be judged");
        for (scan, k) in scans.iter().zip(0u32..) {
            let expected = (k != 20).then(|| 1.0 + f64::from(k % 3) / 23_488.0 - 0.25 + 0.5);
            assert_eq!(scan.row.edge_seq, k);
            match (scan.corrected_dps[0], expected) {
                (Some(found), Some(expected)) => assert!((found - expected).abs() < 1e-12, "{k}: {found}"),
                (found, expected) => assert_eq!(found, expected, "{k}"),
            }
        }
        assert_eq!(scanner.correction_dps(0), Some(-0.25));
        // 1 °/s is π/180 rad/s
        assert_eq!((corrected(Some(1.0)), corrected(None)), (17_453_293, i64::MIN));
    }
}
