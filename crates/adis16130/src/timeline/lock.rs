//! Lock detection: whether the edges lie on the grid. Before the loop begins, the gaps between edges give the
//! offset of the clock.

use super::EdgeGrid;
use crate::quotient::quotient;

/// Sums over regular gaps between neighbouring edges: their number, nominal length, and excess over that length.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    pub(super) count: u32,
    nominal: i64,
    excess: i64,
    /// Whether the previous gap was not regular.
    far: bool,
}

/// The relative offset of the clock is computed in steps of 2⁻²⁰, about 10⁻⁶. The mean of 128 gaps with σ = 15 µs has
/// a noise that is a thousand times larger.
const OFFSET_BITS: u32 = 20;

impl Gaps {
    /// Adds a gap if it is near a regular gap between neighbouring edges, unless the previous gap was not. After a
    /// longer gap the first timestamp may be late.
    pub(super) fn push(&mut self, grid: &EdgeGrid, learned: (i64, i64), gap: i64) {
        let (nearest, nominal) = grid.nearest_gap(learned, gap);
        let far = (gap - nearest).abs() > grid.nearness(learned);
        if !core::mem::replace(&mut self.far, far) && !far {
            self.count += 1;
            self.nominal += nominal;
            self.excess += gap - nominal;
        }
    }

    /// The period that the gaps give, less the nominal period.
    pub(super) fn offset(&self, grid: &EdgeGrid) -> i64 {
        let share = quotient(self.excess.unsigned_abs(), (self.nominal >> OFFSET_BITS) as u64) as i64;
        let offset = (grid.period >> OFFSET_BITS) * share;
        if self.excess < 0 { -offset } else { offset }
    }
}

/// Whether the edges lie on the grid, by the last checks.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Grip {
    /// The edges lie on the grid.
    Firm,
    /// The edges did not lie on the grid, which is learned anew.
    Loose,
    /// The edges do not lie on any grid. The period stays nominal, and the phase is followed slowly. Each check counts
    /// down, and the check that finds 0 ends this state.
    Held(u8),
}

/// The first count of [`Grip::Held`]. The grid is learned anew after about 4300 edges (0.8 s with F-31). Learning up
/// to the last gear takes about as long.
const HELD_CHECKS: u8 = 16;

impl Grip {
    /// Returns the state after a check, which found whether the lock is `lost`.
    pub(super) const fn after(self, lost: bool) -> Self {
        match (self, lost) {
            (Self::Held(0), _) | (Self::Firm, true) => Self::Loose,
            (Self::Held(checks), _) => Self::Held(checks - 1),
            (Self::Loose, true) => Self::Held(HELD_CHECKS),
            (Self::Firm | Self::Loose, false) => Self::Firm,
        }
    }
}

/// Checks after every 256 edges (45 ms with F-31) whether the edges still lie on the grid. 256 is twice the number of
/// gaps that are averaged before the loop begins. So the second check at the latest finds a wrong grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Lock {
    edges: u8,
    error: i64,
}

impl Lock {
    /// Takes the error of an edge. After every 256th edge, returns whether the lock is lost.
    pub(super) fn judge(&mut self, grid: &EdgeGrid, error: i64) -> Option<bool> {
        self.error += error.abs();
        self.edges = self.edges.wrapping_add(1);
        (self.edges == 0).then(|| grid.is_missed(core::mem::take(&mut self.error)))
    }
}
