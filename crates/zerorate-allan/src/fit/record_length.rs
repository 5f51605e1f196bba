//! The record length at which a coefficient is identified.

use super::bins::all_edges;
use super::density::Table;
use super::scoring::{ModelForm, Optimum, Problem};
use super::select::DESCENT;

/// Number of doublings of the record for which the gain in deviance is computed. Beyond them, the gain is assumed to
/// be proportional to the length.
const DOUBLINGS: i32 = 8;
/// (1.96 + 0.84)²: the expected gain in deviance at which zero is outside the 95 % interval in four of five records.
const ENOUGH: f64 = 7.849;
/// Least factor on the length of this record, which does not show the coefficient although it usually would.
const LONGER: f64 = 1.5;

/// The record length at which zero would be outside the 95 % interval in four of five cases, s.
///
/// The result is longer than this record, which does not show the parameter. `value` is the assumed size of the
/// parameter at `place`. The length is interpolated between two doublings, linear in logarithms.
pub(super) fn needed_s(
    best: &Optimum,
    samples: usize,
    (rate_hz, top_hz): (f64, f64),
    place: usize,
    value: f64,
) -> f64 {
    let length_s = samples as f64 / rate_hz;
    let mut at = best.at.clone();
    at[place] = value;
    let form = ModelForm { drift: None, ..best.form };
    let gain = |doublings: i32| {
        let longer = samples.saturating_mul(1 << doublings);
        evidence(form, &at, Table::new(all_edges(longer).into_iter(), &[], longer, rate_hz).below(top_hz), place)
    };
    let mut before = gain(0);
    for doublings in 1..=DOUBLINGS {
        let now = gain(doublings).max(before);
        if now >= ENOUGH {
            let low = before.clamp(1e-9, ENOUGH);
            let part = if now > low { libm::log(ENOUGH / low) / libm::log(now / low) } else { 1.0 };
            return length_s * libm::exp2(f64::from(doublings - 1) + part).max(LONGER);
        }
        before = now;
    }
    length_s * libm::exp2(f64::from(DOUBLINGS)) * ENOUGH / before.max(1e-3)
}

/// The increase of the deviance if the coefficient at `place` is left out and every power has its expected value.
fn evidence(form: ModelForm, at: &[f64], table: Table, place: usize) -> f64 {
    let mut problem = Problem::new(table, 0.0);
    let expected = problem.density(&form, at);
    problem.set_powers(&expected);
    let mut without = at.to_vec();
    without[place] = 0.0;
    problem.descend(form, &without, Some(place), DESCENT).deviance
}
