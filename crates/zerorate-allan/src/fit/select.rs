//! Selects the terms: N, B and K always, the others if they lower −2 ln L by more than their price.

use super::density::{MOST_COSINES, Table};
use super::drift::Drift;
use super::scoring::{
    B2, Explanation, K2, LONGEST, Local, ModelForm, N2, Optimum, POLES, Problem, Q2, SHAPE, SHORTEST, low_pass_memory,
};
use super::{MOST_ERROR, readings};
use crate::{Coefficient, chi2_quantile};
use alloc::vec;
use alloc::vec::Vec;

/// The prices: a term must lower −2 ln L by this much. A Gauss–Markov term costs the 1 % point of χ² with two degrees
/// of freedom, a ramp the 0.1 % point with one, a warm-up the 0.1 % point with two. docs/reference/allan.md states how
/// often each term is selected by mistake.
const MARKOV_PRICE: f64 = 9.21;
/// Added to the price of a Gauss–Markov term that leaves no identified flicker. A few Gauss–Markov terms look like
/// flicker, and if both fit, flicker is preferred.
const INSTEAD_OF_FLICKER: f64 = 9.0;
/// Added to the price of a Gauss–Markov term that may be the sensor's low-pass. Cosines that follow a filter cost no
/// more than this. If they cannot follow it, the misfit raises −2 ln L by thousands.
const INSTEAD_OF_LOW_PASS: f64 = 50.0;
/// The 5 % point of χ² with one degree of freedom: the least gain of an identified coefficient.
const IDENTIFIED: f64 = 3.84;
const RAMP_PRICE: f64 = 10.8;
const WARM_UP_PRICE: f64 = 13.8;
const MOST_MARKOVS: usize = 2;
/// Number of start values of T, from `FIRST_START` samples to the share `LAST_START` of the record. The deviance has
/// several minima.
const STARTS: u32 = 18;
const FIRST_START: f64 = 25.0;
const LAST_START: f64 = 1.0 / 6.0;
/// The number of best starts from which a descent goes on.
const SURVIVORS: usize = 3;
/// Time constants of a warm-up to try, as shares of the record. A shorter warm-up ends before slow noise shows.
const WARM_UPS: [f64; 7] = [0.0075, 0.015, 0.03, 0.06, 0.12, 0.25, 0.5];
/// Steps in which the time constant of a warm-up is refined, to a factor of 2^(1/2^`WARM_UP_STEPS`). A time constant
/// that is a few percent off would leave a part of the warm-up that looks like random walk.
const WARM_UP_STEPS: u32 = 14;
/// A drift is tried in a record with more coefficients than this in bins of their own.
const FEWEST_OF_A_DRIFT: usize = 4;
/// Steps of a short trial and of a full descent, with the gain below which they end.
const LOOK: (usize, f64) = (8, 1e-2);
pub(super) const DESCENT: (usize, f64) = (60, 1e-5);
/// The model error is measured above this share of the upper end, where bins hold many coefficients.
const ERROR_ABOVE: f64 = 1.0 / 64.0;
/// Numbers of adjacent bins that may share one model error.
const RUNS: [usize; 5] = [1, 2, 4, 8, 16];
/// An error is sought if χ² of the upper bins is above its expected value by this many standard deviations.
const ERROR_LIMIT: f64 = 3.0;
/// Added to the limit, because χ² of few bins is skew.
const SKEW: f64 = 2.0;
/// Share of the records in which a correct model would be rejected by the means over one number of bins in [`RUNS`].
const REJECTED_BY_CHANCE: f64 = 1e-4;
/// Two choices of terms whose prices differ by less, in −2 ln L, cannot be told apart.
pub(super) const CLOSE: f64 = 6.0;
/// A second explanation is reported only if the N² of the two explanations differ by this factor or more.
const OTHER_N: f64 = 1.5;
/// A model with a correlation time within this factor of its bound is not selected.
const AT_BOUND: f64 = 1.1;

/// The selected model, the data to which it was fitted, and other models that explain these data nearly as well.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    pub(super) problem: Problem,
    pub(super) found: Optimum,
    /// The best model with other slow terms, and by how much its price is higher.
    pub(super) runner_up: Option<(ModelForm, f64)>,
    /// Another explanation of the whole spectrum that fits as well, with a different N.
    pub(super) other: Option<Other>,
}

/// Another explanation: a Gauss–Markov term in place of a low-pass of the white noise, or the other way round.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    /// The time constant of the Gauss–Markov term or low-pass, s.
    pub(super) tau_s: f64,
    pub(super) n: f64,
}

impl Other {
    /// The candidate as another explanation. `None` if the two N² differ by a factor below [`OTHER_N`], or if neither
    /// model has a time constant.
    fn of(problem: &Problem, chosen: &Optimum, candidate: &Optimum) -> Option<Self> {
        let (own, n2) = (chosen.at[N2], candidate.at[N2]);
        if own.max(n2) < OTHER_N * own.min(n2) {
            return None;
        }
        let low_pass_s = |found: &Optimum| {
            let (rate_hz, top_hz) = (problem.table.rate_hz, problem.table.top_hz);
            low_pass_memory(&found.form, &found.at, rate_hz, top_hz) / rate_hz
        };
        let time_s =
            |found: &Optimum| loudest(found).map_or_else(|| low_pass_s(found), |index| memory(found, index).1);
        let tau_s = [candidate, chosen].map(time_s).into_iter().find(|tau_s| *tau_s > 0.0)?;
        Some(Self { tau_s, n: libm::sqrt(n2) })
    }
}

impl Selection {
    /// Whether the model explains the whole spectrum. It does if it has no error and neither cosines nor a
    /// second-order low-pass, which could follow any filter over a part of the spectrum. It also does if it adds the
    /// slow noise after the filter and has a small error.
    pub(super) fn has_plain_form(&self) -> bool {
        let form = &self.found.form;
        match form.reading {
            Explanation::Joins => self.problem.error < MOST_ERROR / 2.0,
            _ => form.cosines == 0 && form.poles < 2 && self.problem.error == 0.0,
        }
    }

    /// The explanation that takes the model's Gauss–Markov term for a low-pass, or its low-pass for such a term.
    fn own_other(&self) -> Option<Other> {
        let (found, n2) = (&self.found, self.found.at[N2]);
        if let (Explanation::Joins, [pole]) = (found.form.reading, &found.at[SHAPE + found.form.cosines..]) {
            let samples = -1.0 / libm::log(*pole);
            return (samples > SHORTEST).then(|| Other { tau_s: samples / self.problem.table.rate_hz, n: 0.0 });
        }
        let is_hidden = readings::white_share(&self.problem, found) < MOST_ERROR;
        let is_short = found.form.reading == Explanation::Short;
        let least = if is_hidden { n2 } else { (OTHER_N - 1.0) * n2 };
        let loud = loudest(found).filter(|index| (is_hidden || is_short) && memory(found, *index).0 > least);
        let (plateau, tau_s) = memory(found, low_pass(&self.problem, found).or(loud)?);
        Some(Other { tau_s, n: libm::sqrt(n2 + plateau) })
    }

    /// Another reading of the model's own terms, or else another model whose N is outside the interval of `n`.
    pub(super) fn other(&self, n: &Coefficient) -> Option<Other> {
        self.own_other().or_else(|| self.other.filter(|other| other.n < n.lo || other.n > n.hi))
    }
}

#[derive(Clone, Debug)]
pub(super) struct PricedModel {
    pub(super) found: Optimum,
    pub(super) price: f64,
}

/// Selects the terms; `None` if no sound model has a finite likelihood. `shape_price` is the price of a cosine.
pub(super) fn select(table: Table, shape_price: f64) -> Option<Selection> {
    let ideal = Problem::new(table, 0.0).priced_at(shape_price);
    let families = families(&ideal);
    let others = families.iter().flat_map(|best| other_shapes(&ideal, &best.found));
    let others = others.chain(other_readings(&ideal, &families)).chain(plain_with_warm_up(&ideal));
    let others: Vec<Optimum> = others.collect();
    let all = families.iter().map(|best| &best.found).chain(&others);
    let error = all.map(|found| model_error(&ideal, found)).fold(f64::INFINITY, f64::min);
    let (mut problem, families) = match error > 0.0 && error.is_finite() {
        true => {
            let problem = Problem::new(ideal.table, error).priced_at(shape_price);
            let families = self::families(&problem);
            (problem, families)
        }
        false => (ideal, families),
    };
    let further = families.iter().flat_map(|best| variants(&problem, best));
    let read = other_readings(&problem, &families).into_iter().chain(plain_with_warm_up(&problem));
    let read = read.map(|found| priced(&problem, found));
    let mut all: Vec<PricedModel> = families.iter().cloned().chain(further).chain(read).collect();
    all.retain(|candidate| is_sound(&problem, &candidate.found));
    all.sort_by(|a, b| a.price.total_cmp(&b.price));
    let mut best = all.first()?.clone();
    let slow = |form: &ModelForm| (form.markovs, form.drift.is_some());
    let other = all.iter().find(|other| slow(&other.found.form) != slow(&best.found.form));
    let runner_up = other.map(|other| (other.found.form, other.price - best.price));
    if best.found.form.cosines > 0 {
        // the shape with the fewest cosines biases N, and the interval does not include the bias
        best.found = with_cosine(&problem, &best.found);
    }
    let close = all.iter().take_while(|other| other.price < best.price + CLOSE);
    let other = close.filter_map(|other| Other::of(&problem, &best.found, &other.found)).next();
    problem.restricted = best.found.form.drift.is_some();
    if problem.restricted {
        best.found = problem.descend(best.found.form, &best.found.at, None, DESCENT);
    }
    best.price.is_finite().then_some(Selection { problem, found: best.found, runner_up, other })
}

/// Other explanations of a whole spectrum if the best model has a Gauss–Markov term, a large shape, a model error or
/// hardly any white noise; otherwise none.
fn other_readings(problem: &Problem, families: &[PricedModel]) -> Vec<Optimum> {
    let is_bent = |found: &Optimum| {
        found.form.markovs > 0
            || found.form.shape() > MANY_COSINES
            || model_error(problem, found) > 0.0
            || readings::white_share(problem, found) < MOST_ERROR
    };
    let best = families.iter().min_by(|a, b| a.price.total_cmp(&b.price)).filter(|_| !problem.table.is_cut());
    best.filter(|best| is_bent(&best.found)).map_or(Vec::new(), |_| readings::others(problem))
}

pub(super) fn priced(problem: &Problem, found: Optimum) -> PricedModel {
    let form = &found.form;
    let drift = match form.drift {
        None => 0.0,
        Some(Drift::Ramp) => RAMP_PRICE,
        Some(Drift::WarmUp { .. }) => WARM_UP_PRICE,
    };
    let shape = problem.shape_price * (form.shape() + usize::from(form.quantised)) as f64;
    let instead = if form.markovs > 0 && !has_flicker(problem, &found) { INSTEAD_OF_FLICKER } else { 0.0 };
    let low_pass = if low_pass(problem, &found).is_some() { INSTEAD_OF_LOW_PASS } else { 0.0 };
    let price = found.deviance + shape + MARKOV_PRICE * form.markovs as f64 + instead + low_pass + drift;
    PricedModel { found, price }
}

fn has_flicker(problem: &Problem, found: &Optimum) -> bool {
    let mut at = found.at.clone();
    at[B2] = 0.0;
    let without = || problem.descend(found.form, &at, Some(B2), DESCENT).deviance;
    found.at[B2] > 0.0 && without() - found.deviance > IDENTIFIED
}

/// The best shape for zero, one and two Gauss–Markov terms. A second term is tried only if the first is taken. The
/// shape is chosen anew for each number of terms: a shape chosen before would absorb a Gauss–Markov term.
fn families(problem: &Problem) -> Vec<PricedModel> {
    let mut found: Vec<PricedModel> = Vec::new();
    let mut fewer: Vec<Optimum> = Vec::new();
    for markovs in 0..=MOST_MARKOVS {
        let (best, all) = family(problem, markovs, &fewer);
        let Some(best) = best else { break };
        let taken = found.last().is_none_or(|before| best.price < before.price);
        found.push(best);
        if !taken {
            break;
        }
        fewer = all;
    }
    found
}

/// Tries shapes with more and more cosines, until two in a row do not lower the price.
fn family(problem: &Problem, markovs: usize, fewer: &[Optimum]) -> (Option<PricedModel>, Vec<Optimum>) {
    let mut all: Vec<Optimum> = Vec::new();
    let mut best: Option<PricedModel> = None;
    let mut worse = 0;
    for (index, cosines) in (fewest_cosines(problem)..=MOST_CHOSEN).enumerate() {
        let mut tried: Vec<Optimum> = all.last().map(|before| with_cosine(problem, before)).into_iter().collect();
        match (markovs, fewer.get(index)) {
            (0, _) => {
                let form = ModelForm { cosines, ..ModelForm::PLAIN };
                tried.push(problem.descend(form, &start(problem, cosines), None, DESCENT));
            }
            (_, Some(fewer)) => tried.extend(with_markov(problem, fewer)),
            (_, None) => break,
        }
        let Some(found) = tried.into_iter().min_by(|a, b| a.deviance.total_cmp(&b.deviance)) else { break };
        all.push(found.clone());
        let candidate = priced(problem, found);
        match &best {
            Some(best) if best.price <= candidate.price => worse += 1,
            _ => (best, worse) = (Some(candidate), 0),
        }
        if worse == 2 {
            break;
        }
    }
    (best, all)
}

/// The most cosines that are chosen. If any are chosen, the result has one more.
pub(super) const MOST_CHOSEN: usize = MOST_COSINES - 1;

/// Least number of cosines: a model that ends below half the rate has a shape at its upper end.
pub(super) fn fewest_cosines(problem: &Problem) -> usize {
    usize::from(problem.table.is_cut())
}

/// Start values: white noise from the median of the upper band, flicker and random walk from the first coefficients.
pub(super) fn start(problem: &Problem, cosines: usize) -> Vec<f64> {
    let rows = &problem.table.rows;
    let mut upper: Vec<f64> = rows.iter().filter(|row| is_upper(problem, row.f_hz)).map(|row| row.bin.power).collect();
    upper.sort_unstable_by(f64::total_cmp);
    let first = &rows[..rows.len().min(6)];
    let level = first.iter().map(|row| row.bin.power).sum::<f64>() / first.len().max(1) as f64;
    let low = level * rows.get(2).map_or(1.0, |row| row.f_hz);
    let mut at = vec![0.0; SHAPE + cosines];
    at[N2] = upper.get(upper.len() / 2).copied().unwrap_or(level);
    at[B2] = low * core::f64::consts::PI;
    at[K2] = low * 5.0 * rows.get(2).map_or(1.0, |row| row.f_hz);
    at
}

pub(super) fn is_upper(problem: &Problem, f_hz: f64) -> bool {
    f_hz > ERROR_ABOVE * problem.table.top_hz
}

pub(super) fn with_cosine(problem: &Problem, before: &Optimum) -> Optimum {
    let mut at = before.at.clone();
    at.insert(SHAPE + before.form.cosines, 0.0);
    problem.descend(ModelForm { cosines: before.form.cosines + 1, ..before.form }, &at, None, DESCENT)
}

/// Adds a Gauss–Markov term. Empty if the record is too short for one.
pub(super) fn with_markov(problem: &Problem, fewer: &Optimum) -> Vec<Optimum> {
    let table = &problem.table;
    let (first, last) = (FIRST_START / table.rate_hz, LAST_START * table.span_s);
    if last <= first {
        return Vec::new();
    }
    let form = ModelForm { markovs: fewer.form.markovs + 1, ..fewer.form };
    let start = |start: u32| -> Vec<f64> {
        let tau_s = first * libm::pow(last / first, f64::from(start) / f64::from(STARTS - 1));
        let variance = 0.3 * level_near(table, 1.0 / (2.0 * core::f64::consts::PI * tau_s)) / tau_s;
        fewer.at.iter().copied().chain([variance, libm::log(tau_s)]).collect()
    };
    descents(problem, form, (0..STARTS).map(start))
}

/// A short trial from every start, and a full descent from the best trials.
pub(super) fn descents(problem: &Problem, form: ModelForm, starts: impl Iterator<Item = Vec<f64>>) -> Vec<Optimum> {
    let mut looks: Vec<Optimum> = starts.map(|at| problem.descend(form, &at, None, LOOK)).collect();
    looks.sort_by(|a, b| a.deviance.total_cmp(&b.deviance));
    looks.truncate(SURVIVORS);
    looks.iter().map(|found| problem.descend(form, &found.at, None, DESCENT)).collect()
}

pub(super) fn level_near(table: &Table, f_hz: f64) -> f64 {
    let nearest = table.rows.partition_point(|row| row.f_hz < f_hz);
    let part = &table.rows[nearest.saturating_sub(3)..(nearest + 4).min(table.rows.len())];
    part.iter().map(|row| row.bin.power).sum::<f64>() / part.len().max(1) as f64
}

/// The variants that are cheaper than `best`, with a low-pass or quantisation of the angle in place of cosines. Also
/// the cheapest of them (or `best`) with a ramp and with a warm-up, if the record has enough low coefficients.
fn variants(problem: &Problem, best: &PricedModel) -> Vec<PricedModel> {
    let shapes = other_shapes(problem, &best.found).into_iter().map(|found| priced(problem, found));
    let shapes: Vec<PricedModel> = shapes.filter(|other| other.price < best.price).collect();
    let least = shapes.iter().min_by(|a, b| a.price.total_cmp(&b.price)).unwrap_or(best);
    if problem.table.singles() <= FEWEST_OF_A_DRIFT {
        return shapes;
    }
    let ramp =
        problem.descend(ModelForm { drift: Some(Drift::Ramp), ..least.found.form }, &least.found.at, None, DESCENT);
    let drifts = [ramp, with_warm_up(problem, &least.found)].map(|found| priced(problem, found));
    drifts.into_iter().chain(shapes.iter().cloned()).collect()
}

/// White noise, flicker and random walk with a warm-up. A large warm-up bends the spectrum, so that a model without
/// drift needs terms that the noise does not have. `None` without enough low coefficients, or without a warm-up.
fn plain_with_warm_up(problem: &Problem) -> Option<Optimum> {
    let is_whole = problem.table.singles() > FEWEST_OF_A_DRIFT && fewest_cosines(problem) == 0;
    let plain = is_whole.then(|| problem.descend(ModelForm::PLAIN, &start(problem, 0), None, DESCENT))?;
    let warm_up = with_warm_up(problem, &plain);
    (warm_up.deviance + WARM_UP_PRICE < plain.deviance).then_some(warm_up)
}

/// The model with the warm-up that explains the most. Its time constant is refined if the warm-up is significant.
fn with_warm_up(problem: &Problem, found: &Optimum) -> Optimum {
    let with = |part: f64| {
        let drift = Some(Drift::WarmUp { tau_s: part * problem.table.span_s });
        problem.descend(ModelForm { drift, ..found.form }, &found.at, None, DESCENT)
    };
    let least = |a: Optimum, b: Optimum| if b.deviance < a.deviance { b } else { a };
    let coarse = WARM_UPS[1..].iter().map(|part| with(*part)).fold(with(WARM_UPS[0]), least);
    match coarse.deviance + WARM_UP_PRICE < found.deviance {
        true => with_refined_warm_up(problem, coarse),
        false => coarse,
    }
}

/// The model with the time constant, within a factor of 2, at which a warm-up explains the most.
fn with_refined_warm_up(problem: &Problem, coarse: Optimum) -> Optimum {
    let mut best = coarse;
    for step in 1..=WARM_UP_STEPS {
        let Some(Drift::WarmUp { tau_s }) = best.form.drift else { break };
        let factor = libm::exp2(libm::exp2(-f64::from(step)));
        let beside = [tau_s * factor, tau_s / factor].into_iter().map(|tau_s| {
            let form = ModelForm { drift: Some(Drift::WarmUp { tau_s }), ..best.form };
            problem.descend(form, &best.at, None, DESCENT)
        });
        best = beside.into_iter().find(|found| found.deviance < best.deviance).unwrap_or_else(|| best.clone());
    }
    best
}

/// Largest number of cosines for which they alone are no reason to try a pole or another explanation of the spectrum.
const MANY_COSINES: usize = 2;

fn other_shapes(problem: &Problem, found: &Optimum) -> Vec<Optimum> {
    if problem.table.is_cut() {
        return with_corner(problem, found);
    }
    let quantised = (found.form.cosines > 0).then(|| quantised(problem, found));
    quantised.into_iter().chain(with_pole(problem, found)).chain(with_corner(problem, found)).collect()
}

fn quantised(problem: &Problem, found: &Optimum) -> Optimum {
    let mut at = without_shape(found);
    at[Q2] = at[N2] / (problem.table.rate_hz * problem.table.rate_hz);
    problem.descend(ModelForm { cosines: 0, quantised: true, ..found.form }, &at, None, DESCENT)
}

/// A pole instead of many cosines, or instead of the Gauss–Markov term with the highest plateau. Fewer cosines than
/// before are tried beside it.
fn with_pole(problem: &Problem, found: &Optimum) -> Vec<Optimum> {
    let mut form = ModelForm { cosines: 0, poles: 1, ..found.form };
    let mut at = without_shape(found);
    let memories = (0..form.markovs).map(|index| {
        let (plateau, tau_s) = memory(found, index);
        (index, plateau, libm::exp(-1.0 / (tau_s * problem.table.rate_hz)))
    });
    let loud = memories.filter(|&(_, plateau, pole)| plateau > found.at[N2] && pole < POLES.1);
    let pole = if let Some((index, plateau, pole)) = loud.max_by(|a, b| a.1.total_cmp(&b.1)) {
        at.drain(SHAPE + 2 * index..SHAPE + 2 * index + 2);
        form.markovs -= 1;
        at[N2] += plateau;
        pole
    } else if found.form.cosines > MANY_COSINES {
        // the first cosine of a pole p is 2p
        (found.at[SHAPE] / 2.0).clamp(-0.9, 0.9)
    } else {
        return Vec::new();
    };
    at.insert(SHAPE, pole);
    let first = problem.descend(form, &at, None, DESCENT);
    let most = found.form.cosines.max(2) - 1;
    core::iter::successors(Some(first), |last| Some(with_cosine(problem, last))).take(most).collect()
}

/// A second-order low-pass in place of cosines, with fewer cosines than before beside it. The search for its corner
/// starts where the shape of the cosines falls to one half.
pub(super) fn with_corner(problem: &Problem, found: &Optimum) -> Vec<Optimum> {
    if found.form.cosines < 2 {
        return Vec::new();
    }
    let (local, rows) = (problem.local(found), &problem.table.rows);
    let is_down = |row: &usize| local.slopes[N2][*row] < 0.5 * rows[*row].bin.response.gain;
    let down = (0..rows.len()).find(is_down).unwrap_or(rows.len() - 1);
    let mut at = without_shape(found);
    at.splice(SHAPE..SHAPE, [libm::log(-rows[down].cosines[0] / 2.0), 0.0]);
    let first = problem.descend(ModelForm { cosines: 0, poles: 2, ..found.form }, &at, None, DESCENT);
    let more = core::iter::successors(Some(first), |last| Some(with_cosine(problem, last)));
    more.take(found.form.cosines.min(MOST_BESIDE_A_CORNER + 1)).collect()
}

const MOST_BESIDE_A_CORNER: usize = 3;

/// Whether the time constants of the Gauss–Markov terms, and the low-pass, are inside their bounds.
pub(super) fn is_sound(problem: &Problem, found: &Optimum) -> bool {
    let table = &problem.table;
    let (shortest, longest) = (AT_BOUND * found.form.shortest() / table.rate_hz, LONGEST * table.span_s / AT_BOUND);
    let tau_s = |index| libm::exp(found.at[found.form.markov(index) + 1]);
    let low_pass = SHAPE + found.form.cosines;
    (0..found.form.markovs).all(|index| tau_s(index) > shortest && tau_s(index) < longest)
        && (0..found.form.poles).all(|j| problem.is_free(found, low_pass + j))
}

/// The Gauss–Markov term that may be white noise behind a first-order low-pass. It has more power than the white noise
/// in the [`plateau`] bin or, beside a slow low-pass, a higher plateau than the white noise.
pub(super) fn low_pass(problem: &Problem, found: &Optimum) -> Option<usize> {
    let (local, row) = (problem.local(found), plateau(problem));
    let power = |index| local.slopes[found.form.markov(index)][row] * found.at[found.form.markov(index)];
    let is_slow = found.form.poles == 1 && found.at[SHAPE + found.form.cosines] > libm::exp(-1.0 / SHORTEST);
    let is_loud = |index| is_slow && memory(found, index).0 > found.at[N2];
    (0..found.form.markovs).find(|&index| power(index) > white(&local, found, row) || is_loud(index))
}

/// The Gauss–Markov term with the highest plateau.
fn loudest(found: &Optimum) -> Option<usize> {
    (0..found.form.markovs).max_by(|a, b| memory(found, *a).0.total_cmp(&memory(found, *b).0))
}

/// Returns the density of a Gauss–Markov term far below its corner, 2σ²T, and its correlation time T, s.
fn memory(found: &Optimum, index: usize) -> (f64, f64) {
    let place = found.form.markov(index);
    let tau_s = libm::exp(found.at[place + 1]);
    (2.0 * found.at[place] * tau_s, tau_s)
}

/// Index of the bin in which the plateau of the white noise is expected: at a quarter of the upper end.
pub(super) fn plateau(problem: &Problem) -> usize {
    let rows = &problem.table.rows;
    rows.partition_point(|row| row.f_hz < problem.table.top_hz / 4.0).min(rows.len().max(1) - 1)
}

/// The density of the white noise, with its shape, in a bin.
pub(super) fn white(local: &Local, found: &Optimum, row: usize) -> f64 {
    local.slopes[N2][row] * found.at[N2]
}

/// Returns the relative model error that accounts for the scatter of the upper bins, or 0 if chance does.
///
/// Adjacent bins may share an error. So means over 1 to 16 bins are tested, and the largest error counts.
pub(super) fn model_error(problem: &Problem, found: &Optimum) -> f64 {
    let rows = problem.table.rows.iter().zip(&found.density).filter(|(row, _)| is_upper(problem, row.f_hz));
    let off: Vec<(f64, f64)> = rows.map(|(row, density)| (row.bin.power / density - 1.0, row.bin.freedom)).collect();
    RUNS.iter().map(|run| error_of_runs(&off, *run, found.form.shape())).fold(0.0, f64::max)
}

/// The model error of a bin, from means over `run` bins; `off` has the relative deviation of each bin and its degrees
/// of freedom. An error that would reject the model must be beyond chance: few bins are often off by as much.
fn error_of_runs(off: &[(f64, f64)], run: usize, fitted: usize) -> f64 {
    let mean = |bins: &[(f64, f64)]| {
        let nu: f64 = bins.iter().map(|(_, nu)| nu).sum();
        (bins.iter().map(|(off, nu)| off * nu).sum::<f64>() / nu, nu)
    };
    let means: Vec<(f64, f64)> = off.chunks_exact(run).map(mean).collect();
    let freedom = means.len() as f64 - fitted as f64 - 1.0;
    if freedom < 1.0 {
        return 0.0;
    }
    // the deviance of a mean square is nearly χ² with one degree of freedom; the square of its error is not
    let deviance = |(off, nu): &(f64, f64)| nu * (off - libm::log1p(*off)) / (1.0 + 1.0 / (3.0 * nu));
    let is_chance = means.iter().map(deviance).sum::<f64>() < chi2_quantile(1.0 - REJECTED_BY_CHANCE, freedom);
    let scatter = |error: f64| means.iter().map(|(off, nu)| off * off / (2.0 / nu + error * error)).sum::<f64>();
    if is_chance && scatter(0.0) - freedom < ERROR_LIMIT * libm::sqrt(2.0 * freedom) + SKEW {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while scatter(high) > freedom && high < 1e6 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..40 {
        let middle = f64::midpoint(low, high);
        if scatter(middle) > freedom { low = middle } else { high = middle }
    }
    let error = libm::sqrt(run as f64) * high;
    if is_chance && error > MOST_ERROR { 0.0 } else { error }
}

/// χ² of the upper bins with their model error, and its degrees of freedom.
pub(super) fn chi2(problem: &Problem, found: &Optimum) -> (f64, f64) {
    let error = problem.error;
    let term = |(row, density): (&super::density::BinRow, &f64)| {
        let off = row.bin.power / density - 1.0;
        off * off / (2.0 / row.bin.freedom + error * error)
    };
    let chi2 = problem.table.rows.iter().zip(&found.density).filter(|(row, _)| is_upper(problem, row.f_hz)).map(term);
    let (mut sum, mut count) = (0.0, 0);
    chi2.for_each(|term| (sum, count) = (sum + term, count + 1));
    (sum, (f64::from(count) - found.form.shape() as f64 - 1.0).max(1.0))
}

pub(super) fn without_shape(found: &Optimum) -> Vec<f64> {
    let mut at = found.at.clone();
    at.drain(SHAPE..SHAPE + found.form.shape());
    at
}
