//! Converts the parameters of a fit to coefficients and terms with their intervals.

use super::drift::{Drift, Template};
use super::lines::Line;
use super::profile::Profile;
use super::readings::white_share;
use super::record_length;
use super::scoring::{Explanation, K2, LONGEST, N2, SHAPE, corner_hz};
use super::select::{Other, Selection};
use super::{Corner, Estimate, MOST_ERROR, Term};
use crate::Coefficient;
use alloc::vec::Vec;

pub(super) struct Coefficients<'a> {
    pub(super) samples: usize,
    pub(super) chosen: &'a Selection,
    pub(super) rate_hz: f64,
    pub(super) is_rejected: bool,
}

impl Coefficients<'_> {
    fn square(&self, place: usize) -> Profile<'_> {
        Profile::of_square(&self.chosen.problem, &self.chosen.found, place)
    }

    /// The coefficient whose square is the parameter at `place`.
    pub(super) fn of(&self, place: usize) -> Coefficient {
        let value = libm::sqrt(self.chosen.found.at[place]);
        let (lo, hi) = self.square(place).interval();
        self.finished(place, value, (libm::sqrt(lo), libm::sqrt(hi)))
    }

    fn finished(&self, place: usize, value: f64, (lo, hi): (f64, f64)) -> Coefficient {
        let identified = lo > 0.0 && !self.is_rejected;
        let needed_s = (lo <= 0.0 && !self.is_rejected).then(|| {
            let taken = value.max(hi / 2.0);
            let band = (self.rate_hz, self.chosen.problem.table.top_hz);
            record_length::needed_s(&self.chosen.found, self.samples, band, place, taken * taken)
        });
        Coefficient { value, lo: lo.min(value), hi: hi.max(value), identified, needed_s }
    }

    /// N, and a second explanation of the spectrum if one fits as well. The interval of ln N is at least
    /// ±1.96·`unsteady`, the standard deviation of ln N that the parts of the record show. It is widened by `tail`,
    /// the density at frequency 0 that a resonance may add, unit²/Hz.
    pub(super) fn n(&self, unsteady: f64, tail: f64) -> (Coefficient, Option<Other>) {
        let n = self.of(N2);
        let steady = 1.96 * unsteady;
        let doubt = tail / (2.0 * self.chosen.found.at[N2]);
        let wider = |ratio: f64| libm::exp(libm::log(ratio).max(steady) + doubt);
        let wide = Coefficient { lo: n.value / wider(n.value / n.lo), hi: n.value * wider(n.hi / n.value), ..n };
        // not identified if white noise is nowhere a tenth of the density, because the model may be off by as much
        let is_hidden = white_share(&self.chosen.problem, &self.chosen.found) < MOST_ERROR && !self.is_rejected;
        let needed_s = n.needed_s.or(is_hidden.then_some(f64::INFINITY));
        let own = if is_hidden { Coefficient { lo: 0.0, identified: false, needed_s, ..wide } } else { wide };
        let other = self.chosen.other(&own);
        (other.map_or(own, |other| own.or(other.n)), other)
    }

    /// K. Few coefficients of the spectrum determine it, so K² is the mean of its confidence distribution.
    pub(super) fn k(&self) -> Coefficient {
        let profile = self.square(K2);
        let (lo, hi) = profile.interval();
        self.finished(K2, libm::sqrt(profile.mean(hi)), (libm::sqrt(lo), libm::sqrt(hi)))
    }

    fn drift(&self) -> Estimate {
        let (problem, found) = (&self.chosen.problem, &self.chosen.found);
        let information = found.form.drift.map_or(0.0, |drift| {
            Template::new(drift, &problem.table).fitted(&problem.table, &problem.nu, &found.density).information
        });
        let half = 1.96 / libm::sqrt(information);
        Estimate { value: found.drift, lo: found.drift - half, hi: found.drift + half }
    }

    pub(super) fn ramp(&self) -> Coefficient {
        let Estimate { value, lo, hi } = self.drift();
        let (value, lo, hi) = if value < 0.0 { (-value, -hi, -lo) } else { (value, lo, hi) };
        Coefficient { value, lo: lo.max(0.0), hi, identified: lo > 0.0 && !self.is_rejected, needed_s: None }
    }

    pub(super) fn terms(&self, lines: &[Line]) -> Vec<Term> {
        let (table, found) = (&self.chosen.problem.table, &self.chosen.found);
        let range = (libm::log(found.form.shortest() / self.rate_hz), libm::log(LONGEST * table.span_s));
        let markov = |index| {
            let place = found.form.markov(index);
            let (lo, hi) = self.square(place).interval();
            let variance = Estimate { value: found.at[place], lo, hi };
            let (lo, hi) = Profile::between(&self.chosen.problem, found, place + 1, range).interval();
            let log = Estimate { value: found.at[place + 1], lo, hi };
            Term::GaussMarkov { sigma: variance.map(libm::sqrt), tau_s: log.map(libm::exp) }
        };
        let mut terms: Vec<Term> = (0..found.form.markovs).map(markov).collect();
        if found.form.shape() > 0 {
            let (cosines, low_pass) = found.at[SHAPE..SHAPE + found.form.shape()].split_at(found.form.cosines);
            let (pole, corner) = match *low_pass {
                [u, damping] => {
                    (None, Some(Corner { frequency_hz: corner_hz(u, self.rate_hz, table.top_hz), damping }))
                }
                _ => (low_pass.first().copied(), None),
            };
            let of_white = found.form.reading == Explanation::Joins;
            terms.push(Term::BandShape { cosines: cosines.to_vec(), pole, corner, of_white });
        }
        if let Some(Drift::WarmUp { tau_s }) = found.form.drift {
            terms.push(Term::WarmUp { size: self.drift(), tau_s });
        }
        terms.extend(lines.iter().map(|line| Term::Line(*line)));
        terms
    }
}

impl Estimate {
    pub(crate) fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self { value: of(self.value), lo: of(self.lo), hi: of(self.hi) }
    }
}

impl Coefficient {
    /// The coefficient if the value `other` explains the record as well. The interval includes both values, and a
    /// longer record would not decide between them.
    pub(super) fn or(self, other: f64) -> Self {
        Self { lo: self.lo.min(other), hi: self.hi.max(other), identified: false, needed_s: None, ..self }
    }
}
