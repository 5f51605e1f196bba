//! Checks that `t_ns`, `edge_seq` and `lost` of successive rows agree (docs/formats/capture.md, "What must agree").
//!
//! Each of the three columns gives a number of samples between two rows. If the numbers contradict each other, a rate
//! or a gap computed from one of them would be wrong.

use std::fmt;

/// Number of intervals at the start from which the sample rate is learned.
const LEARNED: usize = 64;

/// Number of intervals that are needed before a new row is checked.
const NEEDED: usize = 16;

/// Largest allowed difference between the elapsed time and the count of `lost`, in samples, if the edges do not
/// confirm the time. It is 11 ms at the full rate. Late edges on a busy host, or a loss that is reported a few
/// samples late, cause far smaller differences.
const UNSURE: f64 = 64.0;

/// The same limit as [`UNSURE`], in samples, if the edges confirm the time.
const SURE: f64 = 8.0;

/// Additional allowed difference between the elapsed time and the count of `lost`, as a fraction of 1 + `lost`.
/// Errors of the clock and of the learned period are smaller.
const OF_GAP: f64 = 0.125;

/// Number of extra edges per sample above which `edge_seq` cannot be a count of edges. A bouncing line causes few.
const EDGES_PER_SAMPLE: f64 = 64.0;

/// The time, edge number and losses of a row.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    /// The column `t_ns`.
    pub t_ns: u64,
    /// The column `edge_seq`.
    pub edge_seq: u32,
    /// The column `lost`, saturating at `u32::MAX`.
    pub lost: u32,
}

/// A contradiction between two successive rows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are the words of the message")]
pub enum Break {
    /// The time does not increase.
    NotLater { from_ns: u64, to_ns: u64 },
    /// `t_ns` and `edge_seq` advanced by more samples than `lost` counts: rows were removed.
    RowsMissing { missing: u64, after_ns: u64 },
    /// `t_ns` advanced by more samples than `edge_seq` and `lost` count.
    ClockJump { missing: u64, after_ns: u64 },
    /// `lost` counts more samples than the time allows.
    LostTooMany { lost: u32, after_ns: u64 },
    /// `edge_seq` counts more edges than the time allows, or goes back.
    EdgesJump { edges: u32, after_ns: u64 },
}

impl fmt::Display for Break {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |ns: u64| ns as f64 * 1e-6;
        match *self {
            Self::NotLater { from_ns, to_ns } => write!(f, "t_ns does not increase, from {from_ns} to {to_ns}"),
            Self::RowsMissing { missing, after_ns } => write!(
                f,
                "about {missing} rows are missing: t_ns and edge_seq go on by {:.1} ms, and lost does not count them",
                ms(after_ns)
            ),
            Self::ClockJump { missing, after_ns } => {
                write!(f, "t_ns jumps by {:.1} ms, {missing} samples more than edge_seq and lost count", ms(after_ns))
            }
            Self::LostTooMany { lost, after_ns } => {
                write!(f, "lost counts {lost} samples within {:.1} ms, more than there can be", ms(after_ns))
            }
            Self::EdgesJump { edges, after_ns } => {
                write!(f, "edge_seq goes on by {edges} within {:.1} ms, more than there can be", ms(after_ns))
            }
        }
    }
}

/// The differences from one row to the next.
#[derive(Clone, Copy, Debug)]
struct Step {
    nanos: u64,
    edges: u32,
    lost: u32,
}

impl Step {
    fn samples(&self) -> f64 {
        1.0 + f64::from(self.lost)
    }
}

/// Checks successive rows. The result depends on earlier rows only, so a recorder and a reader of its file agree.
#[derive(Clone, Debug, Default)]
pub struct Continuity {
    last: Option<Mark>,
    first_steps: Vec<Step>,
    learned: Option<Pace>,
}

/// The period of a sample, ns, and its number of edges. Both are medians over the first intervals.
#[derive(Clone, Copy, Debug)]
struct Pace {
    period_ns: f64,
    edges: f64,
}

impl Continuity {
    /// Checks the next row against the previous one. The row replaces the previous one if its time increases.
    pub fn follow(&mut self, mark: Mark) -> Result<(), Break> {
        let Some(last) = self.last else {
            self.last = Some(mark);
            return Ok(());
        };
        if mark.t_ns <= last.t_ns {
            return Err(Break::NotLater { from_ns: last.t_ns, to_ns: mark.t_ns });
        }
        let step =
            Step { nanos: mark.t_ns - last.t_ns, edges: mark.edge_seq.wrapping_sub(last.edge_seq), lost: mark.lost };
        self.last = Some(mark);
        let judged = self.learned.map_or(Ok(()), |pace| pace.judge(step));
        if self.first_steps.len() < LEARNED {
            self.first_steps.push(step);
            self.learned = (self.first_steps.len() >= NEEDED).then(|| Pace::of(&self.first_steps));
        }
        judged
    }

    /// Adds `missing` to the losses of the last row, and returns the sum.
    pub fn amend(&mut self, missing: u64) -> u32 {
        let lost = self.last.map_or(0, |last| last.lost);
        let amended = lost.saturating_add(u32::try_from(missing).unwrap_or(u32::MAX));
        if let Some(last) = &mut self.last {
            last.lost = amended;
        }
        amended
    }

    /// Checks the first rows again, with the sample rate that was learned from them.
    pub fn review(&self) -> Result<(), Break> {
        let pace = self.learned;
        pace.map_or(Ok(()), |pace| self.first_steps.iter().try_for_each(|step| pace.judge(*step)))
    }

    /// True while the rate is being learned. The result of [`Continuity::review`] may then change with the next row.
    pub fn is_learning(&self) -> bool {
        self.first_steps.len() < LEARNED
    }
}

impl Pace {
    fn of(steps: &[Step]) -> Self {
        let median = |of: fn(&Step) -> f64| {
            let mut values: Vec<f64> = steps.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        Self {
            period_ns: median(|step| step.nanos as f64 / step.samples()),
            edges: median(|step| f64::from(step.edges) / step.samples()),
        }
    }

    fn judge(&self, step: Step) -> Result<(), Break> {
        if step.lost == u32::MAX {
            return Ok(());
        }
        let after_ns = step.nanos;
        let elapsed = step.nanos as f64 / self.period_ns;
        let unexplained = elapsed - step.samples();
        let allowed = |samples: f64| samples + OF_GAP * step.samples();
        let missing = unexplained as u64;
        let by_edges = f64::from(step.edges) / self.edges - step.samples();
        let edges_agree = self.edges > 0.0 && (0.75..1.33).contains(&(by_edges / unexplained));
        if edges_agree && unexplained > allowed(SURE) {
            return Err(Break::RowsMissing { missing, after_ns });
        }
        if unexplained > allowed(UNSURE) {
            return Err(Break::ClockJump { missing, after_ns });
        }
        if -unexplained > allowed(UNSURE) {
            return Err(Break::LostTooMany { lost: step.lost, after_ns });
        }
        if f64::from(step.edges) > (EDGES_PER_SAMPLE + self.edges) * (elapsed + step.samples()) {
            return Err(Break::EdgesJump { edges: step.edges, after_ns });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_NS: u64 = 175_667;

    /// `n` rows at the full rate.
    fn rows(n: u32) -> Vec<Mark> {
        (0..n).map(|i| Mark { t_ns: 1_000 + u64::from(i) * PERIOD_NS, edge_seq: i, lost: 0 }).collect()
    }

    fn first_break(rows: &[Mark]) -> Option<(usize, Break)> {
        let mut succession = Continuity::default();
        rows.iter().enumerate().find_map(|(i, row)| Some((i, succession.follow(*row).err()?)))
    }

    #[test]
    fn rows_taken_out_are_found() {
        for taken in [10, 100, 5_693, 80_000] {
            let mut rows = rows(100_000);
            rows.drain(200..200 + taken);
            let (at, found) = first_break(&rows).unwrap();
            assert_eq!(at, 200);
            assert!(matches!(found, Break::RowsMissing { missing, .. } if missing == taken as u64), "{found}");
        }
    }

    #[test]
    fn a_jump_of_the_clock_is_found() {
        for jump_ns in [20_000_000, 3_600_000_000_000] {
            let mut rows = rows(1000);
            rows[300..].iter_mut().for_each(|row| row.t_ns += jump_ns);
            assert!(matches!(first_break(&rows), Some((300, Break::ClockJump { .. }))));
        }
    }

    #[test]
    fn counted_losses_agree_and_invented_ones_do_not() {
        let mut gap = rows(10_000);
        gap.drain(300..9_000);
        gap[300].lost = 8_700;
        assert_eq!(first_break(&gap), None);
        let mut invented = rows(1000);
        invented[300].lost = 4_000_000;
        assert!(matches!(first_break(&invented), Some((300, Break::LostTooMany { .. }))));
        invented[300].lost = u32::MAX;
        assert_eq!(first_break(&invented), None, "that many or more");
    }

    #[test]
    fn edges_out_of_place_are_found() {
        let mut rows = rows(1000);
        rows[300..].iter_mut().for_each(|row| row.edge_seq += 1 << 20);
        assert!(matches!(first_break(&rows), Some((300, Break::EdgesJump { .. }))));
    }

    /// Extra edges of a bouncing line, a wrap of the count, and late edges are not contradictions.
    #[test]
    fn late_rows_are_not_a_contradiction() {
        let mut rows = rows(1000);
        for (i, row) in rows.iter_mut().enumerate() {
            let late_ns = if i % 97 == 0 { 5_000_000 } else { 0 };
            row.t_ns += late_ns.min(PERIOD_NS - 1);
            row.edge_seq = (u32::MAX - 500).wrapping_add(i as u32 * 3);
        }
        assert_eq!(first_break(&rows), None);
    }

    #[test]
    fn a_jump_among_the_first_rows_shows_later() {
        let mut rows = rows(100);
        rows[5..].iter_mut().for_each(|row| row.t_ns += 1_000_000_000);
        let mut succession = Continuity::default();
        assert!(rows.iter().all(|row| succession.follow(*row).is_ok()));
        assert!(matches!(succession.review(), Err(Break::ClockJump { .. })));
    }

    #[test]
    fn an_amended_row_agrees() {
        let mut succession = Continuity::default();
        let rows = rows(500);
        assert!(rows[..200].iter().all(|row| succession.follow(*row).is_ok()));
        let Err(Break::RowsMissing { missing, .. }) = succession.follow(rows[400]) else { panic!("not noticed") };
        assert_eq!(succession.amend(missing), 200);
        assert_eq!(succession.amend(u64::MAX), u32::MAX, "it cannot wrap");
    }
}
