//! The estimate of the bias, prepared so that a query costs little.

use super::filter::{Drift, Filter, place, sd};

/// Number of states in the estimate: offset, slope and curvature.
const SHOWN: usize = 3;
/// If all quiet periods are rotations, half of a change of this size is accepted as bias. It is in units of the
/// slowest rotation to be detected.
const DOUBTED: f32 = 1.75;

/// The bias that the calibration leaves, merged over all hypotheses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    state: [f32; SHOWN],
    /// Rows of the covariance. Below the diagonal they are doubled, above it they are zero.
    covariance: [[f32; SHOWN]; SHOWN],
    at_c: f32,
    doubted_dps2: f32,
}

impl Estimate {
    /// Prepares the estimate. `excess` is the excess of rotations among the quiet periods.
    pub(super) fn new(known: &Filter, excess: f32, least_turn_dps: f32) -> Self {
        let [offset, slope, curvature, ..] = known.state;
        let of = |row, column| known.covariance[place(row, column)];
        let doubted_dps = DOUBTED * least_turn_dps * excess;
        Self {
            state: [offset, slope, curvature],
            covariance: [
                [of(0, 0), 0.0, 0.0],
                [2.0 * of(1, 0), of(1, 1), 0.0],
                [2.0 * of(2, 0), 2.0 * of(2, 1), of(2, 2)],
            ],
            at_c: known.at_c,
            doubted_dps2: doubted_dps * doubted_dps,
        }
    }

    /// Returns the bias that the calibration leaves at `d_c` = T − T3 and its standard uncertainty, °/s. `seconds` is
    /// the time over which the random walk adds to the uncertainty. An estimated change m counts by its share
    /// m²/(m² + τ²), where τ² is `doubted_dps2`. The rest of m is added to the uncertainty in quadrature.
    pub(super) fn at(&self, d_c: f32, seconds: f32, drift: &Drift) -> (f32, f32) {
        let polynomial = |[a, b, c]: &[f32; SHOWN]| a + d_c * (b + d_c * c);
        let change_dps = polynomial(&self.state);
        let known_dps2 = polynomial(&[
            polynomial(&self.covariance[0]),
            polynomial(&self.covariance[1]),
            polynomial(&self.covariance[2]),
        ]);
        let dps2 = known_dps2.max(0.0) + drift.of_walk(seconds) + drift.of_play(d_c - self.at_c);
        let change_dps2 = change_dps * change_dps;
        let doubted =
            if self.doubted_dps2 > 0.0 { self.doubted_dps2 / (change_dps2 + self.doubted_dps2) } else { 0.0 };
        let left_dps = doubted * change_dps;
        (change_dps - left_dps, sd(dps2 + left_dps * left_dps))
    }
}
