//! Filters the samples of a device, so that a recorded capture satisfies the checks of its readers
//! (docs/formats/capture.md, "What must agree").

use super::row::Row;
use super::succession::{Break, Continuity};
use super::warning::CaptureWarning;

/// The number of consecutive samples without increasing time after which the recording stops: 0.7 s at the full rate.
const STANDING: u32 = 4096;

/// Filters the samples of a live device. Samples that cannot be recorded count as lost.
#[derive(Clone, Debug, Default)]
pub struct Admission {
    succession: Continuity,
    /// Number of samples left out since the last admitted one, including the losses that those samples reported.
    owed: u32,
    standing: u32,
    left_out: u64,
    jumped: u64,
}

/// The reasons why the device's data cannot be recorded.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InvalidDeviceData {
    /// The clock stands still or went back.
    #[error(
        "the clock of the device stands still or went back: {0} samples in a row are not later than the one before \
         ({1}); check its time source, and start again"
    )]
    Clock(u32, Break),
    /// The device's count of losses is impossible.
    #[error("the device cannot be believed: {0}; reset it, and start again")]
    Losses(Break),
}

impl Admission {
    /// Returns the row to record, with corrected losses. `None` leaves the row out; the next row counts it as lost.
    pub fn admit(&mut self, row: Row) -> Result<Option<Row>, InvalidDeviceData> {
        let lost = row.lost.saturating_add(self.owed);
        let lost = match self.succession.follow(row.with_lost(lost).mark()) {
            Ok(()) | Err(Break::EdgesJump { .. }) => lost,
            Err(what @ Break::NotLater { .. }) => return self.leave_out(lost, what).map(|()| None),
            Err(Break::RowsMissing { missing, .. } | Break::ClockJump { missing, .. }) => {
                self.jumped += missing;
                self.succession.amend(missing)
            }
            Err(what @ Break::LostTooMany { .. }) => return Err(InvalidDeviceData::Losses(what)),
        };
        (self.owed, self.standing) = (0, 0);
        Ok(Some(row.with_lost(lost)))
    }

    fn leave_out(&mut self, lost: u32, what: Break) -> Result<(), InvalidDeviceData> {
        self.owed = lost.saturating_add(1);
        self.left_out += 1;
        self.standing += 1;
        if self.standing >= STANDING { Err(InvalidDeviceData::Clock(self.standing, what)) } else { Ok(()) }
    }

    /// The warnings about samples that were left out or changed.
    pub fn warnings(&self) -> impl Iterator<Item = CaptureWarning> {
        let left_out = (self.left_out > 0).then_some(CaptureWarning::ClockStands(self.left_out));
        let jumped = (self.jumped > 0).then_some(CaptureWarning::ClockJump(self.jumped));
        left_out.into_iter().chain(jumped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(i: u32) -> Row {
        Row::new(1_000 + u64::from(i) * 175_667, i, &[8_388_608]).unwrap()
    }

    /// The state after `n` evenly spaced samples.
    fn after(n: u32) -> Admission {
        let mut admission = Admission::default();
        assert!((0..n).all(|i| admission.admit(row(i)) == Ok(Some(row(i)))));
        admission
    }

    #[test]
    fn a_repeated_time_is_left_out_and_counted() {
        let mut admission = after(100);
        assert_eq!(admission.admit(Row { t_ns: row(99).t_ns, lost: 2, ..row(100) }), Ok(None));
        assert_eq!(admission.admit(Row { t_ns: 5, ..row(101) }), Ok(None));
        let next = Row { t_ns: row(104).t_ns, ..row(102) };
        assert_eq!(admission.admit(next), Ok(Some(Row { lost: 4, ..next })));
        assert!(admission.warnings().next().unwrap().coded().contains("clock-stands: 2 samples"));
    }

    #[test]
    fn a_clock_that_stands_still_stops_the_recording() {
        let mut admission = after(100);
        let still = |edge_seq| Row { edge_seq, ..row(99) };
        let refused = (0..STANDING + 10).position(|i| admission.admit(still(i)).is_err());
        assert_eq!(refused, Some(STANDING as usize - 1));
    }

    #[test]
    fn a_jump_of_the_clock_counts_as_lost() {
        let mut admission = after(100);
        let jumped = Row { t_ns: row(99).t_ns + 3_600_000_000_000, ..row(100) };
        let lost = admission.admit(jumped).unwrap().unwrap().lost;
        assert!((20_493_000..20_493_600).contains(&lost), "{lost}");
        assert!(admission.warnings().next().unwrap().code().contains("clock-jump"));
    }

    #[test]
    fn losses_saturate() {
        let mut admission = after(100);
        for edge_seq in 0..2 {
            assert_eq!(admission.admit(Row { t_ns: 0, edge_seq, lost: u32::MAX - 1, ..row(0) }), Ok(None));
        }
        assert_eq!(admission.admit(row(200)).unwrap().unwrap().lost, u32::MAX);
    }

    #[test]
    fn impossible_losses_stop_the_recording() {
        let refused = after(100).admit(Row { lost: 1_000_000, ..row(100) });
        assert!(matches!(refused, Err(InvalidDeviceData::Losses(_))));
    }
}
