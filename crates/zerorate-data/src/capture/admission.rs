//! What of a device's samples may become a capture: nothing that a reader of the file would refuse
//! (docs/formats/capture.md, "What must agree").

use super::succession::{Break, Mark, Succession};
use adis16130::Sample;

/// Samples in a row whose time does not increase, before the device is given up: 0.7 s at the full rate.
const STANDING: u32 = 4096;

/// Judges the samples of a live device, and counts as lost what cannot be recorded.
#[derive(Clone, Debug, Default)]
pub struct Admission {
    succession: Succession,
    /// Samples left out since the last that was admitted, with what they lost.
    owed: u32,
    standing: u32,
    left_out: u64,
    jumped: u64,
}

/// The device cannot be believed any more.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Disbelief {
    /// Its clock.
    #[error(
        "the clock of the device stands still or went back: {0} samples in a row are not later than the one before \
         ({1}); check its time source, and start again"
    )]
    Clock(u32, Break),
    /// Its count of losses.
    #[error("the device cannot be believed: {0}; reset it, and start again")]
    Losses(Break),
}

impl Admission {
    /// The sample as it may be recorded; none if it must be left out, and then the next one counts it as lost.
    pub fn admit(&mut self, sample: Sample) -> Result<Option<Sample>, Disbelief> {
        let lost = sample.lost.saturating_add(self.owed);
        let mark = Mark { t_ns: sample.t_ns, edge_seq: sample.seq, lost };
        let lost = match self.succession.follow(mark) {
            Ok(()) | Err(Break::EdgesJump { .. }) => lost,
            Err(what @ Break::NotLater { .. }) => return self.leave_out(lost, what).map(|()| None),
            Err(Break::RowsMissing { missing, .. } | Break::ClockJump { missing, .. }) => {
                self.jumped += missing;
                self.succession.amend(missing)
            }
            Err(what @ Break::LostTooMany { .. }) => return Err(Disbelief::Losses(what)),
        };
        (self.owed, self.standing) = (0, 0);
        Ok(Some(Sample { lost, ..sample }))
    }

    fn leave_out(&mut self, lost: u32, what: Break) -> Result<(), Disbelief> {
        self.owed = lost.saturating_add(1);
        self.left_out += 1;
        self.standing += 1;
        if self.standing >= STANDING { Err(Disbelief::Clock(self.standing, what)) } else { Ok(()) }
    }

    /// What is to be said of samples that were not recorded as they came.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let left_out = (self.left_out > 0).then(|| {
            format!(
                "clock-stands: {} samples were not later than the one before; they are left out, and counted as lost",
                self.left_out
            )
        });
        let jumped = (self.jumped > 0).then(|| {
            format!(
                "clock-jump: the time of the device went on by {} samples that it did not count; they are counted as \
                 lost",
                self.jumped
            )
        });
        left_out.into_iter().chain(jumped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130::{RateCode, Width};

    fn sample(i: u32) -> Sample {
        let rate = RateCode::new(8_388_608, Width::Bits24);
        Sample { t_ns: 1_000 + u64::from(i) * 175_667, seq: i, rate, status: None, temp: None, lost: 0 }
    }

    /// After so many even samples.
    fn after(n: u32) -> Admission {
        let mut admission = Admission::default();
        assert!((0..n).all(|i| admission.admit(sample(i)) == Ok(Some(sample(i)))));
        admission
    }

    #[test]
    fn a_repeated_time_is_left_out_and_counted() {
        let mut admission = after(100);
        assert_eq!(admission.admit(Sample { t_ns: sample(99).t_ns, lost: 2, ..sample(100) }), Ok(None));
        assert_eq!(admission.admit(Sample { t_ns: 5, ..sample(101) }), Ok(None));
        let next = Sample { t_ns: sample(104).t_ns, ..sample(102) };
        assert_eq!(admission.admit(next), Ok(Some(Sample { lost: 4, ..next })));
        assert!(admission.warnings().next().unwrap().contains("clock-stands: 2 samples"));
    }

    #[test]
    fn a_clock_that_stands_ends_in_bounded_time() {
        let mut admission = after(100);
        let still = |seq| Sample { seq, ..sample(99) };
        let refused = (0..STANDING + 10).position(|i| admission.admit(still(i)).is_err());
        assert_eq!(refused, Some(STANDING as usize - 1));
    }

    #[test]
    fn a_jump_of_the_clock_counts_as_lost() {
        let mut admission = after(100);
        let jumped = Sample { t_ns: sample(99).t_ns + 3_600_000_000_000, ..sample(100) };
        let lost = admission.admit(jumped).unwrap().unwrap().lost;
        assert!((20_493_000..20_493_600).contains(&lost), "{lost}");
        assert!(admission.warnings().next().unwrap().contains("clock-jump"));
    }

    #[test]
    fn losses_saturate() {
        let mut admission = after(100);
        for seq in 0..2 {
            assert_eq!(admission.admit(Sample { t_ns: 0, seq, lost: u32::MAX - 1, ..sample(0) }), Ok(None));
        }
        assert_eq!(admission.admit(sample(200)).unwrap().unwrap().lost, u32::MAX);
    }

    #[test]
    fn invented_losses_end_it() {
        let refused = after(100).admit(Sample { lost: 1_000_000, ..sample(100) });
        assert!(matches!(refused, Err(Disbelief::Losses(_))));
    }
}
