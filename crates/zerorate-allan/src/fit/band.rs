//! The frequency up to which the model describes the noise. Above it, the model does not follow the sensor's filter.
//!
//! N² is the density at frequency 0 of noise that a filter shapes above some frequency. Fitted to the lowest part of
//! the spectrum, N is right but uncertain. A higher upper end makes N more certain, until a shape of few terms no
//! longer follows the filter. An upper end is fair if its N agrees with the N of all lower fair ends (Lepski 1991).
//! The fair end with the most certain N is taken. The lowest end may be off by chance, so the longest chain of ends
//! that agree counts.

use super::MOST_ERROR;
use super::density::Table;
use super::profile::marginal_variance;
use super::scoring::{ModelForm, N2, Optimum, Problem, SHAPE};
use super::select::{
    DESCENT, MOST_CHOSEN, PricedModel, fewest_cosines, is_sound, model_error, plateau, priced, start, white,
    with_corner, with_cosine, with_markov, without_shape,
};
use alloc::vec::Vec;

/// The upper ends to try are half the rate and `STEPS_DOWN` lower frequencies, half an octave apart. Each needs more
/// than `FEWEST_COEFFICIENTS` coefficients below it.
const STEPS_DOWN: u32 = 14;
const FEWEST_COEFFICIENTS: f64 = 1500.0;
/// Least share of white noise in the density of the [`plateau`] bin. With less, the white noise does not show.
const PLATEAU: f64 = 0.7;
/// Standard deviations by which two upper ends may differ in ln N. At 3 a record without a filter loses half an octave
/// in 3 of 100 cases, at 3.5 in none.
const AGREE: f64 = 3.5;
/// Least variance of a difference of ln N, as a share of the variance at the lower end.
const LEAST_DIFFERENCE: f64 = 0.04;

struct FitUpTo {
    top_hz: f64,
    /// ln N and its variance.
    ln_n: f64,
    variance: f64,
    error: f64,
    /// Whether the shape follows the filter up to `top_hz`, the white noise shows in the spectrum, the model error is
    /// small, and N agrees with the other fair ends.
    is_fair: bool,
    /// The fitted parameters without the parameters of the shape.
    slow: Vec<f64>,
}

/// The upper end of the model, Hz. In the low part of the spectrum, a Gauss–Markov term can imitate a filter. So a
/// scan with such a term counts only if the term lowers −2 ln L by more than its price, and if the white noise shows
/// beside the term.
pub(super) fn top_hz(table: &Table) -> f64 {
    let tops = tops(table);
    let &[lowest, .., full] = &tops[..] else { return table.top_hz };
    let middle = tops[tops.len() / 2];
    let with = |top_hz: f64| {
        let problem = Problem::new(table.below(top_hz), 0.0);
        let plain = best(&problem, &[start(&problem, 0)], 0, 2)?;
        let found = with_markov(&problem, &plain.found);
        found.into_iter().min_by(|a, b| a.deviance.total_cmp(&b.deviance)).map(|found| without_shape(&found))
    };
    let starts = [middle, full].into_iter().filter_map(with).collect();
    let one = scan(table, &tops, 1, starts).filter(|look| look.is_fair && has_memory(table, look));
    let plain = || Vec::from([start(&Problem::new(table.below(lowest), 0.0), 0)]);
    let look = one.or_else(|| scan(table, &tops, 0, plain()));
    look.map_or(full, |look| look.top_hz)
}

/// The upper ends to try, Hz, ascending. Empty if the record is too short.
fn tops(table: &Table) -> Vec<f64> {
    let tops = (0..=STEPS_DOWN).rev().map(|step| table.rate_hz / 2.0 * libm::exp2(-f64::from(step) / 2.0));
    tops.filter(|top_hz| 2.0 * top_hz * table.span_s > FEWEST_COEFFICIENTS).collect()
}

/// Fits up to each end, from the lowest on, starting from the fit before. Returns the fair fit with the most certain
/// N. If none is fair, returns the highest fit with a small model error, or else the highest.
fn scan(table: &Table, tops: &[f64], markovs: usize, mut starts: Vec<Vec<f64>>) -> Option<FitUpTo> {
    let mut looks: Vec<FitUpTo> = Vec::new();
    for &top_hz in tops {
        let look = look(table, top_hz, markovs, &starts)?;
        starts = Vec::from([look.slow.clone()]);
        looks.push(look);
    }
    let agreeing = agreeing(&looks);
    looks.iter_mut().for_each(|look| look.is_fair = agreeing.contains(&look.top_hz));
    let surest = looks.iter().filter(|look| look.is_fair).min_by(|a, b| a.variance.total_cmp(&b.variance));
    let holds = || looks.iter().rev().find(|look| look.error < MOST_ERROR);
    let top_hz = surest.or_else(holds).or(looks.last())?.top_hz;
    looks.into_iter().find(|look| look.top_hz == top_hz)
}

fn look(table: &Table, top_hz: f64, markovs: usize, starts: &[Vec<f64>]) -> Option<FitUpTo> {
    let mut problem = Problem::new(table.below(top_hz), 0.0);
    let mut found = best(&problem, starts, markovs, MOST_CHOSEN)?.found;
    let error = model_error(&problem, &found);
    if error > 0.0 {
        problem = Problem::new(problem.table, error);
        found = best(&problem, &[without_shape(&found)], markovs, MOST_CHOSEN)?.found;
    }
    let slow = without_shape(&found);
    let has_followed = has_followed(&found);
    if found.form.shape() > 0 {
        found = with_cosine(&problem, &found);
    }
    let n2 = found.at[N2];
    let variance = marginal_variance(&problem, &found, N2, &problem.information(&found))? / (4.0 * n2 * n2);
    let is_fair = has_followed && is_held(&problem) && sees_plateau(&problem, &found) && error < MOST_ERROR;
    Some(FitUpTo { top_hz, ln_n: libm::log(n2) / 2.0, variance, error, is_fair, slow })
}

/// The longest chain of fair ends, Hz, that each agree with all lower ones of the chain. Of equal chains, the lowest.
fn agreeing(looks: &[FitUpTo]) -> Vec<f64> {
    let from = |first: usize| {
        let mut chain: Vec<&FitUpTo> = Vec::new();
        for look in looks[first..].iter().filter(|look| look.is_fair) {
            if chain.iter().all(|lower| look.agrees(lower)) {
                chain.push(look);
            }
        }
        chain
    };
    let longest = (0..looks.len()).rev().map(from).max_by_key(Vec::len);
    longest.unwrap_or_default().iter().map(|look| look.top_hz).collect()
}

impl FitUpTo {
    fn agrees(&self, lower: &Self) -> bool {
        let apart = (lower.variance - self.variance).max(LEAST_DIFFERENCE * lower.variance);
        libm::fabs(self.ln_n - lower.ln_n) < AGREE * libm::sqrt(apart)
    }
}

/// Whether the shape needs fewer cosines than the limit. Otherwise a Gauss–Markov term would absorb its misfit.
fn has_followed(found: &Optimum) -> bool {
    found.form.cosines < MOST_CHOSEN
}

/// Whether bins constrain the shape in more than half of its last octave. Across masked bins the shape is free.
fn is_held(problem: &Problem) -> bool {
    let top_hz = problem.table.top_hz;
    let held_hz: f64 = problem.table.rows.iter().map(|row| row.width_above(top_hz / 2.0)).sum();
    held_hz > top_hz / 4.0
}

fn sees_plateau(problem: &Problem, found: &Optimum) -> bool {
    let (rows, at) = (&problem.table.rows, plateau(problem));
    white(&problem.local(found), found, at) > PLATEAU * (found.density[at] - rows[at].bin.response.offset)
}

/// The model with the lowest price from any of `starts`, which have no cosines. Cosines are added, up to `most`, until
/// two in a row do not lower the price. A second-order low-pass replaces some of them if this lowers the price.
fn best(problem: &Problem, starts: &[Vec<f64>], markovs: usize, most: usize) -> Option<PricedModel> {
    let from = |slow: &Vec<f64>| {
        let cosines = fewest_cosines(problem);
        let form = ModelForm { cosines, markovs, ..ModelForm::PLAIN };
        let mut at = slow.clone();
        at.splice(SHAPE..SHAPE, core::iter::repeat_n(0.0, cosines));
        let mut best = priced(problem, problem.descend(form, &at, None, DESCENT));
        let (mut last, mut worse) = (best.found.clone(), 0);
        while worse < 2 && last.form.cosines < most {
            last = with_cosine(problem, &last);
            let next = priced(problem, last.clone());
            if next.price < best.price { (best, worse) = (next, 0) } else { worse += 1 }
        }
        best
    };
    let of_cosines = starts.iter().map(from).min_by(|a, b| a.price.total_cmp(&b.price))?;
    let corners = with_corner(problem, &of_cosines.found).into_iter().map(|found| priced(problem, found));
    let sound = corners.filter(|corner| is_sound(problem, &corner.found));
    sound.chain([of_cosines]).min_by(|a, b| a.price.total_cmp(&b.price))
}

/// Whether a Gauss–Markov term lowers −2 ln L by more than its price, in fits of the spectrum up to `look.top_hz`.
/// False if the model without the term needs too many cosines, or if the term or the low-pass is at a bound.
fn has_memory(table: &Table, look: &FitUpTo) -> bool {
    let problem = Problem::new(table.below(look.top_hz), look.error);
    let one = best(&problem, core::slice::from_ref(&look.slow), 1, MOST_CHOSEN);
    let none = best(&problem, &[start(&problem, 0), look.slow[..SHAPE].to_vec()], 0, MOST_CHOSEN);
    let (Some(one), Some(none)) = (one, none) else { return false };
    has_followed(&none.found) && one.price < none.price && is_sound(&problem, &one.found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Fits up to 1, 2, 4 … Hz, each with its ln N and the standard deviation of ln N.
    fn looks(all: &[(f64, f64)]) -> Vec<FitUpTo> {
        let look = |(step, &(ln_n, sigma)): (i32, &(f64, f64))| FitUpTo {
            top_hz: libm::exp2(f64::from(step)),
            ln_n,
            variance: sigma * sigma,
            error: 0.0,
            is_fair: true,
            slow: Vec::new(),
        };
        (0..).zip(all).map(look).collect()
    }

    #[test]
    fn a_low_end_that_is_off_by_chance_is_outvoted() {
        let all = [(0.17, 0.03), (0.01, 0.025), (0.0, 0.02), (-0.01, 0.015), (0.0, 0.01)];
        assert_eq!(agreeing(&looks(&all)), [2.0, 4.0, 8.0, 16.0]);
    }

    #[test]
    fn ends_in_the_filter_are_not_fair() {
        let all = [(0.01, 0.04), (-0.01, 0.03), (0.0, 0.02), (-0.2, 0.015), (-0.4, 0.01)];
        assert_eq!(agreeing(&looks(&all)), [1.0, 2.0, 4.0]);
    }
}
