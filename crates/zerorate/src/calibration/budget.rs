//! The uncertainty budget: how much each source adds to the uncertainties of PBC and BTC.

use super::{CalibratedAxis, CurveRecord};
use alloc::vec::Vec;
use serde::Serialize;

/// One source of uncertainty of a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Contribution {
    /// The coefficient, `PBC` or `BTC`.
    pub of: &'static str,
    /// Name of the source, as a report shows it, such as `noise of T3`.
    pub source: &'static str,
    /// Standard uncertainty from this source: °/s for PBC, °/s/°C for BTC.
    pub u: f64,
    /// Share of the variance of the coefficient, 0 … 1. All shares are 0 if this variance is 0.
    pub share: f64,
}

impl CalibratedAxis {
    /// Returns the budget of PBC and BTC. It is empty without stated uncertainties, or for a curve without sources.
    #[must_use]
    pub fn budget(&self) -> Vec<Contribution> {
        if let Some(curve) = &self.curve {
            return curve.budget();
        }
        let Some(stated) = self.uncertainty else { return Vec::new() };
        let drift_dps = stated.drift_dps.unwrap_or(0.0);
        let t3_dps = self.correction.btc_dps_per_c * stated.u_t3_c;
        let pbc = [("drift of the temperature in step 8", drift_dps), ("noise of T3", t3_dps)];
        let btc = [("curvature and hysteresis", stated.u_curvature_dps_per_c)];
        let pbc = of("PBC", stated.u_pbc_dps, &pbc, "noise of the mean in step 8, and what the drift checks found");
        let btc =
            of("BTC", stated.u_btc_dps_per_c, &btc, "noise of B1, B2, T1 and T2, and what the drift checks found");
        pbc.chain(btc).collect()
    }
}

impl CurveRecord {
    fn budget(&self) -> Vec<Contribution> {
        let Some(sources) = self.sources else { return Vec::new() };
        let pbc = [(MODELS, sources.u_models_pbc_dps), (BASE_MOTION, sources.u_sway_pbc_dps)];
        let btc = [(MODELS, sources.u_models_btc_dps_per_c), (BASE_MOTION, sources.u_sway_btc_dps_per_c)];
        let u = |term: usize| libm::sqrt(self.covariance[term][term].max(0.0));
        of("PBC", u(0), &pbc, NOISE).chain(of("BTC", u(1), &btc, NOISE)).collect()
    }
}

const NOISE: &str = "noise of the recording";
const MODELS: &str = "order, lag, play and steps that the recording leaves open";
const BASE_MOTION: &str = "slow base motion, by its probability";

/// Returns the contributions to the standard uncertainty `u` of the coefficient `name`: first `rest`, with the
/// variance that the known sources leave, then each known source with its standard uncertainty.
fn of(
    name: &'static str,
    u: f64,
    known: &[(&'static str, f64)],
    rest: &'static str,
) -> impl Iterator<Item = Contribution> {
    let left = (u * u - known.iter().map(|(_, part)| part * part).sum::<f64>()).max(0.0);
    let share = move |part: f64| if u > 0.0 { part * part / (u * u) } else { 0.0 };
    let contribution = move |source, part: f64| Contribution { of: name, source, u: part.abs(), share: share(part) };
    let known: Vec<_> = known.iter().map(|(source, part)| contribution(source, *part)).collect();
    core::iter::once(contribution(rest, libm::sqrt(left))).chain(known)
}
