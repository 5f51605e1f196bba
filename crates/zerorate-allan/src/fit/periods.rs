//! Detects a period in the slow noise, from heating, air conditioning or equipment that is switched. A period shows
//! in a few coefficients of the spectrum, which look like a random walk.

use super::scoring::{K2, N2, Optimum, Problem};
use super::select::{DESCENT, Selection};
use crate::linear::Square;
use alloc::vec::Vec;
use core::f64::consts::PI;
use core::ops::Range;

/// A periodic disturbance of any waveform.
#[derive(Clone, Copy, Debug)]
pub(super) struct Period {
    pub(super) period_s: f64,
    /// K of the noise without the period, unit/√s.
    pub(super) k: f64,
    /// The decrease of −2 ln L beyond the price of the sines.
    gain: f64,
}

/// Harmonics with more half periods over the record than this are not fitted.
const FASTEST: f64 = 64.0;
/// The frequencies to try, in half periods over the record, and the steps per half period.
const TRIED: Range<u32> = 4..48;
const STEPS: u32 = 4;
const HARMONICS: usize = 4;
/// The price of a sine with its phase, in −2 ln L, and the least gain of more sines.
const PRICE: f64 = 8.0;
const LEAST_MORE: f64 = 1.0;
/// Least gain of a period in −2 ln L, beyond the price of its sines. Of 740 simulated records without a period, 5 gain
/// more. Of 40 records with a ten-minute sawtooth, 32 do.
const LEAST_GAIN: f64 = 10.0;
/// Largest share of white noise in the density at the period. Above it, white noise explains the power at the period.
const MOST_WHITE: f64 = 0.5;
/// A second search for the noise without a period starts at this share of K², where −2 ln L has another minimum.
const LESS: f64 = 0.03;
/// Number of searches over all frequencies, each with the noise model that the last one leaves.
const LOOKS: usize = 3;

/// The period that explains the slow noise better than a random walk.
pub(super) fn period(chosen: &Selection) -> Option<Period> {
    let found = (1..=HARMONICS).filter_map(|harmonics| with(chosen, harmonics));
    // half the frequency with twice the sines explains as much, so more sines must gain more than `LEAST_MORE`
    let best = found.reduce(|best, next| if next.gain > best.gain + LEAST_MORE { next } else { best });
    best.filter(|period| period.gain > LEAST_GAIN)
}

fn with(Selection { problem, found, .. }: &Selection, harmonics: usize) -> Option<Period> {
    let table = &problem.table;
    let mut now = None;
    for _ in 0..LOOKS {
        let under: &Optimum = now.as_ref().map_or(found, |(_, rest, _)| rest);
        let tried = (TRIED.start * STEPS..TRIED.end * STEPS).map(|step| f64::from(step) / f64::from(STEPS));
        let left = tried.filter_map(|turns| Some((turns, left(problem, under, turns, harmonics)?)));
        let weighed = |left: &[f64]| left.iter().zip(&under.density).map(|(left, s)| left * left / s).sum::<f64>();
        let (turns, left) = left.min_by(|a, b| weighed(&a.1).total_cmp(&weighed(&b.1)))?;
        let mut powers: Vec<f64> = table.rows.iter().map(|row| row.bin.power).collect();
        powers.iter_mut().zip(&left).for_each(|(power, left)| *power = (left * left).max(f64::MIN_POSITIVE));
        let mut without = problem.clone();
        without.set_powers(&powers);
        let mut less = found.at.clone();
        less[K2] *= LESS;
        let descents = [&found.at, &less].map(|at| without.descend(found.form, at, None, DESCENT));
        let rest = descents.into_iter().min_by(|a, b| a.deviance.total_cmp(&b.deviance))?;
        let rows = table.rows.iter().zip(&powers).zip(&problem.nu);
        let own: f64 = rows.map(|((row, power), nu)| nu * libm::log(power / row.bin.power)).sum();
        let gain = found.deviance - rest.deviance - own - PRICE * harmonics as f64;
        now = Some((turns, rest, gain));
    }
    let (turns, rest, gain) = now?;
    let row = table.rows.partition_point(|row| (row.bin.first as f64) < turns).min(table.rows.len() - 1);
    if found.at[N2] * table.rows[row].bin.response.gain > MOST_WHITE * found.density[row] {
        return None;
    }
    Some(Period { period_s: 2.0 * table.span_s / turns, k: libm::sqrt(rest.at[K2]), gain })
}

/// Fits sines to the lowest coefficients, weighed by 1/density in `under`, and returns the residuals. The first sine
/// has `turns` half periods over the record, and the others are its harmonics. `None` if the fit is singular.
fn left(problem: &Problem, under: &Optimum, turns: f64, harmonics: usize) -> Option<Vec<f64>> {
    let table = &problem.table;
    let rows = 0..table.singles();
    let places: Vec<f64> = rows.clone().map(|row| table.rows[row].bin.first as f64).collect();
    let low = |row: usize| table.low[table.rows[row].bin.first - 1];
    let turns = (1..=harmonics).map(|j| turns * j as f64).filter(|turns| *turns < FASTEST);
    let templates: Vec<Vec<f64>> = turns.flat_map(|turns| waves(turns, &places)).collect();
    let over = |row: usize| 1.0 / under.density[row];
    let product =
        |x: &[f64], y: &dyn Fn(usize) -> f64| rows.clone().map(|row| x[row] * y(row) * over(row)).sum::<f64>();
    let squares = Square::from_fn(templates.len(), |i, j| product(&templates[i], &|row| templates[j][row]));
    let sizes = squares.cholesky()?.solve(templates.iter().map(|template| product(template, &low)));
    let sum = |row: usize| sizes.iter().zip(&templates).map(|(size, template)| size * template[row]).sum::<f64>();
    Some(rows.clone().map(|row| low(row) - sum(row)).collect())
}

/// 2·∫cos(πax)·cos(πkx)dx from 0 to 1 and the same integral with sin(πax), for a = `turns` and each k.
fn waves(turns: f64, places: &[f64]) -> [Vec<f64>; 2] {
    let (sin, cos) = (libm::sin(PI * turns), libm::cos(PI * turns));
    let at = |k: f64| {
        let sign = if k % 2.0 == 0.0 { 1.0 } else { -1.0 };
        let factor = 2.0 * turns / (PI * (turns * turns - k * k));
        if turns == k { (1.0, 0.0) } else { (sign * sin * factor, (1.0 - sign * cos) * factor) }
    };
    [places.iter().map(|k| at(*k).0).collect(), places.iter().map(|k| at(*k).1).collect()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_their_integrals() {
        const STEPS: u32 = 100_000;
        for (turns, k) in [(4.25, 1.0), (4.25, 4.0), (6.0, 6.0), (6.0, 5.0), (7.5, 2.0)] {
            let sum = |wave: fn(f64) -> f64| {
                let x = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
                let term = |step: u32| wave(PI * turns * x(step)) * libm::cos(PI * k * x(step));
                2.0 / f64::from(STEPS) * (0..STEPS).map(term).sum::<f64>()
            };
            let [cosine, sine] = waves(turns, &[k]);
            assert!((cosine[0] - sum(libm::cos)).abs() < 1e-8, "{turns} {k}");
            assert!((sine[0] - sum(libm::sin)).abs() < 1e-8, "{turns} {k}");
        }
    }
}
